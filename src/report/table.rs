//! Rows of numbers: CSV for other programs, aligned text for a terminal.

use std::io;

use super::number::plain;
use crate::study::artefacts::jump::Jump;
use crate::study::error::ErrorRow;
use crate::study::pareto;

/// The width that tables for people fit into, in characters: that of a terminal.
pub const WIDTH: usize = 80;
/// Between two columns.
const GAP: usize = 2;

/// What stands in one place of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A word, aligned to the left.
    Text(String),
    /// A number of things.
    Count(usize),
    /// A measured number: every digit in CSV, four in text; not finite ones are `inf`, `-inf` and `NaN` in CSV.
    Number(f64),
}

impl Value {
    fn exact(&self) -> String {
        match self {
            Value::Text(text) => text.clone(),
            Value::Count(count) => count.to_string(),
            // The shortest text that reads back as the same number; adding 0 turns −0 into 0.
            Value::Number(number) => format!("{:?}", number + 0.0),
        }
    }

    fn brief(&self) -> String {
        match self {
            Value::Number(number) => plain(*number, 4),
            other => other.exact(),
        }
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Value::Text(text.to_owned())
    }
}

impl From<usize> for Value {
    fn from(count: usize) -> Self {
        Value::Count(count)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Value::Number(number)
    }
}

/// A table of N columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Table<const N: usize> {
    columns: [&'static str; N],
    rows: Vec<[Value; N]>,
}

