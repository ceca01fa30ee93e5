//! Light as two bands of spherical harmonics a cell, sent from each cell to its six neighbours: what a propagation
//! scheme is, the [schemes] themselves, and the loops that apply one to a grid.
//!
//! A [`Lattice`] takes every level of an octree through its iterations: [`levels`] says with which operator,
//! [`kernel`] has the loops, `iterate` decides which of them run, `occlusion` what stands in the way and `ceiling`
//! whether the light stays in range. [`fixed_point`] finds what all iterations come to.
//!
//! **Stopping early.** Where a scheme's light keeps to its cone ([`kernel::form`]), the sum of c00 over a level gains
//! at most g an iteration, and no coefficient is larger than its cell's c00 (but for a bare lobe, 1.155 times). So all
//! the light of all iterations still to come sums to at most E·g / (1 − g) in c00, with E the sum now:
//! [`Transport::still_to_come`] is that bound over what has been accumulated, on the level where it is largest. For
//! g ≥ 1 (cascaded: p ≥ 4), or light without clamps that is not in the cone, nothing is proved and no run stops early.

mod arriving;
mod ceiling;
mod coarse;
pub mod exact;
pub(crate) mod face;
pub(crate) mod fixed_point;
pub(crate) mod geometry_volume;
mod hand_down;
pub(crate) mod hard_solids;
mod iterate;
pub mod kernel;
mod known;
pub(crate) mod levels;
pub(crate) mod linear;
pub(crate) mod obstacles;
mod occlusion;
#[cfg(feature = "gpu")]
mod parts;
mod radial;
pub(crate) mod reach;
pub mod scheme;
pub mod schemes;
pub mod stencil;

use std::sync::Arc;

use super::arrivals::Arrivals;
use super::divergence::Divergence;
use super::kind::{Capabilities, Kind, Law, Setup, Transport};
use super::options::{Kernel, Options, Wanted, Work};
use super::refusal::Refusal;
use super::state::{State, accumulating, keep};
use super::team;
use crate::field::{Cell, Grid, Levels, Marks};
use crate::scene::Problem;
use crate::scene::propagation::{Index, Policy, Propagation};
use crate::sh::Real;
use ceiling::Ceiling;
use coarse::Coarse;
use exact::leaves::{Leaves, Way};
use fixed_point::Solver;
use kernel::form::Form;
use kernel::occluded::Which;
use kernel::plain;
use known::Known;
pub use levels::TooLarge;
use linear::linear_form;
use obstacles::Obstacles;
use occlusion::LatticeSolids;
use radial::Radial;
use scheme::Scheme;
use stencil::Stencil;

/// Every scheme, as a kind of transport.
pub fn kinds() -> Vec<Kind> {
    schemes::all().iter().map(kind).collect()
}

fn kind(scheme: &Scheme) -> Kind {
    Kind {
        name: scheme.name,
        summary: scheme.summary,
        source: scheme.source,
        flaws: scheme.flaws,
        can: Capabilities { levels: true, occluders: true, clamp: true, grows: true },
        conserving: 1.0 / Stencil::<f64>::new(scheme, 1.0, false).uniform_gain()[0],
        laws,
        check: |_| Ok(()),
        label: |propagation| propagation.scheme.clone(),
        bytes,
        solver: |problem| Ok(Box::new(Solver::for_problem(problem)?)),
        tolerances: &[1e-2, 1e-4],
        variants: |propagation| vec![propagation.clone()],
        single: Lattice::build,
        double: Some(Lattice::build),
        card: None,
    }
}

/// Bytes that a lattice keeps beside the state.
pub(super) fn bytes(problem: &Problem, sizes: Levels, channels: usize, number: usize) -> u64 {
    // Where light may be, a bit a cell of source and target.
    let marks = sizes.cells() as u64 / 4 * channels as u64;
    let coarse = match problem.propagation.levels {
        Policy::Exact | Policy::Ahead => {
            let leaves: u64 = (1..sizes.count()).map(|i| Leaves::<f32>::bytes_of_uniform(i, sizes.side(i))).sum();
            leaves + obstacles::bytes(problem, sizes, channels, number)
        }
        _ => 0,
    };
    let radial = match problem.propagation.index {
        Index::Thesis => 0,
        Index::Radial { .. } => (size_of::<f32>() * sizes.finest().pow(3)) as u64,
    };
    let scheme = schemes::find(&problem.propagation.scheme);
    marks + coarse + radial + scheme.map_or(0, |scheme| occlusion::bytes(problem, &scheme, sizes, number))
}

