//! Divergence, caught before it happens: no iteration is done that could take light out of the range of
//! numbers, so the light that stands is always finite.
//!
//! An iteration multiplies the largest coefficient of a level by at most the norm of its operator. So a
//! ceiling on each level's light is carried along for the price of a multiplication; only where the
//! ceiling would pass the limit is the light itself looked at. For f32 and a common factor that is once in
//! some sixty iterations.

use multiversion::multiversion;

use super::stencil::Stencil;
use crate::field::{Grid, Marks};
use crate::sh::{K0, K1, LOBE0, LOBE1, Real};
use crate::transport::divergence::{Divergence, limit};
use crate::transport::state::{Light, State};

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

    /// Lets an iteration of the levels from `level` on multiply light by so much more.
    pub fn amplify(&mut self, level: usize, by: f64) {
        self.levels.iter_mut().skip(level).for_each(|bound| bound.norm *= by);
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

    /// Allows the next iteration if its light must stay in range; else tells on which level it may not.
    pub fn admit<T: Real>(&mut self, state: &State<T>) -> Result<(), Divergence> {
        let State { lights, index, .. } = state;
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
                    return Err(Divergence {
                        iteration: state.iteration + 1,
                        level,
                        side,
                        largest: source.max(accumulated),
                    });
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
/// times it, and 1 for the source that NVIDIA's first iteration keeps. A fuzzy bounce (MATH.md section 9) adds at
/// most 4.8·bounce·(G·Y ≤ K0·LOBE0 + K1·LOBE1)·G of the same flux, without p; a hard one at most bounce times what is
/// sent.
fn norm<T: Real>(stencil: &Stencil<T>, bounce: f64) -> f64 {
    let magnitude = |sh: crate::sh::Sh<T>| sh.widen().0.iter().map(|c| c.abs()).sum::<f64>();
    let flux = |gain: &dyn Fn(f64) -> f64| -> f64 {
        let taps = stencil.taps().iter().flatten();
        taps.map(|tap| magnitude(tap.sampler) * gain(tap.lobe.max_norm().to_f64())).sum()
    };
    let reflected = stencil.reflect(crate::sh::Sh::<T>([T::of(LOBE1); 4])).max_norm().to_f64();
    let fuzzy = 4.8 * bounce * (K0 * LOBE0 + K1 * LOBE1) * reflected;
    1.0 + flux(&|sent| (1.0 + bounce) * sent + fuzzy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::lattice::schemes::cascaded;

    #[test]
    fn an_iteration_never_passes_its_ceiling_and_the_ceiling_is_not_far_above() {
        for factor in [0.5, 3.0, 1e4] {
            let stencil = Stencil::<f64>::new(&cascaded::scheme(), factor, true);
            let lobe = crate::sh::Sh::lobe(glam::DVec3::X);
            let sum = (0..6).map(|d| stencil.send(d, lobe).max_norm()).sum::<f64>() / lobe.max_norm();
            let norm = norm(&stencil, 0.0);
            assert!(sum <= norm && norm < 10.0 * (1.0 + sum), "{factor}: {sum}, {norm}");
        }
    }
}
