//! Whether the coarse levels of the octree start the fine ones.

use serde::{Deserialize, Serialize};

use super::super::error::Fault;

/// The largest distance of leaves; beyond, all that is lit is surrounded by finest cells.
pub const FARTHEST: f64 = 1024.0;
/// The smallest side of a cascade: narrower ones would touch the border of the next but one.
pub const LEAST_SIDE: usize = 8;

/// From coarse to fine, with so many iterations on every level as [`super::Propagation::iterations`] says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Descent {
    /// Every level is propagated by itself.
    #[default]
    Off,
    /// Over all cells of one level after the other.
    Cells,
    /// Over leaves, cells that are the larger the farther they are from injected light.
    Leaves {
        /// How many times half its width a block must be away from injected light to stay whole; 2 or more.
        distance: f64,
    },
    /// Over nested cascades: grids of as many cells each, about a point, the cells of each twice as wide as those of the
    /// one before. The last fills the volume; the octree's coarsest level, if the octree ends before.
    Cascades {
        /// Cells along a side of every grid, c: a power of two from [`LEAST_SIDE`] to the volume's side.
        side: usize,
        /// The point that they lie about, in finest cells: (0, 0, 0) is the volume's corner. Left out, its middle.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        center: Option<[f64; 3]>,
        /// Whether every grid is propagated by itself and alike, dark beyond its border, as NVIDIA's sample does; false.
        /// There is no descent then, and `iterations` are those of all grids at once.
        #[serde(default, skip_serializing_if = "is_false")]
        alone: bool,
    },
}

fn is_false(value: &bool) -> bool {
    !value
}

/// How the light of a coarse leaf is shown in the finest cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Inside {
    /// Decaying along each axis as the leaf's neighbours say.
    #[default]
    Exponential,
    /// Everywhere alike.
    Constant,
}

impl Descent {
    /// The distance of leaves where none is asked for: neighbours differ by one level at most, and hardly more cells
    /// are touched than there must be.
    pub const DISTANCE: f64 = 2.0;

    /// The side of cascades where none is asked for.
    pub const SIDE: usize = 16;

    /// Its name on the command line and in tables.
    pub fn name(self) -> String {
        match self {
            Descent::Off => "off".to_owned(),
            Descent::Cells => "cells".to_owned(),
            Descent::Leaves { distance } => format!("leaves-{distance}"),
            Descent::Cascades { side, alone: false, .. } => format!("cascades-{side}"),
            Descent::Cascades { side, alone: true, .. } => format!("cascades-{side}-alone"),
        }
    }

    /// Whether coarse levels start fine ones: an iteration is then one of the level that has been come down to.
    pub fn goes_down(self) -> bool {
        !matches!(self, Descent::Off | Descent::Cascades { alone: true, .. })
    }

    /// The same in a volume of side `size`: cascades change their side, or give way where it is too small for any.
    pub fn fitted(self, size: usize) -> Self {
        match self {
            Descent::Cascades { .. } if size < LEAST_SIDE => Descent::Off,
            Descent::Cascades { side, center, alone } => {
                let center = center.map(|center| center.map(|c| c.clamp(0.0, size as f64)));
                Descent::Cascades { side: side.clamp(LEAST_SIDE, size), center, alone }
            }
            other => other,
        }
    }

    /// Whether it fits into a volume of side `size`.
    pub(crate) fn check(self, size: usize) -> Result<(), Fault> {
        match self {
            Descent::Cascades { side, .. } if !side.is_power_of_two() || !(LEAST_SIDE..=size).contains(&side) => {
                let what = format!("cascades cannot have side {side} in a volume of side {size}");
                let remedy = format!("a power of two from {LEAST_SIDE} to the volume's side");
                Err(Fault::new(what, remedy).field("side"))
            }
            Descent::Cascades { center: Some(center), .. }
                if !center.iter().all(|c| (0.0..=size as f64).contains(c)) =>
            {
                let what = "cascades cannot lie about a point outside the volume".to_owned();
                Err(Fault::new(what, format!("coordinates from 0 to {size}")).field("center"))
            }
            Descent::Leaves { distance } if !(2.0..=FARTHEST).contains(&distance) => {
                let what = format!("leaves cannot have the distance {distance}");
                Err(Fault::new(what, format!("from 2 to {FARTHEST}")).field("distance"))
            }
            _ => Ok(()),
        }
    }
}
