//! The scheme of the blog article (003, "Propagation"), weights and clamp exactly as its shader has them.
//!
//! ```text
//! far face:   flux = max(0, a · Y(d)) · 0.4006696846 / (2π)
//! side faces: flux =        a · Y((2d + f)/√5) · 0.4234413544 / (3π)
//! B += p · flux · L(face axis)
//! ```
//!
//! - The side angle is the one with the wrong digit that most ports carry (0.4234313544 would be right);
//!   here it is meant, since this scheme is that program.
//! - The article's divisors 2π and 3π have no derivation. The mean of a uniform field gains 0.3652 at
//!   p = 1, so the energy is kept at p = 2.738; its direction part gains 0.1441.
//! - With open borders the iteration grows without bound above p = 7.01 (2³), 3.65 (4³), 2.99 (8³),
//!   2.81 (16³), 2.76 (32³).
//! - Only the far face is clamped, so cells behind a lobe receive negative light.

use std::f64::consts::PI;

use glam::DVec3;

use crate::transport::lattice::scheme::{Face, Scheme, Surface};

/// The far face's weight as printed.
const FAR: f64 = 0.400_669_684_6 / (2.0 * PI);
/// A side face's weight as printed, wrong digit and all.
const SIDE: f64 = 0.423_441_354_4 / (3.0 * PI);

/// The scheme as data.
pub fn scheme() -> Scheme {
    let far = Face::toward(DVec3::X, FAR, true, DVec3::X);
    let side = |f: DVec3| Face::toward((2.0 * DVec3::X + f).normalize(), SIDE, false, f);
    Scheme {
        name: "blog",
        summary: "five faces with the weights of a widely copied article, only the far face clamped",
        source: "the blog article on light propagation volumes (003, Propagation)",
        flaws: "one digit of the side angle is wrong; unclamped sides send negative light backwards, and an \
                occluder that stops it adds energy; gains 0.3652 where 0.25 would be asked of p = 1",
        faces: vec![far, side(DVec3::Y), side(DVec3::NEG_Y), side(DVec3::Z), side(DVec3::NEG_Z)],
        surface: Surface::Blocked,
    }
}
