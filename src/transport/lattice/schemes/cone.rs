//! The cone scheme: what a cell shines into a cone of 90° towards its neighbour (001, 4.2, T_cone).
//!
//! ```text
//! flux = max(0, ⟨a, cone(d)⟩) / (6 Ω)             Ω = 2π(1 − √2/2), the cone's solid angle
//! B   += p · flux · L(d)
//! ```
//!
//! - cone(d) is 1 within 45° of d: c00 = √π(1 − √2/2) = 0.519140, along d (√(3π)/2)·½ = 0.767495.
//! - As published there is no divisor, the flux is ⟨a, cone(d)⟩ itself: with L(d) the mean of a uniform
//!   field then gains 3π(1 − √2/2) = 2.760460 an iteration. Divided by 6 Ω = 11.0418 it gains 1/4 at
//!   p = 1, as in `cascaded`, and that is what is registered; p = 11.0418 runs it as published.
//! - Normalised, it is `axial` with the mean over the cone in place of the value on its axis. The
//!   direction part of a uniform field gains 0.1423 at p = 1.
//! - With open borders the iteration grows without bound above p = 18.56 (2³), 6.50 (4³), 4.70 (8³),
//!   4.20 (16³), 4.06 (32³).
//! - Opposite lights in a cell hold each other back, as in [`super::axial`].

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use glam::DVec3;

use crate::sh::Sh;
use crate::transport::lattice::scheme::{Face, Scheme, Surface};

/// The solid angle of a cone that opens 90°.
const SOLID_ANGLE: f64 = 2.0 * PI * (1.0 - FRAC_1_SQRT_2);

/// The indicator function of the cone about +X in two bands, as published.
fn cone() -> Sh<f64> {
    Sh([PI.sqrt() * (1.0 - FRAC_1_SQRT_2), (3.0 * PI).sqrt() / 4.0, 0.0, 0.0])
}

/// The one face of this scheme and of those built on it.
pub(super) fn face() -> Face {
    let sampler = cone() * (1.0 / (6.0 * SOLID_ANGLE));
    Face { direction: DVec3::X, sampler, clamp: true, lobe: Sh::lobe(DVec3::X) }
}

/// The scheme as data.
pub fn scheme() -> Scheme {
    Scheme {
        name: "cone",
        summary: "the mean over a cone of 90° towards the neighbour",
        source: "interactive volume-based indirect illumination (001, 4.2), normalised",
        flaws: "six cones leave 12 % of the sphere out; forgets direction faster than axial; the clamp adds \
                energy in every iteration, which exact levels and descents do not know of: from level 2 on converged \
                exact levels are mostly farther off than consistent ones",
        faces: vec![face()],
        surface: Surface::Blocked,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cone_is_the_projection_of_its_indicator() {
        // Rings at evenly spaced heights x: each has the solid angle 2π dx and the mean direction (x, 0, 0).
        let rings = 100_000;
        let width = (1.0 - FRAC_1_SQRT_2) / f64::from(rings);
        let (mut c00, mut along) = (0.0, 0.0);
        for i in 0..rings {
            let x = FRAC_1_SQRT_2 + (f64::from(i) + 0.5) * width;
            let Sh([y0, y1, ..]) = Sh::<f64>::basis(DVec3::new(x, (1.0 - x * x).sqrt(), 0.0));
            c00 += 2.0 * PI * width * y0;
            along += 2.0 * PI * width * y1;
        }
        let Sh([expected_c00, expected_along, ..]) = cone();
        assert!((c00 - expected_c00).abs() < 1e-9 && (along - expected_along).abs() < 1e-9);
    }
}
