//! One propagator on its way through a scene: the simulation, its past and its errors.

use std::sync::Arc;

use crate::app::worker::history::History;
use crate::field::Grid;
use crate::scene::Problem;
use crate::simulation::options::{Device, Options};
use crate::simulation::{Action, Change, Refusal, Simulation};
use crate::study::error::ErrorRow;
use crate::study::expectation::{Expectation, References};
use crate::study::light;

/// The errors of a state against an expectation; what is dark, or lacks the references, has none.
pub fn errors(state: &Simulation<f32>, expectation: Expectation, references: &References) -> Vec<ErrorRow> {
    let is_dark = (0..state.sizes().count()).all(|i| state.index().level(i).count() == 0);
    if is_dark { Vec::new() } else { expectation.rows(state, references) }
}

/// The merged light of one of several tracks after iteration `k`, or now; `None` where it is not there.
pub fn merged(tracks: &mut [Track], which: usize, k: Option<usize>) -> Option<Arc<[Grid<f32>]>> {
    let state = tracks.get_mut(which)?.at(k)?;
    Some(light::sampled(state).into())
}

/// A simulation that remembers.
#[derive(Clone, Debug)]
pub struct Track {
    now: Simulation<f32>,
    past: History,
    /// Whether the present state cannot be computed again from the one before.
    fixed: bool,
}

impl Track {
    /// A dark simulation of `problem`, with `budget` bytes for its past.
    pub fn new(problem: Problem, budget: usize) -> Result<Self, Refusal> {
        Ok(Track::on(Device::Cpu, problem, budget)?.0)
    }

    /// The same on a device, or on the processor where that cannot do it; then with the reason.
    pub fn on(device: Device, problem: Problem, budget: usize) -> Result<(Self, Option<String>), Refusal> {
        let options = Options { device, ..Options::default() };
        let (now, why) = Simulation::with_fallback(problem, options)?;
        Ok((Track { now, past: History::new(budget), fixed: true }, why))
    }

    /// Does one action and tells what it changed.
    pub fn act(&mut self, action: Action) -> Change {
        match action {
            Action::Clear => self.past.clear(),
            Action::Propagate => self.past.keep(&self.now, self.fixed),
            Action::Inject | Action::Downsample | Action::Merge => {}
        }
        match action {
            Action::Propagate => self.fixed = false,
            // A merge adds something that can be had again; it does not change what is propagated.
            Action::Merge => {}
            Action::Clear | Action::Inject | Action::Downsample => self.fixed = true,
        }
        let change = self.now.act(action);
        if self.now.divergence().is_some() {
            // The present is still what was just kept as the past.
            self.past.truncate(self.now.iteration());
        }
        change
    }

    /// The present state.
    pub fn now(&self) -> &Simulation<f32> {
        &self.now
    }

    /// The state after iteration `k`, or the present one; `None` where it is no longer remembered.
    pub fn at(&mut self, k: Option<usize>) -> Option<&Simulation<f32>> {
        match k {
            Some(k) if k < self.now.iteration() => self.past.at(k),
            _ => Some(&self.now),
        }
    }

    /// Every state that is at hand, oldest first.
    pub fn states(&self) -> impl Iterator<Item = &Simulation<f32>> {
        self.past.states().chain([&self.now])
    }

    /// Goes back to iteration `k` and forgets what came after; false where it is no longer remembered.
    pub fn restart(&mut self, k: usize) -> bool {
        if k >= self.now.iteration() {
            return true;
        }
        let Some(state) = self.past.at(k).cloned() else { return false };
        self.fixed = self.past.is_fixed(k);
        self.past.truncate(k);
        self.now = state;
        true
    }

    /// The oldest iteration that can be shown.
    pub fn oldest(&self) -> usize {
        self.past.oldest().unwrap_or(self.now.iteration())
    }

    /// Bytes that the past takes.
    pub fn past_bytes(&self) -> usize {
        self.past.bytes()
    }

    /// Bytes that the present takes.
    pub fn now_bytes(&self) -> usize {
        self.now.bytes() + self.now.shared_bytes()
    }

    /// Changes the memory for the past, in bytes.
    pub fn set_budget(&mut self, budget: usize) {
        self.past.set_budget(budget);
    }
}
