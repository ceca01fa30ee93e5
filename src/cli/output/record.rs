//! What a results folder remembers: for which preset it was filled, and by which files.
//!
//! The record is a hidden text file: a line `of PRESET` or `of` alone, then a line for each file. A file is recorded
//! before it is written, so that a run which is killed leaves none behind that nobody knows.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Component, Path};

use crate::system::file::{FileError, read_text, write_whole};
use crate::system::text::one_line;

/// The record's name in its folder.
const NAME: &str = ".lpv-lab";
/// The longest record that is read, in bytes: thousands of files.
const LONGEST: u64 = 1 << 20;
/// The endings of what runs write.
const RESULTS: [&str; 4] = ["csv", "npy", "png", "svg"];

/// What was written to a folder, and what is being written to it.
#[derive(Debug)]
pub(super) struct Record {
    /// The preset that the folder is filled for now.
    of: Option<String>,
    /// The files of the run before, until the first file of this one.
    earlier: Vec<String>,
    /// This run's files.
    written: BTreeSet<String>,
}

impl Record {
    /// The record of a folder that is about to be filled for the preset `of`.
    pub(super) fn read(folder: &Path, of: Option<String>) -> Self {
        let text = read_text(&folder.join(NAME), LONGEST).unwrap_or_default();
        // A line without its end was being written when the program was killed.
        let lines = text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n')).skip(1);
        let earlier = lines.filter(|name| is_inside(name)).map(str::to_owned).collect();
        Record { of, earlier, written: BTreeSet::new() }
    }

    /// The preset that a folder was last filled for.
    pub(super) fn owner(folder: &Path) -> Option<String> {
        let text = read_text(&folder.join(NAME), LONGEST).ok()?;
        text.lines().next()?.strip_prefix("of ").map(str::to_owned)
    }

    /// Records a file that is about to be written. The first one sends away those of the run before.
    pub(super) fn add(&mut self, folder: &Path, name: &str) -> Result<(), FileError> {
        let path = folder.join(NAME);
        if self.written.is_empty() {
            for earlier in self.earlier.drain(..) {
                let earlier = folder.join(earlier);
                match fs::remove_file(&earlier) {
                    Err(error) if error.kind() != io::ErrorKind::NotFound => {
                        return Err(FileError::from_system(&earlier, &error));
                    }
                    _ => {}
                }
            }
            let of = self.of.as_deref().map_or(String::new(), |of| format!(" {}", one_line(of)));
            write_whole(&path, format!("of{of}\n").as_bytes())?;
        }
        if self.written.insert(name.to_owned()) {
            let line = format!("{name}\n");
            let written = File::options().append(true).open(&path).and_then(|mut file| file.write_all(line.as_bytes()));
            written.map_err(|error| FileError::from_system(&path, &error))?;
        }
        Ok(())
    }

    /// Files in the folder that look like results and are not this run's.
    pub(super) fn others(&self, folder: &Path) -> Vec<String> {
        let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
        let names = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok());
        let result = |name: &str| Path::new(name).extension().is_some_and(|e| RESULTS.iter().any(|r| e == *r));
        let mut others: Vec<String> =
            names.filter(|name| !name.starts_with('.') && result(name) && !self.written.contains(name)).collect();
        others.sort();
        others
    }
}

/// Whether a record names a file in its own folder, and nothing elsewhere.
fn is_inside(name: &str) -> bool {
    let mut components = Path::new(name).components();
    matches!((components.next(), components.next()), (Some(Component::Normal(_)), None)) && name != NAME
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_that_lies_removes_nothing_elsewhere() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("results");
        fs::create_dir_all(folder.join("sub")).unwrap();
        for name in ["out.csv", "results/sub/a.csv", "results/cut.csv", "results/b.csv"] {
            fs::write(place.path().join(name), "kept").unwrap();
        }
        let lines = "of x\n../out.csv\nsub/a.csv\nsub\n/etc/no-such-file\n..\n\nb.csv\ncut.csv";
        fs::write(folder.join(NAME), lines).unwrap();
        let mut record = Record::read(&folder, None);
        // A folder's name is no file's.
        record.earlier.retain(|name| name != "sub");
        record.add(&folder, "new.csv").unwrap();
        assert!(place.path().join("out.csv").exists() && folder.join("sub/a.csv").exists());
        assert!(folder.join("cut.csv").exists() && !folder.join("b.csv").exists());
        assert_eq!(record.others(&folder), ["cut.csv"]);
    }

    #[test]
    fn the_preset_is_remembered() {
        let place = tempfile::tempdir().unwrap();
        assert_eq!(Record::owner(place.path()), None);
        Record::read(place.path(), Some("a/room.ron".to_owned())).add(place.path(), "a.csv").unwrap();
        assert_eq!(Record::owner(place.path()).as_deref(), Some("a/room.ron"));
        Record::read(place.path(), None).add(place.path(), "a.csv").unwrap();
        assert_eq!(Record::owner(place.path()), None);
    }
}
