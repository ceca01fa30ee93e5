//! The files that a preset names: beside it or deeper, so that a preset can be moved with its files and a stranger's
//! opens nothing else.

use std::fs::File;
use std::path::{Component, Path, PathBuf};

use super::error::{Fault, SceneError};
use crate::system::file::{self, FileError};

/// A text file's contents, at most `limit` bytes of them.
///
/// # Errors
/// Where it is no regular file, too long, or not UTF-8.
pub fn read_text(path: &Path, limit: u64) -> Result<String, SceneError> {
    Ok(file::read_text(path, limit)?)
}

/// Writes a file whole or not at all, as [`file::write_whole`] does.
///
/// # Errors
/// Where it cannot be written; the file is then what it was before.
#[cfg(feature = "app")]
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), SceneError> {
    Ok(file::write_whole(path, bytes)?)
}

/// Where a file lies that a preset in `folder` names; it must be there and readable.
pub(super) fn inside(folder: &Path, path: &Path) -> Result<PathBuf, Fault> {
    check_relative(path)?;
    let found = folder.join(path);
    let opened =
        file::length(&found).and_then(|_| File::open(&found).map_err(|error| FileError::from_system(&found, &error)));
    opened.map_err(|error| Fault::new(format!("`{}`: {}", found.display(), error.what), error.remedy))?;
    Ok(found)
}

/// Checks that a path stays in its preset's folder.
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
}
