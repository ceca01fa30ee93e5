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
//!   consistent levels, to the light that it takes over one step later ([`levels`]).
//! - *Propagate* takes every level one iteration further: source to target, target added to
//!   accumulated, then source and target swap.
//! - *Merge* stores the sample S(x, y, z) of the accumulated octree for every finest cell.
//!
//! A propagation that could take light out of the range of numbers is not done: the light stays as it
//! was, and [`Simulation::divergence`] tells why.

mod advance;
mod ceiling;
mod descent;
mod engine;
mod occlusion;
pub mod options;
mod radiance;

use std::fmt;
use std::sync::Arc;

use ceiling::Ceiling;
pub use ceiling::{Divergence, limit};

use crate::field::{Channels, Grid, IndexVolume, Levels, Marks, Octree, memory};
use crate::scene::Problem;
use crate::scene::propagation::Policy;
use crate::scene::propagation::{Propagation, Snapshots};
use crate::sh::Real;
use crate::transport::lattice::kernel::occluded::Which;
use crate::transport::lattice::kernel::plain;
use crate::transport::lattice::levels;
use crate::transport::lattice::scheme::Scheme;
use crate::transport::lattice::stencil::Stencil;

pub use crate::transport::Refusal;
use crate::transport::{refuse_what_does_not_fit, scheme_of};
use engine::Engine;
use occlusion::Obstacles;
use options::Options;
use radiance::Radiance;

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

/// One channel of light in its three octrees.
#[derive(Clone, Debug, PartialEq)]
pub struct Light<T> {
    /// What the next iteration propagates: S_k.
    pub source: Octree<T>,
    /// What the next iteration writes; until then S_{k−1}.
    pub target: Octree<T>,
    /// The running sum of the snapshots, S_A.
    pub accumulated: Octree<T>,
    /// S(x, y, z) of the accumulated octree, once merged.
    pub merged: Option<Grid<T>>,
}

/// A scene on its way through the iterations, in single or double precision.
#[derive(Clone, Debug)]
pub struct Simulation<T> {
    problem: Arc<Problem>,
    sizes: Levels,
    channels: Channels,
    stencils: Vec<Stencil<T>>,
    /// What light that comes to rest on each level is multiplied with, by band.
    residences: Vec<[f64; 2]>,
    obstacles: Option<Obstacles<T>>,
    /// By level the cells that accumulate, where not all do.
    accumulating: Option<Vec<Marks>>,
    lights: Vec<Light<T>>,
    index: IndexVolume,
    iteration: usize,
    engine: Engine<T>,
    ceiling: Ceiling,
    /// Where the scene wants ordinates; there are no stencils then.
    radiance: Option<Radiance>,
    divergence: Option<Divergence>,
}

impl<T: Real> Simulation<T> {
    /// A dark simulation of `problem`.
    pub fn new(problem: impl Into<Arc<Problem>>) -> Result<Self, Refusal> {
        Self::with_options(problem, Options::default())
    }

    /// A dark simulation of `problem` that carries its iterations out as `options` say.
    pub fn with_options(problem: impl Into<Arc<Problem>>, options: Options) -> Result<Self, Refusal> {
        let problem = problem.into();
        let sizes = Levels::new(problem.size, problem.coarsest)
            .ok_or(Refusal::Sizes { size: problem.size, coarsest: problem.coarsest })?;
        let scheme = scheme_of(&problem.propagation)?;
        let (stencils, residences) = operators(scheme.as_ref(), &problem.propagation, sizes)?;
        let channels = if options.skip.channels { problem.channels() } else { Channels::separate() };
        let under_way = |size: usize| Radiance::bytes(&problem.propagation, size, channels.count());
        refuse_what_does_not_fit(sizes.finest(), |size| {
            memory::of_simulation::<T>(sizes.with_finest(size), channels.count()) + under_way(size)
        })?;
        let obstacles = scheme.and_then(|scheme| Obstacles::new(&problem, sizes, &scheme));
        let accumulating = occlusion::accumulating(&problem, sizes);
        let ceiling = Ceiling::new(&stencils, problem.occlusion.bounce);
        let engine = Engine::new(&stencils, options);
        let dark = || Octree::new(sizes);
        let light = || Light { source: dark(), target: dark(), accumulated: dark(), merged: None };
        let lights = (0..channels.count()).map(|_| light()).collect();
        let mut index = IndexVolume::new(sizes);
        occlusion::mark_shut(obstacles.as_ref(), &mut index);
        let radiance = Radiance::new(&problem, &channels);
        if radiance.is_some() {
            Radiance::mark(&mut index);
        }
        let divergence = None;
        Ok(Simulation {
            problem,
            sizes,
            channels,
            stencils,
            residences,
            obstacles,
            accumulating,
            lights,
            index,
            iteration: 0,
            engine,
            ceiling,
            radiance,
            divergence,
        })
    }

