//! What is wrong with a preset or a file it names, told in one line: the file, the place in it, what
//! is wrong there and what would be right.

use std::fmt;
use std::path::{Path, PathBuf};

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

/// A place as it follows a file's name, `:line:column`.
struct Colon<'a>(&'a Option<Place>);

impl fmt::Display for Colon<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(place) = self.0 else { return Ok(()) };
        write!(f, ":{}", place.line)?;
        place.column.map_or(Ok(()), |column| write!(f, ":{column}"))
    }
}

/// What a message quotes of a file, at most: enough to recognise, not enough to flood a terminal.
const QUOTED: usize = 60;

/// `found`, cut to what a message may quote.
pub fn quote(found: &str) -> String {
    match found.char_indices().nth(QUOTED) {
        Some((end, _)) => format!("`{}…`", &found[..end]),
        None => format!("`{found}`"),
    }
}

/// The text with control characters written out, so that it stays one line whatever a file holds.
fn one_line(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut line, c| {
        if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}') {
            line.extend(c.escape_default());
        } else {
            line.push(c);
        }
        line
    })
}

/// The known name that `found` most likely means: the one with the fewest letters to change, if that
/// is at most half of them.
pub fn nearest<'a>(found: &str, known: &[&'a str]) -> Option<&'a str> {
    let length = found.chars().count();
    if length > QUOTED {
        return None;
    }
    let (changes, name) = known.iter().map(|name| (changes(found, name), *name)).min_by_key(|&(n, _)| n)?;
    (2 * changes <= length.max(name.len())).then_some(name)
}

/// How many letters must be put in, taken out or replaced to get from `a` to `b`; case is free.
fn changes(a: &str, b: &str) -> usize {
    let (a, b) = (a.to_lowercase(), b.to_lowercase());
    let mut row: Vec<usize> = (0..=b.chars().count()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.chars().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.chars().count()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_name_finds_its_neighbour_and_a_strange_one_finds_none() {
        let known = ["factor", "iterations", "scheme", "snapshots"];
        for (found, meant) in [("fcator", "factor"), ("Factor", "factor"), ("shceme", "scheme")] {
            assert_eq!(nearest(found, &known), Some(meant));
        }
        assert_eq!(nearest("colour", &known), None);
        assert_eq!(nearest(&"factor".repeat(1000), &known), None);
        assert_eq!(nearest("a", &[]), None);
        assert_eq!((changes("kitten", "sitting"), changes("", "abc"), changes("abc", "")), (3, 3, 3));
    }

    #[test]
    fn every_message_is_one_line_and_short() {
        let error = SceneError::line(Path::new("a\nb.csv"), 7, "a\nb\u{7}\u{2028}", "c\rd");
        assert_eq!(error.to_string(), "a\\nb.csv:7: a\\nb\\u{7}\\u{2028}; c\\rd");
        assert!(quote(&"é".repeat(5000)).len() < 200);
    }

    #[test]
    fn a_fault_tells_the_way_to_its_value() {
        let fault = Fault::new("too far", "come back").field("cell").field("kind").within(Step::Item(2));
        assert_eq!(fault.field("injectors").to_string(), "injectors[2].kind.cell: too far; come back");
        assert_eq!(Fault::new("a", "b").to_string(), "a; b");
    }
}
