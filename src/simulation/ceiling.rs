//! Divergence, caught before it happens: no iteration is done that could take light out of the range of
//! numbers, so the light that stands is always finite.
//!
//! An iteration multiplies the largest coefficient of a level by at most the norm of its operator. So a
//! ceiling on each level's light is carried along for the price of a multiplication; only where the
//! ceiling would pass the limit is the light itself looked at. For f32 and a common factor that is once in
//! some sixty iterations.

use std::fmt;

use multiversion::multiversion;

use super::Light;
use crate::field::{Grid, IndexVolume, Marks};
use crate::sh::{K0, K1, LOBE0, LOBE1, Real};
use crate::transport::lattice::stencil::Stencil;

/// How far below the largest number light must stay: eight children are added before their mean is taken,
/// and colours are added where they are shown.
const HEADROOM: f64 = 32.0;

/// An iteration that was not done because its light could have left the range of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divergence {
    /// The iteration that was not done; the light is that of the one before.
    pub iteration: usize,
    /// The level, 0 the finest.
    pub level: usize,
    /// Its side, in cells.
    pub side: usize,
    /// The largest magnitude among the coefficients of its source and accumulated light.
    pub largest: f64,
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Divergence { iteration, level, side, largest } = self;
        write!(
            f,
            "the light diverges: iteration {iteration} could take level {level} ({side}³), now up to {largest:.1e}, \
             out of the range of numbers"
        )
    }
}

/// The largest coefficient that light in `T` may have before an iteration is refused.
pub fn limit<T: Real>() -> f64 {
    T::LARGEST / HEADROOM
}

/// What the light of every level cannot exceed.
#[derive(Clone, Debug)]
pub(super) struct Ceiling {
    levels: Vec<Bound>,
}

#[derive(Clone, Copy, Debug)]
struct Bound {
    /// What an iteration multiplies the largest coefficient by, at most.
    norm: f64,
    source: f64,
    accumulated: f64,
}

impl Bound {
    /// The same after an iteration.
    fn next(self) -> Self {
        let source = self.norm * self.source;
        Bound { source, accumulated: self.accumulated + source, ..self }
    }

    fn fits(self, limit: f64) -> bool {
        // Not true of NaN, which dark light times an infinite factor makes.
        self.source <= limit && self.accumulated <= limit
    }
}

impl Ceiling {
    /// For the operators of all levels; `bounce` is the preset's.
    pub fn new<T: Real>(stencils: &[Stencil<T>], bounce: f64) -> Self {
        let unknown =
            |stencil| Bound { norm: norm(stencil, bounce), source: f64::INFINITY, accumulated: f64::INFINITY };
        Ceiling { levels: stencils.iter().map(unknown).collect() }
    }

    /// Takes note that all light was cleared.
    pub fn clear(&mut self) {
        self.set_from(0, [0.0; 2]);
    }

    /// Takes note that light whose coefficients sum up to at most `light` was added to the finest level.
    pub fn inject(&mut self, light: f64) {
        if let [finest, ..] = &mut self.levels[..] {
            (finest.source, finest.accumulated) = (finest.source + light, finest.accumulated + light);
        }
    }

    /// Takes note that every level but the finest was set to means of the next finer one.
    pub fn downsample(&mut self) {
        if let [Bound { source, accumulated, .. }, ..] = self.levels[..] {
            self.set_from(1, [source, accumulated]);
        }
    }

    /// Forgets what is known of the levels from `level` on, because something else changed their light.
    pub fn forget(&mut self, level: usize) {
        self.set_from(level, [f64::INFINITY; 2]);
    }

    fn set_from(&mut self, level: usize, [source, accumulated]: [f64; 2]) {
        for bound in self.levels.iter_mut().skip(level) {
            (bound.source, bound.accumulated) = (source, accumulated);
        }
    }

    /// Allows the next iteration, `iteration`, if its light must stay in range; else tells on which level
    /// it may not.
    pub fn admit<T: Real>(
        &mut self,
        iteration: usize,
        lights: &[Light<T>],
        index: &IndexVolume,
    ) -> Result<(), Divergence> {
        let mut next = Vec::with_capacity(self.levels.len());
        for (level, bound) in self.levels.iter().enumerate() {
            let mut ceiling = bound.next();
            if !ceiling.fits(limit::<T>()) {
                let largest = |grid: fn(&Light<T>, usize) -> &Grid<T>| {
                    lights.iter().map(|light| brightest(grid(light, level), index.level(level))).fold(0.0, f64::max)
                };
                let source = largest(|light, level| light.source.level(level));
                let accumulated = largest(|light, level| light.accumulated.level(level));
                ceiling = Bound { source, accumulated, ..*bound }.next();
                if !ceiling.fits(limit::<T>()) {
                    let side = lights.first().map_or(0, |light| light.source.level(level).side());
                    return Err(Divergence { iteration, level, side, largest: source.max(accumulated) });
                }
            }
            next.push(ceiling);
        }
        self.levels = next;
        Ok(())
    }

    /// Allows as many more iterations, up to `most`, as need no look at their light.
    pub fn admit_more<T: Real>(&mut self, most: usize) -> usize {
        for allowed in 0..most {
            let next: Vec<Bound> = self.levels.iter().map(|bound| bound.next()).collect();
            if !next.iter().all(|bound| bound.fits(limit::<T>())) {
                return allowed;
            }
            self.levels = next;
        }
        most
    }
}

