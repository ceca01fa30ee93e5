//! The folder that a command writes its results to. It holds one run's files, each of them whole.
//!
//! ```text
//! let folder = Folder::create(args.out.clone())?;     // before the work: a folder that cannot be written is told now
//! folder.write_table("errors.csv", &table)?;          // as often as needed
//! folder.write_with("light.npy", |out| …)?;           // what is too long to be held
//! folder.finish();                                    // after the last file
//! ```
//!
//! The folder is locked while a command has it, so that another one that would write into it is told. A record in it
//! names the files that were written, and when the next run writes its first one, those go: nobody takes one run's
//! curves for another's. What the record does not name was not written here and stays; [`Folder::finish`] names it.

mod record;

use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::CliError;
use super::console::remark;
use crate::report::raster;
use crate::report::table::Table;
use crate::system::file::{self, write_whole_with};
use record::Record;

/// A folder that this command alone writes to.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    record: Mutex<Record>,
    /// Held open: the lock lasts as long as it is.
    _lock: Option<File>,
}

impl Folder {
    /// Takes a folder, and makes it if it is not there.
    ///
    /// # Errors
    /// Where it cannot be written to, or another run is writing to it.
    pub fn create(path: impl Into<PathBuf>) -> Result<Self, CliError> {
        Self::of(path.into(), None)
    }

    /// Takes the folder for the results of a preset: `asked` where one was named, else `lpv-lab-results/STEM`. Two
    /// presets of one name do not share it: the second one's is `STEM-2`.
    ///
    /// # Errors
    /// As [`Folder::create`].
    pub fn of_preset(asked: Option<&Path>, preset: &Path) -> Result<Self, CliError> {
        Self::of(results_of(asked, preset), Some(identity(preset)))
    }

    fn of(path: PathBuf, of: Option<String>) -> Result<Self, CliError> {
        let refused = |error: &io::Error| {
            let (what, remedy) = file::explain(error);
            CliError::Failed(format!("{}: cannot write here: {what}; {remedy}", path.display()))
        };
        fs::create_dir_all(&path).map_err(|e| refused(&e))?;
        let lock = lock(&path)?;
        // The surest way to know whether files can be made here is to make one.
        let probe = path.join(".lpv-lab.new");
        let probed = File::create(&probe).and_then(|_| fs::remove_file(&probe));
        probed.map_err(|e| refused(&e))?;
        file::clear_up(&path);
        let record = Mutex::new(Record::read(&path, of));
        Ok(Folder { path, record, _lock: lock })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file in it, whole or not at all.
    ///
    /// # Errors
    /// Where that cannot be done.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), CliError> {
        self.write_with(name, |out| io::Write::write_all(out, bytes.as_ref()))
    }

