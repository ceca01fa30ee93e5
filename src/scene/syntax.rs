//! What RON's parser refuses, in the lab's words: what is wrong, and what would be right.

use std::path::Path;

use ron::Error;
use ron::error::SpannedError;

use super::error::{Place, SceneError, nearest, quote};

/// A fault that RON's parser found in a preset's text; `name` is the preset's file.
pub(super) fn error(error: SpannedError, text: &str, name: &Path) -> SceneError {
    let (what, remedy) = decimal_comma(&error, text).unwrap_or_else(|| explain(&error.code));
    let (line, column) = (error.span.start.line, error.span.start.col);
    // The parser stands before the blanks that lead to what it refused.
    let rest = text.lines().nth(line.saturating_sub(1)).unwrap_or("").chars().skip(column.saturating_sub(1));
    let blanks = rest.take_while(|c| c.is_whitespace()).count();
    SceneError::file(name, Place { line, column: Some(column + blanks) }, what, remedy)
}

/// Whether the parser stumbled over `3,5`, which is a number in half of the world's spreadsheets.
fn decimal_comma(error: &SpannedError, text: &str) -> Option<(String, String)> {
    if !matches!(error.code, Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_)) {
        return None;
    }
    let line = text.lines().nth(error.span.start.line.checked_sub(1)?)?;
    let at = line.char_indices().nth(error.span.start.col.checked_sub(1)?).map_or(line.len(), |(at, _)| at);
    let (before, after) = line.split_at(at);
    let digits = |c: &char| c.is_ascii_digit();
    let fraction: String = after.chars().take_while(digits).collect();
    let whole = before.strip_suffix(',')?;
    let start = whole.rfind(|c: char| !digits(&c)).map_or(0, |i| i + 1);
    if fraction.is_empty() || start == whole.len() {
        return None;
    }
    let what = "a comma cannot stand before decimals";
    Some((what.to_owned(), format!("write {}.{fraction}", &whole[start..])))
}

fn explain(code: &Error) -> (String, String) {
    let (what, remedy) = match code {
        Error::NoSuchStructField { expected, found, .. } => {
            return (format!("there is no field {}", quote(found)), choose(found, expected));
        }
        Error::NoSuchEnumVariant { expected, found, .. } => {
            return (format!("{} is not known here", quote(found)), choose(found, expected));
        }
        Error::MissingStructField { field, .. } => {
            return (format!("the field `{field}` is missing before this"), format!("write `{field}: …`"));
        }
        Error::DuplicateStructField { field, .. } => {
            return (format!("the field `{field}` is given twice"), "give it once".to_owned());
        }
        Error::ExpectedDifferentLength { found, .. } => {
            return (format!("{found} numbers where three should be"), "write (x, y, z)".to_owned());
        }
        // The version's own message, which says what would be right.
        Error::Message(message) => message.split_once("; ").unwrap_or((message, FORM)),
        Error::ExpectedNamedStructLike("Preset") | Error::ExpectedDifferentStructName { expected: "Preset", .. } => {
            ("this is no preset", "a preset is `(version: 1, …)`")
        }
        Error::Eof => ("the text ends too early", "close every bracket"),
        Error::ExceededRecursionLimit => ("brackets are nested too deeply", "a preset needs six at most"),
        Error::ExpectedBoolean => ("this should be true or false", "write one of them"),
        Error::ExpectedComma => ("a comma should stand before this", "whole numbers have no fraction, brackets close"),
        Error::ExpectedFloat => ("this should be a number", "write one such as 0.5"),
        Error::ExpectedInteger => ("this should be a whole number", "write one, zero or more"),
        Error::ExpectedString => ("this should be text", "write it in double quotes"),
        Error::ExpectedStringEnd => ("the text that begins here does not end", "close its quotes"),
        Error::ExpectedStructLikeEnd => ("a `)` should stand here", "cells, directions and colours have three numbers"),
        Error::IntegerOutOfBounds => ("this whole number does not fit here", "write one, zero or more, of usual size"),
        Error::TrailingCharacters => ("the preset has ended before this", "leave it out"),
        other => return (other.to_string(), FORM.to_owned()),
    };
    (what.to_owned(), remedy.to_owned())
}

/// The remedy where the parser's message says all there is to say.
const FORM: &str = "compare the presets that come with the program";

/// The known name that was most likely meant, or all of them.
fn choose(found: &str, known: &[&str]) -> String {
    match nearest(found, known) {
        Some(name) => format!("did you mean `{name}`?"),
        None => format!("there are {}", known.join(", ")),
    }
}
