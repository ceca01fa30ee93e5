//! What a preset says of the directions in which light travels, where a transport keeps them.

use serde::{Deserialize, Serialize};

/// The most directions: their light takes 96 KiB a cell.
pub const MOST_DIRECTIONS: usize = 8192;

/// How many directions, which, and how light is shared. Fields left out take the defaults.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Setting {
    /// About how many directions, 1 to [`MOST_DIRECTIONS`]; 128. See [`Lattice`].
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

/// How light that a cell takes in is shared among its far faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Rule {
    /// Donor cell: whatever came in leaves in the shares a : b : c. A cell forgets where light came in.
    Donor,
    /// Light is kept by the face through which it came in, and leaves as the geometry has it.
    Faces,
}

impl Rule {
    /// Both rules.
    pub const ALL: [Rule; 2] = [Rule::Donor, Rule::Faces];

    /// Its name in files and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Rule::Donor => "donor",
            Rule::Faces => "faces",
        }
    }
}

/// How directions are spread over the sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Lattice {
    /// A spiral from pole to pole, each point the golden angle on from the last (004, 2.4.2). Any number of
    /// directions, all of one weight; no symmetry.
    Fibonacci,
    /// The faces of an octahedron, each cut into k² triangles and blown up to the sphere: 8·k² directions
    /// that keep all 48 symmetries of the cube, each weighted by its triangle's solid angle.
    Octahedral,
}

impl Lattice {
    /// Both lattices.
    pub const ALL: [Lattice; 2] = [Lattice::Fibonacci, Lattice::Octahedral];

    /// Its name in files and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Lattice::Fibonacci => "fibonacci",
            Lattice::Octahedral => "octahedral",
        }
    }
}
