//! What a simulation looked like after every iteration so far, within a budget of memory.
//!
//! Every iteration is kept while there is room. When there is not, only every second one stays, then
//! every fourth; those in between are computed again from the one before them when they are asked for,
//! which gives the same bits. A state that something other than a propagation has changed cannot be
//! computed again, so it is kept as long as any older one is.
//!
//! A copy of a large state takes longer than an iteration. Of those only every fourth is kept to begin with: what lies
//! between is at most three iterations away.

use std::sync::Arc;

use crate::simulation::{Action, Simulation};

/// The size from which states are large, in bytes, and how many iterations apart those are kept.
const LARGE: usize = 48 << 20;
const APART: usize = 4;

/// A state that is kept; branches of a run share it.
#[derive(Clone, Debug)]
struct Kept {
    state: Arc<Simulation<f32>>,
    bytes: usize,
    /// Whether it cannot be computed again from the one before it.
    fixed: bool,
}

/// The past states of a simulation, oldest first.
#[derive(Clone, Debug)]
pub struct History {
    kept: Vec<Kept>,
    /// The state last asked for that had to be computed again.
    again: Option<Simulation<f32>>,
    stride: usize,
    budget: usize,
}

impl History {
    /// No past, and room for `budget` bytes of it.
    pub fn new(budget: usize) -> Self {
        History { kept: Vec::new(), again: None, stride: 1, budget }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.truncate(0);
        self.stride = 1;
    }

    /// Forgets iteration `k` and all that came after it.
    pub fn truncate(&mut self, k: usize) {
        self.kept.retain(|kept| kept.state.iteration() < k);
        self.again = None;
    }

    /// Changes the memory that may be used, in bytes.
    pub fn set_budget(&mut self, budget: usize) {
        self.budget = budget;
        self.fit();
    }

    /// Takes note of a state; `fixed` where it cannot be computed again from the one before.
    pub fn keep(&mut self, state: &Simulation<f32>, fixed: bool) {
        self.truncate(state.iteration());
        let bytes = state.bytes();
        if bytes > self.budget {
            // Not even one has room: a copy of it would only be in the way.
            self.kept.clear();
            return;
        }
        if bytes > LARGE {
            self.stride = self.stride.max(APART);
        }
        if fixed || state.iteration().is_multiple_of(self.stride) {
            self.kept.push(Kept { bytes, state: Arc::new(state.clone()), fixed });
            self.fit();
        }
    }

    /// The state after iteration `k`, computed again if need be; `None` where nothing as old is kept.
    pub fn at(&mut self, k: usize) -> Option<&Simulation<f32>> {
        let nearest = self.kept.iter().rposition(|kept| kept.state.iteration() <= k)?;
        if self.kept[nearest].state.iteration() == k {
            return self.kept.get(nearest).map(|kept| kept.state.as_ref());
        }
        if self.again.as_ref().is_none_or(|state| state.iteration() != k) {
            let mut state = Simulation::clone(&self.kept[nearest].state);
            while state.iteration() < k {
                state.act(Action::Propagate);
            }
            self.again = Some(state);
        }
        self.again.as_ref()
    }

    /// Whether the state after iteration `k` is one that cannot be computed again.
    pub fn is_fixed(&self, k: usize) -> bool {
        self.kept.iter().any(|kept| kept.fixed && kept.state.iteration() == k)
    }

    /// The states that are kept, oldest first.
    pub fn states(&self) -> impl Iterator<Item = &Simulation<f32>> {
        self.kept.iter().map(|kept| kept.state.as_ref())
    }

    /// The first iteration that [`History::at`] can give.
    pub fn oldest(&self) -> Option<usize> {
        self.kept.first().map(|kept| kept.state.iteration())
    }

    /// Bytes that are used.
    pub fn bytes(&self) -> usize {
        self.kept.iter().map(|kept| kept.bytes).sum()
    }

    /// Thins the past out until it fits its budget; if it never does, the oldest go.
    fn fit(&mut self) {
        while self.bytes() > self.budget {
            let last = self.kept.last().map_or(0, |kept| kept.state.iteration());
            if self.stride <= last {
                self.stride *= 2;
                let stride = self.stride;
                self.kept.retain(|kept| kept.fixed || kept.state.iteration().is_multiple_of(stride));
            } else {
                self.kept.remove(0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Preset, Problem};

    fn started() -> Simulation<f32> {
        let text = "(version: 1, size: 8, injectors: [(kind: Single(cell: (3, 4, 2)))])";
        let preset = Preset::parse(text, std::path::Path::new("test")).unwrap();
        let mut simulation = Simulation::new(Problem::build(&preset, std::path::Path::new("")).unwrap()).unwrap();
        simulation.act(Action::Inject);
        simulation.act(Action::Downsample);
        simulation
    }

    #[test]
    fn what_was_thinned_out_comes_back_to_the_last_bit() {
        let mut simulation = started();
        let mut past = History::new(4 * simulation.bytes());
        let mut truth = Vec::new();
        for k in 0..12 {
            past.keep(&simulation, k == 0);
            truth.push(simulation.clone());
            simulation.act(Action::Propagate);
        }
        assert!(past.bytes() <= 4 * simulation.bytes());
        assert!(past.states().count() < 12);
        assert_eq!(past.oldest(), Some(0));
        for (k, state) in truth.iter().enumerate() {
            assert_eq!(past.at(k).unwrap().lights(), state.lights(), "k = {k}");
        }
    }

    #[test]
    fn a_state_that_cannot_be_computed_again_stays() {
        let mut simulation = started();
        let mut past = History::new(4 * simulation.bytes());
        for k in 0..12 {
            if k == 5 {
                simulation.act(Action::Inject);
            }
            past.keep(&simulation, k == 0 || k == 5);
            simulation.act(Action::Propagate);
        }
        assert!(past.is_fixed(5) && !past.is_fixed(6));
    }

    #[test]
    fn without_room_there_is_no_past() {
        let simulation = started();
        let mut past = History::new(1);
        past.keep(&simulation, true);
        assert!(past.at(0).is_none());
        assert_eq!(past.bytes(), 0);
    }
}
