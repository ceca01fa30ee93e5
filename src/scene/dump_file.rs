//! Dumps of a grid that another program wrote: numbers as they are in the file, in any order of axes and coefficients.
//!
//! A `.npy` file holds an array of shape (n, n, n, 4), C order, f2, f4 or f8; a CSV file the lit cells of one, as
//! [`super::cell_file`] describes them. Nothing is assumed of what the numbers mean.

use std::io::{BufReader, Read};
use std::path::Path;

use super::cell_file::Column;
use super::error::{SceneError, quote};
use super::npy::{self, Number};
use super::rows::{self, Wrong};
use crate::system::file;

/// The largest side of a dump.
pub const LARGEST_SIDE: usize = 128;

/// The headers of CSV dumps.
const HEADERS: [&str; 4] =
    ["x,y,z,s0,s1,s2,s3,a0,a1,a2,a3", "x,y,z,s0,s1,s2,s3", "x,y,z,a0,a1,a2,a3", "x,y,z,c0,c1,c2,c3"];

/// Numbers of a dump.
#[derive(Clone, Debug, PartialEq)]
pub enum Numbers {
    /// All of them, C order.
    Array {
        /// The array's side.
        side: usize,
        /// Four numbers a cell.
        cells: Vec<[f64; 4]>,
    },
    /// Those of some cells (x, y, z) of a grid whose side the file does not tell; the others are dark.
    Cells(Vec<([usize; 3], [f64; 4])>),
}

impl Numbers {
    /// The smallest side that holds all cells.
    pub fn least_side(&self) -> usize {
        match self {
            Numbers::Array { side, .. } => *side,
            Numbers::Cells(cells) => cells.iter().flat_map(|(cell, _)| cell).max().map_or(1, |last| last + 1),
        }
    }

    /// The array of side `side`, indexed [z, y, x] where the file holds cells; `None` if they do not fit.
    pub fn array(self, side: usize) -> Option<Vec<[f64; 4]>> {
        if self.least_side() > side {
            return None;
        }
        match self {
            Numbers::Array { side: own, cells } => (own == side).then_some(cells),
            Numbers::Cells(cells) => {
                let mut array = vec![[0.0; 4]; side.pow(3)];
                for ([x, y, z], numbers) in cells {
                    array[x + side * (y + side * z)] = numbers;
                }
                Some(array)
            }
        }
    }
}

/// Reads a dump; `column` chooses where a CSV file holds two grids.
pub fn read(path: &Path, column: Column) -> Result<Numbers, SceneError> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npy")) {
        let longest = 12 + 4096 + LARGEST_SIDE.pow(3) as u64 * 4 * 8;
        let (file, length) = file::open(path, longest)?;
        return array(BufReader::new(file), length)
            .map_err(|(what, remedy)| SceneError::file(path, None, what, remedy));
    }
    let rows = rows::read(path, LARGEST_SIDE, LARGEST_SIDE.pow(3), &HEADERS, |_, numbers| {
        let chosen: Option<&[f64; 4]> = match column {
            Column::Source => numbers.first_chunk(),
            Column::Accumulated => numbers.last_chunk(),
        };
        chosen.copied().ok_or_else(|| ("no light".to_owned(), "write four coefficients".to_owned()))
    })?;
    Ok(Numbers::Cells(rows.cells))
}

fn array(mut file: impl Read, length: u64) -> Result<Numbers, Wrong> {
    let (header, header_length) = npy::header(&mut file)?;
    let number = Number::in_c_order(&header)?;
    let side = side(&header)?;
    let expected = header_length + (side.pow(3) * 4 * number.width) as u64;
    if length != expected {
        let what = format!("the file has {length} bytes, its header promises {expected}");
        return Err((what, "write the whole array again".to_owned()));
    }
    let mut cells = vec![[0.0; 4]; side.pow(3)];
    for c in cells.iter_mut().flatten() {
        *c = number.read(&mut file).map_err(npy::unreadable)?;
    }
    Ok(Numbers::Array { side, cells })
}

/// The n of an array of shape (n, n, n, 4).
fn side(header: &str) -> Result<usize, Wrong> {
    let shape = npy::entry(header, "shape").unwrap_or_default();
    let numbers: Vec<usize> = shape
        .trim_matches(['(', ')'])
        .split(',')
        .filter(|part| !part.is_empty())
        .filter_map(|part| part.parse().ok())
        .collect();
    match numbers[..] {
        [a, b, c, 4] if a == b && b == c && (2..=LARGEST_SIDE).contains(&a) => Ok(a),
        _ => {
            let what = format!("the array's shape is {}", quote(shape));
            Err((what, format!("a dump has the shape (n, n, n, 4), n from 2 to {LARGEST_SIDE}")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn npy(header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    fn read_bytes(bytes: &[u8]) -> Result<Numbers, Wrong> {
        array(bytes, bytes.len() as u64)
    }

    #[test]
    fn half_precision_arrays_are_read() {
        let header = "{'descr': '<f2', 'fortran_order': False, 'shape': (2, 2, 2, 4), }\n";
        let halves = [0x3c00u16, 0xb800, 0x0001, 0x7bff];
        let data: Vec<u8> = halves.iter().cycle().take(32).flat_map(|h| h.to_le_bytes()).collect();
        let Ok(Numbers::Array { side: 2, cells }) = read_bytes(&npy(header, &data)) else { panic!() };
        assert_eq!(cells, vec![[1.0, -0.5, 2f64.powi(-24), 65504.0]; 8]);
    }

    #[test]
    fn arrays_that_are_no_dump_are_refused() {
        let of = |shape: &str, descr: &str, bytes: usize| {
            let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
            read_bytes(&npy(&header, &vec![0; bytes])).unwrap_err().0
        };
        assert!(of("(2, 2, 2)", "<f4", 32).contains("shape"));
        assert!(of("(2, 2, 3, 4)", "<f4", 192).contains("shape"));
        assert!(of("(9999999999999999999, 2, 2, 4)", "<f4", 0).contains("shape"));
        assert!(of("(2, 2, 2, 4)", "<f4", 100).contains("promises"));
        assert!(of("(2, 2, 2, 4)", "<i4", 128).contains("type"));
        assert!(read_bytes(b"no array").unwrap_err().0.contains("no .npy"));
    }
}
