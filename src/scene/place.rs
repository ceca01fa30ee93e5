//! Finds the line and column of a value in a preset's text, for faults that only show when all is read.
//!
//! RON's own parser tells where its syntax breaks but not where a value stood. This walk goes from the
//! root to a value by names and numbers, over strings, characters, comments and brackets. It never fails:
//! where the text does not go on as the way does, the last value that was found is the place.

use std::path::Path;

use super::error::{Fault, Place, SceneError, Step};

/// A fault of a document, placed in the text that it was read from.
pub(super) fn at_its_place(fault: Fault, text: &str, name: &Path) -> SceneError {
    let place = place_of(text, find(text, &fault.steps));
    SceneError::file(name, place, fault.what, fault.remedy)
}

impl SceneError {
    /// The same fault, placed in the text that the document was read from; `name` is the file that it names.
    pub fn at_its_place(self, text: &str, name: &Path) -> Self {
        match self {
            SceneError::Document(fault) => at_its_place(fault, text, name),
            fault => fault,
        }
    }
}

/// Where the value at the end of `steps` begins, in bytes; the nearest enclosing value where it is not written.
fn find(text: &str, steps: &[Step]) -> usize {
    let mut walk = Walk { text, at: 0 };
    walk.skip_blanks();
    let mut found = walk.at;
    for step in steps {
        if walk.enter().and_then(|()| walk.go_to(*step)).is_none() {
            break;
        }
        found = walk.at;
    }
    found
}

/// The line and column of a byte, both from 1.
fn place_of(text: &str, at: usize) -> Place {
    let before = text.get(..at).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    Place { line: before.matches('\n').count() + 1, column: Some(before[line_start..].chars().count() + 1) }
}

/// A place in RON's text that moves forward by tokens and values.
struct Walk<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Walk<'a> {
    fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or("")
    }

    /// Steps over `token` if it comes next.
    fn eat(&mut self, token: &str) -> Option<()> {
        self.rest().starts_with(token).then(|| self.at += token.len())
    }

    /// Steps to behind the next `token`, or to the end.
    fn pass(&mut self, token: &str) {
        self.at = self.rest().find(token).map_or(self.text.len(), |i| self.at + i + token.len());
    }

    /// Steps over blanks, comments and `#![enable(…)]`.
    fn skip_blanks(&mut self) {
        loop {
            self.at += self.rest().len() - self.rest().trim_start().len();
            if self.eat("//").is_some() {
                self.pass("\n");
            } else if self.eat("/*").is_some() {
                self.skip_block_comment();
            } else if self.eat("#!").is_some() {
                self.pass("]");
            } else {
                return;
            }
        }
    }

    /// From behind its `/*` to behind its `*/`; they nest.
    fn skip_block_comment(&mut self) {
        let mut depth = 1;
        while depth > 0 && !self.rest().is_empty() {
            if self.eat("/*").is_some() {
                depth += 1;
            } else if self.eat("*/").is_some() {
                depth -= 1;
            } else {
                self.skip_char();
            }
        }
    }

    fn skip_char(&mut self) {
        self.at += self.rest().chars().next().map_or(0, char::len_utf8);
    }

    /// The identifier or number that comes next, maybe empty.
    fn word(&mut self) -> &'a str {
        let rest = self.rest();
        let end = rest.find(|c: char| !(c.is_alphanumeric() || "_.+-".contains(c))).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    /// Steps into the value that comes next, over its name and opening bracket.
    fn enter(&mut self) -> Option<()> {
        self.word();
        self.skip_blanks();
        self.rest().starts_with(['(', '[', '{']).then(|| self.at += 1)
    }

    /// Steps from behind an opening bracket to a value in it.
    fn go_to(&mut self, step: Step) -> Option<()> {
        let mut items = 0;
        loop {
            self.skip_blanks();
            if self.rest().is_empty() || self.rest().starts_with([')', ']', '}']) {
                return None;
            }
            if let Step::Field(wanted) = step {
                // A raw identifier, r#name, names the same field.
                let _ = self.eat("r#");
                let name = self.word();
                self.skip_blanks();
                self.eat(":")?;
                self.skip_blanks();
                if name == wanted {
                    return Some(());
                }
            } else if step == Step::Item(items) {
                return Some(());
            }
            items += 1;
            self.skip_value();
            self.eat(",")?;
        }
    }

    /// Steps over one value, to the comma or closing bracket behind it.
    fn skip_value(&mut self) {
        let mut depth = 0usize;
        loop {
            self.skip_blanks();
            match self.rest().chars().next() {
                None => return,
                Some(',' | ')' | ']' | '}') if depth == 0 => return,
                Some(')' | ']' | '}') => depth -= 1,
                Some('(' | '[' | '{') => depth += 1,
                Some('"') => {
                    self.skip_string();
                    continue;
                }
                Some('\'') => {
                    self.skip_quoted_char();
                    continue;
                }
                Some('r' | 'b') if self.skip_raw_string().is_some() => continue,
                Some(c) if c.is_alphanumeric() || c == '_' => {
                    self.word();
                    continue;
                }
                Some(_) => {}
            }
            self.skip_char();
        }
    }

    /// From a string's opening quote to behind its closing one.
    fn skip_string(&mut self) {
        self.skip_char();
        loop {
            match self.rest().chars().next() {
                None => return,
                Some('\\') => self.skip_char(),
                Some('"') => return self.skip_char(),
                Some(_) => {}
            }
            self.skip_char();
        }
    }

    /// Over a character such as `'x'`, `'('` or `'\''`.
    fn skip_quoted_char(&mut self) {
        self.skip_char();
        if self.eat("\\").is_some() {
            self.skip_char();
        }
        self.pass("'");
    }

    /// Over a raw string such as `r"…"`, `r#"…"#` or `br"…"`; `None` where there is none.
    fn skip_raw_string(&mut self) -> Option<()> {
        let marks = self.rest().strip_prefix('b').unwrap_or(self.rest()).strip_prefix('r')?;
        let body = marks.trim_start_matches('#').strip_prefix('"')?;
        let hashes = marks.len() - body.len() - 1;
        self.at = self.text.len() - body.len();
        self.pass(&format!("\"{}", "#".repeat(hashes)));
        Some(())
    }
}
