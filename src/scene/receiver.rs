//! Places on surfaces whose light somebody wants to know.

use glam::DVec3;

use crate::field::Cell;

/// One side of a piece of surface in a cell. Transports that keep directions tell what it receives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// The cell that it lies in.
    pub cell: Cell,
    /// Its unit normal.
    pub normal: DVec3,
}
