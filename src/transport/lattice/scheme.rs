//! What a propagation scheme is; [`super::schemes`] lists all there are.
//!
//! A scheme is data: how the light of cell A that reaches its neighbour B = A + X is written down.
//! Everything else follows from the symmetry of the grid (see [`super::stencil`]). To add a scheme,
//! write a file that returns a [`Scheme`] and add one line to [`super::schemes::all`].

use glam::DVec3;

use crate::sh::Sh;

/// One way by which light of cell A goes into its neighbour: an evaluation of A and a lobe added to B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// The direction of travel, a unit vector from A's centre; blockers in B are evaluated along it.
    pub direction: DVec3,
    /// What A's light is multiplied with for the flux: flux = sampler · a.
    pub sampler: Sh<f64>,
    /// Whether a negative flux counts as none.
    pub clamp: bool,
    /// What one unit of flux adds to B.
    pub lobe: Sh<f64>,
}

impl Face {
    /// A face that takes A's value along `direction` with the given weight and sends a clamped cosine
    /// lobe about `axis`.
    pub fn toward(direction: DVec3, weight: f64, clamp: bool, axis: DVec3) -> Self {
        Face { direction, sampler: Sh::basis(direction) * weight, clamp, lobe: Sh::lobe(axis) }
    }
}

/// A propagation scheme, given for light that goes from a cell to its neighbour in +X at factor p = 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Scheme {
    /// The name by which presets and the command line call it.
    pub name: &'static str,
    /// A line that says what it is.
    pub summary: &'static str,
    /// Where it was published.
    pub source: &'static str,
    /// What it is known to get wrong.
    pub flaws: &'static str,
    /// The faces through which light enters the neighbour. The set must not change under the
    /// symmetries of the cube that keep +X.
    pub faces: Vec<Face>,
    /// What becomes of light in a cell that an occluder occupies.
    pub surface: Surface,
}

/// What becomes of light in a cell that an occluder occupies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// The occlusion mode decides: fuzzy blockers or hard ones.
    Blocked,
    /// It is mirrored on the axis along which it came (see [`super::schemes::reflective`]).
    Mirrored,
}
