//! Why a mesh cannot be read: the file, the place in it, what is wrong and what would be right.

use std::fmt;
use std::path::{Path, PathBuf};

/// What is wrong with a file of a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshError {
    /// The file.
    pub file: PathBuf,
    /// The line of a text file, counted from 1, where the fault has one. Binary files tell the place in `what`.
    pub line: Option<usize>,
    /// What is wrong.
    pub what: String,
    /// What would be right.
    pub remedy: String,
}

impl MeshError {
    /// A fault of a file.
    pub fn new(file: &Path, what: impl Into<String>, remedy: impl Into<String>) -> Self {
        MeshError { file: file.to_path_buf(), line: None, what: what.into(), remedy: remedy.into() }
    }

    /// A fault of a line of a file, counted from 1.
    pub fn line(file: &Path, line: usize, what: impl Into<String>, remedy: impl Into<String>) -> Self {
        MeshError { line: Some(line), ..MeshError::new(file, what, remedy) }
    }
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": {}; {}", self.what, self.remedy)
    }
}

impl std::error::Error for MeshError {}
