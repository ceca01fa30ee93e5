//! How iterations are carried out: which loops, how many threads, what is left out, when to stop.
//!
//! **Stopping early.** Where a scheme's light keeps to its cone ([`crate::transport::lattice::kernel::form`]), the
//! sum of c00 over a level gains at most g an iteration, and no coefficient is larger than its cell's c00
//! (but for a bare lobe, 1.155 times). So all the light of all iterations still to come sums to at most
//! E·g / (1 − g) in c00, with E the sum now: [`Simulation::still_to_come`] is that bound over what has been
//! accumulated, on the level where it is largest. For g ≥ 1 (cascaded: p ≥ 4), or light without clamps
//! that is not in the cone, nothing is proved and no run stops early.

use super::engine::Stage;
use super::occlusion::accumulate;
use super::options::{Kernel, Options, Wanted, Work};
use super::{Action, Light, Simulation, step};
use crate::field::{IndexVolume, Marks, row_mask};
use crate::scene::propagation::Snapshots;
use crate::sh::Real;
use crate::transport::lattice::active::grown;
use crate::transport::lattice::kernel::occluded::Which;
use crate::transport::team;

impl<T: Real> Simulation<T> {
    /// How iterations are carried out.
    pub fn options(&self) -> &Options {
        &self.engine.options
    }

    /// Changes how the iterations to come are carried out; which channels are carried stays as it is.
    pub fn set_options(&mut self, options: Options) {
        self.engine.set_options(options);
    }

    /// How much was computed since the last clear, and how much there was to compute.
    pub fn work(&self) -> Work {
        self.engine.work
    }

    /// Iterations up to the number the scene asks for, as [`Self::run`] does them, but with nobody looking
    /// in between; then the merge. Returns how many iterations it did: fewer if the tolerance was met.
    pub fn run_all(&mut self, wanted: Wanted) -> usize {
        for action in [Action::Clear, Action::Inject, Action::Downsample] {
            self.act(action);
        }
        self.advance(self.problem.propagation.iterations, wanted);
        self.act(Action::Merge);
        self.iteration
    }

    /// So many iterations with nobody looking in between; fewer if the tolerance is met or the light
    /// diverges. After [`Wanted::Merged`] only merging makes sense.
    pub fn advance(&mut self, iterations: usize, wanted: Wanted) {
        let end = self.iteration + iterations;
        while self.iteration < end && !self.is_done() {
            if self.options().tolerance.is_some() || self.obstacles.is_some() || !self.is_fast() {
                if !self.act(Action::Propagate).target {
                    break;
                }
                continue;
            }
            if let Err(divergence) = self.ceiling.admit(self.iteration + 1, &self.lights, &self.index) {
                self.divergence = Some(divergence);
                break;
            }
            let together = 1 + self.ceiling.admit_more::<T>(end - self.iteration - 1);
            // Which samples will be looked at shows only at the end.
            let is_last = self.iteration + together == end;
            self.fast(together, if is_last { wanted } else { Wanted::Everything });
        }
    }

    /// An upper bound on all light still to come, as a part of what has been accumulated (both as Σ c00, on
    /// the level where it is largest). `None` while nothing is proved, or if no tolerance is set.
    pub fn still_to_come(&self) -> Option<f64> {
        // Occluders may reflect more than they stop, and what counts is what was accumulated everywhere.
        if self.engine.options.tolerance.is_none() || self.obstacles.is_some() || self.accumulating.is_some() {
            return None;
        }
        let known = self.engine.known.as_ref()?;
        let levels = known.iter().flat_map(|channel| channel.iter().enumerate());
        levels
            .map(|(i, known)| self.engine.still_to_come(i, known))
            .try_fold(0.0, |most: f64, bound| Some(most.max(bound?)))
    }

    /// Whether the light still to come is within the tolerance.
    pub(super) fn is_done(&self) -> bool {
        self.options().tolerance.is_some_and(|tolerance| self.still_to_come().is_some_and(|bound| bound <= tolerance))
    }

    /// One iteration on every level.
    pub(super) fn propagate(&mut self) {
        if let Some(mut radiance) = self.radiance.take() {
            self.radiate(&mut radiance);
            self.radiance = Some(radiance);
        } else if self.is_fast() {
            self.fast(1, Wanted::Everything)
        } else {
            self.plainly()
        }
    }

    /// Whether the fast loops can do the next iteration and all after it.
    fn is_fast(&self) -> bool {
        let counts_twice = self.iteration == 0 && self.problem.propagation.snapshots == Snapshots::CopyFirst;
        self.options().kernel == Kernel::Fast
            && !counts_twice
            && self.radiance.is_none()
            && self.engine.forms.iter().all(Option::is_some)
    }

