//! Files of light: what one run writes, another injects, and the same light whichever format it was written in.
//!
//! CSV holds the cells where something is non-zero, z slowest and x fastest, with coefficients in the
//! published basis (c00, c1-1, c10, c11). Its header says which light it is:
//!
//! - `x,y,z,s0,s1,s2,s3,a0,a1,a2,a3`: the source grid S_k, then the accumulated one S_A;
//! - `x,y,z,s0,s1,s2,s3`: the source grid alone;
//! - `x,y,z,a0,a1,a2,a3`: an accumulated or merged grid alone;
//! - `x,y,z,c0,c1,c2,c3`: any light.
//!
//! A last column `side` says of how many cells a side the grid is; it is written for all levels but the finest, whose
//! cells would otherwise pass for a corner of a finer volume. Semicolons or tabulators between the columns, decimal
//! commas then, quotes, and remarks after `#` are read, too. The last row must have its line end.
//!
//! A `.npy` file holds every cell of one grid: an array of shape (n, n, n, 4), C order, indexed [z, y, x], with the
//! same coefficients as f4 or f8 of either endianness. What is written is little-endian f4.

use std::io::{self, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::{Fault, SceneError};
use super::rows::Wrong;
use super::{MOST_CELLS, npy, rows};
use crate::field::{Cell, Grid};
use crate::sh::Sh;

/// The headers that are read.
const HEADERS: [&str; 8] = [
    "x,y,z,s0,s1,s2,s3,a0,a1,a2,a3",
    "x,y,z,s0,s1,s2,s3",
    "x,y,z,a0,a1,a2,a3",
    "x,y,z,c0,c1,c2,c3",
    "x,y,z,s0,s1,s2,s3,a0,a1,a2,a3,side",
    "x,y,z,s0,s1,s2,s3,side",
    "x,y,z,a0,a1,a2,a3,side",
    "x,y,z,c0,c1,c2,c3,side",
];
/// The first of those that end in `side`.
const WITH_SIDE: usize = 4;

/// Which light of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Column {
    /// The source grid S_k, `s0` to `s3`: the light that is under way.
    Source,
    /// The accumulated grid S_A, `a0` to `a3`: all light that has been there.
    Accumulated,
}

/// What a header of the list holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Holds {
    Both,
    Only(Column),
    Any,
}

impl Holds {
    fn of(header: usize) -> Self {
        match header % WITH_SIDE {
            0 => Holds::Both,
            1 => Holds::Only(Column::Source),
            2 => Holds::Only(Column::Accumulated),
            _ => Holds::Any,
        }
    }

    /// Which of the row's lights is asked for: 0 the first, 1 the second.
    fn choose(self, column: Option<Column>) -> Result<usize, Fault> {
        match (self, column) {
            (Holds::Both, None) => Err(Fault::new(
                "the file holds two lights, the source grid and the accumulated one",
                "name one, `column: Source` or `column: Accumulated`; a .npy file holds the accumulated one",
            )
            .field("kind")),
            (Holds::Both, Some(column)) => Ok(column as usize),
            (Holds::Only(held), Some(column)) if held != column => Err(Fault::new(
                format!("the file holds the {} alone", held.name()),
                format!("write `column: {held:?}`, or leave it out"),
            )
            .field("column")
            .field("kind")),
            (Holds::Only(_) | Holds::Any, _) => Ok(0),
        }
    }
}

impl Column {
    fn name(self) -> &'static str {
        match self {
            Column::Source => "source grid (s0 to s3)",
            Column::Accumulated => "accumulated grid (a0 to a3)",
        }
    }
}

/// Reads the lit cells of a file for a volume of side `size`: z slowest, x fastest, at most
/// [`MOST_CELLS`] of them. A file whose name ends in `.npy` is read as such, any other as CSV. `column` names the light
/// where the file holds two; where it holds one, that one is taken.
///
/// # Errors
/// Where it cannot be read, is not for a volume of this size, holds two lights and `column` names none, or another one
/// than `column` names.
pub fn read(path: &Path, size: usize, column: Option<Column>) -> Result<Vec<(Cell, Sh<f64>)>, SceneError> {
    read_at_most(path, size, column, MOST_CELLS)
}

/// Whether a file holds two lights, so that an injector must name one.
pub fn holds_two(path: &Path) -> bool {
    !is_npy(path) && rows::header(path, &HEADERS).is_ok_and(|header| Holds::of(header) == Holds::Both)
}

fn is_npy(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npy"))
}

/// As [`read`], but at most `most` cells.
pub(super) fn read_at_most(
    path: &Path,
    size: usize,
    column: Option<Column>,
    most: usize,
) -> Result<Vec<(Cell, Sh<f64>)>, SceneError> {
    if is_npy(path) {
        return npy::read(path, size, most);
    }
    let read = rows::read(path, size, most, &HEADERS, |header, numbers| {
        let numbers = if header < WITH_SIDE { numbers } else { of_this_side(numbers, size)? };
        let lights = numbers.as_chunks::<4>().0;
        match *lights {
            [one] => Ok([one; 2]),
            [one, other] => Ok([one, other]),
            _ => Err(("no light".to_owned(), "write four coefficients".to_owned())),
        }
    })?;
    let chosen = Holds::of(read.header).choose(column)?;
    let light = read.cells.into_iter().map(|(cell, lights)| (cell, Sh::from_basis(lights[chosen])));
    Ok(light.filter(|(_, sh)| !sh.is_zero()).collect())
}

/// The numbers of a row before its last one, which must be the volume's side.
fn of_this_side(numbers: &[f64], size: usize) -> Result<&[f64], Wrong> {
    match numbers.split_last() {
        Some((side, rest)) if *side == size as f64 => Ok(rest),
        Some((side, _)) => Err((
            format!("the cell is one of a grid of {side} cells a side, the volume has {size}"),
            "write level 0, or inject it into a volume of that size".to_owned(),
        )),
        None => Err(("no light".to_owned(), "write four coefficients".to_owned())),
    }
}

/// The grids of one level that are written.
#[derive(Clone, Copy, Debug)]
pub struct Grids<'a> {
    /// The source grid.
    pub source: Option<&'a Grid<f32>>,
    /// The accumulated grid.
    pub accumulated: Option<&'a Grid<f32>>,
    /// Whether the rows say of how many cells a side the grids are.
    pub side: bool,
}

/// Writes grids of one size as CSV: nine significant digits, which is all that f32 has.
///
/// # Errors
/// Where `writer` cannot be written to, or there is no grid.
pub fn write_csv(mut writer: impl Write, grids: Grids<'_>) -> io::Result<()> {
    let Grids { source, accumulated, side } = grids;
    let header = match (source, accumulated) {
        (Some(_), Some(_)) => 0,
        (Some(_), None) => 1,
        (None, _) => 2,
    };
    writeln!(writer, "{}", HEADERS[header + if side { WITH_SIDE } else { 0 }])?;
    let grids: Vec<&Grid<f32>> = source.into_iter().chain(accumulated).collect();
    let first = grids.first().ok_or(io::ErrorKind::InvalidInput)?;
    for cell in first.layout().cells() {
        let lights = grids.iter().map(|grid| grid.get(cell));
        if lights.clone().all(|light| light.is_zero()) {
            continue;
        }
        let [x, y, z] = cell;
        write!(writer, "{x},{y},{z}")?;
        for coefficient in lights.flat_map(Sh::to_basis) {
            write!(writer, ",{coefficient:.8e}")?;
        }
        if side {
            write!(writer, ",{}", first.side())?;
        }
        writeln!(writer)?;
    }
    writer.flush()
}

pub use super::npy::write as write_npy;
