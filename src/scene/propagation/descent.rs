//! Whether the coarse levels of the octree start the fine ones.

use serde::{Deserialize, Serialize};

use super::super::error::Fault;

/// The largest distance of leaves; beyond, all that is lit is surrounded by finest cells.
pub const FARTHEST: f64 = 1024.0;

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

    /// Its name on the command line and in tables.
    pub fn name(self) -> String {
        match self {
            Descent::Off => "off".to_owned(),
            Descent::Cells => "cells".to_owned(),
            Descent::Leaves { distance } => format!("leaves-{distance}"),
        }
    }

    pub(super) fn check(self) -> Result<(), Fault> {
        match self {
            Descent::Leaves { distance } if !(2.0..=FARTHEST).contains(&distance) => {
                let what = format!("leaves cannot have the distance {distance}");
                Err(Fault::new(what, format!("from 2 to {FARTHEST}")).field("distance"))
            }
            _ => Ok(()),
        }
    }
}
