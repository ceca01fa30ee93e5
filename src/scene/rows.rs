//! CSV files of cells: a known header, then x,y,z and numbers, each cell at most once.
//!
//! The files are plain numbers, so lines are split at commas and no more. Reading line by line with a
//! limit keeps a file without line ends out of memory, and tells the line in every error.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::error::{SceneError, quote};
use crate::field::Cell;
use crate::system::file;

/// The longest line, in bytes: eleven numbers of any usual form fit several times over.
const LONGEST_LINE: u64 = 1024;

/// A value in a cell of the volume.
struct Row<T> {
    cell: Cell,
    value: T,
    line: usize,
}

/// Reads a file of cells in a volume of side `size`, at most `most` of them. The header must be one of
/// `headers`, each of which begins with `x,y,z`; `value` gets that header's number in the list and the finite
/// numbers that follow the cell, and makes the value or tells what is wrong and what would be right.
/// The cells come z slowest, x fastest, whatever the file's order.
pub(super) fn read<T>(
    path: &Path,
    size: usize,
    most: usize,
    headers: &[&str],
    value: impl Fn(usize, &[f64]) -> Result<T, (String, &'static str)>,
) -> Result<Vec<(Cell, T)>, SceneError> {
    let limit = (most.min(size.pow(3)) as u64 + 2) * LONGEST_LINE;
    let (file, _) = file::open(path, limit)?;
    let mut lines = Lines { path, reader: BufReader::new(file.take(limit)), line: 0, bytes: Vec::new() };
    let header = lines.header(headers)?;
    let columns: Vec<&str> = headers[header].split(',').collect();
    let mut rows: Vec<Row<T>> = Vec::new();
    let mut numbers = Vec::with_capacity(columns.len());
    while let Some((line, text)) = lines.next()? {
        let fault = |(what, remedy): (String, &str)| SceneError::line(path, line, what, remedy);
        if rows.len() == most {
            let what = "the scene's light and occluders hold too many cells with this one";
            return Err(fault((what.to_owned(), "use fewer cells")));
        }
        let cell = numbers_of(text, &columns, size, &mut numbers).map_err(fault)?;
        rows.push(Row { cell, value: value(header, &numbers).map_err(fault)?, line });
    }
    rows.sort_by_key(|row| (row.cell[2], row.cell[1], row.cell[0], row.line));
    if let Some(pair) = rows.windows(2).find(|pair| pair[0].cell == pair[1].cell) {
        let [x, y, z] = pair[0].cell;
        let what = format!("the cell ({x}, {y}, {z}) is in line {} already", pair[0].line);
        return Err(SceneError::line(path, pair[1].line, what, "give each cell once"));
    }
    Ok(rows.into_iter().map(|row| (row.cell, row.value)).collect())
}

/// Takes a line apart: returns its cell and leaves the numbers behind it in `numbers`.
fn numbers_of(
    text: &str,
    columns: &[&str],
    size: usize,
    numbers: &mut Vec<f64>,
) -> Result<Cell, (String, &'static str)> {
    numbers.clear();
    let count = text.split(',').count();
    if count != columns.len() {
        return Err((format!("{count} columns, the header has {}", columns.len()), "write a number for each column"));
    }
    let mut cell = [0; 3];
    for (i, (field, column)) in text.split(',').map(str::trim).zip(columns).enumerate() {
        if i < 3 {
            cell[i] = field.parse().ok().filter(|c| *c < size).ok_or_else(|| {
                let last = size - 1;
                (
                    format!("{column} is {}; cells go from 0 to {last}", quote(field)),
                    "write a whole number in that range",
                )
            })?;
        } else {
            numbers.push(field.parse().ok().filter(|n: &f64| n.is_finite()).ok_or_else(|| {
                (format!("{column} is {}, no finite number", quote(field)), "write a decimal number such as -1.5e-3")
            })?);
        }
    }
    Ok(cell)
}

/// The lines of a text file, blank ones skipped.
struct Lines<'a, R> {
    path: &'a Path,
    reader: R,
    line: usize,
    bytes: Vec<u8>,
}

impl<R: BufRead> Lines<'_, R> {
    /// The next line that is not blank, with its number from 1.
    fn next(&mut self) -> Result<Option<(usize, &str)>, SceneError> {
        loop {
            self.bytes.clear();
            self.line += 1;
            let mut limited = self.reader.by_ref().take(LONGEST_LINE);
            let read = limited.read_until(b'\n', &mut self.bytes).map_err(|error| {
                SceneError::line(self.path, self.line, error.to_string(), "check the file and its disk")
            })?;
            if read == 0 {
                return Ok(None);
            }
            if read as u64 == LONGEST_LINE && !self.bytes.ends_with(b"\n") {
                let what = format!("the line is longer than {LONGEST_LINE} bytes");
                return Err(SceneError::line(self.path, self.line, what, "write one cell a line"));
            }
            if self.line == 1 && self.bytes.starts_with("\u{feff}".as_bytes()) {
                self.bytes.drain(..3);
            }
            if !self.bytes.trim_ascii().is_empty() {
                break;
            }
        }
        let text = str::from_utf8(&self.bytes).map_err(|_| {
            SceneError::line(self.path, self.line, "this line is not UTF-8 text", "save the file as a text CSV")
        })?;
        Ok(Some((self.line, text.trim())))
    }

    /// Which of the known headers the file begins with.
    fn header(&mut self, known: &[&str]) -> Result<usize, SceneError> {
        let path = self.path;
        let remedy = format!("it begins with {}", known.join(" or "));
        let Some((line, text)) = self.next()? else {
            return Err(SceneError::line(path, 1, "the file is empty", remedy));
        };
        let found: String = text.chars().filter(|c| !c.is_whitespace() && *c != '"').collect();
        known
            .iter()
            .position(|header| found.eq_ignore_ascii_case(header))
            .ok_or_else(|| SceneError::line(path, line, format!("the header {} is not known", quote(text)), remedy))
    }
}