    /// Writes a file in it as it is made, whole or not at all.
    ///
    /// # Errors
    /// Where that cannot be done.
    pub fn write_with(
        &self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<(), CliError> {
        let mut record = self.record.lock().unwrap_or_else(PoisonError::into_inner);
        record.add(&self.path, name).map_err(|e| CliError::Failed(e.to_string()))?;
        write_whole_with(&self.path.join(name), write).map_err(|e| CliError::Failed(e.to_string()))
    }

    /// Writes a table as CSV.
    ///
    /// # Errors
    /// Where that cannot be done.
    pub fn write_table<const N: usize>(&self, name: &str, table: &Table<N>) -> Result<(), CliError> {
        let mut bytes = Vec::new();
        table.write_csv(&mut bytes).map_err(|e| CliError::Failed(format!("{name}: {e}")))?;
        self.write(name, bytes)
    }

    /// Writes a drawing as `name`.svg and `name`.png.
    ///
    /// # Errors
    /// Where it cannot be drawn or written.
    pub fn write_svg_and_png(&self, name: &str, svg: &str) -> Result<(), CliError> {
        let png = raster::png(svg).map_err(|e| CliError::Failed(format!("{name}.png: {e}")))?;
        self.write(&format!("{name}.svg"), svg)?;
        self.write(&format!("{name}.png"), png)
    }

    /// Says which results in the folder are not this run's, if there are any.
    pub fn finish(self) {
        let record = self.record.into_inner().unwrap_or_else(PoisonError::into_inner);
        let others = record.others(&self.path);
        if let Some((last, first)) = others.split_last() {
            let named = match first {
                [] => last.clone(),
                [..] if first.len() < 4 => format!("{} and {last}", first.join(", ")),
                [..] => format!("{} and {} more", first[..3].join(", "), others.len() - 3),
            };
            remark!("{}: also holds {named}, not of this run", self.path.display());
        }
    }
}

/// The folder that [`Folder::of_preset`] takes.
pub fn results_of(asked: Option<&Path>, preset: &Path) -> PathBuf {
    if let Some(asked) = asked {
        return asked.to_path_buf();
    }
    let stem = preset.file_stem().unwrap_or_default();
    let of = identity(preset);
    let numbered = |number: usize| {
        let mut name = stem.to_owned();
        if number > 1 {
            name.push(format!("-{number}"));
        }
        Path::new("lpv-lab-results").join(name)
    };
    let free = |path: &PathBuf| Record::owner(path).is_none_or(|owner| owner == of);
    (1..1000).map(numbered).find(free).unwrap_or_else(|| numbered(1))
}

/// What tells a preset from every other one: where its file lies, or its name where it is built in.
fn identity(preset: &Path) -> String {
    let whole = if preset.is_file() { fs::canonicalize(preset).ok() } else { None };
    whole.as_deref().unwrap_or(preset).to_string_lossy().into_owned()
}

/// Locks a folder, where the system can: Unix locks folders as it locks files, and leaves nothing in them.
fn lock(path: &Path) -> Result<Option<File>, CliError> {
    let Ok(folder) = File::open(path) else { return Ok(None) };
    match folder.try_lock() {
        Ok(()) => Ok(Some(folder)),
        Err(TryLockError::WouldBlock) => Err(CliError::Failed(format!(
            "{}: another run is writing here; wait for its end, or name another folder by --out",
            path.display()
        ))),
        // Disks that know no locks.
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = entries.filter(|name| !name.starts_with('.')).collect();
        names.sort();
        names
    }

    #[test]
    fn a_run_replaces_the_files_of_the_one_before_and_no_others() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("deep/results");
        let first = Folder::create(&path).unwrap();
        first.write("level-0.csv", "first").unwrap();
        first.write("errors.csv", "first").unwrap();
        first.finish();
        fs::write(path.join("notes.txt"), "mine").unwrap();
        let second = Folder::create(&path).unwrap();
        assert_eq!(names(&path), ["errors.csv", "level-0.csv", "notes.txt"], "nothing goes before something comes");
        second.write("errors.csv", "second").unwrap();
        assert_eq!(names(&path), ["errors.csv", "notes.txt"]);
        second.write("level-1.csv", "second").unwrap();
        assert_eq!(names(&path), ["errors.csv", "level-1.csv", "notes.txt"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_second_run_into_the_folder_is_told() {
        let place = tempfile::tempdir().unwrap();
        let first = Folder::create(place.path()).unwrap();
        let told = Folder::create(place.path()).unwrap_err().to_string();
        assert!(told.contains("another run is writing here") && told.lines().count() == 1, "{told}");
        drop(first);
        assert!(Folder::create(place.path()).is_ok());
    }

    #[test]
    fn a_file_in_the_way_is_told_before_the_work() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("results");
        fs::write(&path, "").unwrap();
        assert!(Folder::create(&path).unwrap_err().to_string().contains("cannot write here"));
    }

    #[test]
    fn presets_are_told_apart_by_where_they_lie() {
        let place = tempfile::tempdir().unwrap();
        let [one, other] = ["one", "other"].map(|name| {
            let folder = place.path().join(name);
            fs::create_dir(&folder).unwrap();
            fs::write(folder.join("room.ron"), "").unwrap();
            folder.join("room.ron")
        });
        assert_ne!(identity(&one), identity(&other));
        assert_eq!(identity(&one), identity(&place.path().join("other/../one/room.ron")));
        assert_eq!(identity(Path::new("two-walls")), "two-walls");
        assert_eq!(results_of(Some(Path::new("x")), &one), Path::new("x"));
    }
}