/// The largest magnitude among all coefficients of a grid that is dark where `lit` has no bit.
fn brightest<T: Real>(grid: &Grid<T>, lit: &Marks) -> f64 {
    let (layout, n) = (grid.layout(), grid.side());
    let slabs = lit.words().chunks_exact(lit.words_per_row() * n).enumerate();
    let lit_slabs = slabs.filter(|(_, words)| words.iter().any(|word| *word != 0));
    let of_slab = |z: usize| {
        let start = layout.row_start(0, z);
        grid.planes().each_ref().map(|plane| largest(&plane[start..start + n * layout.steps()[1]]))
    };
    lit_slabs.flat_map(|(z, _)| of_slab(z)).map(T::to_f64).fold(0.0, f64::max)
}

/// The largest magnitude; lane by lane, so that it becomes vector code.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn largest<T: Real>(numbers: &[T]) -> T {
    let larger = |a: T, b: T| if a > b { a } else { b };
    let (chunks, rest) = numbers.as_chunks::<32>();
    let mut lanes = [T::ZERO; 32];
    for chunk in chunks {
        for (lane, c) in lanes.iter_mut().zip(chunk) {
            *lane = larger(c.abs(), *lane);
        }
    }
    lanes.iter().chain(rest).fold(T::ZERO, |most, c| larger(c.abs(), most))
}

/// How many times the largest coefficient of the source the largest of the target can be: every flux is at most Σ|sampler|
/// times it, and 1 for the source that NVIDIA's first iteration keeps. A bounce (MATH.md section 9) adds at
/// most 4.8·bounce·(G·Y ≤ K0·LOBE0 + K1·LOBE1) of the same flux.
fn norm<T: Real>(stencil: &Stencil<T>, bounce: f64) -> f64 {
    let magnitude = |sh: crate::sh::Sh<T>| sh.widen().0.iter().map(|c| c.abs()).sum::<f64>();
    let flux: f64 =
        stencil.taps().iter().flatten().map(|tap| magnitude(tap.sampler) * tap.lobe.max_norm().to_f64()).sum();
    1.0 + flux * (1.0 + 4.8 * bounce * (K0 * LOBE0 + K1 * LOBE1))
}

#[cfg(test)]
mod tests {
    use super::super::{Action, Simulation};
    use super::*;
    use crate::scene::propagation::{Propagation, Snapshots};
    use crate::scene::{Occlusion, Problem, Source};
    use crate::sh::Sh;

    fn simulation(factor: f64, strength: f64, snapshots: Snapshots) -> Simulation<f32> {
        let light = vec![([3, 4, 4], Sh::lobe(glam::DVec3::X) * strength)];
        let problem = Problem {
            size: 8,
            coarsest: 1,
            sources: vec![Source { color: [1.0; 3], light, ..Source::default() }],
            solids: Vec::new(),
            occlusion: Occlusion::default(),
            propagation: Propagation { factor, iterations: 10_000, snapshots, ..Propagation::default() },
            ..Problem::default()
        };
        Simulation::new(problem).unwrap()
    }

    fn is_finite(simulation: &Simulation<f32>) -> bool {
        let light = &simulation.lights()[0];
        let octrees = [&light.source, &light.target, &light.accumulated];
        let grids = octrees.iter().flat_map(|octree| octree.levels()).chain(&light.merged);
        grids.flat_map(|grid| grid.planes()).flatten().all(|c| c.is_finite())
    }

    #[test]
    fn growing_light_is_stopped_in_time_and_the_last_good_state_kept() {
        for (factor, strength) in [(10.0, 1.0), (1e4, 1.0), (1e30, 1.0), (1e300, 1.0), (4.5, 1e30)] {
            let mut simulation = simulation(factor, strength, Snapshots::CopyFirst);
            let mut last = None;
            simulation.run(|now| {
                last = Some(now.lights()[0].source.clone());
                true
            });
            let told = simulation.divergence().unwrap();
            assert_eq!((told.level, told.iteration, told.side), (0, simulation.iteration() + 1, 8), "{factor}");
            assert!(is_finite(&simulation));
            // Not given up long before there is need: a state whose next could not overflow is no end.
            let norm =
                norm(&Stencil::<f64>::new(&crate::transport::lattice::schemes::cascaded::scheme(), factor, true), 0.0);
            assert!(told.largest * (norm + 1.0) > limit::<f32>(), "{factor}: {told:?}");
            assert_eq!(Some(&simulation.lights()[0].source), last.as_ref());
        }
    }

    #[test]
    fn light_that_does_not_grow_is_never_stopped() {
        let mut simulation = simulation(3.0, 1e30, Snapshots::Thesis);
        simulation.run(|_| true);
        assert_eq!((simulation.divergence(), simulation.iteration()), (None, 10_000));
    }

    #[test]
    fn a_stopped_simulation_goes_on_with_a_smaller_factor_and_starts_anew_when_cleared() {
        let mut simulation = simulation(1e30, 1.0, Snapshots::Thesis);
        simulation.run(|_| true);
        assert!(simulation.divergence().is_some());
        let before = simulation.iteration();
        simulation.set_propagation(Propagation { factor: 3.0, ..Propagation::default() }).unwrap();
        assert!(simulation.act(Action::Propagate).source);
        assert_eq!((simulation.iteration(), simulation.divergence()), (before + 1, None));
        simulation.act(Action::Clear);
        assert!(simulation.divergence().is_none() && is_finite(&simulation));
    }
}
