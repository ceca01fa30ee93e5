//! One row of a CSV file of cells, taken apart: what separates its fields, quotes around them, decimal commas.
//!
//! Spreadsheets in half of Europe write `1;2;3;0,886227`: semicolons between fields, a comma before decimals. A file
//! whose header is separated by semicolons or tabulators is read that way; in one separated by commas a decimal comma
//! cannot be told from a separator, and the row has too many fields.

/// What stands between fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    /// `,`, with decimal points.
    Comma,
    /// `;`, with decimal points or commas.
    Semicolon,
    /// A tabulator, with decimal points or commas.
    Tabulator,
}

impl Separator {
    /// The separator of a header: the one that it holds.
    pub(super) fn of(header: &str) -> Self {
        let known = [Separator::Comma, Separator::Semicolon, Separator::Tabulator];
        let held = known.into_iter().find(|separator| header.contains(separator.character()));
        held.unwrap_or(Separator::Comma)
    }

    fn character(self) -> char {
        match self {
            Separator::Comma => ',',
            Separator::Semicolon => ';',
            Separator::Tabulator => '\t',
        }
    }

    /// The fields of a row, without the blanks and quotes around them. Numbers hold no separators, so none needs the
    /// quotes.
    pub(super) fn fields(self, row: &str) -> impl Iterator<Item = &str> {
        row.split(self.character()).map(unquoted)
    }

    /// The number that a field holds; `None` where it holds none.
    pub(super) fn number(self, field: &str) -> Option<f64> {
        let decimal_comma = self != Separator::Comma && field.matches(',').count() == 1 && !field.contains('.');
        let number = if decimal_comma { field.replace(',', ".").parse() } else { field.parse() };
        number.ok().filter(|number: &f64| number.is_finite())
    }
}

/// A field without the blanks around it, and the double quotes around that.
fn unquoted(field: &str) -> &str {
    let field = field.trim();
    let inner = field.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
    inner.map_or(field, str::trim)
}

/// Whether a line is a remark: some programs put `# made by …` before the header.
pub(super) fn is_comment(line: &[u8]) -> bool {
    line.trim_ascii_start().starts_with(b"#")
}

/// What a file is that is no text, by how it begins; `None` where nothing is known about it.
pub(super) fn other_kind(start: &[u8]) -> Option<(&'static str, &'static str)> {
    const KINDS: [(&[u8], &str, &str); 5] = [
        (
            b"PK\x03\x04",
            "this is an archive (.npz, .xlsx or .zip)",
            "save one array with numpy.save, or the sheet as CSV",
        ),
        (b"\x93NUMPY", "this is a .npy array", "give it a name that ends in .npy"),
        (b"\x1f\x8b", "this is a compressed file (.gz)", "unpack it"),
        (b"\x89HDF", "this is an HDF5 file", "save the cells as CSV or with numpy.save"),
        (b"PAR1", "this is a Parquet file", "save the cells as CSV or with numpy.save"),
    ];
    KINDS.iter().find(|(magic, ..)| start.starts_with(magic)).map(|(_, what, remedy)| (*what, *remedy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decimal_comma_is_read_where_it_separates_nothing() {
        let fields = |header: &str, row: &str| {
            let separator = Separator::of(header);
            separator.fields(row).map(|field| separator.number(field)).collect::<Vec<_>>()
        };
        assert_eq!(fields("x;y;z;c", "1;-0,5;2.5;\"1e-3\""), [Some(1.0), Some(-0.5), Some(2.5), Some(1e-3)]);
        assert_eq!(fields("x\ty", "1\t-0,5"), [Some(1.0), Some(-0.5)]);
        assert_eq!(fields("x,y,z", "1, -0.5 ,\" 2\""), [Some(1.0), Some(-0.5), Some(2.0)]);
        let semicolon = Separator::Semicolon;
        for field in ["1.234,5", "1,234,5", "", "inf", "NaN", "1e999", "x", "\"1"] {
            assert_eq!(semicolon.number(field), None, "{field}");
        }
        assert_eq!(Separator::Comma.number("1,5"), None);
    }
}
