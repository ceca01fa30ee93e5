//! A file in memory for readers that take a path.

use std::fs;
use std::path::PathBuf;
use std::sync::OnceLock;

/// The path of a file of this name that holds `bytes`; the same file for every call of a program.
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    let memory = std::path::Path::new("/dev/shm");
    let folder = FOLDER.get_or_init(|| match memory.is_dir() {
        true => tempfile::tempdir_in(memory).expect("a folder"),
        false => tempfile::tempdir().expect("a folder"),
    });
    let path = folder.path().join(name);
    fs::write(&path, bytes).expect("writable");
    path
}
