//! Levels that agree: one operator for cells of every size, from how plane light decays.
//!
//! The thesis propagates every level alike, so light fades by the cell and not by the distance, and it leaves open what
//! each level should do instead (000, 7.1), how light goes from level to level on the fly (000, 7.1), and where to stop
//! trusting a coarse cell. One function answers all three: the decay μ of light that depends on one coordinate alone
//! ([`decay`]).
//!
//! **Moved light.** Injected light S is not smooth: it sits in one cell, has a direction, and the clamp acts on it. So it
//! takes its first step, clamps and all, at level 0: q. What follows is smooth and linear, B = q + P·B, and all the
//! light is A = S + B. Only B is carried on coarse levels; S is kept where it was injected, and a coarse cell shows its mean.
//!
//! **The operator of level i**, h = 2^i. Split the share M_d of the neighbour in direction d into its even part E_d
//! (α δ ε) and its odd part O_d (β γ), T = Σ_d M_d. Then
//!
//! ```text
//! P_i = (1 − θe)·T + Σ_d shift_d·(θe·E_d + θo·O_d)       θe = (sinh(μ/2)/sinh(μh/2))²,  θo = sinh μ/sinh μh
//! ```
//!
//! takes means of plane light to means of plane light exactly. Differences of first and of second order scale
//! differently with the cell; that is why no single factor a level can do (see [`super::levels`]). At μ = 0 they are
//! h⁻¹ and h⁻².
//!
//! The same fit of cosh and sine through the means of two cells of *different* size gives what crosses the face between
//! them, so the levels need not be propagated each by itself: [`leaves`].
//!
//! - [`filter`]: how q goes from a level to the next coarser one.
//! - [`crossing`]: what crosses a face, and what goes out at the border of the volume.
//! - [`leaves`], `step`: any tiling of the volume by cells of several levels, and an iteration of it.
//! - [`walls`]: what stands between them; [`blockers`], `touched`: what weakens light or turns it.
//! - [`sampling`]: what a coarse cell holds inside.
//!
//! Everything is derived for schemes in their linear form ([`super::kernel::form`]). Schemes whose clamp never ceases to
//! act are treated as if it did. That costs them what is gained over levels that are consistent ([`super::levels`]): L1
//! ratio of levels 1, 2 and 3 against the downsampled uniform volume, n = 32, converged (k = 48 at p = 3, 200 at 3.8),
//! as `lpv-lab run PRESET --scheme axial --levels exact --coarsest 1` writes it to errors.csv under `corrected`:
//!
//! | preset, p | axial, consistent | axial, exact | cone, consistent | cone, exact |
//! |---|---|---|---|---|
//! | two-walls, 3 | .107 .034 .023 | .076 .151 .185 | .093 .031 .032 | .061 .115 .139 |
//! | mixed, 3 | .111 .041 .029 | .085 .147 .178 | .100 .040 .035 | .071 .114 .134 |
//! | one-lobe, 3 | .260 .269 .257 | .250 .391 .430 | .235 .243 .227 | .227 .350 .380 |
//! | two-walls, 3.8 | .125 .115 .054 | .117 .174 .183 | .114 .103 .082 | .109 .153 .138 |
//! | mixed, 3.8 | .125 .124 .074 | .121 .160 .166 | .115 .113 .089 | .108 .138 .125 |
//! | one-lobe, 3.8 | .270 .378 .408 | .323 .367 .376 | .224 .324 .363 | .222 .305 .317 |
//!
//! Only for the lone lobe at p = 3.8 are exact levels 2 and 3 the better ones. In step they are better for both (k = 4:
//! a lone lobe at p = 3.8 .215 against 1.778 with axial, .200 against 1.689 with cone), and a descent of four iterations,
//! over all cells or leaves r = 3, beats every octree whose levels go each by itself (`lpv-lab octree --scheme axial`).

pub(crate) mod blockers;
pub(crate) mod crossing;
pub mod decay;
pub(crate) mod filter;
pub(crate) mod leaves;
mod meeting;
pub(crate) mod sampling;
mod step;
pub(super) mod touched;
pub(crate) mod walls;
mod within;

#[cfg(test)]
mod conformance;

use decay::Decay;

use super::kernel::form::Share;

/// A factor so large that light inside a coarse cell would grow for ever before it leaves.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "factor {factor} is too large to descend with: on level {level} light would grow inside a cell for ever; use a \
     factor below {limit:.3}, or fewer levels"
)]
pub struct Grows {
    /// The factor asked for.
    pub factor: f64,
    /// The first level that has no sum.
    pub level: usize,
    /// Factors below this have one on every level, about.
    pub limit: f64,
}

/// The longest that light resides in an inner cell of any of `count` levels: the largest 1/(1 − D), D what one finest
/// step leaves in the cell. `share` is that at the `factor`.
pub fn residence(share: &Share<f64>, factor: f64, count: usize) -> Result<f64, Grows> {
    let decay = Decay::of(share);
    let gain = (6.0 * share.alpha).max(2.0 * share.delta + 4.0 * share.epsilon);
    let stay = |level: usize| gain * (1.0 - decay.even(f64::from(1u32 << level)));
    if let Some(level) = (0..count).find(|level| stay(*level) >= 1.0) {
        // There the gain is above 1, so light does not decay and θe is 4^−level.
        let limit = factor / (gain * (1.0 - 0.25f64.powi(count as i32 - 1)));
        return Err(Grows { factor, level, limit });
    }
    Ok((0..count).map(|level| 1.0 / (1.0 - stay(level))).fold(1.0, f64::max))
}
