//! What stands between leaves: cells that let a share of the light that enters them go on, and mirror some of the rest.

use super::blockers::Blockers;
use crate::field::{Cell, Grid};
use crate::sh::{Real, Sh};
use crate::transport::lattice::kernel::occluded::Hard;

/// Walls, by level and cell.
pub trait Walls: Sync {
    /// Whether any cell lets less than all light go on.
    fn any(&self) -> bool {
        true
    }

    /// What acts on light otherwise than by a share for each axis.
    fn blockers(&self) -> Option<&Blockers> {
        None
    }

    /// The share of the light that enters a cell along an axis (0 for x) that goes on in it, 0 to 1.
    fn passes(&self, level: usize, cell: Cell, axis: usize) -> f64;

    /// What light that cannot enter a cell is multiplied with when it is mirrored.
    fn mirrors(&self, level: usize, cell: Cell) -> f64;
}

/// No cell stands in light's way, but blockers may act on it.
#[derive(Clone, Copy, Debug)]
pub struct Open<'a>(pub Option<&'a Blockers>);

impl Walls for Open<'_> {
    fn any(&self) -> bool {
        false
    }

    fn blockers(&self) -> Option<&Blockers> {
        self.0
    }

    fn passes(&self, _: usize, _: Cell, _: usize) -> f64 {
        1.0
    }

    fn mirrors(&self, _: usize, _: Cell) -> f64 {
        0.0
    }
}

/// Hard occluders, as light of a colour (0 red, 1 green, 2 blue) meets them.
#[derive(Clone, Copy, Debug)]
pub struct Solid<'a, T> {
    /// The occluders.
    pub hard: &'a Hard<T>,
    /// The colour whose albedo counts.
    pub colour: usize,
}

impl<T: Real> Walls for Solid<'_, T> {
    fn passes(&self, level: usize, cell: Cell, axis: usize) -> f64 {
        self.hard.hard_solids.passes(level, cell, axis).to_f64()
    }

    fn mirrors(&self, level: usize, cell: Cell) -> f64 {
        (self.hard.bounce * self.hard.geometry.albedo(level, cell, self.colour)).to_f64()
    }
}

impl<T: Real> Solid<'_, T> {
    /// Makes the cells of a level dark that no light can enter: the filter hands light on without looking.
    pub fn darken(&self, level: usize, light: &mut Grid<T>) {
        for cell in light.layout().cells() {
            if (0..3).all(|axis| self.hard.hard_solids.passes(level, cell, axis) == T::ZERO) {
                light.set(cell, Sh::ZERO);
            }
        }
    }
}
