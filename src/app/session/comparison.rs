//! Side by side: other propagators and references on the same scene, stepped together, or two iterations of
//! one run.

use crate::app::worker::look::{Light, Of, Pane, State};
use crate::app::worker::rival::{Rival, sides};
use crate::scene::Propagation;
use crate::transport;

/// The most propagators that are compared, the document's own among them.
pub const MOST: usize = 4;

/// What is put side by side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// The document's propagator and others.
    #[default]
    Propagators,
    /// The iteration that is seen and another of the same run.
    Iterations,
}

/// A comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What is put side by side.
    pub sides: Sides,
    /// What the document's own propagator is compared with.
    pub others: Vec<Rival>,
    /// Which octree is shown.
    pub light: Light,
    /// Whether differences from the first are shown too.
    pub difference: bool,
    /// The other iteration.
    pub against: usize,
}

impl Default for Comparison {
    fn default() -> Self {
        Comparison {
            sides: Sides::default(),
            others: Vec::new(),
            light: Light::default(),
            difference: true,
            against: 0,
        }
    }
}

impl Comparison {
    /// The views, with `at` the iteration that is seen and the rivals that are running.
    pub fn panes(&self, at: Option<usize>, running: &[Rival]) -> Vec<Pane> {
        let pane = |state: State, minus: Option<State>| Pane { light: self.light, state, minus };
        let states: Vec<State> = match self.sides {
            Sides::Propagators => sides(running).into_iter().map(|of| State { of, iteration: at }).collect(),
            Sides::Iterations => {
                [at, Some(self.against)].map(|iteration| State { of: Of::Track(0), iteration }).to_vec()
            }
        };
        let mut panes: Vec<Pane> = states.iter().map(|state| pane(*state, None)).collect();
        if self.difference {
            panes.extend(states.iter().skip(1).map(|state| pane(*state, Some(states[0]))));
        }
        panes
    }

    /// Adds a propagator: the next scheme that is not there yet.
    pub fn add(&mut self, own: &Propagation) {
        let used = |name: &str| own.scheme == name || self.others.iter().any(|other| other.choice() == name);
        let next = transport::names().into_iter().find(|name| !used(name)).unwrap_or(transport::names()[0]);
        self.others.push(Rival::Propagator(Propagation { scheme: next.to_owned(), ..own.clone() }));
    }
}

/// A propagator's name on screen, by its place among those that are compared.
pub fn letter(place: usize) -> char {
    char::from(b'A' + (place % 26) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_from_the_first() {
        let compare = Comparison { light: Light::Source, ..Comparison::default() };
        let rivals = [Rival::Ballistic, Rival::Uniform];
        let panes = compare.panes(Some(3), &rivals);
        let first = State { of: Of::Track(0), iteration: Some(3) };
        let minus: Vec<Option<State>> = panes.iter().map(|pane| pane.minus).collect();
        assert_eq!(minus, [None, None, None, Some(first), Some(first)]);
        let (own, uniform) = (Of::Track(0), Of::Track(1));
        let whose: Vec<Of> = panes.iter().map(|pane| pane.state.of).collect();
        assert_eq!(whose, [own, Of::Truth, uniform, Of::Truth, uniform]);
        let compare = Comparison { sides: Sides::Iterations, difference: false, against: 1, ..compare };
        let seen: Vec<_> = compare.panes(None, &rivals).iter().map(|pane| pane.state.iteration).collect();
        assert_eq!(seen, [None, Some(1)]);
    }

    #[test]
    fn propagators_that_are_added_differ_while_they_can() {
        let own = Propagation::default();
        let mut compare = Comparison::default();
        for (i, known) in transport::names().into_iter().skip(1).enumerate() {
            compare.add(&own);
            assert_eq!(compare.others[i].choice(), known);
        }
    }
}
