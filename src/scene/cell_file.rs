//! Files of light: what one run writes, another injects.
//!
//! CSV holds the cells where something is non-zero, z slowest and x fastest, with coefficients in the
//! published basis (c00, c1-1, c10, c11). Its header is one of
//!
//! - `x,y,z,s0,s1,s2,s3,a0,a1,a2,a3`: the source grid S_k, then the accumulated one;
//! - `x,y,z,a0,a1,a2,a3`: an accumulated or merged grid alone;
//! - `x,y,z,c0,c1,c2,c3`: any light.
//!
//! A `.npy` file holds every cell: an array of shape (n, n, n, 4), C order, indexed [z, y, x], with the same
//! coefficients as f4 or f8 of either endianness. What is written is little-endian f4.

use std::io::{self, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::SceneError;
use super::{MOST_CELLS, npy, rows};
use crate::field::{Cell, Grid};
use crate::sh::Sh;

/// The headers that are read; the first and the second are also written.
const HEADERS: [&str; 3] = ["x,y,z,s0,s1,s2,s3,a0,a1,a2,a3", "x,y,z,a0,a1,a2,a3", "x,y,z,c0,c1,c2,c3"];

/// Which light of a file that holds two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Column {
    /// The source grid, `s0` to `s3`.
    #[default]
    Source,
    /// The accumulated grid, `a0` to `a3`.
    Accumulated,
}

/// Reads the lit cells of a file for a volume of side `size`: z slowest, x fastest, at most
/// [`MOST_CELLS`] of them. A file whose name ends in `.npy` is read as such, any other as CSV. `column` chooses
/// where the file holds two lights; where it holds one that one is taken.
pub fn read(path: &Path, size: usize, column: Column) -> Result<Vec<(Cell, Sh<f64>)>, SceneError> {
    read_at_most(path, size, column, MOST_CELLS)
}

/// As [`read`], but at most `most` cells.
pub(super) fn read_at_most(
    path: &Path,
    size: usize,
    column: Column,
    most: usize,
) -> Result<Vec<(Cell, Sh<f64>)>, SceneError> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npy")) {
        return npy::read(path, size, most);
    }
    let mut light = rows::read(path, size, most, &HEADERS, |_, numbers| {
        let chosen = match column {
            Column::Source => numbers.first_chunk(),
            Column::Accumulated => numbers.last_chunk(),
        };
        chosen.map(|c| Sh::from_basis(*c)).ok_or_else(|| ("no light".to_owned(), "write four coefficients"))
    })?;
    light.retain(|(_, sh)| !sh.is_zero());
    Ok(light)
}

/// Writes grids of one size as CSV: nine significant digits, which is all that f32 has.
pub fn write_csv(mut writer: impl Write, source: Option<&Grid<f32>>, accumulated: &Grid<f32>) -> io::Result<()> {
    writeln!(writer, "{}", HEADERS[usize::from(source.is_none())])?;
    for (cell, sum) in accumulated.iter() {
        let sent = source.map(|grid| grid.get(cell));
        if sum.is_zero() && sent.is_none_or(Sh::is_zero) {
            continue;
        }
        let [x, y, z] = cell;
        write!(writer, "{x},{y},{z}")?;
        for coefficient in sent.into_iter().chain([sum]).flat_map(Sh::to_basis) {
            write!(writer, ",{coefficient:.8e}")?;
        }
        writeln!(writer)?;
    }
    writer.flush()
}

pub use super::npy::write as write_npy;
