//! Side by side: other propagators on the same scene, stepped together, or two iterations of one run.

use egui::{ComboBox, DragValue, Ui};

use super::controls::{self, name};
use super::lab::Lab;
use super::look::{Light, Pane, State};
use crate::propagate;
use crate::propagate::levels::Policy;
use crate::scene::Propagation;

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
    /// Propagators beside the document's own.
    pub others: Vec<Propagation>,
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
    /// The views, with `at` the iteration that is seen. `tracks` propagators are running.
    pub fn panes(&self, at: Option<usize>, tracks: usize) -> Vec<Pane> {
        let pane = |state: State, minus: Option<State>| Pane { light: self.light, state, minus };
        let states: Vec<State> = match self.sides {
            Sides::Propagators => (0..tracks).map(|track| State { track, iteration: at }).collect(),
            Sides::Iterations => [at, Some(self.against)].map(|iteration| State { track: 0, iteration }).to_vec(),
        };
        let mut panes: Vec<Pane> = states.iter().map(|state| pane(*state, None)).collect();
        if self.difference {
            panes.extend(states.iter().skip(1).map(|state| pane(*state, Some(states[0]))));
        }
        panes
    }

    /// Adds a propagator: the next scheme that is not there yet.
    pub fn add(&mut self, own: &Propagation) {
        let used = |name: &str| own.scheme == name || self.others.iter().any(|other| other.scheme == name);
        let next = propagate::names().into_iter().find(|name| !used(name)).unwrap_or(propagate::names()[0]);
        self.others.push(Propagation { scheme: next.to_owned(), ..own.clone() });
    }
}

/// A propagator's name on screen, by its place among those that are compared.
pub fn letter(track: usize) -> char {
    char::from(b'A' + (track % 26) as u8)
}

/// A propagator in a few words, as titles and legends have it.
pub fn describe(propagation: &Propagation) -> String {
    let clamp = if propagation.clamp { "" } else { ", no clamp" };
    let levels = match propagation.levels {
        Policy::Same => "",
        Policy::Consistent => ", consistent",
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

/// The propagators beside the document's own, in the scene's panel.
pub fn propagators(lab: &mut Lab, ui: &mut Ui) {
    let own = lab.document.preset.propagation.clone();
    let compare = &mut lab.comparison;
    ui.label(format!("A  {} (the preset's own)", describe(&own)));
    let mut gone = None;
    for (i, other) in compare.others.iter_mut().enumerate() {
        ui.push_id(("other", i), |ui| {
            ui.horizontal(|ui| {
                ui.strong(format!("{}", letter(i + 1)));
                let combo = ComboBox::from_id_salt("scheme").selected_text(&other.scheme).width(96.0);
                let combo = combo.show_ui(ui, |ui| {
                    for name in propagate::names() {
                        ui.selectable_value(&mut other.scheme, name.to_owned(), name);
                    }
                });
                let full = |what: &str| format!("Propagator {} {what}", letter(i + 1));
                name(&combo.response, &full("scheme"));
                let factor =
                    DragValue::new(&mut other.factor).range(0.0..=100.0).speed(0.01).max_decimals(6).prefix("p = ");
                name(&ui.add(factor).on_hover_text("The propagation factor"), &full("factor"));
                let remove = format!("Remove propagator {}", letter(i + 1));
                if controls::small_button(ui, "✖", &remove).clicked() {
                    gone = Some(i);
                }
            });
            ui.horizontal(|ui| {
                let full = |what: &str| format!("Propagator {} {what}", letter(i + 1));
                ui.add_space(16.0);
                let mut consistent = other.levels == Policy::Consistent;
                let levels = ui.checkbox(&mut consistent, "Consistent levels");
                let levels = levels.on_hover_text("Levels that agree, in place of one factor for all");
                name(&levels, &full("consistent levels"));
                other.levels = if consistent { Policy::Consistent } else { Policy::Same };
                name(&ui.checkbox(&mut other.clamp, "Clamp"), &full("clamp"));
            });
        });
    }
    if let Some(i) = gone {
        compare.others.remove(i);
    }
    let room = compare.others.len() + 1 < MOST;
    if ui.add_enabled(room, egui::Button::new("Add propagator")).clicked() {
        compare.add(&own);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_from_the_first() {
        let compare = Comparison { light: Light::Source, ..Comparison::default() };
        let panes = compare.panes(Some(3), 3);
        let first = State { track: 0, iteration: Some(3) };
        let minus: Vec<Option<State>> = panes.iter().map(|pane| pane.minus).collect();
        assert_eq!(minus, [None, None, None, Some(first), Some(first)]);
        assert_eq!(panes.iter().map(|pane| pane.state.track).collect::<Vec<_>>(), [0, 1, 2, 1, 2]);
        let compare = Comparison { sides: Sides::Iterations, difference: false, against: 1, ..compare };
        let seen: Vec<_> = compare.panes(None, 3).iter().map(|pane| pane.state.iteration).collect();
        assert_eq!(seen, [None, Some(1)]);
    }

    #[test]
    fn propagators_that_are_added_differ_while_they_can() {
        let own = Propagation::default();
        let mut compare = Comparison::default();
        for (i, known) in propagate::names().into_iter().skip(1).enumerate() {
            compare.add(&own);
            assert_eq!(compare.others[i].scheme, known);
        }
    }
}
