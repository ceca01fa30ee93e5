//! What a propagation scheme is, and the registry of all there are.
//!
//! A scheme is data: how the light of cell A that reaches its neighbour B = A + X is written down.
//! Everything else follows from the symmetry of the grid (see [`super::stencil`]). To add a scheme,
//! write a file that returns a [`Scheme`] and add one line to [`all`].

use glam::DVec3;

use super::{axial, blog, cascaded, cone, reflective};
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
    /// It is mirrored on the axis along which it came (see [`super::reflective`]).
    Mirrored,
}

/// Every scheme, the default first.
pub fn all() -> Vec<Scheme> {
    vec![cascaded::scheme(), blog::scheme(), axial::scheme(), cone::scheme(), reflective::scheme()]
}

/// The names of all schemes, the default first.
pub fn names() -> Vec<&'static str> {
    all().iter().map(|s| s.name).collect()
}

/// The scheme called `name`.
pub fn find(name: &str) -> Option<Scheme> {
    all().into_iter().find(|s| s.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The eight symmetries of the cube that keep +X, as maps of (y, z).
    fn keep_x(v: DVec3, which: usize) -> DVec3 {
        let (y, z) = if which & 1 == 0 { (v.y, v.z) } else { (v.z, v.y) };
        let sign = |bit: usize, c: f64| if which & bit == 0 { c } else { -c };
        DVec3::new(v.x, sign(2, y), sign(4, z))
    }

    fn key(f: &Face, which: usize) -> [i64; 8] {
        let sh = |s: Sh<f64>| {
            let v = keep_x(s.vector(), which);
            [s.0[0], v.x, v.y, v.z].map(|c| (c * 1e9).round() as i64)
        };
        let ([a, b, c, d], [e, f, g, h]) = (sh(f.sampler), sh(f.lobe));
        [a, b, c, d, e, f, g, h]
    }

    #[test]
    fn every_scheme_has_the_symmetry_of_the_cell() {
        for scheme in all() {
            let sorted = |which| {
                let mut keys: Vec<_> = scheme.faces.iter().map(|f| key(f, which)).collect();
                keys.sort();
                keys
            };
            for which in 1..8 {
                assert_eq!(sorted(which), sorted(0), "{} under symmetry {which}", scheme.name);
            }
        }
    }

    #[test]
    fn names_are_distinct_and_found() {
        for name in names() {
            assert_eq!(names().iter().filter(|other| **other == name).count(), 1);
            assert_eq!(find(name).unwrap().name, name);
        }
        assert_eq!(find("no such scheme"), None);
    }
}
