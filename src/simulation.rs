//! The stepper: clear, inject, downsample, propagate once, merge, each an action of its own, in any
//! order and any number of times.
//!
//! What each does to the three octrees (000, 3.2.3, 4.2 and 5.1):
//!
//! - *Clear* makes everything dark and sets the iteration to 0. Where hard occluders let no light in, the
//!   index volume is marked: such a cell is sampled at level 0, where it holds what is injected there, if
//!   anything, and not in a coarse cell that reaches around to the light.
//! - *Inject* adds the scene's light to level 0 of the source, and of the accumulated light where the
//!   snapshots count the injection; it marks the index volume.
//! - *Downsample* sets every coarser level of source and accumulated to the mean of its children; with
//!   consistent levels, to the light that it takes over one step later ([`crate::transport::lattice::levels`]).
//! - *Propagate* takes every level one iteration further: source to target, target added to
//!   accumulated, then source and target swap. In a descent it is the level that the descent has come down to
//!   ([`crate::transport::descent`]).
//! - *Merge* stores the sample S(x, y, z) of the accumulated octree for every finest cell.
//!
//! A propagation that could take light out of the range of numbers is not done: the light stays as it
//! was, and [`Simulation::divergence`] tells why.

#[cfg(test)]
mod tests;

use std::fmt;
use std::sync::Arc;

pub use crate::transport::divergence::{Divergence, limit};
pub use crate::transport::options;
pub use crate::transport::{Light, Refusal};

use crate::field::{Cell, Channels, Grid, IndexVolume, Levels, Octree, memory};
use crate::scene::Problem;
use crate::scene::propagation::Snapshots;
use crate::sh::Real;
use crate::transport::arrivals::Arrivals;
use crate::transport::kind::{Kind, Precision, Setup, Transport};
use crate::transport::{self, State, refuse_what_does_not_fit};
use options::{Device, Options, Stage, Wanted, Work};

/// The part of all light under which the newest counts as nothing more ([`Simulation::settle`]).
pub const SETTLED: f64 = 1e-4;
/// The most iterations that are waited for that.
pub const PATIENCE: usize = 2048;

/// What the stepper can be told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Make everything dark.
    Clear,
    /// Add the scene's light to the finest level.
    Inject,
    /// Fill the coarser levels from the finest.
    Downsample,
    /// One iteration on every level.
    Propagate,
    /// Sample the accumulated octree for every finest cell.
    Merge,
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Action::Clear => "clear",
            Action::Inject => "inject",
            Action::Downsample => "downsample",
            Action::Propagate => "propagate",
            Action::Merge => "merge",
        })
    }
}

/// What an action changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// The action.
    pub action: Action,
    /// Iterations done since the last clear.
    pub iteration: usize,
    /// Whether the source light changed.
    pub source: bool,
    /// Whether the target light changed.
    pub target: bool,
    /// Whether the accumulated light changed.
    pub accumulated: bool,
    /// Whether the merged light changed.
    pub merged: bool,
    /// Cells, over all levels, that received light for the first time.
    pub newly_lit: usize,
}

/// A problem on its way through the iterations, in single or double precision.
///
/// ```
/// use lpv_lab::scene::Problem;
/// use lpv_lab::simulation::Simulation;
/// use lpv_lab::transport::preset;
///
/// let text = "(version: 1, size: 8, injectors: [(kind: Single(cell: (3, 4, 4)), direction: (1, 0, 0))])";
/// let problem = Problem::build(&preset::parse(text, "lobe.ron".as_ref())?, "".as_ref())?;
/// let mut simulation = Simulation::<f32>::new(problem).unwrap();
/// simulation.run(|_| true);
/// let light = simulation.lights()[0].accumulated.level(0);
/// assert!(light.get([4, 4, 4]).0[0] > light.get([2, 4, 4]).0[0]);
/// # Ok::<(), lpv_lab::scene::SceneError>(())
/// ```
#[derive(Debug)]
pub struct Simulation<T> {
    problem: Arc<Problem>,
    kind: &'static Kind,
    options: Options,
    state: State<T>,
    transport: Box<dyn Transport<T>>,
    work: Work,
    divergence: Option<Divergence>,
    /// Whether the state is as dark as a new one.
    untouched: bool,
}

impl<T: Real> Clone for Simulation<T> {
    fn clone(&self) -> Self {
        Simulation {
            problem: Arc::clone(&self.problem),
            state: self.state.clone(),
            transport: self.transport.clone(),
            ..*self
        }
    }
}

impl<T: Precision> Simulation<T> {
    /// A dark simulation of `problem`.
    pub fn new(problem: impl Into<Arc<Problem>>) -> Result<Self, Refusal> {
        Self::with_options(problem, Options::default())
    }

