//! What is compared: the bar over the views, and the list of propagators and references.

use egui::{ComboBox, DragValue, Label, RichText, Ui};

use super::button::small_button;
use super::field::{self, name};
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::comparison::{Comparison, MOST, Sides, letter};
use crate::app::worker::look::Light;
use crate::app::worker::rival::{Rival, describe};
use crate::scene::Propagation;
use crate::scene::propagation::Policy;
use crate::study::stability::outlook::Exceeded;
use crate::transport;

/// The bar over the compared views.
pub fn bar(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let latest = session.run.progress.iteration;
    let mut compare = session.comparison.clone();
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
        ui.checkbox(&mut compare.difference, "Difference")
            .on_hover_text("Views of the others minus the one with the star");
        if compare.sides == Sides::Iterations {
            ui.label("against");
            let field = DragValue::new(&mut compare.against).range(0..=latest).speed(0.1).prefix("k = ");
            name(&field::add(ui, field), "Compared iteration");
        }
    });
    asks.changed(&session.comparison, compare, Ask::Comparison);
}

/// The list of runs: the document's own and what runs beside it, with a star on the one that the others are held
/// against.
pub fn list(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let own = &session.document.preset.propagation;
    let mut compare = session.comparison.clone();
    ui.horizontal(|ui| {
        star(ui, 0, &mut compare);
        ui.add(Label::new(format!("A  {} (the preset's own)", describe(own))).truncate());
    });
    let mut gone = None;
    for i in 0..compare.others.len() {
        ui.push_id(("other", i), |ui| {
            if rival(ui, i, &mut compare, own) {
                gone = Some(i);
            }
            let warned = matches!(compare.others[i], Rival::Propagator(_));
            warning(ui, session.asides.exceeded(i + 1).filter(|_| warned));
        });
    }
    if let Some(i) = gone {
        compare.remove(i);
    }
    let room = compare.others.len() + 1 < MOST;
    let add = egui::Button::new("Add propagator or reference");
    if ui.add_enabled(room, add).on_hover_text("Runs beside the preset's own, on the same scene").clicked() {
        compare.add(&session.document.preset);
    }
    asks.changed(&session.comparison, compare, Ask::Comparison);
}

/// The star of a run: it is held against none, the others against it.
fn star(ui: &mut Ui, place: usize, compare: &mut Comparison) {
    let chosen = compare.star == place;
    let letter = letter(place);
    let button = ui.selectable_label(chosen, if chosen { "★" } else { "☆" });
    name(&button.clone().on_hover_text(format!("Hold the others against {letter}")), &format!("Star {letter}"));
    if button.clicked() {
        compare.star = place;
    }
}

/// The warning beneath a factor's field.
pub fn warning(ui: &mut Ui, exceeded: Option<Exceeded>) {
    let Some(Exceeded { level, side, critical }) = exceeded else { return };
    let text =
        format!("⚠ above {critical:.2}, the critical factor of level {level} ({side}³): its light grows without bound");
    ui.add(egui::Label::new(RichText::new(text).color(ui.visuals().warn_fg_color)).wrap());
}

/// The fields of the `i`-th rival; true where it is to go.
fn rival(ui: &mut Ui, i: usize, compare: &mut Comparison, own: &Propagation) -> bool {
    let letter = letter(i + 1);
    let full = |what: &str| format!("Propagator {letter} {what}");
    let gone = ui.horizontal(|ui| {
        star(ui, i + 1, compare);
        ui.strong(format!("{letter}"));
        let rival = &mut compare.others[i];
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
            name(&field::add(ui, factor).on_hover_text("The propagation factor"), &full("factor"));
        }
        small_button(ui, "✖", &format!("Remove propagator {letter}")).clicked()
    });
    if let Rival::Propagator(propagation) = &mut compare.others[i] {
        ui.horizontal(|ui| {
            ui.add_space(16.0);
            let mut consistent = propagation.levels == Policy::Consistent;
            let levels = ui.checkbox(&mut consistent, "Consistent levels");
            name(
                &levels.clone().on_hover_text("Levels that agree, in place of one factor for all"),
                &full("consistent levels"),
            );
            if levels.changed() {
                propagation.levels = if consistent { Policy::Consistent } else { Policy::Same };
            }
            name(&ui.checkbox(&mut propagation.clamp, "Clamp"), &full("clamp"));
        });
    }
    gone.inner
}
