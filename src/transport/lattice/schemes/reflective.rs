//! The reflective scheme: `cone` in the free, and a mirror in every cell that an occluder occupies
//! (001, 4.2, T_cone and T_r).
//!
//! In an occupied cell what arrives along an axis is mirrored on that axis: the SH component along it
//! changes its sign. The paper replaces the true reflection about the normal by this "for speed and
//! simplicity". The mirrored light is what the cell sends on and what is accumulated there, so light
//! needs as many iterations a bounce as the walls are cells apart. What is reflected is multiplied by
//! the albedo (the paper: 0.5 throughout) and the opacity; the rest of the opacity is absorbed.
//!
//! - Weights, clamp, gains and critical factors are those of [`super::cone`].
//! - The paper accumulates at occupied cells alone, because it reads nowhere else, and from the first
//!   iteration on: `accumulate: Occupied` with `snapshots: WithoutInjected`, as in the preset
//!   `mirrored-room`. By default the lab accumulates everywhere; at occupied cells of level 0 the sum is
//!   the same.
//! - A preset's `bounce` does not count here: the mirror reflects by opacity and albedo.

use super::cone;
use crate::transport::lattice::scheme::{Scheme, Surface};

/// The scheme as data.
pub fn scheme() -> Scheme {
    Scheme {
        name: "reflective",
        summary: "the cone scheme, with a mirror in every occupied cell",
        source: "interactive volume-based indirect illumination (001, 4.2), normalised",
        flaws: "the mirror knows the axes only, not the normal; light runs along inside a wall and comes out \
                behind it; what `cone` gets wrong",
        faces: vec![cone::face()],
        surface: Surface::Mirrored,
    }
}
