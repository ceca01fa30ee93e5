//! How far single precision runs away from double precision in a long run, and how far it may.
//!
//! **The bound.** With u = 2⁻²⁴, an iteration in f32 multiplies every term of a cell's sum by 1 + ε, with
//! |ε| ≤ m·u to first order: two roundings for the stored sampler and lobe, four for sampler · a, one for
//! the lobe's multiple, one for each of the taps of a direction, one for each of the six directions. The terms of the mean
//! (c00) can cancel: light is a sum of lobes, so its direction is at most ρ = LOBE1/LOBE0 times its mean,
//! and the magnitudes sum to at most κ times what is left,
//!
//! ```text
//! κ = Σ lobe_0·(|sampler_0| + ρ·|sampler_1..3|) / Σ lobe_0·sampler_0
//! ```
//!
//! Near the critical factor all but the slowest mode dies out, so that an iteration's rounding changes
//! its amplitude by at most m·κ·u, relative, and k iterations by k·m·κ·u. That is perturbation theory to
//! first order in u; the worst case, every rounding the same way, is far from what is measured.
//!
//! **Many small terms.** The accumulated light S_A = Σ S_i is a running sum in f32, each addition off by
//! at most u·S_A, together at most k·u relative. Two effects could hurt: terms below half a unit in
//! the last place of the sum are lost (for a steady term not before 2²⁴ iterations, more than a preset may
//! ask for; for a fading one what is lost is about u·k of the sum), and roundings that go the same way. Both are measured
//! apart from the drift of the terms, by summing the same f32 snapshots in f64. A compensated sum would
//! take a fourth octree, a third more memory, to remove an error that is no larger than the one the
//! snapshots bring with them; so the lab sums plainly, and runs in f64 what needs more digits.

use crate::field::Grid;
use crate::scene::Propagation;
use crate::scene::{Occlusion, Problem, Source};
use crate::sh::{LOBE0, LOBE1, Real, Sh};
use crate::simulation::{Action, Refusal, Simulation};
use crate::transport::lattice::scheme::Scheme;
use crate::transport::lattice::stencil::Stencil;

/// Half a unit in the last place of 1 in f32: the largest relative error of one rounding.
pub const UNIT: f64 = f32::EPSILON as f64 / 2.0;

/// A long run of one lobe in the middle of an open volume of one level.
#[derive(Clone, Debug)]
pub struct LongRun<'a> {
    /// The scheme, clamped as published.
    pub scheme: &'a Scheme,
    /// The side of the volume.
    pub size: usize,
    /// The propagation factor.
    pub factor: f64,
    /// Iterations.
    pub iterations: usize,
    /// How many rows to give, spread evenly.
    pub rows: usize,
}

/// Single precision against double after some iterations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriftRow {
    /// Iterations done, k.
    pub iteration: usize,
    /// Σ c00 of S_k in f64, in units of SH coefficients.
    pub energy: f64,
    /// |Σ c00 of S_k in f32 − the same in f64|, relative to it.
    pub source: f64,
    /// The same for the accumulated light S_A.
    pub accumulated: f64,
    /// Σ c00 of S_A in f32 against the sum in f64 of the same f32 snapshots: what summing alone loses.
    pub summing: f64,
    /// What `source` may be, k·m·κ·u.
    pub bound: f64,
}

impl LongRun<'_> {
    /// Runs in both precisions side by side.
    pub fn run(&self) -> Result<Vec<DriftRow>, Refusal> {
        let mut single = Simulation::<f32>::new(self.problem())?;
        let mut double = Simulation::<f64>::new(self.problem())?;
        single.act(Action::Inject);
        double.act(Action::Inject);
        let step_bound = rounding(&Stencil::<f64>::new(self.scheme, self.factor, true));
        let every = (self.iterations / self.rows.max(1)).max(1);
        let mut sum = energy(single.lights()[0].source.level(0));
        let mut rows = Vec::new();
        for k in 1..=self.iterations {
            single.act(Action::Propagate);
            double.act(Action::Propagate);
            let (narrow, wide) = (&single.lights()[0], &double.lights()[0]);
            let source = energy(narrow.source.level(0));
            sum += source;
            if k % every == 0 || k == self.iterations {
                let wide = [wide.source.level(0), wide.accumulated.level(0)].map(energy);
                let accumulated = energy(narrow.accumulated.level(0));
                rows.push(DriftRow {
                    iteration: k,
                    energy: wide[0],
                    source: off(source, wide[0]),
                    accumulated: off(accumulated, wide[1]),
                    summing: off(accumulated, sum),
                    bound: k as f64 * step_bound,
                });
            }
        }
        Ok(rows)
    }

    fn problem(&self) -> Problem {
        let middle = [self.size / 2; 3];
        Problem {
            size: self.size,
            coarsest: self.size,
            sources: vec![Source {
                color: [1.0; 3],
                light: vec![(middle, Sh::lobe(glam::DVec3::X))],
                ..Source::default()
            }],
            solids: Vec::new(),
            occlusion: Occlusion::default(),
            propagation: Propagation {
                scheme: self.scheme.name.to_owned(),
                factor: self.factor,
                iterations: self.iterations,
                ..Propagation::default()
            },
            ..Problem::default()
        }
    }
}

/// What one iteration's roundings may change the energy by, relative: m·κ·u.
pub fn rounding(stencil: &Stencil<f64>) -> f64 {
    let taps = stencil.taps();
    let roundings = 2 + 4 + 1 + taps[0].len() + taps.len();
    let (mut magnitudes, mut left) = (0.0, 0.0);
    for tap in taps.iter().flatten() {
        let (lobe, sampler) = (tap.lobe.0[0], tap.sampler);
        magnitudes += lobe.abs() * (sampler.0[0].abs() + LOBE1 / LOBE0 * sampler.vector().length());
        left += lobe * sampler.0[0];
    }
    roundings as f64 * magnitudes / left * UNIT
}

fn energy<T: Real>(grid: &Grid<T>) -> f64 {
    grid.energy()
}

/// |found − expected| relative to expected; 0 where both are 0.
fn off(found: f64, expected: f64) -> f64 {
    if found == expected { 0.0 } else { (found - expected).abs() / expected.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::stability::of_scheme;
    use crate::transport::lattice::schemes;

    #[test]
    fn single_precision_stays_within_the_bound_at_the_critical_factor() {
        for scheme in schemes::all() {
            let (size, factor) = of_scheme(&scheme, &[4]).critical[0];
            let rows = LongRun { scheme: &scheme, size, factor, iterations: 2000, rows: 4 }.run().unwrap();
            assert_eq!(rows.iter().map(|row| row.iteration).collect::<Vec<_>>(), [500, 1000, 1500, 2000]);
            for row in rows {
                assert!(row.energy > 1e-3 && row.energy < 1e3, "{}: {row:?}", scheme.name);
                assert!(row.source > 0.0 && row.source < row.bound, "{}: {row:?}", scheme.name);
                assert!(row.accumulated < row.bound && row.summing < row.iteration as f64 * UNIT, "{row:?}");
            }
        }
    }

    #[test]
    fn the_bound_counts_what_the_derivation_says() {
        // Cascaded: five faces, m = 2 + 4 + 1 + 5 + 6; directions as long as a lobe's make κ = 1 + ρ·√3 = 3.
        let stencil = Stencil::new(&crate::transport::lattice::schemes::cascaded::scheme(), 3.0, true);
        assert!((rounding(&stencil) / (18.0 * 3.0 * UNIT) - 1.0).abs() < 1e-9);
    }
}
