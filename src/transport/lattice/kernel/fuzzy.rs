//! Fuzzy occlusion: blockers half a cell off the light weaken the flux through every face and reflect some
//! of it (000, 6.2; NVIDIA's sample; MATH.md section 9).
//!
//! Blockers at a cell's near corners weaken what enters, from a certain iteration on. Those at its far corners send
//! back, from the first iteration on, of every flux that has entered
//!
//! ```text
//! (G · Y(−d)) · flux · 4.8 · ρ · bounce · G          G the mean far blocker, ρ its albedo, d the way of the light
//! ```
//!
//! which is not multiplied by p, as what a neighbour sends is.

use super::gather::{Which, sender};
use crate::field::{Cell, Grid};
use crate::sh::{Real, Sh};
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::geometry_volume::GeometryVolume;
use crate::transport::lattice::stencil::Stencil;

/// What NVIDIA's sample multiplies its reflected light by.
pub const REFLECTION: f64 = 4.8;

/// Blockers, and how they act.
#[derive(Clone, Debug, PartialEq)]
pub struct Fuzzy<T> {
    /// The blockers.
    pub geometry: GeometryVolume<T>,
    /// What a blocker's value is multiplied by before it is limited to 0..1.
    pub amplifier: T,
    /// Whether blockers are evaluated along the light's travel, as NVIDIA does, or against it.
    pub along_travel: bool,
    /// What reflected light is multiplied by.
    pub bounce: T,
}

/// The blockers around a cell as light in one direction meets them. They stand still, so cells near them
/// keep this from one iteration to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Around<T> {
    /// The mean blocker where light enters, turned so that it blocks where it is positive.
    near: Sh<T>,
    /// The mean blocker where light would leave.
    far: Sh<T>,
    /// How much the latter faces the light, 0 or more.
    facing: T,
    /// Its albedo by colour.
    albedo: [T; 3],
}

impl<T: Real> Around<T> {
    /// What a card keeps of it: the near blocker, the far one, and (how much that faces the light, its albedos).
    #[cfg(feature = "gpu")]
    pub(super) fn table(&self) -> [[T; 4]; 3] {
        let [red, green, blue] = self.albedo;
        [self.near.0, self.far.0, [self.facing, red, green, blue]]
    }
}

impl<T: Real> Fuzzy<T> {
    /// Whether a blocker lies at one of the cell's eight corners.
    pub(super) fn touches(&self, level: usize, cell: Cell) -> bool {
        corners(cell).any(|(_, at)| !self.geometry.lobe(level, at).is_zero())
    }

    /// The blockers around a cell of a level, for light in each of [`Direction::ALL`].
    pub(super) fn around(&self, level: usize, cell: Cell) -> [Around<T>; 6] {
        Direction::ALL.map(|direction| {
            let lobe = |at| self.geometry.lobe(level, at);
            let near = mean(cell, direction.opposite(), lobe);
            let far = mean(cell, direction, lobe);
            let albedo = [0, 1, 2].map(|colour| {
                let albedo = |at| Sh([self.geometry.albedo(level, at, colour), T::ZERO, T::ZERO, T::ZERO]);
                mean(cell, direction, albedo).0[0]
            });
            Around {
                near: if self.along_travel { near } else { near.reversed() },
                far,
                facing: far.eval(direction.opposite().vector()).max(T::ZERO),
                albedo,
            }
        })
    }

    /// What a cell receives, the blockers around it being `around`.
    pub(super) fn receive(
        &self,
        stencil: &Stencil<T>,
        which: Which,
        source: &Grid<T>,
        cell: Cell,
        around: &[Around<T>; 6],
    ) -> Sh<T> {
        let each = Direction::ALL.into_iter().zip(around);
        each.map(|(direction, around)| self.admit(stencil, which, direction, around, sender(source, cell, direction)))
            .sum()
    }

    /// What a cell receives of the `light` of the neighbour that sends it in a direction.
    pub(super) fn admit(
        &self,
        stencil: &Stencil<T>,
        which: Which,
        direction: Direction,
        around: &Around<T>,
        light: Sh<T>,
    ) -> Sh<T> {
        let mut reflected = T::ZERO;
        let mut received = Sh::ZERO;
        for tap in &stencil.taps()[direction.index()] {
            let mut flux = tap.flux(light);
            if which.blocks {
                let blocked = (self.amplifier * around.near.dot(tap.travel)).max(T::ZERO);
                flux *= (T::of(1.0) - blocked).max(T::ZERO);
            }
            received += tap.lobe * flux;
            reflected += around.facing * flux * T::of(REFLECTION);
        }
        if reflected == T::ZERO || self.bounce == T::ZERO {
            return received;
        }
        received + stencil.reflect(around.far * (reflected * around.albedo[which.colour] * self.bounce))
    }
}

/// The mean of what the four corners of `cell` on the side of `side` hold; those outside the grid count as
/// empty.
fn mean<T: Real>(cell: Cell, side: Direction, value: impl Fn(Cell) -> Sh<T>) -> Sh<T> {
    let on_side = corners(cell).filter(|(low, _)| (low[side.axis()] == 0) == side.is_positive());
    let sum: Sh<T> = on_side.map(|(_, at)| value(at)).sum();
    sum * T::of(0.25)
}

/// The corners of a cell that lie in the grid: by axis whether it is the lower one (1) or the upper (0), and
/// the cell whose blocker lies there. Corner g is shared by the cells g and g + (1, 1, 1).
fn corners([x, y, z]: Cell) -> impl Iterator<Item = ([usize; 3], Cell)> {
    (0..8)
        .map(|bits| [bits & 1, bits >> 1 & 1, bits >> 2])
        .filter(move |low| x >= low[0] && y >= low[1] && z >= low[2])
        .map(move |low| (low, [x - low[0], y - low[1], z - low[2]]))
}
