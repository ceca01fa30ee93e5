//! How iterations are carried out: which loops, how many iterations a pass, what is left out.
//!
//! [`Plan::next`] decides from what is known of the light, and touches none of it; [`Stage::advance`] does as it
//! says, and learns from what comes of it.

use std::ops::Range;

use super::Lattice;
use super::kernel::form::Form;
use super::kernel::occluded::Which;
use super::kernel::with_solids::{self, WithSolids};
use super::kernel::{Level, Order, blocked, pass};
use super::known::Known;
use super::occlusion::LatticeSolids;
use super::reach::grown;
use super::stencil::Stencil;
use crate::field::{Grid, IndexVolume, Layout, Marks, row_mask};
use crate::scene::propagation::Snapshots;
use crate::sh::Real;
use crate::transport::options::{Options, Wanted, Work};
use crate::transport::state::{State, accumulate};
use crate::transport::team;

impl<T: Real> Lattice<T> {
    /// One iteration by the definition.
    pub(super) fn plainly(&mut self, state: &mut State<T>) -> Work {
        let keep_source = self.counts_twice(state);
        let acting = self.solids.as_deref().and_then(|solids| solids.acting(state.iteration + 1));
        let blocks = acting.is_some_and(|solids| solids.blocks(state.iteration + 1));
        for (colour, light) in state.lights.iter_mut().enumerate() {
            for (i, stencil) in self.stencils.iter().enumerate() {
                let (source, target) = (light.source.level(i), light.target.level_mut(i));
                super::step(acting, stencil, Which { level: i, colour, blocks }, source, target);
                if keep_source {
                    target.add_grid(source);
                }
                state.index.level_mut(i).mark_lit(target);
                let cells = self.accumulating.as_ref().map(|cells| &cells[i]);
                accumulate(target, cells, light.accumulated.level_mut(i));
                // By the level: not all of them need have a stencil.
                std::mem::swap(light.source.level_mut(i), light.target.level_mut(i));
            }
        }
        self.known = None;
        let volume = state.sizes().cells() * state.lights.len();
        state.iteration += 1;
        Work { visited: volume, dark: 0, volume }
    }

    /// Whether the next iteration keeps its source, so that it counts twice.
    pub(super) fn counts_twice(&self, state: &State<T>) -> bool {
        state.iteration == 0 && self.problem.propagation.snapshots == Snapshots::CopyFirst
    }

    /// Iterations by the fast loops, level by level.
    pub(super) fn fast(&mut self, state: &mut State<T>, iterations: usize, wanted: Wanted) -> Work {
        team::inside(|| self.fast_inside(state, iterations, wanted))
    }