    /// A dark simulation of `problem` on the device that `options` name, or on the processor where that cannot do it:
    /// then with the reason, in a line.
    ///
    /// # Errors
    /// Where the processor refuses as well.
    pub fn with_fallback(
        problem: impl Into<Arc<Problem>>,
        options: Options,
    ) -> Result<(Self, Option<String>), Refusal> {
        let problem = problem.into();
        match Self::with_options(Arc::clone(&problem), options) {
            Err(Refusal::Device { what }) if options.device != Device::Cpu => {
                let options = Options { device: Device::Cpu, ..options };
                Ok((Self::with_options(problem, options)?, Some(what)))
            }
            made => Ok((made?, None)),
        }
    }

    /// A dark simulation of `problem` that carries its iterations out as `options` say.
    pub fn with_options(problem: impl Into<Arc<Problem>>, options: Options) -> Result<Self, Refusal> {
        let problem = problem.into();
        let sizes = Levels::new(problem.size, problem.coarsest)
            .ok_or(Refusal::Sizes { size: problem.size, coarsest: problem.coarsest })?;
        let kind = transport::known(&problem.propagation.scheme)?;
        let make = T::maker(kind, options.device).ok_or_else(|| kind.refusal(options.device))?;
        let channels = if options.skip.channels { problem.channels() } else { Channels::separate() };
        let bytes = |size| bytes::<T>(kind, &problem, sizes.with_finest(size), channels.count());
        refuse_what_does_not_fit(sizes.finest(), bytes)?;
        let setup = Setup { problem: Arc::clone(&problem), sizes, channels: channels.clone(), options };
        let mut transport = make(&setup)?;
        let mut state = State::new(sizes, channels);
        transport.start(&mut state);
        Ok(Simulation {
            problem,
            kind,
            options,
            state,
            transport,
            work: Work::default(),
            divergence: None,
            untouched: true,
        })
    }

    /// Bytes that a simulation of `problem` will take once it runs and is merged, occluders and all.
    pub fn bytes_of(problem: &Problem, options: &Options) -> Result<u64, Refusal> {
        let sizes = Levels::new(problem.size, problem.coarsest)
            .ok_or(Refusal::Sizes { size: problem.size, coarsest: problem.coarsest })?;
        let channels = if options.skip.channels { problem.channels() } else { Channels::separate() };
        Ok(bytes::<T>(transport::known(&problem.propagation.scheme)?, problem, sizes, channels.count()))
    }
}

/// Bytes of the state and of what the transport keeps.
fn bytes<T>(kind: &Kind, problem: &Problem, sizes: Levels, channels: usize) -> u64 {
    memory::of_simulation::<T>(sizes, channels) + (kind.bytes)(problem, sizes, channels, size_of::<T>())
}

impl<T: Real> Simulation<T> {
    /// The problem that is simulated.
    pub fn problem(&self) -> &Arc<Problem> {
        &self.problem
    }

