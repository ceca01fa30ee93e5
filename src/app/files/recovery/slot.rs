//! A file for unsaved work, with the lock that says whose it is.

use std::fs::{self, File};
use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

/// How the files' names begin and end.
const START: &str = "unsaved-";
const END: &str = "ron";

/// A file that is this window's own for as long as this lives. Dropped, the file stays for another window.
#[derive(Debug)]
pub struct Slot {
    path: PathBuf,
    _lock: File,
}

impl Slot {
    /// A name in `folder` that no file has yet; the folder is made if it is not there.
    pub fn new(folder: &Path) -> Result<Self> {
        fs::create_dir_all(folder)?;
        for number in 0..1000 {
            let path = folder.join(format!("{START}{}-{number}.{END}", std::process::id()));
            match File::options().write(true).create_new(true).open(lock_of(&path)) {
                Ok(_) if path.symlink_metadata().is_ok() => {}
                Ok(lock) => {
                    lock.try_lock()?;
                    return Ok(Slot { path, _lock: lock });
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Err(Error::other("there are too many files of unsaved work"))
    }

    /// Takes over a file unless a window that runs has it. A lock that is no regular file is let be: opening a pipe
    /// waits.
    pub fn take(path: &Path) -> Option<Self> {
        let lock = lock_of(path);
        if lock.symlink_metadata().is_ok_and(|data| !data.is_file()) {
            return None;
        }
        let lock = File::options().write(true).create(true).truncate(false).open(lock).ok()?;
        lock.try_lock().ok()?;
        // Its owner may have removed it just before giving up the lock.
        path.symlink_metadata().is_ok().then(|| Slot { path: path.to_path_buf(), _lock: lock })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes the file and its lock. What cannot be removed is offered again.
    pub fn remove(self) {
        let _ = fs::remove_file(&self.path);
        self.remove_lock();
    }

    /// Removes the lock alone, once the file has another name. Left behind, it would be in nobody's way.
    pub fn remove_lock(self) {
        let _ = fs::remove_file(lock_of(&self.path));
    }
}

fn lock_of(path: &Path) -> PathBuf {
    path.with_extension("lock")
}

/// All files of unsaved work in a folder.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let ours = entries.map(|entry| entry.path()).filter(|path| {
        let begins = path.file_name().and_then(|name| name.to_str()).is_some_and(|name| name.starts_with(START));
        begins && path.extension().is_some_and(|end| end == END)
    });
    ours.collect()
}
