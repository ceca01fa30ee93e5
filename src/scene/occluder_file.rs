//! Files of occupied cells: CSV with the header `x,y,z`, then `nx,ny,nz` (a normal of any length but zero)
//! or `opacity` (0 to 1) or both.

use std::path::Path;

use glam::DVec3;

use super::error::SceneError;
use super::rows;
use super::value::{check_share, unit};
use crate::field::Cell;

const HEADERS: [&str; 4] = ["x,y,z", "x,y,z,opacity", "x,y,z,nx,ny,nz", "x,y,z,nx,ny,nz,opacity"];

/// An occupied cell of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    /// The cell.
    pub(super) cell: Cell,
    /// The surface's unit normal, where the file gives one.
    pub(super) normal: Option<DVec3>,
    /// How much of the cell is blocked, 0 to 1; 1 where the file does not say.
    pub(super) opacity: f64,
}

/// Reads the occupied cells of a file, at most `most`, for a volume of side `size`.
pub(super) fn read(path: &Path, size: usize, most: usize) -> Result<Vec<Row>, SceneError> {
    let rows = rows::read(path, size, most, &HEADERS, |_, numbers| {
        let (normal, opacity) = match *numbers {
            [] => (None, 1.0),
            [opacity] => (None, opacity),
            [x, y, z] => (Some([x, y, z]), 1.0),
            [x, y, z, opacity] => (Some([x, y, z]), opacity),
            _ => return Err(("these columns are not known".to_owned(), "use one of the known headers".to_owned())),
        };
        let refused = |_| ("the normal has length zero".to_owned(), "any other length will do".to_owned());
        let normal = normal.map(|n| unit(n, "normal")).transpose().map_err(refused)?;
        check_share(opacity, "the opacity")
            .map_err(|fault| (fault.what, "write a number from 0 to 1".to_owned()))
            .map(|()| (normal, opacity))
    })?;
    Ok(rows.cells.into_iter().map(|(cell, (normal, opacity))| Row { cell, normal, opacity }).collect())
}