    /// The problem that is simulated.
    pub fn problem(&self) -> &Arc<Problem> {
        &self.problem
    }

    /// The sizes of the levels.
    pub fn sizes(&self) -> Levels {
        self.sizes
    }

    /// How colours come from the channels.
    pub fn channels(&self) -> &Channels {
        &self.channels
    }

    /// The light of each channel.
    pub fn lights(&self) -> &[Light<T>] {
        &self.lights
    }

    /// Which level to sample where.
    pub fn index(&self) -> &IndexVolume {
        &self.index
    }

    /// Iterations since the last clear, k.
    pub fn iteration(&self) -> usize {
        self.iteration
    }

    /// Why the last propagation was not done, if it was not: its light could have left the range of numbers.
    pub fn divergence(&self) -> Option<Divergence> {
        self.divergence
    }

    /// Takes other settings for the iterations to come; the light stays as it is.
    pub fn set_propagation(&mut self, propagation: Propagation) -> Result<(), Refusal> {
        let scheme = scheme_of(&propagation)?;
        if propagation.ordinates != self.problem.propagation.ordinates
            || propagation.scheme != self.problem.propagation.scheme
        {
            let under_way = |size: usize| Radiance::bytes(&propagation, size, self.channels.count());
            refuse_what_does_not_fit(self.sizes.finest(), under_way)?;
        }
        (self.stencils, self.residences) = operators(scheme.as_ref(), &propagation, self.sizes)?;
        self.engine.set_stencils(&self.stencils);
        if propagation.scheme != self.problem.propagation.scheme {
            self.obstacles = scheme.and_then(|scheme| Obstacles::new(&self.problem, self.sizes, &scheme));
        }
        self.ceiling = Ceiling::new(&self.stencils, self.problem.occlusion.bounce);
        Arc::make_mut(&mut self.problem).propagation = propagation;
        self.set_radiance();
        Ok(())
    }

    /// Does one action and tells what it changed.
    pub fn act(&mut self, action: Action) -> Change {
        let lit_before = self.lit();
        if action != Action::Propagate {
            self.engine.forget(action);
        }
        self.divergence = None;
        let unchanged = Change {
            action,
            iteration: 0,
            source: false,
            target: false,
            accumulated: false,
            merged: false,
            newly_lit: 0,
        };
        let change = match action {
            Action::Clear => {
                self.clear();
                self.ceiling.clear();
                Change { source: true, target: true, accumulated: true, merged: true, ..unchanged }
            }
            Action::Inject => {
                let accumulated = self.inject();
                Change { source: true, accumulated, ..unchanged }
            }
            Action::Downsample => {
                self.downsample();
                Change { source: true, accumulated: true, ..unchanged }
            }
            Action::Propagate => match self.admit() {
                Ok(()) => {
                    self.propagate();
                    Change { source: true, target: true, accumulated: true, ..unchanged }
                }
                Err(divergence) => {
                    self.divergence = Some(divergence);
                    unchanged
                }
            },
            Action::Merge => {
                self.merge();
                Change { merged: true, ..unchanged }
            }
        };
        Change { iteration: self.iteration, newly_lit: self.lit().saturating_sub(lit_before), ..change }
    }

    /// Clear, inject, downsample, as many iterations as the scene asks for, merge; `watch` sees the
    /// simulation after the downsampling (iteration 0) and after every iteration, and returns whether to
    /// go on. Where the light diverges the iterations end early, and [`Self::divergence`] tells of it.
    pub fn run(&mut self, mut watch: impl FnMut(&Self) -> bool) {
        for action in [Action::Clear, Action::Inject, Action::Downsample] {
            self.act(action);
        }
        let mut go_on = watch(self);
        while go_on && self.iteration < self.problem.propagation.iterations && !self.is_done() {
            self.act(Action::Propagate);
            if self.divergence.is_some() {
                break;
            }
            go_on = watch(self);
        }
        self.merge();
    }

