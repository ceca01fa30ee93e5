//! Unsaved work survives a crash: while a document has unsaved changes they are written beside the settings every few
//! seconds, and what a window left there that runs no more is offered to the next.
//!
//! The file `unsaved-7-0.ron` belongs to whoever holds the lock on `unsaved-7-0.lock`. The system takes a lock back when
//! its program ends, however it ends, so that no window takes what another is still writing.

mod slot;

use std::path::{Path, PathBuf};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, SystemTime};

use serde::{Deserialize, Serialize};

use super::home::put_aside;
use crate::app::session::document::Document;
use crate::app::session::unreadable::fault;
use crate::scene::{Preset, SceneError, file};
use slot::Slot;

/// Seconds between two writes.
const PAUSE: f64 = 3.0;
/// The longest file that is read, in bytes: twice the longest preset.
const LONGEST: u64 = 8 << 20;
/// How many files are looked at, at most, so that no crowd of them holds the window up.
const MOST: usize = 32;

/// Unsaved work, as it is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Unsaved {
    /// What people call the document.
    name: String,
    /// Its file, if it has one that can be written as text.
    path: Option<PathBuf>,
    preset: Preset,
}

impl Unsaved {
    fn of(document: &Document) -> Self {
        let whole = document.path().map(|path| std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()));
        let path = whole.filter(|path| path.to_str().is_some());
        Unsaved { name: document.name(), path, preset: document.preset.clone() }
    }

    fn to_ron(&self) -> String {
        // Writing numbers and strings to a String has no way to fail; paths that are no text are left out.
        dialect().to_string(self).unwrap_or_default()
    }

    fn load(path: &Path) -> Result<Self, SceneError> {
        let found = dialect().from_str(&file::read_text(path, LONGEST)?);
        found.map_err(|error| fault(&error, path, "this is no unsaved work of this program"))
    }
}

fn dialect() -> ron::Options {
    // Presets leave `Some` out, and neither they nor what is around them is nested deeply.
    let leave_out_some = ron::extensions::Extensions::IMPLICIT_SOME;
    ron::Options::default().with_default_extension(leave_out_some).with_recursion_limit(32)
}

/// Unsaved work that a window left.
#[derive(Debug)]
struct Found {
    slot: Slot,
    unsaved: Unsaved,
    written: SystemTime,
}

/// The unsaved work of this window, and that of windows that crashed.
#[derive(Debug)]
pub struct Recovery {
    folder: PathBuf,
    /// Where this window's work is kept; there is none while it is saved.
    slot: Option<Slot>,
    /// What was last written there.
    kept: Option<Preset>,
    writing: Option<JoinHandle<Result<(), SceneError>>>,
    /// When the next write may begin, in seconds.
    due: f64,
    /// What other windows left, the latest first.
    found: Vec<Found>,
    /// Why unsaved work could not be kept, until it is told; told once.
    complaint: Option<String>,
    told: bool,
}

impl Recovery {
    /// Looks for what windows left in `folder`. Files that cannot be read are put aside, with a line for each.
    pub fn look(folder: &Path) -> (Self, Vec<String>) {
        let (mut found, mut complaints) = (Vec::new(), Vec::new());
        for path in slot::files(folder).into_iter().take(MOST) {
            let Some(slot) = Slot::take(&path) else { continue };
            match Unsaved::load(&path) {
                Ok(unsaved) => {
                    let written = path.metadata().and_then(|data| data.modified()).unwrap_or(SystemTime::UNIX_EPOCH);
                    found.push(Found { slot, unsaved, written });
                }
                Err(error) => {
                    complaints.push(put_aside(&path, &error, "this unsaved work cannot be recovered").1);
                    slot.remove_lock();
                }
            }
        }
        found.sort_by_key(|found| std::cmp::Reverse(found.written));
        let folder = folder.to_path_buf();
        (
            Recovery { folder, slot: None, kept: None, writing: None, due: 0.0, found, complaint: None, told: false },
            complaints,
        )
    }

    /// Keeps what is not saved at `time`, in seconds; gives up what is. The seconds after which it wants to be called
    /// again, if it does.
    pub fn keep(&mut self, document: &Document, time: f64) -> Option<f64> {
        if document.is_saved() {
            self.forget();
            return None;
        }
        if self.kept.as_ref() == Some(&document.preset) {
            return None;
        }
        if time < self.due || self.writing.as_ref().is_some_and(|writing| !writing.is_finished()) {
            return Some((self.due - time).max(0.1));
        }
        self.due = time + PAUSE;
        self.finish();
        if let Err(error) = self.write(document) {
            self.complain(format!("unsaved work is not kept in {}: {error}", self.folder.display()));
            return Some(PAUSE);
        }
        None
    }

    /// Starts to write, on a thread of its own because disks may take their time.
    fn write(&mut self, document: &Document) -> std::io::Result<()> {
        let slot = match self.slot.take() {
            Some(slot) => slot,
            None => Slot::new(&self.folder)?,
        };
        let (path, unsaved) = (slot.path().to_path_buf(), Unsaved::of(document));
        self.slot = Some(slot);
        let write = move || file::write_whole(&path, unsaved.to_ron().as_bytes());
        self.writing = Some(Builder::new().name("unsaved work".to_owned()).spawn(write)?);
        self.kept = Some(document.preset.clone());
        Ok(())
    }

    /// Waits until the last write is done.
    fn finish(&mut self) {
        match self.writing.take().map(JoinHandle::join) {
            Some(Ok(Err(error))) => {
                self.kept = None;
                self.complain(format!("unsaved work is not kept: {error}"));
            }
            Some(Err(_)) => self.kept = None,
            Some(Ok(Ok(()))) | None => {}
        }
    }

