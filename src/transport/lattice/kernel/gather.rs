//! Which light a cell gathers, and from whom.

use crate::field::{Cell, Grid};
use crate::sh::{Real, Sh};
use crate::transport::lattice::face::Direction;

/// Which light is propagated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Which {
    /// The level, 0 the finest.
    pub level: usize,
    /// The colour whose albedo counts: 0 red, 1 green, 2 blue.
    pub colour: usize,
    /// Whether fuzzy blockers weaken light yet; where not they only reflect it.
    pub blocks: bool,
}

/// The light of the neighbour from which light in direction `d` enters `cell`; none outside the grid.
pub(super) fn sender<T: Real>(source: &Grid<T>, cell: Cell, d: Direction) -> Sh<T> {
    d.opposite().neighbour(cell, source.side()).map_or(Sh::ZERO, |sender| source.get(sender))
}
