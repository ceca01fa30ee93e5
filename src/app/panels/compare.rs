//! Side by side: other propagators and references on the same scene, stepped together, or two iterations of
//! one run.

use egui::{ComboBox, DragValue, Ui};

use crate::app::lab::Lab;
use crate::app::panels::controls::{self, name};
use crate::app::session::critical::warning;
use crate::app::worker::look::{Light, Of, Pane, State};
use crate::scene::propagation::Policy;
use crate::scene::{Problem, Propagation};
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

/// What the document's own propagator is compared with.
#[derive(Clone, Debug, PartialEq)]
pub enum Rival {
    /// Another propagator.
    Propagator(Propagation),
    /// The uniform volume: the document's own propagator on the finest level alone.
    Uniform,
    /// What truly arrives along straight lines.
    Ballistic,
}

impl Rival {
    /// What is simulated for it; nothing for what truly arrives.
    pub fn problem(&self, own: &Problem) -> Option<Problem> {
        match self {
            Rival::Propagator(propagation) => Some(Problem { propagation: propagation.clone(), ..own.clone() }),
            Rival::Uniform => Some(Problem { coarsest: own.size, ..own.clone() }),
            Rival::Ballistic => None,
        }
    }

    /// Whether anything is simulated for it.
    pub fn runs(&self) -> bool {
        *self != Rival::Ballistic
    }

    /// A few words, as titles and legends have them.
    pub fn describe(&self) -> String {
        match self {
            Rival::Propagator(propagation) => describe(propagation),
            Rival::Uniform => "uniform volume of A".to_owned(),
            Rival::Ballistic => "what truly arrives".to_owned(),
        }
    }

    /// What the list of schemes says.
    fn choice(&self) -> &str {
        match self {
            Rival::Propagator(propagation) => &propagation.scheme,
            Rival::Uniform => "Uniform volume",
            Rival::Ballistic => "What truly arrives",
        }
    }
}

/// Whose light each of the compared views shows: the document's own first, then its rivals'.
pub fn sides(rivals: &[Rival]) -> Vec<Of> {
    let mut tracks = 1..;
    let others = rivals.iter().map(|rival| match rival.runs() {
        true => Of::Track(tracks.next().unwrap_or_default()),
        false => Of::Truth,
    });
    std::iter::once(Of::Track(0)).chain(others).collect()
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

/// A propagator in a few words, as titles and legends have it.
fn describe(propagation: &Propagation) -> String {
    let clamp = if propagation.clamp { "" } else { ", no clamp" };
    let levels = match propagation.levels {
        Policy::Same => "",
        Policy::Consistent => ", consistent",
        Policy::Exact => ", exact",
    };
    format!("{}, p = {}{levels}{clamp}", propagation.scheme, propagation.factor)
}

/// The bar over the compared views.
pub fn bar(lab: &mut Lab, ui: &mut Ui) {
    let latest = lab.progress.iteration;
    let compare = &mut lab.comparison;
    ui.horizontal_wrapped(|ui| {
        ui.selectable_value(&mut compare.sides, Sides::Propagators, "Propagators");
        ui.selectable_value(&mut compare.sides, Sides::Iterations, "Two iterations");
        ui.separator();
        let combo = ComboBox::from_id_salt("compared light").selected_text(compare.light.name()).width(96.0);
        let combo = combo.show_ui(ui, |ui| {
            for light in Light::ALL {
                ui.selectable_value(&mut compare.light, light, light.name());
            }
        });
        name(&combo.response, "Compared light");
        ui.checkbox(&mut compare.difference, "Difference").on_hover_text("Views of the others minus the first");
        if compare.sides == Sides::Iterations {
            ui.label("against");
            let field = DragValue::new(&mut compare.against).range(0..=latest).speed(0.1).prefix("k = ");
            name(&ui.add(field), "Compared iteration");
        }
    });
}

/// The propagators and references beside the document's own, in the scene's panel.
pub fn propagators(lab: &mut Lab, ui: &mut Ui) {
    let own = lab.document.preset.propagation.clone();
    let compare = &mut lab.comparison;
    ui.label(format!("A  {} (the preset's own)", describe(&own)));
    let mut gone = None;
    for (i, other) in compare.others.iter_mut().enumerate() {
        ui.push_id(("other", i), |ui| {
            if rival(ui, letter(i + 1), other, &own) {
                gone = Some(i);
            }
            warning(ui, lab.critical.exceeded(i + 1).filter(|_| matches!(other, Rival::Propagator(_))));
        });
    }
    if let Some(i) = gone {
        compare.others.remove(i);
    }
    let room = compare.others.len() + 1 < MOST;
    let add = egui::Button::new("Add propagator or reference");
    if ui.add_enabled(room, add).clicked() {
        compare.add(&own);
    }
}

/// The fields of one rival; true where it is to go.
fn rival(ui: &mut Ui, letter: char, rival: &mut Rival, own: &Propagation) -> bool {
    let full = |what: &str| format!("Propagator {letter} {what}");
    let gone = ui.horizontal(|ui| {
        ui.strong(format!("{letter}"));
        let combo = ComboBox::from_id_salt("scheme").selected_text(rival.choice()).width(118.0);
        let combo = combo.show_ui(ui, |ui| {
            for scheme in transport::names() {
                if ui.selectable_label(rival.choice() == scheme, scheme).clicked() {
                    let like = if let Rival::Propagator(propagation) = &*rival { propagation } else { own };
                    *rival = Rival::Propagator(Propagation { scheme: scheme.to_owned(), ..like.clone() });
                }
            }
            ui.separator();
            for (reference, about) in [
                (Rival::Uniform, "A's propagator on the finest level alone: what the octree costs"),
                (Rival::Ballistic, "Light along straight lines: what the propagator costs"),
            ] {
                let text = reference.choice().to_owned();
                ui.selectable_value(rival, reference, text).on_hover_text(about);
            }
        });
        name(&combo.response, &full("scheme"));
        if let Rival::Propagator(propagation) = rival {
            let factor = DragValue::new(&mut propagation.factor).range(0.0..=100.0);
            let factor = factor.speed(0.01).max_decimals(6).prefix("p = ");
            name(&ui.add(factor).on_hover_text("The propagation factor"), &full("factor"));
        }
        controls::small_button(ui, "✖", &format!("Remove propagator {letter}")).clicked()
    });
    if let Rival::Propagator(propagation) = rival {
        ui.horizontal(|ui| {
            ui.add_space(16.0);
            let mut consistent = propagation.levels == Policy::Consistent;
            let levels = ui.checkbox(&mut consistent, "Consistent levels");
            name(
                &levels.on_hover_text("Levels that agree, in place of one factor for all"),
                &full("consistent levels"),
            );
            propagation.levels = if consistent { Policy::Consistent } else { Policy::Same };
            name(&ui.checkbox(&mut propagation.clamp, "Clamp"), &full("clamp"));
        });
    }
    gone.inner
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