    /// Whether the light of the next iteration stays in range.
    fn admit(&mut self) -> Result<(), Divergence> {
        let next = self.iteration + 1;
        match &mut self.radiance {
            Some(radiance) => radiance.admit(next, &self.lights),
            None => self.ceiling.admit(next, &self.lights, &self.index),
        }
    }

    /// Cells, over all levels, that have received light.
    fn lit(&self) -> usize {
        (0..self.sizes.count()).map(|i| self.index.level(i).count()).sum()
    }

    fn clear(&mut self) {
        for light in &mut self.lights {
            light.source.clear();
            light.target.clear();
            light.accumulated.clear();
            light.merged = None;
        }
        self.index.clear();
        occlusion::mark_shut(self.obstacles.as_ref(), &mut self.index);
        if let Some(radiance) = &mut self.radiance {
            radiance.clear();
            Radiance::mark(&mut self.index);
        }
        self.iteration = 0;
    }

    /// Whether the accumulated light changed with the source.
    fn inject(&mut self) -> bool {
        let accumulate = self.problem.propagation.snapshots == Snapshots::Thesis;
        // Cells may hold light of several entries: nothing is brighter than all of it together.
        let mut most = vec![0.0; self.lights.len()];
        for source in &self.problem.sources {
            if let Some(radiance) = &mut self.radiance {
                radiance.inject(source, &self.channels);
            }
            for (channel, light) in self.lights.iter_mut().enumerate() {
                let weight = self.channels.weight(channel, source.color);
                for (cell, value) in &source.light {
                    most[channel] += (*value * weight).max_norm();
                    let value = (*value * weight).cast();
                    light.source.level_mut(0).add(*cell, value);
                    if accumulate && self.accumulating.as_ref().is_none_or(|cells| cells[0].get(*cell)) {
                        light.accumulated.level_mut(0).add(*cell, value);
                    }
                    if !value.is_zero() {
                        self.index.level_mut(0).set(*cell);
                    }
                }
            }
        }
        self.ceiling.inject(most.into_iter().fold(0.0, f64::max));
        accumulate
    }

    fn downsample(&mut self) {
        let hands_down = self.problem.propagation.levels == Policy::Consistent && self.radiance.is_none();
        if hands_down {
            self.hand_down();
            self.ceiling.forget(1);
        } else {
            self.ceiling.downsample();
        }
        for light in &mut self.lights {
            if !hands_down {
                light.source.downsample();
                light.accumulated.downsample();
            }
            for i in 1..self.sizes.count() {
                self.index.level_mut(i).mark_lit(light.source.level(i));
                self.index.level_mut(i).mark_lit(light.accumulated.level(i));
            }
        }
    }

    fn merge(&mut self) {
        for channel in 0..self.lights.len() {
            let mut merged = self.lights[channel].merged.take().unwrap_or_else(|| Grid::new(self.sizes.finest()));
            self.sample(channel, &mut merged);
            self.lights[channel].merged = Some(merged);
        }
    }

    /// Sets `merged` to the sample S(x, y, z) of a channel's accumulated octree at every finest cell, as
    /// merging does.
    pub fn sample(&self, channel: usize, merged: &mut Grid<T>) {
        self.index.merge(&self.lights[channel].accumulated, merged);
    }
}

/// One iteration of one level. Where albedos have colours each channel is one; where not, any colour will do.
fn step<T: Real>(
    acting: Option<&Obstacles<T>>,
    stencil: &Stencil<T>,
    which: Which,
    source: &Grid<T>,
    target: &mut Grid<T>,
) {
    match acting {
        Some(Obstacles { occluders, .. }) => occluders.propagate(stencil, which, source, target),
        None => plain::propagate(stencil, source, target),
    }
}

/// The stencil of every level, and its residence.
type Operators<T> = (Vec<Stencil<T>>, Vec<[f64; 2]>);

/// The operators of a setting; ordinates have none.
fn operators<T: Real>(
    scheme: Option<&Scheme>,
    propagation: &Propagation,
    sizes: Levels,
) -> Result<Operators<T>, Refusal> {
    let Some(scheme) = scheme else { return Ok((Vec::new(), Vec::new())) };
    let Propagation { factor, clamp, levels, .. } = *propagation;
    let operators = levels::operators(scheme, factor, clamp, levels, sizes.count())?;
    Ok(operators.into_iter().map(|operator| (operator.stencil, operator.residence)).unzip())
}
