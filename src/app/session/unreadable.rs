//! Faults that RON's parser finds in files that the window keeps.

use std::path::Path;

use ron::error::SpannedError;

use crate::scene::SceneError;
use crate::scene::error::Place;

/// The same as an error that names the file and the place in it, with what to do about it.
pub fn fault(error: &SpannedError, file: &Path, remedy: &str) -> SceneError {
    let place = Place { line: error.span.start.line, column: Some(error.span.start.col) };
    SceneError::file(file, place, error.code.to_string(), remedy)
}
