//! The folder where the window keeps what outlasts it: settings, and work that was not saved. Whatever stands in
//! there, the window opens; what cannot be read is put aside and told of, never written over.

use std::collections::HashMap;
use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::app::session::settings::Settings;
use crate::scene::{SceneError, file};

/// The longest file that is read here, in bytes; settings take a few thousand.
const LONGEST: u64 = 1 << 20;

/// The folder, and what was found there.
#[derive(Debug)]
pub struct Home {
    folder: PathBuf,
    /// The settings' text as the file has it; `None` where the file must not be written over.
    known: Option<String>,
    /// Where eframe keeps the window's place and the panels' sizes; `None` where what is there must not be read.
    layout: Option<PathBuf>,
    /// What was wrong, a line each.
    complaints: Vec<String>,
}

impl Home {
    /// Looks into a folder, which need not be there yet; gives the settings that are kept in it.
    pub fn open(folder: &Path) -> (Self, Settings) {
        let layout = folder.join("app.ron");
        let mut home =
            Home { folder: folder.to_path_buf(), known: None, layout: Some(layout.clone()), complaints: Vec::new() };
        let settings = match read(&home.settings_file(), Settings::parse) {
            Ok(settings) => {
                home.known = Some(settings.as_ref().map(Settings::to_ron).unwrap_or_default());
                settings.unwrap_or_default()
            }
            Err(error) => {
                let aside = home.put_aside(&home.settings_file(), &error, "the usual settings are taken");
                home.known = aside.then(String::new);
                Settings::default()
            }
        };
        // eframe reads its file whatever it is, and would wait for a pipe.
        let pairs = |text: &str, name: &Path| {
            ron::from_str::<HashMap<String, String>>(text)
                .map(drop)
                .map_err(|error| SceneError::file(name, None, error.to_string(), "it was not written by this program"))
        };
        if let Err(error) = read(&layout, pairs)
            && !home.put_aside(&layout, &error, "panels have their usual sizes")
        {
            home.layout = None;
        }
        (home, settings)
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Where eframe may keep the window's place and the panels' sizes; a name that nothing has where what is there
    /// can be neither read nor put aside.
    pub fn layout(&self) -> PathBuf {
        self.layout.clone().unwrap_or_else(|| free_name(&self.folder.join("app.ron")))
    }

    /// What was wrong with what was found, a line each.
    pub fn complaints(&self) -> &[String] {
        &self.complaints
    }

    /// Writes the settings, whole or not at all, if they changed.
    pub fn save(&mut self, settings: &Settings) -> Result<(), SceneError> {
        let text = settings.to_ron();
        if self.known.as_ref().is_some_and(|known| *known != text) {
            // Where this fails, so does the write, which says why.
            let _ = std::fs::create_dir_all(&self.folder);
            file::write_whole(&self.settings_file(), text.as_bytes())?;
            self.known = Some(text);
        }
        Ok(())
    }

    fn settings_file(&self) -> PathBuf {
        self.folder.join("settings.ron")
    }

    /// Renames what cannot be read, so that it is not lost when its name is written to again; takes a note of it, with
    /// what happens `instead`. False where it stays.
    fn put_aside(&mut self, path: &Path, error: &SceneError, instead: &str) -> bool {
        let (aside, line) = put_aside(path, error, instead);
        self.complaints.push(line);
        aside
    }
}

/// Reads a file, `None` where there is none.
fn read<T>(path: &Path, parse: impl Fn(&str, &Path) -> Result<T, SceneError>) -> Result<Option<T>, SceneError> {
    match path.symlink_metadata() {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        _ => parse(&file::read_text(path, LONGEST)?, path).map(Some),
    }
}

/// Renames what cannot be read; whether that went well, and a line that tells of it.
pub(super) fn put_aside(path: &Path, error: &SceneError, instead: &str) -> (bool, String) {
    let aside = free_name(path);
    match std::fs::rename(path, &aside) {
        Ok(()) => (true, format!("{error}; {instead}, and it is kept as {}", aside.display())),
        Err(_) => (false, format!("{error}; {instead}, and it is left as it is")),
    }
}

/// A name beside `path` that nothing has yet.
fn free_name(path: &Path) -> PathBuf {
    let name = |number: usize| {
        let mut name = path.file_name().map(OsString::from).unwrap_or_default();
        name.push(format!(".unreadable-{number}"));
        path.with_file_name(name)
    };
    let is_free = |path: &PathBuf| path.symlink_metadata().is_err();
    (1..1000).map(name).find(is_free).unwrap_or_else(|| name(1000))
}
