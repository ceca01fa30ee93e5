//! CSV files of cells: a known header, then x,y,z and numbers, each cell at most once.
//!
//! Reading line by line with a limit keeps a file without line ends out of memory, and tells the line in every error.
//! The last row must have its line end: a row that was cut in its last number looks like another, good one.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::error::{SceneError, quote};
use super::row_text::{Separator, is_comment, other_kind};
use crate::field::Cell;
use crate::system::file;

/// The longest line, in bytes: eleven numbers of any usual form fit several times over.
const LONGEST_LINE: u64 = 1024;

/// What is wrong with a row, and what would be right.
pub(super) type Wrong = (String, String);

/// The cells of a file, and which of the known headers it has.
pub(super) struct Rows<T> {
    /// The header's number in the list.
    pub(super) header: usize,
    /// The cells, z slowest, x fastest, whatever the file's order.
    pub(super) cells: Vec<(Cell, T)>,
}

/// A value in a cell of the volume.
struct Row<T> {
    cell: Cell,
    value: T,
    line: usize,
}

/// Reads a file of cells in a volume of side `size`, at most `most` of them. The header must be one of
/// `headers`, each of which begins with `x,y,z`; `value` gets that header's number in the list and the finite
/// numbers that follow the cell, and makes the value or tells what is wrong and what would be right.
pub(super) fn read<T>(
    path: &Path,
    size: usize,
    most: usize,
    headers: &[&str],
    value: impl Fn(usize, &[f64]) -> Result<T, Wrong>,
) -> Result<Rows<T>, SceneError> {
    let limit = (most.min(size.pow(3)) as u64 + 2) * LONGEST_LINE;
    let (file, _) = file::open(path, limit)?;
    let mut lines = Lines { path, reader: BufReader::new(file.take(limit)), line: 0, bytes: Vec::new(), ended: true };
    let (header, separator) = lines.header(headers)?;
    let columns: Vec<&str> = headers[header].split(',').collect();
    let mut rows: Vec<Row<T>> = Vec::new();
    let mut numbers = Vec::with_capacity(columns.len());
    while let Some((line, text)) = lines.next()? {
        let fault = |(what, remedy): Wrong| SceneError::line(path, line, what, remedy);
        if rows.len() == most {
            let what = "the scene's light and occluders hold too many cells with this one";
            return Err(fault((what.to_owned(), "use fewer cells".to_owned())));
        }
        let cell = numbers_of(text, separator, &columns, size, &mut numbers).map_err(fault)?;
        rows.push(Row { cell, value: value(header, &numbers).map_err(fault)?, line });
    }
    lines.check_end()?;
    rows.sort_by_key(|row| (row.cell[2], row.cell[1], row.cell[0], row.line));
    if let Some(pair) = rows.windows(2).find(|pair| pair[0].cell == pair[1].cell) {
        let [x, y, z] = pair[0].cell;
        let what = format!("the cell ({x}, {y}, {z}) is in line {} already", pair[0].line);
        return Err(SceneError::line(path, pair[1].line, what, "give each cell once"));
    }
    Ok(Rows { header, cells: rows.into_iter().map(|row| (row.cell, row.value)).collect() })
}

/// Which of the known headers a file has.
pub(super) fn header(path: &Path, headers: &[&str]) -> Result<usize, SceneError> {
    let (file, _) = file::open(path, u64::MAX)?;
    let reader = BufReader::new(file.take(LONGEST_LINE));
    let mut lines = Lines { path, reader, line: 0, bytes: Vec::new(), ended: true };
    Ok(lines.header(headers)?.0)
}

/// Takes a line apart: returns its cell and leaves the numbers behind it in `numbers`.
fn numbers_of(
    text: &str,
    separator: Separator,
    columns: &[&str],
    size: usize,
    numbers: &mut Vec<f64>,
) -> Result<Cell, Wrong> {
    numbers.clear();
    let count = separator.fields(text).count();
    if count != columns.len() {
        let what = format!("{count} columns, the header has {}", columns.len());
        let remedy = match separator {
            Separator::Comma if count > columns.len() => "write a number for each column, with a decimal point",
            _ => "write a number for each column",
        };
        return Err((what, remedy.to_owned()));
    }
    let mut cell = [0; 3];
    for (i, (field, column)) in separator.fields(text).zip(columns).enumerate() {
        if i < 3 {
            cell[i] = field.parse().ok().filter(|c| *c < size).ok_or_else(|| outside(field, column, size))?;
        } else {
            numbers.push(separator.number(field).ok_or_else(|| {
                let what = format!("{column} is {}, no finite number", quote(field));
                (what, "write a decimal number such as -1.5e-3".to_owned())
            })?);
        }
    }
    Ok(cell)
}

/// A coordinate that is none of the volume's.
fn outside(field: &str, column: &str, size: usize) -> Wrong {
    let what = format!("{column} is {}; cells go from 0 to {}", quote(field), size - 1);
    let remedy = match field.parse::<usize>() {
        Ok(_) => format!("the volume has {size} cells a side, the file is for a larger one or a finer level"),
        Err(_) => "write a whole number in that range".to_owned(),
    };
    (what, remedy)
}

/// The lines of a text file, blank ones and remarks skipped.
struct Lines<'a, R> {
    path: &'a Path,
    reader: R,
    line: usize,
    bytes: Vec<u8>,
    /// Whether the last row that was read cannot have been cut: it has its line end, or a closing quote.
    ended: bool,
}

impl<R: BufRead> Lines<'_, R> {
    /// The next line that is neither blank nor a remark, with its number from 1.
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
            let text = self.bytes.trim_ascii();
            if !text.is_empty() && !is_comment(text) {
                self.ended = self.bytes.ends_with(b"\n") || text.ends_with(b"\"");
                break;
            }
        }
        let text = str::from_utf8(&self.bytes).map_err(|_| {
            SceneError::line(self.path, self.line, "this line is not UTF-8 text", "save the file as a text CSV")
        })?;
        Ok(Some((self.line, text.trim())))
    }

    /// Which of the known headers the file begins with, and what separates its columns.
    fn header(&mut self, known: &[&str]) -> Result<(usize, Separator), SceneError> {
        let path = self.path;
        if let Some((what, remedy)) = self.reader.fill_buf().ok().and_then(other_kind) {
            return Err(SceneError::file(path, None, what, remedy));
        }
        let remedy = format!("it begins with {}", known.join(" or "));
        let Some((line, text)) = self.next()? else {
            return Err(SceneError::line(path, 1, "the file is empty", remedy));
        };
        let separator = Separator::of(text);
        let found: Vec<String> =
            separator.fields(text).map(|field| field.split_whitespace().collect::<String>()).collect();
        let found = found.join(",");
        known
            .iter()
            .position(|header| found.eq_ignore_ascii_case(header))
            .map(|header| (header, separator))
            .ok_or_else(|| SceneError::line(path, line, format!("the header {} is not known", quote(text)), remedy))
    }

    /// Refuses a file whose last line may have been cut.
    fn check_end(&self) -> Result<(), SceneError> {
        if self.ended {
            return Ok(());
        }
        let what = "the last row has no line end, so it may have been cut";
        let remedy = "write the file again, or end the row if it is whole";
        Err(SceneError::line(self.path, self.line.saturating_sub(1), what, remedy))
    }
}
