//! Side by side: other propagators and references on the same scene, stepped together, or two iterations of
//! one run.

use crate::app::worker::look::{Light, Of, Pane, State};
use crate::app::worker::rival::{Rival, sides};
use crate::scene::{Preset, Propagation};
use crate::study::stability::outlook::surely_bounded;
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
    /// The place of the one that the others are held against, 0 for the document's own.
    pub star: usize,
    /// Whether differences from that one are shown too.
    pub difference: bool,
    /// The other iteration.
    pub against: usize,
    /// Whether looking side by side has begun it, and nobody has changed it since: then it ends with the look.
    pub begun: bool,
}

impl Default for Comparison {
    fn default() -> Self {
        Comparison {
            sides: Sides::default(),
            others: Vec::new(),
            star: 0,
            light: Light::default(),
            difference: true,
            against: 0,
            begun: false,
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
        // Of two iterations the second is held against the first.
        let star = if self.sides == Sides::Propagators { self.star.min(states.len() - 1) } else { 0 };
        if self.difference {
            let others = states.iter().enumerate().filter(|(place, _)| *place != star);
            panes.extend(others.map(|(_, state)| pane(*state, Some(states[star]))));
        }
        panes
    }

    /// Adds a run that is not there yet: what cannot grow without bound first.
    pub fn add(&mut self, preset: &Preset) {
        let (own, size, coarsest) = (&preset.propagation, preset.size, preset.coarsest);
        let with = |scheme: &&str| Propagation { scheme: (*scheme).to_owned(), ..own.clone() };
        let (bounded, others): (Vec<&str>, Vec<&str>) =
            transport::names().iter().partition(|scheme| surely_bounded(&with(scheme), size, coarsest));
        let schemes = |names: &[&str]| names.iter().map(|name| Rival::Propagator(with(name))).collect::<Vec<_>>();
        let references = [Rival::Uniform, Rival::Ballistic];
        let all = schemes(&bounded).into_iter().chain(references).chain(schemes(&others));
        let used = |rival: &Rival| {
            rival.choice() == own.scheme || self.others.iter().any(|other| other.choice() == rival.choice())
        };
        // The uniform volume of a single level is the run itself.
        let idle = |rival: &Rival| *rival == Rival::Uniform && size == coarsest;
        let next = all.into_iter().find(|rival| !used(rival) && !idle(rival));
        self.others.push(next.unwrap_or_else(|| Rival::Propagator(own.clone())));
    }

    /// The first run to hold the document's own against: what its octree costs, or, where it has a single level, what its
    /// propagator does.
    pub fn begin(&mut self, preset: &Preset) {
        self.begun = true;
        self.others.push(if preset.size > preset.coarsest { Rival::Uniform } else { Rival::Ballistic });
    }

    /// As it was changed by hand to `now`: what runs in it is no longer there for the look alone.
    pub fn changed(&self, now: Comparison) -> Comparison {
        let begun = now.begun && now.others == self.others && now.star == self.star;
        Comparison { begun, ..now }
    }

    /// Takes a run out of the list; the star goes to the document's own where it was that run's.
    pub fn remove(&mut self, i: usize) {
        self.others.remove(i);
        self.star = match self.star {
            star if star == i + 1 => 0,
            star if star > i + 1 => star - 1,
            star => star,
        };
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
    fn differences_are_from_the_star_and_it_stays_with_its_run() {
        let mut compare =
            Comparison { star: 2, others: vec![Rival::Uniform, Rival::Ballistic], ..Comparison::default() };
        let of = |compare: &Comparison| -> Vec<(Of, Option<Of>)> {
            let panes = compare.panes(None, &compare.others);
            panes.iter().map(|pane| (pane.state.of, pane.minus.map(|minus| minus.of))).collect()
        };
        let (own, uniform, truth) = (Of::Track(0), Of::Track(1), Of::Truth);
        let plain = [(own, None), (uniform, None), (truth, None)];
        assert_eq!(of(&compare), [plain.as_slice(), &[(own, Some(truth)), (uniform, Some(truth))]].concat());
        compare.remove(0);
        assert_eq!(compare.star, 1);
        assert_eq!(of(&compare), [(own, None), (truth, None), (own, Some(truth))]);
        compare.remove(0);
        assert_eq!((compare.star, of(&compare)), (0, vec![(own, None)]));
    }

    #[test]
    fn runs_that_are_added_differ_and_those_that_stay_bounded_come_first() {
        let preset = Preset::default();
        let mut compare = Comparison::default();
        (1..MOST).for_each(|_| compare.add(&preset));
        let chosen: Vec<&str> = compare.others.iter().map(Rival::choice).collect();
        let distinct: std::collections::HashSet<&str> = chosen.iter().copied().collect();
        assert_eq!(distinct.len(), chosen.len());
        assert!(!distinct.contains(preset.propagation.scheme.as_str()));
        // At p = 3 the schemes from public ports grow without bound (MATH.md section 2).
        assert!(!distinct.contains("blog"), "{chosen:?}");
        let mut begun = Comparison::default();
        begun.begin(&preset);
        assert_eq!(begun.others, [Rival::Uniform]);
        // Another look at the same runs leaves them the look's own, a star or another run does not.
        assert!(begun.changed(Comparison { difference: false, ..begun.clone() }).begun);
        assert!(!begun.changed(Comparison { star: 1, ..begun.clone() }).begun);
        assert!(!begun.changed(Comparison { others: vec![Rival::Ballistic], ..begun.clone() }).begun);
    }
}
