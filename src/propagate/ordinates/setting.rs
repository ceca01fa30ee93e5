//! What a preset says of its ordinates.

use serde::{Deserialize, Serialize};

use super::directions::Lattice;
use super::shares::Rule;

/// The most directions: their light takes 96 KiB a cell.
pub const MOST_DIRECTIONS: usize = 8192;

/// How many directions, which, and how light is shared. Fields left out take the defaults.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Setting {
    /// About how many directions, 1 to [`MOST_DIRECTIONS`]; 128. See [`Lattice::directions`].
    pub directions: usize,
    /// How light is shared among a cell's far faces; `Faces`.
    pub rule: Rule,
    /// How the directions are spread; `Octahedral`.
    pub lattice: Lattice,
}

impl Default for Setting {
    fn default() -> Self {
        Setting { directions: 128, rule: Rule::Faces, lattice: Lattice::Octahedral }
    }
}
