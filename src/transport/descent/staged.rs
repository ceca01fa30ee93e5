//! A descent as a transport: every action takes one iteration on the level it has come down to.
//!
//! The state's octrees show it. The accumulated light lies in the leaves of the stage; what coarser levels held is left
//! where it is, and finer ones are dark until the light is handed down to them. The index volume marks the leaves, so
//! every finest cell is sampled in the leaf it lies in.
//!
//! Light that is injected on the way is taken up together with what was injected before, and the descent starts anew.

use std::sync::Arc;

use super::course::{Descent, Grids};
use super::first_steps::Injected;
use crate::field::{Grid, Marks, Octree};
use crate::scene::Problem;
use crate::sh::Real;
use crate::transport::divergence::{Divergence, limit};
use crate::transport::kind::{Setup, Transport};
use crate::transport::options::{Stage, Work};
use crate::transport::refusal::Refusal;
use crate::transport::state::{Light, State, keep};
use crate::transport::team;

/// A descent on its way.
#[derive(Clone, Debug)]
pub struct Staged<T> {
    problem: Arc<Problem>,
    descent: Descent<T>,
    /// Iterations of every stage.
    each: usize,
    /// How many of this stage are done.
    done: usize,
    ceiling: Ceiling,
    /// The finest cells whose light counts, where not all do. The others are dark once merged: leaves need the light of
    /// their neighbours, whoever looks at it.
    accumulating: Option<Marks>,
}

/// What the light cannot exceed.
#[derive(Clone, Copy, Debug)]
struct Ceiling {
    /// What an iteration multiplies the largest coefficient by, at most.
    norm: f64,
    /// How many steps injected light takes cell by cell, at most.
    first_steps: i32,
    injected: f64,
    source: f64,
    accumulated: f64,
}

impl Ceiling {
    /// The same after an iteration; after the first of a stage if it `enters`.
    fn next(self, enters: bool) -> Self {
        // A leaf that is split hands at most eight times its mean to a child.
        let before = if enters { 8.0 * self.accumulated } else { self.accumulated };
        // Injected light takes some steps before the first iteration; what it was on the way stays.
        let head = self.norm.powi(self.first_steps) * self.injected;
        let source = if enters { self.norm * (head + before) + before } else { self.norm * self.source };
        Ceiling { source, accumulated: before + source + head, ..self }
    }

    fn fits(self, limit: f64) -> bool {
        // Not true of NaN, which dark light times an infinite factor makes.
        self.source <= limit && self.accumulated <= limit
    }
}

impl<T: Real> Staged<T> {
    /// For the descent of a problem.
    pub fn new(setup: &Setup) -> Result<Self, Refusal> {
        let Setup { problem, sizes, channels, .. } = setup;
        let descent: Descent<T> = super::of_problem(problem, *sizes, channels.count())?;
        let (norm, first_steps) = (descent.norm(), descent.first_steps() as i32);
        let ceiling = Ceiling { norm, first_steps, injected: 0.0, source: 0.0, accumulated: 0.0 };
        Ok(Staged {
            each: problem.propagation.iterations.max(1),
            problem: Arc::clone(problem),
            descent,
            done: 0,
            ceiling,
            accumulating: problem.accumulating(0),
        })
    }

    /// Whether the next iteration is the first of a stage.
    fn enters(&self) -> bool {
        !self.descent.is_under_way() || (self.done >= self.each && self.descent.level() > 0)
    }

    fn step_inside(&mut self, state: &mut State<T>) -> Work {
        team::stay_awake();
        let enters = self.enters();
        if !self.descent.is_under_way() {
            let lights = state.lights.iter_mut();
            let mut injected: Vec<Injected<'_, T>> = lights
                .map(|Light { source, target, .. }| Injected { light: source.level_mut(0), room: target.level_mut(0) })
                .collect();
            self.descent.take_up(&mut injected);
            self.descent.starts_clean();
        } else if enters {
            self.descent.descend();
        }
        for (channel, light) in state.lights.iter_mut().enumerate() {
            let Light { source, target, accumulated, .. } = light;
            let mut grids = Grids { source, target, accumulated };
            if enters {
                self.descent.enter(channel, &mut grids);
            } else {
                self.descent.iterate(channel, &mut grids);
            }
        }
        self.done = if enters { 1 } else { self.done + 1 };
        state.iteration += 1;
        let Some(leaves) = self.descent.leaves() else { return Work::default() };
        if enters {
            for i in leaves.levels() {
                state.index.level_mut(i).clone_from(leaves.marks(i));
            }
        }
        let channels = state.lights.len();
        Work { visited: leaves.count() * channels, dark: 0, volume: state.sizes().cells() * channels }
    }
}

impl<T: Real> Transport<T> for Staged<T> {
    fn start(&mut self, _: &mut State<T>) {
        self.descent.clear();
        self.done = 0;
        self.ceiling = Ceiling { injected: 0.0, source: 0.0, accumulated: 0.0, ..self.ceiling };
    }

    fn inject(&mut self, state: &mut State<T>) {
        if self.descent.is_under_way() {
            // What the source holds are corrections, not light to be sent.
            for (channel, light) in state.lights.iter_mut().enumerate() {
                let Light { source, target, accumulated, .. } = &mut *light;
                [source, target, accumulated].into_iter().for_each(Octree::clear);
                self.descent.put_back(channel, light.source.level_mut(0));
            }
            self.descent.clear();
            self.done = 0;
        }
        self.ceiling.injected += state.inject(&self.problem, self.accumulating.as_ref());
    }

    fn downsample(&mut self, state: &mut State<T>) {
        if !self.descent.is_under_way() {
            state.downsample();
        }
    }

    fn admit(&mut self, state: &State<T>) -> Result<(), Divergence> {
        let (enters, limit) = (self.enters(), limit::<T>());
        let mut next = self.ceiling.next(enters);
        if !next.fits(limit) {
            let largest = |octree: fn(&Light<T>) -> &Octree<T>| {
                let lights = state.lights.iter().enumerate();
                lights.map(|(channel, light)| self.descent.largest(channel, octree(light))).fold(0.0, f64::max)
            };
            let source = largest(|light| &light.source);
            let accumulated = largest(|light| &light.accumulated);
            next = Ceiling { source, accumulated, ..self.ceiling }.next(enters);
            if !next.fits(limit) {
                let level = self.descent.level();
                let side = state.sizes().side(level);
                let largest = source.max(accumulated);
                return Err(Divergence { iteration: state.iteration + 1, level, side, largest });
            }
        }
        self.ceiling = next;
        Ok(())
    }

    fn step(&mut self, state: &mut State<T>) -> Work {
        team::inside(|| self.step_inside(state))
    }

    fn stage(&self) -> Option<Stage> {
        let under_way = self.descent.is_under_way();
        under_way.then(|| Stage { level: self.descent.level(), done: self.done, each: self.each })
    }

    fn sample(&self, state: &State<T>, channel: usize, merged: &mut Grid<T>) {
        let accumulated = &state.lights[channel].accumulated;
        if self.descent.is_under_way() {
            let inside = self.problem.propagation.inside;
            team::inside(|| self.descent.sample(channel, inside, accumulated, merged));
            keep(merged, self.accumulating.as_ref());
        } else {
            state.index.merge(accumulated, merged);
        }
    }

    fn bytes(&self) -> usize {
        self.descent.bytes()
    }

    fn shared_bytes(&self) -> usize {
        self.descent.shared_bytes()
    }

    fn boxed_clone(&self) -> Box<dyn Transport<T>> {
        Box::new(self.clone())
    }
}