impl<const N: usize> Table<N> {
    /// A table without rows.
    ///
    /// ```
    /// use lpv_lab::report::table::Table;
    ///
    /// let mut table = Table::new(["scheme", "k", "error"]);
    /// table.push(["cascaded".into(), 4.into(), 7.8e-5.into()]);
    /// assert_eq!(table.to_text(), "scheme    k   error\ncascaded  4  7.8e-5\n");
    /// let mut csv = Vec::new();
    /// table.write_csv(&mut csv)?;
    /// assert_eq!(csv, b"scheme,k,error\ncascaded,4,7.8e-5\n");
    /// # Ok::<(), std::io::Error>(())
    /// ```
    pub fn new(columns: [&'static str; N]) -> Self {
        Table { columns, rows: Vec::new() }
    }

    /// Adds a row at the end.
    pub fn push(&mut self, row: [Value; N]) {
        self.rows.push(row);
    }

    /// The table as CSV: a line with the columns' names, then a line a row.
    ///
    /// # Errors
    /// Where `out` cannot be written to.
    pub fn write_csv(&self, out: impl io::Write) -> io::Result<()> {
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(self.columns)?;
        for row in &self.rows {
            writer.write_record(row.each_ref().map(Value::exact))?;
        }
        writer.flush()
    }

    /// The table for people: a line with the columns' names, then a line a row, columns two spaces
    /// apart, numbers aligned to the right. Columns that do not fit into [`WIDTH`] are left out, the last
    /// first, and named below.
    pub fn to_text(&self) -> String {
        let rows: Vec<[String; N]> = self.rows.iter().map(|row| row.each_ref().map(Value::brief)).collect();
        let width = |c: usize| {
            let cells = rows.iter().map(|row| row[c].chars().count());
            cells.fold(self.columns[c].chars().count(), usize::max)
        };
        let widths: [usize; N] = std::array::from_fn(width);
        let words: [bool; N] = std::array::from_fn(|c| self.rows.iter().any(|row| matches!(row[c], Value::Text(_))));
        let mut used = 0;
        let fits = |width: &&usize| {
            used += **width + if used == 0 { 0 } else { GAP };
            used <= WIDTH
        };
        let shown = widths.iter().take_while(fits).count().max(1);
        let line = |cells: &[String; N]| {
            let aligned = (0..shown).map(|c| {
                let (cell, width) = (&cells[c], widths[c]);
                if words[c] { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
            });
            aligned.collect::<Vec<_>>().join(&" ".repeat(GAP)).trim_end().to_owned() + "\n"
        };
        let head = line(&self.columns.map(str::to_owned));
        let mut text = rows.iter().fold(head, |text, row| text + &line(row));
        if shown < N {
            text += &format!("(no room for {})\n", self.columns[shown..].join(", "));
        }
        text
    }
}

/// The errors of a run, as `errors.csv` has them; level is `all` or a number. Under the metric `jump` each iteration ends
/// with the jumps between levels: mean and largest as absolute, the pairs left out as undefined.
pub fn errors(rows: &[ErrorRow], jumps: &[(usize, Jump)]) -> Table<9> {
    let mut table = Table::new([
        "iteration",
        "metric",
        "level",
        "absolute_mean",
        "absolute_max",
        "relative_mean",
        "relative_max",
        "l1_ratio",
        "undefined",
    ]);
    let measured = rows.iter().map(|row| {
        let line: [Value; 9] = [
            row.iteration.into(),
            row.expectation.name().into(),
            row.level.map_or("all".into(), |level| Value::Text(level.to_string())),
            row.absolute_mean.into(),
            row.absolute_max.into(),
            row.relative_mean.into(),
            row.relative_max.into(),
            row.l1_ratio.into(),
            row.undefined.into(),
        ];
        (row.iteration, line)
    });
    let jumps = jumps.iter().map(|(iteration, jump)| {
        let line: [Value; 9] = [
            (*iteration).into(),
            "jump".into(),
            "all".into(),
            jump.mean.into(),
            jump.max.into(),
            // A logarithm of ratios is relative as it is.
            "".into(),
            "".into(),
            "".into(),
            jump.undefined.into(),
        ];
        (*iteration, line)
    });
    let mut lines: Vec<(usize, [Value; 9])> = measured.chain(jumps).collect();
    // Stable: what was measured stays before the jump.
    lines.sort_by_key(|(iteration, _)| *iteration);
    lines.into_iter().for_each(|(_, line)| table.push(line));
    table
}

/// What is told of light that is held against a path-traced truth, as `truth.csv` has it.
pub fn traced(rows: &[ErrorRow]) -> Table<10> {
    let mut table = Table::new([
        "iteration",
        "metric",
        "mean_ratio",
        "l1_ratio",
        "l1_best_fit",
        "correlation",
        "rmse",
        "relmse",
        "flip",
        "truth_noise",
    ]);
    let number = |value: Option<f64>| value.map_or_else(|| "".into(), Value::Number);
    for (row, traced) in rows.iter().filter_map(|row| Some((row, row.traced?))) {
        let picture = |i: usize| number(traced.picture.map(|numbers| numbers[i]));
        table.push([
            row.iteration.into(),
            row.expectation.name().into(),
            traced.mean_ratio.into(),
            row.l1_ratio.into(),
            number(row.l1_best_fit),
            number(traced.correlation),
            picture(0),
            picture(1),
            picture(2),
            traced.noise.into(),
        ]);
    }
    table
}

/// Ways to get at the light of a scene, as `pareto.csv` has them.
pub fn pareto(rows: &[&pareto::Row]) -> Table<9> {
    let mut table =
        Table::new(["preset", "scheme", "levels", "size", "iterations", "seconds", "reference", "l1", "l1_best_fit"]);
    for row in rows {
        table.push([
            row.preset.as_str().into(),
            Value::Text(row.name()),
            Value::Text(row.levels()),
            row.size.into(),
            row.iterations.into(),
            row.seconds.into(),
            row.expectation.reference().into(),
            row.l1.raw.into(),
            row.l1.fitted.into(),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::expectation::Expectation;

    #[test]
    fn errors_are_written_under_the_agreed_header_and_read_back_to_the_last_bit() {
        let row = ErrorRow {
            iteration: 12,
            expectation: Expectation::Thesis,
            level: None,
            absolute_mean: 9.35e-5 + 1e-19,
            absolute_max: 0.1 + 0.2,
            relative_mean: 1.0 / 3.0,
            relative_max: 20.0,
            l1_ratio: f64::INFINITY,
            l1_best_fit: None,
            traced: None,
            undefined: 4,
        };
        let rows = [row, ErrorRow { level: Some(3), l1_ratio: 0.5, ..row }];
        let later = ErrorRow { iteration: 13, ..row };
        let mut file = Vec::new();
        let jump = Jump { mean: 0.25, max: 2.0, pairs: 3, undefined: 1 };
        errors(&[rows[0], rows[1], later], &[(12, jump)]).write_csv(&mut file).unwrap();
        let first = std::str::from_utf8(&file).unwrap().lines().next().unwrap();
        assert_eq!(
            first,
            "iteration,metric,level,absolute_mean,absolute_max,relative_mean,relative_max,l1_ratio,undefined"
        );
        let mut reader = csv::Reader::from_reader(file.as_slice());
        let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let iterations: Vec<&str> = records.iter().map(|record| &record[0]).collect();
        assert_eq!(iterations, ["12", "12", "12", "13"]);
        assert_eq!(records[2].iter().collect::<Vec<_>>(), ["12", "jump", "all", "0.25", "2.0", "", "", "", "1"]);
        for (record, row) in records.iter().zip(rows) {
            let number = |i: usize| record[i].parse::<f64>().unwrap();
            let level = row.level.map_or("all".to_owned(), |level| level.to_string());
            assert_eq!((&record[0], &record[1], &record[2]), ("12", "thesis", level.as_str()));
            assert_eq!([number(3), number(4)], [row.absolute_mean, row.absolute_max]);
            assert_eq!([number(5), number(6), number(7)], [row.relative_mean, row.relative_max, row.l1_ratio]);
            assert_eq!(&record[8], "4");
        }
    }

    #[test]
    fn words_with_commas_survive() {
        let mut table = Table::new(["name", "n"]);
        table.push(["a, \"b\"".into(), 3.into()]);
        let mut file = Vec::new();
        table.write_csv(&mut file).unwrap();
        let record = csv::Reader::from_reader(file.as_slice()).records().next().unwrap().unwrap();
        assert_eq!((&record[0], &record[1]), ("a, \"b\"", "3"));
    }

    #[test]
    fn text_lines_up() {
        let mut table = Table::new(["scheme", "k", "error"]);
        table.push(["cascaded".into(), 4.into(), 7.8e-5.into()]);
        table.push(["axial".into(), 128.into(), 0.5.into()]);
        assert_eq!(
            table.to_text(),
            "scheme      k   error\n\
             cascaded    4  7.8e-5\n\
             axial     128     0.5\n"
        );
        assert_eq!(Table::new(["a", "b"]).to_text(), "a  b\n");
    }

    #[test]
    fn what_a_terminal_has_no_room_for_is_named_and_not_broken() {
        let names = ["one", "two", "three", "four", "five", "six", "seven", "eight", "nine"];
        let mut table = Table::new(names);
        table.push(std::array::from_fn(|_| Value::Number(-1.234_567e-30)));
        let text = table.to_text();
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert!(text.ends_with("(no room for seven, eight, nine)\n"), "{text}");
    }

    #[test]
    fn minus_zero_is_zero() {
        let mut table = Table::new(["a"]);
        table.push([Value::Number(-0.0)]);
        let mut file = Vec::new();
        table.write_csv(&mut file).unwrap();
        assert_eq!((std::str::from_utf8(&file).unwrap(), table.to_text().as_str()), ("a\n0.0\n", "a\n0\n"));
    }
}
