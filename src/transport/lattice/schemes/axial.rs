//! The axial scheme, the first of all light propagation volumes: one value a neighbour, taken straight
//! towards it (002, N.5.4; the thesis calls it the original, 000, 4.1).
//!
//! ```text
//! flux = max(0, a · Y(d)) · (2π/3) / (4π)         2π/3: the solid angle of the shared face
//! B   += p · flux · L(d)
//! ```
//!
//! - The mean of a uniform field gains 1/4 at p = 1, so p = 4 keeps the energy of a uniform field; its
//!   direction part gains 1/6.
//! - With open borders the iteration grows without bound above p = 24.0 (2³), 7.09 (4³), 4.86 (8³),
//!   4.26 (16³), 4.08 (32³).
//! - The clamp works in every iteration, not only in the first: a cell that holds one lobe along an axis
//!   sends nothing back, where the unclamped sum would have been negative.
//! - Opposite lights in a cell hold each other back. So an occluder that takes one away may turn the other
//!   from a border, and then a small open volume keeps up to 0.05 % more light than without the occluder.

use std::f64::consts::PI;

use glam::DVec3;

use crate::transport::lattice::scheme::{Face, Scheme, Surface};

/// The solid angle of the shared face over that of the sphere.
const SHARED_FACE: f64 = (2.0 * PI / 3.0) / (4.0 * PI);

/// The scheme as data.
pub fn scheme() -> Scheme {
    Scheme {
        name: "axial",
        summary: "the value straight towards the neighbour, weighted by the shared face's solid angle",
        source: "the first light propagation volumes (002, N.5.4; 000, 4.1)",
        flaws: "light aslant is seen only by what it projects on the axes, so light prefers the axes; the \
                clamp adds energy in every iteration, which exact levels and descents do not know of: from level 2 \
                on converged exact levels are mostly farther off than consistent ones",
        faces: vec![Face::toward(DVec3::X, SHARED_FACE, true, DVec3::X)],
        surface: Surface::Blocked,
    }
}
