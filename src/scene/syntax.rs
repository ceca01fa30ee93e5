//! What RON's parser refuses, in the lab's words: what is wrong, and what would be right.

use std::path::Path;

use ron::Error;
use ron::error::SpannedError;

use super::error::{Place, SceneError, nearest, quote};

/// A fault that RON's parser found in a preset's text; `name` is the preset's file.
pub(super) fn error(error: SpannedError, name: &Path) -> SceneError {
    let (what, remedy) = explain(&error.code);
    let start = error.span.start;
    SceneError::file(name, Place { line: start.line, column: Some(start.col) }, what, remedy)
}

fn explain(code: &Error) -> (String, String) {
    match code {
        Error::NoSuchStructField { expected, found, .. } => {
            (format!("there is no field {}", quote(found)), choose(found, expected))
        }
        Error::NoSuchEnumVariant { expected, found, .. } => {
            (format!("{} is not known here", quote(found)), choose(found, expected))
        }
        Error::MissingStructField { field, .. } => {
            (format!("the field `{field}` is missing"), format!("write `{field}: …`"))
        }
        Error::DuplicateStructField { field, .. } => {
            (format!("the field `{field}` is given twice"), "give it once".to_owned())
        }
        Error::ExceededRecursionLimit => {
            ("brackets are nested too deeply".to_owned(), "a preset needs six at most".to_owned())
        }
        // The version's own message, which says what would be right.
        Error::Message(message) => match message.split_once("; ") {
            Some((what, remedy)) => (what.to_owned(), remedy.to_owned()),
            None => (message.clone(), "see the presets that come with the program".to_owned()),
        },
        other => (other.to_string(), "see the presets that come with the program for the form".to_owned()),
    }
}

/// The known name that was most likely meant, or all of them.
fn choose(found: &str, known: &[&str]) -> String {
    match nearest(found, known) {
        Some(name) => format!("did you mean `{name}`?"),
        None => format!("there are {}", known.join(", ")),
    }
}