    fn fast_inside(&mut self, state: &mut State<T>, iterations: usize, wanted: Wanted) -> Work {
        team::stay_awake();
        let mut known = self.known.take().unwrap_or_else(|| self.look(state));
        let (options, threads) = (self.options, rayon::current_num_threads());
        let only_merged = wanted == Wanted::Merged && options.skip.unmerged;
        let mut work = Work::default();
        let mut uncovered: Option<Marks> = None;
        let sizes = state.sizes();
        for (i, form) in self.forms.iter().enumerate() {
            let needs = if only_merged && i > 0 {
                let sampled = sampled(&state.index, i, uncovered.as_ref());
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
            for (colour, (light, known)) in state.lights.iter_mut().zip(&mut known).enumerate() {
                let mut stage = Stage {
                    source: light.source.level_mut(i),
                    target: light.target.level_mut(i),
                    accumulated: light.accumulated.level_mut(i),
                    index: &mut state.index,
                    level: i,
                    colour,
                    stencil: &self.stencils[i],
                    solids: self.solids.as_deref(),
                    accumulating: self.accumulating.as_ref().map(|cells| &cells[i]),
                };
                let iterations = state.iteration..state.iteration + iterations;
                visited += stage.advance((form, &options), threads, &mut known[i], iterations, needs.as_deref());
            }
            let times = state.lights.len() * iterations;
            let had_light = if needs.is_none() { state.index.level(i).count() * times } else { 0 };
            let volume = sizes.side(i).pow(3) * times;
            work += Work { visited, dark: had_light.saturating_sub(visited), volume };
        }
        self.known = Some(known);
        state.iteration += iterations;
        work
    }

    /// Looks at all light, where nothing is known of it yet.
    fn look(&self, state: &State<T>) -> Vec<Vec<Known>> {
        let of_light = |light| {
            let forms = self.forms.iter().enumerate();
            forms.map(|(i, form)| Known::of(light, &state.index, i, form.as_ref(), &self.options)).collect()
        };
        state.lights.iter().map(of_light).collect()
    }
}

/// How the next iterations of one level are carried out.
struct Plan<T> {
    order: Order<T>,
    /// How many of them share a pass over memory.
    depth: usize,
}

/// What a plan follows from, besides the options and what is known of the light.
struct Facts {
    layout: Layout,
    threads: usize,
    /// Iterations that are left to do.
    left: usize,
    /// Whether there are occluders, and whether they act in the next iteration.
    occluders: bool,
    acting: bool,
    /// Whether only some cells accumulate.
    some_accumulate: bool,
}

impl<T: Real> Plan<T> {
    fn next(form: &Form<T>, options: &Options, known: &Known, facts: &Facts) -> Self {
        // What occluders leave of the light need not be in the cone.
        let linear = known.linear && !facts.acting;
        let undecided = form.cone.filter(|_| !linear && !facts.occluders);
        let order = Order {
            form: *form,
            linear,
            drop_dark: options.skip.dark && !facts.acting,
            cone: undecided,
            energy: options.tolerance.is_some(),
            instructions: options.instructions,
        };
        // While the clamped form is only in use until the light is in the cone, every step is looked at.
        let looked_at = undecided.is_some() || options.tolerance.is_some() || facts.some_accumulate;
        let single = !options.blocked || looked_at || facts.occluders;
        let depth = match single {
            true => 1,
            false => blocked::depth::<T>(facts.layout, facts.threads).min(facts.left),
        };
        Plan { order, depth }
    }
}

/// One channel's light on one level, on its way.
struct Stage<'a, T> {
    source: &'a mut Grid<T>,
    target: &'a mut Grid<T>,
    accumulated: &'a mut Grid<T>,
    index: &'a mut IndexVolume,
    level: usize,
    colour: usize,
    stencil: &'a Stencil<T>,
    solids: Option<&'a LatticeSolids<T>>,
    /// The cells that accumulate, where not all do.
    accumulating: Option<&'a Marks>,
}

impl<'a, T: Real> Stage<'a, T> {
    /// Takes the level through `iterations`, counted from 0, and returns how many cells that took. The newest
    /// light is in the source then. `needs` holds, for each of the iterations, the cells that may not be left out.
    fn advance(
        &mut self,
        (form, options): (&Form<T>, &Options),
        threads: usize,
        known: &mut Known,
        iterations: Range<usize>,
        needs: Option<&[&Marks]>,
    ) -> usize {
        let (mut done, mut visited) = (0, 0);
        while done < iterations.len() {
            let among = self.among(iterations.start + done + 1);
            let facts = Facts {
                layout: self.source.layout(),
                threads,
                left: iterations.len() - done,
                occluders: self.solids.is_some(),
                acting: among.is_some(),
                some_accumulate: self.accumulating.is_some(),
            };
            let Plan { order, depth } = Plan::next(form, options, known, &facts);
            let mut level = Level {
                source: self.source,
                source_lit: &mut known.source,
                target: self.target,
                target_lit: &mut known.target,
                sum: self.accumulating.is_none().then_some(&mut *self.accumulated),
                marks: self.index.level_mut(self.level),
            };
            let need = needs.map(|needs| &needs[done..done + depth]);
            let tally = match among {
                Some(among) => with_solids::advance(&order, &mut level, threads, need, among),
                None => pass::advance(&order, &mut level, depth, threads, need),
            };
            if let Some(cells) = self.accumulating {
                accumulate(self.source, Some(cells), self.accumulated);
            }
            known.linear = order.linear || (order.cone.is_some() && tally.in_cone);
            known.of_lobes = form.gain.of_lobes.is_some();
            known.energy = [tally.energy, known.energy[1] + tally.energy];
            done += depth;
            visited += tally.visited;
        }
        visited
    }

    /// The occluders that act in an iteration, counted from 1.
    fn among(&self, iteration: usize) -> Option<WithSolids<'a, T>> {
        let solids = self.solids?.acting(iteration)?;
        let (occluders, touched) = (&solids.occluders, &solids.touched[self.level]);
        let which = Which { level: self.level, colour: self.colour, blocks: solids.blocks(iteration) };
        Some(WithSolids { occluders, which, touched, stencil: self.stencil })
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