    /// One iteration by the definition.
    fn plainly(&mut self) {
        let keep_source = self.iteration == 0 && self.problem.propagation.snapshots == Snapshots::CopyFirst;
        let acting = self.obstacles.as_ref().and_then(|obstacles| obstacles.acting(self.iteration + 1));
        for (colour, light) in self.lights.iter_mut().enumerate() {
            for (i, stencil) in self.stencils.iter().enumerate() {
                let (source, target) = (light.source.level(i), light.target.level_mut(i));
                step(acting, stencil, Which { level: i, colour }, source, target);
                if keep_source {
                    target.add_grid(source);
                }
                self.index.level_mut(i).mark_lit(target);
                let cells = self.accumulating.as_ref().map(|cells| &cells[i]);
                accumulate(target, cells, light.accumulated.level_mut(i));
            }
            std::mem::swap(&mut light.source, &mut light.target);
        }
        let volume = self.sizes.cells() * self.lights.len();
        self.engine.work += Work { visited: volume, dark: 0, volume };
        self.engine.known = None;
        self.iteration += 1;
    }

    /// Iterations by the fast loops, level by level.
    fn fast(&mut self, iterations: usize, wanted: Wanted) {
        team::inside(|| self.fast_inside(iterations, wanted));
    }

    fn fast_inside(&mut self, iterations: usize, wanted: Wanted) {
        team::stay_awake();
        let looked = self.engine.known.take();
        let mut known = looked.unwrap_or_else(|| {
            let look = |light: &Light<T>| self.engine.look(&light.source, &light.accumulated, &self.index);
            self.lights.iter().map(look).collect()
        });
        let (options, threads) = (self.engine.options, rayon::current_num_threads());
        let only_merged = wanted == Wanted::Merged && options.skip.unmerged;
        let mut work = Work::default();
        let mut uncovered: Option<Marks> = None;
        for (i, form) in self.engine.forms.iter().enumerate() {
            let needs = if only_merged && i > 0 {
                let sampled = sampled(&self.index, i, uncovered.as_ref());
                let needs = needs(&sampled, iterations);
                uncovered = Some(sampled);
                Some(needs)
            } else {
                None
            };
            let needs: Option<Vec<&Marks>> = needs.as_ref().map(|needs| {
                // Beyond the end of the list every cell is needed, as in its last entry.
                (0..iterations).map(|t| &needs[(iterations - 1 - t).min(needs.len() - 1)]).collect()
            });
            let Some(form) = form else { continue };
            let mut visited = 0;
            for (colour, (light, known)) in self.lights.iter_mut().zip(&mut known).enumerate() {
                let mut stage = Stage {
                    source: light.source.level_mut(i),
                    target: light.target.level_mut(i),
                    accumulated: light.accumulated.level_mut(i),
                    index: &mut self.index,
                    which: Which { level: i, colour },
                    stencil: &self.stencils[i],
                    obstacles: self.obstacles.as_ref(),
                    accumulating: self.accumulating.as_ref().map(|cells| &cells[i]),
                };
                let iterations = self.iteration..self.iteration + iterations;
                visited += stage.advance((form, &options), threads, &mut known[i], iterations, needs.as_deref());
            }
            let times = self.lights.len() * iterations;
            let had_light = if needs.is_none() { self.index.level(i).count() * times } else { 0 };
            let volume = self.sizes.side(i).pow(3) * times;
            work += Work { visited, dark: had_light.saturating_sub(visited), volume };
        }
        self.engine.known = Some(known);
        self.engine.work += work;
        self.iteration += iterations;
    }
}

/// The cells of level `i` that some sample looks at, or a coarser cell in its place: those with a child
/// that was looked at and has had no light. `finer` are those of the next finer level; `None` for all.
fn sampled(index: &IndexVolume, i: usize, finer: Option<&Marks>) -> Marks {
    let lit = index.level(i - 1);
    let mask = row_mask(lit.side());
    let mut open = Marks::new(lit.side());
    for (w, (open, lit)) in open.words_mut().iter_mut().zip(lit.words()).enumerate() {
        *open = !lit & mask & finer.map_or(u64::MAX, |finer| finer.words()[w]);
    }
    open.parents()
}

/// What a level has to compute so that the `sampled` cells are right at the end: entry j for the iteration
/// that j more follow, each one step wider than the one before, until nothing more is gained.
fn needs(sampled: &Marks, iterations: usize) -> Vec<Marks> {
    let mut needs = vec![sampled.clone()];
    while needs.len() < iterations {
        let wider = grown(&needs[needs.len() - 1]);
        if wider == needs[needs.len() - 1] {
            break;
        }
        needs.push(wider);
    }
    needs
}
