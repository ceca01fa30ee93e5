//! The cascaded scheme: through the five faces of the neighbour other than the shared one
//! (000, 3.2.3; NVIDIA's D3D11 sample; MATH.md section 2).
//!
//! ```text
//! flux_f = max(0, a · Y(dir_f)) · Ω_f / (4π)         dir_f from A's centre to B's face f
//! B     += p · flux_f · L(face axis f)
//! ```
//!
//! - Far face: direction d, Ω = 4·asin(0.1). Four side faces f ⊥ d: direction (2d + f)/√5,
//!   Ω = (2π/3 − Ω_far)/4. Every face is clamped.
//! - The mean of a uniform field gains p/4 an iteration, its direction part 0.3686·p/4: p = 4 keeps
//!   all energy, p = 3 (the thesis) three quarters, p = 3.8 (NVIDIA's cascades) 95 %.
//! - With open borders the iteration grows without bound above p = 9.53 (2³), 5.22 (4³), 4.33 (8³),
//!   4.09 (16³), 4.03 (32³).
//! - From a raw cosine lobe along an axis the clamp makes the first iteration gain 13.82 %; after it the
//!   clamp removes nothing more, and the scheme is linear. Oblique lobes can take up to four iterations to
//!   get there, so the fast loops decide from the light itself ([`crate::transport::lattice::kernel`]).

use std::f64::consts::PI;

use glam::DVec3;

use crate::transport::lattice::face::{far_solid_angle, side_solid_angle};
use crate::transport::lattice::scheme::{Face, Scheme, Surface};

/// The scheme as data.
pub fn scheme() -> Scheme {
    let far = Face::toward(DVec3::X, far_solid_angle() / (4.0 * PI), true, DVec3::X);
    let side = |f: DVec3| {
        let direction = (2.0 * DVec3::X + f).normalize();
        Face::toward(direction, side_solid_angle() / (4.0 * PI), true, f)
    };
    let faces = vec![far, side(DVec3::Y), side(DVec3::NEG_Y), side(DVec3::Z), side(DVec3::NEG_Z)];
    Scheme {
        name: "cascaded",
        summary: "five faces, each weighted by its solid angle over 4π and clamped",
        source: "the thesis (000, 3.2.3) and NVIDIA's sample of cascaded light propagation volumes",
        flaws: "spreads like diffusion: a lobe's centre of mass stops at 0.70 cell; light bleeds back after two iterations",
        faces,
        surface: Surface::Blocked,
    }
}
