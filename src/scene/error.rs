//! What is wrong with a preset or a file it names, told in one line: the file, the place in it, what
//! is wrong there and what would be right.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::system::file::FileError;
use crate::system::text::one_line;
pub use crate::system::text::{nearest, quote};

/// One step from a document's root to a value in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The field of this name.
    Field(&'static str),
    /// The list's item of this number, from 0.
    Item(usize),
}

/// Something that a preset says and that cannot be: where in the document, what is wrong, what would
/// be right. It knows no file, because the window checks documents that are in none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{what}; {remedy}", Prefix(steps))]
pub struct Fault {
    /// The way from the document's root to the value.
    pub steps: Vec<Step>,
    /// What is wrong.
    pub what: String,
    /// What would be right.
    pub remedy: String,
}

impl Fault {
    /// A fault at the root; [`Fault::within`] leads it to its place.
    pub fn new(what: impl AsRef<str>, remedy: impl AsRef<str>) -> Self {
        Fault { steps: Vec::new(), what: one_line(what.as_ref()), remedy: one_line(remedy.as_ref()) }
    }

    /// The same fault, seen from one step further up the document.
    pub fn within(mut self, step: Step) -> Self {
        self.steps.insert(0, step);
        self
    }

    /// The same fault, in the field `name`.
    pub fn field(self, name: &'static str) -> Self {
        self.within(Step::Field(name))
    }
}

/// The way to a fault as people write it, `injectors[2].kind.cell: `; nothing at the root.
struct Prefix<'a>(&'a [Step]);

impl fmt::Display for Prefix<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, step) in self.0.iter().enumerate() {
            match step {
                Step::Field(name) if i == 0 => f.write_str(name)?,
                Step::Field(name) => write!(f, ".{name}")?,
                Step::Item(item) => write!(f, "[{item}]")?,
            }
        }
        if self.0.is_empty() { Ok(()) } else { f.write_str(": ") }
    }
}

/// A place in a text file, counted from 1 as editors do; columns are characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The line.
    pub line: usize,
    /// The column, where one is known.
    pub column: Option<usize>,
}

/// Why there is no scene. Shows as one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SceneError {
    /// A file cannot be taken.
    #[error("{}{}: {what}; {remedy}", one_line(&file.to_string_lossy()), Colon(place))]
    File {
        /// The file.
        file: PathBuf,
        /// The place in it, where the fault has one.
        place: Option<Place>,
        /// What is wrong.
        what: String,
        /// What would be right.
        remedy: String,
    },
    /// A document that is in no file yet cannot be taken.
    #[error(transparent)]
    Document(#[from] Fault),
}

impl SceneError {
    /// A fault of `file`, at `place` if it has one there.
    pub fn file(file: &Path, place: impl Into<Option<Place>>, what: impl AsRef<str>, remedy: impl AsRef<str>) -> Self {
        SceneError::File {
            file: file.to_path_buf(),
            place: place.into(),
            what: one_line(what.as_ref()),
            remedy: one_line(remedy.as_ref()),
        }
    }

    /// The same fault; a document's is seen from one step further up.
    pub fn within(self, step: Step) -> Self {
        match self {
            SceneError::Document(fault) => SceneError::Document(fault.within(step)),
            fault => fault,
        }
    }

    /// A fault of line `line` of `file`.
    pub fn line(file: &Path, line: usize, what: impl AsRef<str>, remedy: impl AsRef<str>) -> Self {
        Self::file(file, Place { line, column: None }, what, remedy)
    }
}

impl From<FileError> for SceneError {
    fn from(FileError { file, line, what, remedy }: FileError) -> Self {
        SceneError::File { file, place: line.map(|line| Place { line, column: None }), what, remedy }
    }
}

/// A place as it follows a file's name, `:line:column`.
struct Colon<'a>(&'a Option<Place>);

impl fmt::Display for Colon<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(place) = self.0 else { return Ok(()) };
        write!(f, ":{}", place.line)?;
        place.column.map_or(Ok(()), |column| write!(f, ":{column}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_message_is_one_line_and_short() {
        let error = SceneError::line(Path::new("a\nb.csv"), 7, "a\nb\u{7}\u{2028}", "c\rd");
        assert_eq!(error.to_string(), "a\\nb.csv:7: a\\nb\\u{7}\\u{2028}; c\\rd");
    }

    #[test]
    fn a_fault_tells_the_way_to_its_value() {
        let fault = Fault::new("too far", "come back").field("cell").field("kind").within(Step::Item(2));
        assert_eq!(fault.field("injectors").to_string(), "injectors[2].kind.cell: too far; come back");
        assert_eq!(Fault::new("a", "b").to_string(), "a; b");
    }
}