    /// The kind of transport that propagates the light.
    pub fn kind(&self) -> &'static Kind {
        self.kind
    }

    /// How iterations are carried out.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// The sizes of the levels.
    pub fn sizes(&self) -> Levels {
        self.state.sizes()
    }

    /// How colours come from the channels.
    pub fn channels(&self) -> &Channels {
        self.state.channels()
    }

    /// The light of each channel.
    pub fn lights(&self) -> &[Light<T>] {
        &self.state.lights
    }

    /// Which level to sample where.
    pub fn index(&self) -> &IndexVolume {
        &self.state.index
    }

    /// Iterations since the last clear, k.
    pub fn iteration(&self) -> usize {
        self.state.iteration
    }

    /// How much was computed since the last clear, and how much there was to compute.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Why the last propagation was not done, if it was not: its light could have left the range of numbers.
    pub fn divergence(&self) -> Option<Divergence> {
        self.divergence
    }

    /// An upper bound on all light still to come, as a part of what has been accumulated (both as Σ c00, on
    /// the level where it is largest). `None` while nothing is proved, or if no tolerance is set.
    pub fn still_to_come(&self) -> Option<f64> {
        self.transport.still_to_come()
    }

    /// By channel, what each of the problem's receivers has received so far: its irradiance times a cell's side squared.
    /// `None` where the transport does not know from where light comes.
    pub fn received(&self) -> Option<&[Vec<f64>]> {
        self.transport.received()
    }

    /// For each channel what has arrived at solids so far, in the cells of a level or in the finest cells as they are
    /// sampled; `None` where what arrives at a solid is in its cell.
    pub fn arrivals(&self, level: Option<usize>) -> Option<Vec<Arrivals>> {
        self.transport.arrivals(&self.state, level)
    }

    /// Bytes that a copy of it takes: its light, and what the transport keeps under way.
    pub fn bytes(&self) -> usize {
        self.state.bytes() + self.transport.bytes()
    }

    /// Bytes that it shares with its copies, such as what is known of the occluders.
    pub fn shared_bytes(&self) -> usize {
        self.transport.shared_bytes()
    }

    /// Does one action and tells what it changed.
    pub fn act(&mut self, action: Action) -> Change {
        let lit_before = self.state.lit_cells();
        self.divergence = None;
        let was_untouched = std::mem::replace(&mut self.untouched, action == Action::Clear);
        let Simulation { state, transport, problem, .. } = self;
        let (mut source, mut target, mut accumulated, mut merged) = (true, false, true, false);
        match action {
            Action::Clear => {
                // New memory is dark, and costs nothing before it is touched.
                if !was_untouched {
                    state.clear();
                }
                transport.start(state);
                self.work = Work::default();
                (target, merged) = (true, true);
            }
            Action::Inject => {
                transport.inject(state);
                accumulated = problem.propagation.snapshots == Snapshots::Thesis;
            }
            Action::Downsample => transport.downsample(state),
            Action::Propagate => match transport.admit(state) {
                Ok(()) => {
                    self.work += transport.step(state);
                    target = true;
                }
                Err(divergence) => {
                    self.divergence = Some(divergence);
                    (source, accumulated) = (false, false);
                }
            },
            Action::Merge => {
                state.merge(|state, channel, merged| transport.sample(state, channel, merged));
                (source, accumulated, merged) = (false, false, true);
            }
        }
        let newly_lit = self.state.lit_cells().saturating_sub(lit_before);
        Change { action, iteration: self.state.iteration, source, target, accumulated, merged, newly_lit }
    }

    /// Clear, inject, downsample, as many iterations as the problem asks for, merge; `watch` sees the
    /// simulation after the downsampling (iteration 0) and after every iteration, and returns whether to
    /// go on. Where the light diverges the iterations end early, and [`Self::divergence`] tells of it.
    pub fn run(&mut self, mut watch: impl FnMut(&Self) -> bool) {
        for action in [Action::Clear, Action::Inject, Action::Downsample] {
            self.act(action);
        }
        let mut go_on = watch(self);
        while go_on && self.iteration() < self.problem.actions() && !self.transport.is_done() {
            self.act(Action::Propagate);
            if self.divergence.is_some() {
                break;
            }
            go_on = watch(self);
        }
        let Simulation { state, transport, .. } = self;
        state.merge(|state, channel, merged| transport.sample(state, channel, merged));
    }

    /// Iterations up to the number the problem asks for, as [`Self::run`] does them, but with nobody looking
    /// in between; then the merge. Returns how many iterations it did: fewer if the tolerance was met.
    pub fn run_all(&mut self, wanted: Wanted) -> usize {
        for action in [Action::Clear, Action::Inject, Action::Downsample] {
            self.act(action);
        }
        self.advance(self.problem.actions(), wanted);
        let divergence = self.divergence;
        self.act(Action::Merge);
        self.divergence = divergence;
        self.iteration()
    }

    /// Clear, inject, all the way that light goes, merge: at once where the transport can, else by iterations until the
    /// newest light is at most [`SETTLED`] of all light, or [`PATIENCE`] of them. Returns whether it came to that; not
    /// where the light diverges or `watch`, called after every iteration, does not want to go on.
    pub fn settle(&mut self, mut watch: impl FnMut(&Self) -> bool) -> bool {
        for action in [Action::Clear, Action::Inject, Action::Downsample] {
            self.act(action);
        }
        self.untouched = false;
        let mut settled = self.transport.settle(&mut self.state);
        let c00 = |of: fn(&Light<T>) -> &Octree<T>, all: &Self| {
            all.lights().iter().map(|light| of(light).level(0).energy().abs()).sum::<f64>()
        };
        while !settled && self.iteration() < PATIENCE && watch(self) {
            self.act(Action::Propagate);
            if self.divergence.is_some() {
                return false;
            }
            settled = c00(|light| &light.source, self) <= SETTLED * c00(|light| &light.accumulated, self);
        }
        self.act(Action::Merge);
        settled
    }

    /// So many iterations with nobody looking in between; fewer if the tolerance is met or the light
    /// diverges. After [`Wanted::Merged`] only merging makes sense.
    pub fn advance(&mut self, iterations: usize, wanted: Wanted) {
        self.untouched = false;
        self.divergence = self.transport.advance(&mut self.state, iterations, wanted, &mut self.work).err();
    }

    /// How far a descent has come down; `None` where every iteration is one of all levels, and before the first.
    pub fn stage(&self) -> Option<Stage> {
        self.transport.stage()
    }

    /// Whether neighbouring levels are blended, so that a coarse cell is not shown as one.
    pub fn blends_levels(&self) -> bool {
        self.transport.blends_levels()
    }

    /// The level that a finest cell is sampled on; where levels are blended, the one with the largest share.
    pub fn sampled_level(&self, cell: Cell) -> usize {
        self.transport.sampled_level(&self.state, cell)
    }

    /// Sets `merged` to the sample S(x, y, z) of a channel's accumulated octree at every finest cell, as
    /// merging does.
    pub fn sample(&self, channel: usize, merged: &mut Grid<T>) {
        self.transport.sample(&self.state, channel, merged);
    }
}