    fn complain(&mut self, line: String) {
        if !std::mem::replace(&mut self.told, true) {
            self.complaint = Some(line);
        }
    }

    /// Why unsaved work could not be kept, the first time that it could not.
    pub fn complaint(&mut self) -> Option<String> {
        self.complaint.take()
    }

    /// Removes what was kept of this window's work.
    pub fn forget(&mut self) {
        self.finish();
        self.kept = None;
        self.slot.take().into_iter().for_each(Slot::remove);
    }

    /// Takes over the latest work that was found, in place of this window's. It stays on the disk, as this window's.
    pub fn recover(&mut self) -> Option<Document> {
        let Found { slot, unsaved, .. } = (!self.found.is_empty()).then(|| self.found.remove(0))?;
        self.forget();
        self.slot = Some(slot);
        self.kept = Some(unsaved.preset.clone());
        Some(Document::unsaved(unsaved.preset, unsaved.path, unsaved.name))
    }

    /// What is offered, in a line.
    pub fn offer(&self) -> Option<String> {
        let latest = self.found.first()?;
        let more = match self.found.len() - 1 {
            0 => String::new(),
            more => format!(" ({more} more after this)"),
        };
        // A clock that was set back tells nothing.
        let age = SystemTime::now().duration_since(latest.written).unwrap_or_default();
        let name = &latest.unsaved.name;
        Some(format!("Unsaved changes of {name} from {} were left by a window that ended early{more}.", ago(age)))
    }

    /// Removes the latest work that was found.
    pub fn discard(&mut self) {
        if !self.found.is_empty() {
            self.found.remove(0).slot.remove();
        }
    }
}

/// A time that has passed, as people say it.
fn ago(age: Duration) -> String {
    let minutes = age.as_secs() / 60;
    let (count, unit) = match minutes {
        0 => return "less than a minute ago".to_owned(),
        1..60 => (minutes, "minute"),
        60..2880 => (minutes / 60, "hour"),
        _ => (minutes / 1440, "day"),
    };
    format!("{count} {unit}{} ago", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ages_are_told_as_people_do() {
        let told = |seconds| ago(Duration::from_secs(seconds));
        assert_eq!(told(59), "less than a minute ago");
        assert_eq!([told(60), told(3599)], ["1 minute ago", "59 minutes ago"]);
        assert_eq!([told(3600), told(172_799)], ["1 hour ago", "47 hours ago"]);
        assert_eq!(told(172_800), "2 days ago");
    }

    fn edited(factor: f64) -> Document {
        let mut document = Document::new(Preset::default(), None);
        document.preset.propagation.factor = factor;
        document
    }

    fn files(folder: &Path) -> usize {
        std::fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn unsaved_work_is_kept_every_few_seconds_and_given_up_when_it_is_saved() {
        let folder = tempfile::tempdir().unwrap();
        let (mut recovery, _) = Recovery::look(folder.path());
        let mut document = edited(3.5);
        recovery.keep(&document, 10.0);
        recovery.finish();
        let path = slot::files(folder.path())[0].clone();
        let kept = || Unsaved::load(&path).unwrap().preset.propagation.factor;
        assert_eq!(kept(), 3.5);
        document.preset.propagation.factor = 3.6;
        assert!(recovery.keep(&document, 10.5).is_some_and(|wait| wait <= PAUSE));
        recovery.finish();
        assert_eq!(kept(), 3.5);
        assert_eq!(recovery.keep(&document, 10.0 + PAUSE), None);
        recovery.finish();
        assert_eq!(kept(), 3.6);
        document.save(Some(folder.path().join("saved.ron"))).unwrap();
        recovery.keep(&document, 20.0);
        assert_eq!(files(folder.path()), 1, "only what was saved");
    }

    #[test]
    fn work_of_a_window_that_runs_is_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let (mut first, _) = Recovery::look(folder.path());
        first.keep(&edited(3.5), 0.0);
        first.finish();
        assert!(Recovery::look(folder.path()).0.found.is_empty());
        // It ends without a word.
        drop(first);
        let (mut second, _) = Recovery::look(folder.path());
        assert_eq!(second.found.len(), 1);
        assert!(Recovery::look(folder.path()).0.found.is_empty(), "one window offers it at a time");
        second.keep(&edited(3.7), 0.0);
        assert_eq!(second.recover().unwrap().preset.propagation.factor, 3.5);
        drop(second);
        let (mut third, _) = Recovery::look(folder.path());
        assert_eq!(third.found.len(), 1, "what was recovered is still kept");
        third.discard();
        assert_eq!(files(folder.path()), 0);
    }

    #[test]
    fn an_edit_that_cannot_be_run_is_kept_with_its_name_and_file() {
        let folder = tempfile::tempdir().unwrap();
        let (mut recovery, _) = Recovery::look(folder.path());
        let preset = Preset { title: "\u{1} \"é\"".into(), size: 48, ..Preset::default() };
        assert!(preset.check().is_err());
        let file = folder.path().join("mine.ron");
        let document = Document::unsaved(preset.clone(), Some(file.clone()), "mine.ron".into());
        recovery.keep(&document, 0.0);
        recovery.finish();
        drop(recovery);
        let recovered = Recovery::look(folder.path()).0.recover().unwrap();
        assert_eq!((&recovered.preset, recovered.path()), (&preset, Some(file.as_path())));
        assert!(!recovered.is_saved());
    }
}
