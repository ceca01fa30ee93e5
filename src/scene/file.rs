//! Files, taken with care: only regular ones are opened, none is read beyond a limit, and what is written
//! is written whole or not at all.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{ErrorKind, Read, Write};
use std::path::{Component, Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::error::{Fault, SceneError};

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
pub(super) fn inside(folder: &Path, path: &Path) -> Result<PathBuf, Fault> {
    check_relative(path)?;
    let found = folder.join(path);
    regular(&found)
        .and_then(|_| File::open(&found).map_err(|error| explain(&error)))
        .map_err(|(what, remedy)| Fault::new(format!("`{}`: {what}", found.display()), remedy))?;
    Ok(found)
}

/// Checks that a path stays in its preset's folder, so that a preset can be moved with its files and a
/// stranger's preset opens nothing else.
pub(super) fn check_relative(path: &Path) -> Result<(), Fault> {
    let remedy = "put the file beside the preset and give its path from there, such as `cells/ring.csv`";
    let mut depth = 0;
    for component in path.components() {
        match component {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir if depth > 0 => depth -= 1,
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => {
                let what = format!("`{}` leads out of the preset's folder", path.display());
                return Err(Fault::new(what, remedy));
            }
        }
    }
    if depth == 0 { Err(Fault::new("the path names no file", remedy)) } else { Ok(()) }
}

/// How old an unfinished file is before it counts as left behind by a program that was killed: none takes
/// that long to write.
const LEFT_BEHIND: Duration = Duration::from_secs(60);

/// Writes a file whole or not at all: into a new file beside it, onto the disk, then in its place. A link
/// stays a link, and the file keeps its permissions. What a killed program left unfinished beside it is
/// removed.
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
    remove_left_behind(path, &unfinished_name(name, ""));
    let number = format!("{}-{}", process::id(), WRITTEN.fetch_add(1, Ordering::Relaxed));
    let mut temporary = unfinished_name(name, &number);
    temporary.push(UNFINISHED);
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

/// What the names of unfinished files end in.
const UNFINISHED: &str = ".new";

/// How the name of an unfinished `name` begins: `.name.number`.
fn unfinished_name(name: &OsStr, number: &str) -> OsString {
    let mut unfinished = OsString::from(".");
    unfinished.push(name);
    unfinished.push(".");
    unfinished.push(number);
    unfinished
}

/// Removes the old unfinished files beside `path` whose names begin with `start`. Where one cannot be
/// removed it stays: that must not keep anybody from saving.
fn remove_left_behind(path: &Path, start: &OsStr) {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let between = name.as_encoded_bytes().strip_prefix(start.as_encoded_bytes());
        let number = between.and_then(|rest| rest.strip_suffix(UNFINISHED.as_bytes()));
        if !number.is_some_and(|number| number.iter().all(|byte| byte.is_ascii_digit() || *byte == b'-')) {
            continue;
        }
        let age = entry.metadata().and_then(|metadata| metadata.modified()).ok().and_then(|time| time.elapsed().ok());
        if age.is_some_and(|age| age > LEFT_BEHIND) {
            let _ = fs::remove_file(entry.path());
        }
    }
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
    fn what_killed_programs_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let old = std::time::SystemTime::now() - 2 * LEFT_BEHIND;
        let kept = [".a.ron.7-0.new.txt", ".a.ron.my-own.new", ".b.ron.7-0.new", "a.ron.7-0.new", ".a.ron.8-1.new"];
        for name in kept.into_iter().chain([".a.ron.7-0.new", ".a.ron.9-12.new"]) {
            let file = File::create(at(name)).unwrap();
            // The last of those kept is being written just now.
            if name != ".a.ron.8-1.new" {
                file.set_modified(old).unwrap();
            }
        }
        write_whole(&at("a.ron"), b"text").unwrap();
        let mut left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        let mut expected: Vec<OsString> = kept.into_iter().chain(["a.ron"]).map(OsString::from).collect();
        left.sort();
        expected.sort();
        assert_eq!(left, expected);
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