/// Every face is linear but for its clamp. On exact levels light stays in a cell, and is handed on by a filter that loses
/// some at the border.
pub(super) fn laws(propagation: &Propagation) -> Vec<Law> {
    let mut laws = vec![Law::Symmetry, Law::Shutters, Law::Precision];
    if Solver::new(propagation, 1).is_ok() {
        laws.push(Law::FixedPoint);
    }
    if !propagation.clamp {
        laws.push(Law::Superposition);
    }
    if !propagation.levels.is_exact() {
        laws.push(Law::Reach);
        laws.extend((!propagation.clamp).then_some(Law::Conservation));
    }
    laws
}

/// Light of one problem on its way under a scheme.
#[derive(Clone, Debug)]
pub struct Lattice<T> {
    problem: Arc<Problem>,
    options: Options,
    /// By level.
    stencils: Vec<Stencil<T>>,
    /// By level, in the form that the fast loops take; `None` where the stencil has another shape.
    forms: Vec<Option<Form<T>>>,
    /// What light that comes to rest on each level is multiplied with, by band.
    residences: Vec<[f64; 2]>,
    solids: Option<Arc<LatticeSolids<T>>>,
    /// By level the cells that accumulate, where not all do.
    accumulating: Option<Arc<Vec<Marks>>>,
    /// By channel and level; `None` after anything but an iteration has touched the light.
    known: Option<Vec<Vec<Known>>>,
    ceiling: Ceiling,
    /// Under exact levels all but the finest, which is the only one with a stencil then.
    coarse: Option<Coarse<T>>,
    /// Which levels are sampled where, if not the finest that are lit.
    radial: Option<Radial<T>>,
}

impl<T: Real> Lattice<T> {
    /// For the scheme of a problem.
    pub fn new(setup: &Setup) -> Result<Self, Refusal> {
        let Setup { problem, sizes, options, .. } = setup;
        let Propagation { factor, clamp, levels, .. } = problem.propagation;
        let scheme = schemes::find(&problem.propagation.scheme)
            .ok_or_else(|| Refusal::unknown(&problem.propagation.scheme, &schemes::names()))?;
        let operators = levels::operators(&scheme, factor, clamp, levels, sizes.count())?;
        let (mut stencils, residences): (Vec<_>, Vec<_>) =
            operators.into_iter().map(|operator| (operator.stencil, operator.residence)).unzip();
        // In step exact levels move no more light than the scheme itself does.
        let mut ceiling = Ceiling::new(&stencils, problem.occlusion.bounce);
        let coarse = if levels.is_exact() && sizes.count() > 1 {
            let (_, share) = linear_form::<T>(problem, "exact levels")?;
            let way = if levels == Policy::Ahead { Way::Ahead } else { Way::InStep };
            if way == Way::Ahead {
                // Of a leaf at a border less stays, and more of it is turned; four times as much is more than enough.
                ceiling.amplify(1, 4.0 * exact::residence(&share, factor, sizes.count())?);
            }
            let colours = setup.channels.count();
            let obstacles = Obstacles::new(problem, *sizes, colours).map(Arc::new);
            if obstacles.is_some() {
                // Of a leaf that occluders touch what stays, what leaves and what enters are not of one share.
                ceiling.amplify(1, 4.0);
            }
            stencils.truncate(1);
            Some(Coarse::new(&share, way, *sizes, colours, obstacles))
        } else {
            None
        };
        Ok(Lattice {
            forms: stencils.iter().map(Form::of).collect(),
            solids: LatticeSolids::new(problem, *sizes, &scheme).map(Arc::new),
            accumulating: accumulating(problem, *sizes).map(Arc::new),
            ceiling,
            coarse,
            problem: Arc::clone(problem),
            options: *options,
            stencils,
            residences,
            known: None,
            radial: match problem.propagation.index {
                Index::Thesis => None,
                Index::Radial { reach } => Some(Radial::new(problem, *sizes, reach)),
            },
        })
    }

    pub(super) fn build(setup: &Setup) -> Result<Box<dyn Transport<T>>, Refusal> {
        Ok(Box::new(Lattice::new(setup)?))
    }

    /// Whether the fast loops can do the next iteration and all after it.
    fn is_fast(&self, state: &State<T>) -> bool {
        self.options.kernel == Kernel::Fast && !self.counts_twice(state) && self.forms.iter().all(Option::is_some)
    }
}

impl<T: Real> Transport<T> for Lattice<T> {
    fn start(&mut self, state: &mut State<T>) {
        self.known = None;
        self.ceiling.clear();
        self.coarse.iter_mut().for_each(Coarse::rest);
        self.radial.iter_mut().for_each(Radial::clear);
        if let Some(solids) = &self.solids {
            solids.mark_shut(&mut state.index);
        }
    }

    fn inject(&mut self, state: &mut State<T>) {
        self.known = None;
        let finest = self.accumulating.as_ref().map(|cells| &cells[0]);
        self.ceiling.inject(state.inject(&self.problem, finest));
    }

