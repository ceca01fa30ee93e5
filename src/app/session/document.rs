//! The preset that is being edited: its file, what was saved of it, and the way back.

use std::path::{Path, PathBuf};

use egui::util::undoer::{Settings, Undoer};

use crate::scene::{Preset, SceneError, builtin};
use crate::transport::preset;

/// A preset on the desk.
#[derive(Debug)]
pub struct Document {
    /// The preset as edited.
    pub preset: Preset,
    /// Its file, if it has one.
    path: Option<PathBuf>,
    /// A name for it where it has no file.
    name: String,
    /// The preset as its file has it; `None` where that is not known.
    saved: Option<Preset>,
    undoer: Undoer<Preset>,
}

impl Document {
    /// A preset that was just loaded.
    pub fn new(preset: Preset, path: Option<PathBuf>) -> Self {
        let name = if preset.title.is_empty() { "Untitled".to_owned() } else { preset.title.clone() };
        Document::named(preset, path, name)
    }

    /// A built-in preset; it has no file until it is saved.
    pub fn built_in(name: &str) -> Result<Self, SceneError> {
        let text = builtin::find(name).unwrap_or_default();
        Ok(Document::named(preset::parse(text, Path::new(name))?, None, name.to_owned()))
    }

    /// Edits that were never saved.
    pub fn unsaved(preset: Preset, path: Option<PathBuf>, name: String) -> Self {
        Document { saved: None, ..Document::named(preset, path, name) }
    }

    fn named(preset: Preset, path: Option<PathBuf>, name: String) -> Self {
        // An edit is a step of its own as soon as the hand rests.
        let settings = Settings { stable_time: 0.4, ..Settings::default() };
        let mut undoer = Undoer::with_settings(settings);
        undoer.add_undo(&preset);
        Document { saved: Some(preset.clone()), preset, path, name, undoer }
    }

    /// Its file, if it has one.
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// The folder that paths in it are relative to.
    pub fn folder(&self) -> PathBuf {
        match &self.path {
            Some(path) => path.parent().unwrap_or(Path::new("")).to_path_buf(),
            // What has no file yet came from a built-in preset. Without a folder its files are missed by name.
            None => builtin::folder().unwrap_or_default(),
        }
    }

    /// What people call it: its file's name, or its own.
    pub fn name(&self) -> String {
        let of_file = self.path.as_ref().and_then(|path| path.file_name());
        of_file.map_or_else(|| self.name.clone(), |name| name.to_string_lossy().into_owned())
    }

    /// Whether closing it would lose nothing.
    pub fn is_saved(&self) -> bool {
        self.saved.as_ref() == Some(&self.preset)
    }

    /// Writes it to its file, or to `path` and makes that its file.
    pub fn save(&mut self, path: Option<PathBuf>) -> Result<(), SceneError> {
        let Some(path) = path.or_else(|| self.path.clone()) else { return Ok(()) };
        self.preset.save(&path)?;
        self.path = Some(path);
        self.saved = Some(self.preset.clone());
        Ok(())
    }

    /// Takes note of the preset as it is at `time`, in seconds; edits that rest become steps of undo.
    /// True while an edit has not come to rest.
    pub fn note(&mut self, time: f64) -> bool {
        self.undoer.feed_state(time, &self.preset);
        self.undoer.is_in_flux()
    }

    /// Whether there is an edit to take back.
    pub fn can_undo(&self) -> bool {
        self.undoer.has_undo(&self.preset)
    }

    /// Whether there is an edit to do again.
    pub fn can_redo(&self) -> bool {
        self.undoer.has_redo(&self.preset)
    }

    /// Takes the last edit back.
    pub fn undo(&mut self) {
        if let Some(before) = self.undoer.undo(&self.preset) {
            self.preset = before.clone();
        }
    }

    /// Does the last undone edit again.
    pub fn redo(&mut self) {
        if let Some(after) = self.undoer.redo(&self.preset) {
            self.preset = after.clone();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_are_taken_back_and_done_again_one_by_one() {
        let mut document = Document::new(Preset::default(), None);
        for (time, factor) in [(1.0, 3.5), (2.0, 3.6), (3.0, 4.0)] {
            document.preset.propagation.factor = factor;
            document.note(time);
            assert!(!document.note(time + 0.5));
        }
        assert!(!document.is_saved() && document.can_undo() && !document.can_redo());
        let mut seen = Vec::new();
        while document.can_undo() {
            document.undo();
            seen.push(document.preset.propagation.factor);
        }
        assert_eq!(seen, [3.6, 3.5, 3.0]);
        assert!(document.is_saved());
        document.redo();
        assert_eq!(document.preset.propagation.factor, 3.5);
    }

    #[test]
    fn saving_makes_the_file_hold_the_preset() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.ron");
        let mut document = Document::new(Preset::default(), None);
        document.preset.title = "Mine".to_owned();
        assert!(!document.is_saved());
        document.save(Some(path.clone())).unwrap();
        assert!(document.is_saved());
        assert_eq!(document.name(), "mine.ron");
        assert_eq!(document.folder(), folder.path());
        assert_eq!(Preset::load(&path).unwrap(), document.preset);
    }
}
