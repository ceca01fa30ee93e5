//! Files, taken with care: only regular ones are opened, none is read beyond a limit, and what is written
//! is written whole or not at all.

use std::fs::{self, File};
use std::io::{ErrorKind, Read, Write};
use std::path::{Component, Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use super::error::{Problem, SceneError};

/// Opens a regular file of at most `limit` bytes; gives it with its length. Folders, pipes and devices
/// are refused before they are opened, because opening a pipe waits for somebody to write.
pub(super) fn open(path: &Path, limit: u64) -> Result<(File, u64), SceneError> {
    let length = regular(path).map_err(|(what, remedy)| SceneError::file(path, None, what, remedy))?;
    if length > limit {
        return Err(too_long(path, length, limit));
    }
    let file = File::open(path).map_err(|error| {
        let (what, remedy) = explain(&error);
        SceneError::file(path, None, what, remedy)
    })?;
    Ok((file, length))
}

/// A text file's contents, at most `limit` bytes of them.
pub fn read_text(path: &Path, limit: u64) -> Result<String, SceneError> {
    let (file, _) = open(path, limit)?;
    let mut bytes = Vec::new();
    // The limit again, because a file may grow while it is read.
    file.take(limit + 1).read_to_end(&mut bytes).map_err(|error| {
        let (what, remedy) = explain(&error);
        SceneError::file(path, None, what, remedy)
    })?;
    if bytes.len() as u64 > limit {
        return Err(too_long(path, bytes.len() as u64, limit));
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
        SceneError::line(path, line, "this line is not UTF-8 text", "save the file as UTF-8")
    })
}

/// Where a file lies that a preset in `folder` names; it must be there and readable.
pub(super) fn inside(folder: &Path, path: &Path) -> Result<PathBuf, Problem> {
    check_relative(path)?;
    let found = folder.join(path);
    regular(&found)
        .and_then(|_| File::open(&found).map_err(|error| explain(&error)))
        .map_err(|(what, remedy)| Problem::new(format!("`{}`: {what}", found.display()), remedy))?;
    Ok(found)
}

/// Checks that a path stays in its preset's folder, so that a preset can be moved with its files and a
/// stranger's preset opens nothing else.
pub(super) fn check_relative(path: &Path) -> Result<(), Problem> {
    let remedy = "put the file beside the preset and give its path from there, such as `cells/ring.csv`";
    let mut depth = 0;
    for component in path.components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir if depth > 0 => depth -= 1,
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => {
                let what = format!("`{}` leads out of the preset's folder", path.display());
                return Err(Problem::new(what, remedy));
            }
        }
    }
    if depth == 0 { Err(Problem::new("the path names no file", remedy)) } else { Ok(()) }
}

/// Writes a file whole or not at all: into a new file beside it, onto the disk, then in its place. A link
/// stays a link, and the file keeps its permissions.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), SceneError> {
    let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    replace(&path, bytes).map_err(|error| {
        let (what, remedy) = explain(&error);
        SceneError::file(&path, None, format!("cannot be saved: {what}"), remedy)
    })
}

fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    /// Tells apart the files that one process writes at a time.
    static WRITTEN: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().ok_or(ErrorKind::InvalidFilename)?;
    let before = fs::metadata(path).ok();
    match &before {
        Some(old) if old.is_dir() => return Err(ErrorKind::IsADirectory.into()),
        Some(old) if old.permissions().readonly() => return Err(ErrorKind::PermissionDenied.into()),
        _ => {}
    }
    let mut temporary = std::ffi::OsString::from(".");
    temporary.push(name);
    temporary.push(format!(".{}-{}.new", process::id(), WRITTEN.fetch_add(1, Ordering::Relaxed)));
    let temporary = path.with_file_name(temporary);
    let written = (|| {
        let mut file = File::create_new(&temporary)?;
        file.write_all(bytes)?;
        if let Some(old) = before {
            file.set_permissions(old.permissions())?;
        }
        file.sync_all()?;
        fs::rename(&temporary, path)
    })();
    if written.is_err() {
        // The write's error is the one to tell.
        let _ = fs::remove_file(&temporary);
    }
    written?;
    // Makes the new name last through a power cut, where the system lets folders be synchronised.
    if let Some(folder) = path.parent().and_then(|folder| File::open(folder).ok()) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// The length of a regular file, or why it is none and what to do.
fn regular(path: &Path) -> Result<u64, (String, &'static str)> {
    let metadata = fs::metadata(path).map_err(|error| explain(&error))?;
    if metadata.is_dir() {
        return Err(("this is a folder".to_owned(), "name a file in it"));
    }
    if !metadata.is_file() {
        return Err(("this is a pipe or a device".to_owned(), "name a regular file"));
    }
    Ok(metadata.len())
}

/// What went wrong with a file and what to do.
fn explain(error: &std::io::Error) -> (String, &'static str) {
    let (what, remedy) = match error.kind() {
        ErrorKind::NotFound => ("no such file", "check the path"),
        ErrorKind::PermissionDenied => ("permission denied", "allow this user to access it"),
        ErrorKind::IsADirectory => ("this is a folder", "name a file in it"),
        ErrorKind::NotADirectory => ("a part of the path is no folder", "check the path"),
        ErrorKind::InvalidFilename => ("this is no file's name", "check the path"),
        _ => return (error.to_string(), "check the file and its disk"),
    };
    (what.to_owned(), remedy)
}

fn too_long(path: &Path, length: u64, limit: u64) -> SceneError {
    let what = format!("{length} bytes are too many");
    SceneError::file(path, None, what, format!("at most {limit} are read here"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_in_the_presets_folder() {
        for path in ["cells.csv", "cells/ring.csv", "./a/../b.csv", "a/b/../../c.csv"] {
            assert!(check_relative(Path::new(path)).is_ok(), "{path}");
        }
        for path in ["", ".", "..", "a/..", "../b.csv", "a/../../b.csv", "/etc/passwd"] {
            assert!(check_relative(Path::new(path)).is_err(), "{path}");
        }
    }

    #[test]
    fn a_saved_file_is_whole_and_leaves_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        for text in ["first", "second and longer", "3"] {
            write_whole(&path, text.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_save_that_fails_keeps_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("folder");
        fs::create_dir(&path).unwrap();
        let error = write_whole(&path, b"text").unwrap_err().to_string();
        assert!(error.contains("this is a folder"), "{error}");
        assert!(write_whole(&folder.path().join("no/such/folder.ron"), b"text").is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn text_beyond_the_limit_or_not_utf8_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text");
        fs::write(&path, b"good\nb\xffd\n").unwrap();
        let error = read_text(&path, 100).unwrap_err().to_string();
        assert!(error.contains("text:2: "), "{error}");
        let error = read_text(&path, 8).unwrap_err().to_string();
        assert!(error.contains("9 bytes") && error.contains("at most 8"), "{error}");
    }
}
