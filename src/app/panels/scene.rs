//! The panel where a scene is edited: presets, volume, injectors, occluders, propagation.

mod injectors;
mod occluders;
mod presets;
mod propagation;

use egui::{CollapsingHeader, ScrollArea, Ui};

use super::field::{self, choice};
use super::{menu, runs};
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::report::slice::Axis;
use crate::scene::Preset;
use crate::scene::preset::LARGEST;
use crate::study::stability::outlook::Exceeded;

/// The largest volume that the list of sizes offers; larger ones can be opened from a file.
const LARGEST_OFFERED: usize = 256;

/// What the panel needs to know beside the preset.
#[derive(Clone, Copy, Debug)]
struct Surroundings {
    /// The axis that slices are cut across.
    axis: Axis,
    /// The injector that waits for a click in a view to be placed.
    placing: Option<usize>,
    /// The level whose critical factor the preset's exceeds.
    exceeded: Option<Exceeded>,
}

/// The whole panel.
pub fn ui(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    ui.add_space(4.0);
    presets::ui(ui, session, asks);
    menu::rerun(ui, session, asks);
    ui.add_space(4.0);
    let around = Surroundings {
        axis: session.settings.view.axis,
        placing: session.placing,
        exceeded: session.asides.exceeded(0),
    };
    let mut preset = session.document.preset.clone();
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        let runs = format!("Runs ({})", session.comparison.others.len() + 1);
        section(ui, &runs, |ui| runs::list(ui, session, asks));
        edit(ui, &mut preset, around, asks);
    });
    asks.changed(&session.document.preset, preset, |preset| Ask::Preset(Box::new(preset)));
}

fn edit(ui: &mut Ui, preset: &mut Preset, around: Surroundings, asks: &mut Asks) {
    ui.spacing_mut().slider_width = 110.0;
    section(ui, "Propagation", |ui| {
        propagation::ui(ui, &mut preset.propagation, preset.size, around.exceeded);
    });
    let injectors = format!("Injectors ({})", preset.injectors.len());
    section(ui, &injectors, |ui| injectors::ui(ui, preset, around, asks));
    let occluders = format!("Occluders ({})", preset.occluders.len());
    section(ui, &occluders, |ui| occluders::ui(ui, preset, asks));
    section(ui, "Volume", |ui| volume(ui, preset));
}

fn section(ui: &mut Ui, title: &str, content: impl FnOnce(&mut Ui)) {
    // The count in a title changes; the section stays the same one.
    let salt: String = title.chars().take_while(|c| *c != ' ').collect();
    CollapsingHeader::new(egui::RichText::new(title).strong()).id_salt(salt).default_open(true).show_unindented(
        ui,
        |ui| {
            content(ui);
            ui.add_space(6.0);
        },
    );
}

fn volume(ui: &mut Ui, preset: &mut Preset) {
    field::row(ui, "Title", |ui| {
        let edit = egui::TextEdit::singleline(&mut preset.title).desired_width(f32::INFINITY);
        ui.add(edit).on_hover_text("What the preset is called")
    });
    let sizes = (0..).map(|i| 1usize << i).take_while(|size| *size <= LARGEST_OFFERED.max(preset.size).min(LARGEST));
    let sizes: Vec<usize> = sizes.collect();
    let before = preset.size;
    choice(ui, "Size n", "Cells along a side of the finest level", &mut preset.size, &sizes[1..], |n| format!("{n}³"));
    if preset.size < before {
        preset.coarsest = preset.coarsest.min(preset.size);
    }
    let coarsest: Vec<usize> = sizes.iter().copied().filter(|side| *side <= preset.size).collect();
    let hint = "The side of the last level; the thesis's GPU version stopped at 2³";
    choice(ui, "Coarsest level", hint, &mut preset.coarsest, &coarsest, |n| format!("{n}³"));
    preset.propagation.descent = preset.propagation.descent.fitted(preset.size);
}
