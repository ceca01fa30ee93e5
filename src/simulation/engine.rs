//! What the fast loops know about a simulation's light from one iteration to the next.

use std::ops::Range;

use super::Action;
use super::occlusion::{Obstacles, accumulate};
use super::options::{Options, Work};
use crate::field::{Grid, IndexVolume, Marks, Octree};
use crate::sh::Real;
use crate::transport::lattice::active::everywhere;
use crate::transport::lattice::kernel::among::{self, Among};
use crate::transport::lattice::kernel::form::Form;
use crate::transport::lattice::kernel::occluded::Which;
use crate::transport::lattice::kernel::{Level, Order, Tally, blocked, lies_in_cone, step};
use crate::transport::lattice::stencil::Stencil;

/// Options, the forms of the levels' stencils, and what is known of the light.
#[derive(Clone, Debug)]
pub(super) struct Engine<T> {
    pub(super) options: Options,
    /// By level; `None` where the stencil has another shape.
    pub(super) forms: Vec<Option<Form<T>>>,
    /// By channel and level; `None` after anything else has touched the light.
    pub(super) known: Option<Vec<Vec<Known>>>,
    pub(super) work: Work,
}

/// What is known of one channel's light on one level.
#[derive(Clone, Debug)]
pub(super) struct Known {
    /// Where source and target may be lit.
    source: Marks,
    target: Marks,
    /// Whether the source meets no clamp, now and in all iterations to come.
    linear: bool,
    /// Whether the source is a sum of what the scheme sends, with all faces clamped.
    of_lobes: bool,
    /// Σ c00 of the source and of what was accumulated, if anybody asks.
    energy: [f64; 2],
}

impl<T: Real> Engine<T> {
    pub(super) fn new(stencils: &[Stencil<T>], options: Options) -> Self {
        let mut engine = Engine { options, forms: Vec::new(), known: None, work: Work::default() };
        engine.set_options(options);
        engine.set_stencils(stencils);
        engine
    }

    pub(super) fn set_options(&mut self, options: Options) {
        self.options = options;
        self.known = None;
    }

    pub(super) fn set_stencils(&mut self, stencils: &[Stencil<T>]) {
        self.forms = stencils.iter().map(Form::of).collect();
        self.known = None;
    }

    /// Takes note of an action that changes light without the engine.
    pub(super) fn forget(&mut self, action: Action) {
        if action != Action::Merge {
            self.known = None;
        }
        if action == Action::Clear {
            self.work = Work::default();
        }
    }

    /// Looks at one channel's light on every level, where that is not known yet.
    pub(super) fn look(&self, source: &Octree<T>, accumulated: &Octree<T>, index: &IndexVolume) -> Vec<Known> {
        let level = |(i, form): (usize, &Option<Form<T>>)| {
            let (grid, n) = (source.level(i), source.level(i).side());
            let lit = if self.options.skip.reach { index.level(i).clone() } else { everywhere(n) };
            let linear =
                form.and_then(|form| form.cone).is_some_and(|r| r.is_infinite() || lies_in_cone(grid, &lit, r));
            let energy = match self.options.tolerance {
                Some(_) => [grid.energy(), accumulated.level(i).energy()],
                None => [0.0; 2],
            };
            Known { source: lit.clone(), target: lit, linear, of_lobes: false, energy }
        };
        self.forms.iter().enumerate().map(level).collect()
    }

    /// An upper bound on Σ c00 of all light still to come on a level, over the accumulated Σ c00, as far as
    /// the scheme's gain allows one.
    pub(super) fn still_to_come(&self, i: usize, known: &Known) -> Option<f64> {
        let form = self.forms[i].as_ref()?;
        let in_cone = known.linear && form.cone.is_some_and(f64::is_finite);
        let gain = if in_cone { Some(form.gain.in_cone) } else { form.gain.of_lobes.filter(|_| known.of_lobes) };
        let gain = gain.filter(|gain| *gain < 1.0)?;
        let [now, so_far] = known.energy;
        let coming = now * gain / (1.0 - gain);
        if coming == 0.0 { Some(0.0) } else { Some(coming / so_far) }
    }
}

/// One channel's light on one level, on its way.
pub(super) struct Stage<'a, T> {
    pub(super) source: &'a mut Grid<T>,
    pub(super) target: &'a mut Grid<T>,
    pub(super) accumulated: &'a mut Grid<T>,
    pub(super) index: &'a mut IndexVolume,
    pub(super) which: Which,
    pub(super) stencil: &'a Stencil<T>,
    pub(super) obstacles: Option<&'a Obstacles<T>>,
    /// The cells that accumulate, where not all do.
    pub(super) accumulating: Option<&'a Marks>,
}

impl<'a, T: Real> Stage<'a, T> {
    /// Takes the level through `iterations`, counted from 0, and returns how many cells that took. The newest
    /// light is in the source then. `needs` holds, for each of the iterations, the cells that may not be left out.
    pub(super) fn advance(
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
            // What occluders leave of the light need not be in the cone.
            known.linear &= among.is_none();
            let undecided = form.cone.filter(|_| !known.linear && self.obstacles.is_none());
            let order = Order {
                form: *form,
                linear: known.linear,
                drop_dark: options.skip.dark && among.is_none(),
                cone: undecided,
                energy: options.tolerance.is_some(),
                instructions: options.instructions,
            };
            // While the clamped form is only in use until the light is in the cone, every step is looked at.
            let looked_at = undecided.is_some() || options.tolerance.is_some() || self.accumulating.is_some();
            let single = !options.blocked || looked_at || self.obstacles.is_some();
            let depth = match single {
                true => 1,
                false => blocked::depth::<T>(self.source.layout(), threads).min(iterations.len() - done),
            };
            let mut level = Level {
                source: self.source,
                source_lit: &mut known.source,
                target: self.target,
                target_lit: &mut known.target,
                sum: self.accumulating.is_none().then_some(&mut *self.accumulated),
                marks: self.index.level_mut(self.which.level),
            };
            let tally: Tally = if depth == 1 {
                let pieces = step::pieces(threads, level.source_lit.cells_in_touched_words());
                let need = needs.map(|needs| needs[done]);
                match among {
                    Some(among) => among::step(&order, &mut level, pieces, need, among),
                    None => step::step(&order, &mut level, pieces, need),
                }
            } else {
                blocked::advance_many(&order, &mut level, depth, threads, needs.map(|needs| &needs[done..done + depth]))
            };
            if let Some(cells) = self.accumulating {
                accumulate(self.target, Some(cells), self.accumulated);
            }
            if depth % 2 == 1 {
                std::mem::swap(self.source, self.target);
                std::mem::swap(&mut known.source, &mut known.target);
            }
            known.linear |= undecided.is_some() && tally.in_cone;
            known.of_lobes = form.gain.of_lobes.is_some();
            known.energy = [tally.energy, known.energy[1] + tally.energy];
            done += depth;
            visited += tally.visited;
        }
        visited
    }

    /// The occluders that act in an iteration, counted from 1.
    fn among(&self, iteration: usize) -> Option<Among<'a, T>> {
        let obstacles = self.obstacles?.acting(iteration)?;
        let touched = &obstacles.touched[self.which.level];
        Some(Among { occluders: &obstacles.occluders, which: self.which, touched, stencil: self.stencil })
    }
}