    fn downsample(&mut self, state: &mut State<T>) {
        self.known = None;
        if self.problem.propagation.levels == Policy::Consistent {
            self.hand_down(state);
            self.ceiling.forget(1);
            state.mark_coarser();
        } else {
            state.downsample();
            self.ceiling.downsample();
            self.coarse.iter_mut().for_each(Coarse::rest);
        }
        self.radial.iter_mut().for_each(|radial| radial.downsampled(state));
    }

    fn admit(&mut self, state: &State<T>) -> Result<(), Divergence> {
        self.ceiling.admit(state)
    }

    fn step(&mut self, state: &mut State<T>) -> Work {
        let finest = if self.is_fast(state) { self.fast(state, 1, Wanted::Everything) } else { self.plainly(state) };
        let accumulating = self.accumulating.as_ref().map(|cells| cells.as_slice());
        let coarser = self.coarse.as_mut().map(|coarse| coarse.step(state, accumulating)).unwrap_or_default();
        Work { visited: finest.visited + coarser.visited, dark: finest.dark, volume: finest.volume.max(coarser.volume) }
    }

    fn advance(
        &mut self,
        state: &mut State<T>,
        iterations: usize,
        wanted: Wanted,
        work: &mut Work,
    ) -> Result<(), Divergence> {
        let end = state.iteration + iterations;
        // A radial index looks at samples of several levels, wherever they are.
        let wanted = if self.radial.is_some() { Wanted::Everything } else { wanted };
        while state.iteration < end && !self.is_done() {
            self.admit(state)?;
            let steps = self.options.tolerance.is_some() || self.solids.is_some() || self.coarse.is_some();
            if steps || !self.is_fast(state) {
                *work += self.step(state);
                continue;
            }
            let together = 1 + self.ceiling.admit_more::<T>(end - state.iteration - 1);
            // Which samples will be looked at shows only at the end.
            let is_last = state.iteration + together == end;
            *work += self.fast(state, together, if is_last { wanted } else { Wanted::Everything });
        }
        Ok(())
    }

    fn still_to_come(&self) -> Option<f64> {
        // Occluders may reflect more than they stop, and what counts is what was accumulated everywhere.
        let hidden = self.solids.is_some() || self.accumulating.is_some() || self.coarse.is_some();
        if self.options.tolerance.is_none() || hidden {
            return None;
        }
        let known = self.known.as_ref()?;
        let levels = known.iter().flat_map(|channel| channel.iter().zip(&self.forms));
        levels
            .map(|(known, form)| known.still_to_come(form.as_ref()?))
            .try_fold(0.0, |most: f64, bound| Some(most.max(bound?)))
    }

    fn is_done(&self) -> bool {
        self.options.tolerance.is_some_and(|tolerance| self.still_to_come().is_some_and(|bound| bound <= tolerance))
    }

    fn sample(&self, state: &State<T>, channel: usize, merged: &mut Grid<T>) {
        match &self.radial {
            None => state.sample(channel, merged),
            Some(radial) => {
                team::inside(|| radial.sample(state, channel, merged));
                // A coarse cell with surfaces in it is larger than they are.
                keep(merged, self.accumulating.as_ref().map(|cells| &cells[0]));
            }
        }
    }

    fn blends_levels(&self) -> bool {
        self.radial.is_some()
    }

    fn sampled_level(&self, state: &State<T>, cell: Cell) -> usize {
        match &self.radial {
            None => state.index.index(cell),
            Some(radial) => radial.level(&state.index, cell).round() as usize,
        }
    }

    fn arrivals(&self, state: &State<T>, level: Option<usize>) -> Option<Vec<Arrivals>> {
        self.arrivals_at_solids(state, level)
    }

    fn bytes(&self) -> usize {
        let coarse = self.coarse.as_ref().map_or(0, Coarse::bytes);
        let radial = self.radial.as_ref().map_or(0, Radial::bytes);
        coarse + radial + self.known.iter().flatten().flatten().map(Known::bytes).sum::<usize>()
    }

    fn shared_bytes(&self) -> usize {
        let marks = self.accumulating.iter().flat_map(|cells| cells.iter());
        let marks: usize = marks.map(|cells| size_of_val(cells.words())).sum();
        let coarse = self.coarse.as_ref().map_or(0, Coarse::shared_bytes);
        marks + coarse + self.solids.as_ref().map_or(0, |solids| solids.bytes())
    }

    fn boxed_clone(&self) -> Box<dyn Transport<T>> {
        Box::new(self.clone())
    }
}

/// One iteration of one level by the definition. Where albedos have colours each channel is one; where not, any
/// colour will do.
fn step<T: Real>(
    acting: Option<&LatticeSolids<T>>,
    stencil: &Stencil<T>,
    which: Which,
    source: &Grid<T>,
    target: &mut Grid<T>,
) {
    match acting {
        Some(LatticeSolids { occluders, .. }) => occluders.propagate(stencil, which, source, target),
        None => plain::propagate(stencil, source, target),
    }
}
