//! The panel where a scene is edited: volume, injectors, occluders, propagation.

mod field;
mod injectors;
mod occluders;
mod propagation;

use egui::{CollapsingHeader, Response, ScrollArea, Ui};

use field::choice;
pub use field::name;
pub use occluders::occluder;

use crate::report::slice::Axis;
use crate::scene::Preset;
use crate::scene::preset::LARGEST;
use crate::study::stability::outlook::Exceeded;

/// The largest volume that the list of sizes offers; larger ones can be opened from a file.
const LARGEST_OFFERED: usize = 256;

/// What the panel needs to know beside the preset.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    /// The axis that slices are cut across.
    pub axis: Axis,
    /// The injector that waits for a click in a view to be placed.
    pub placing: Option<usize>,
    /// The level whose critical factor the preset's exceeds.
    pub exceeded: Option<Exceeded>,
}

/// What the panel asks of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wish {
    /// Place this injector by a click in a view, or stop doing so.
    pub place: Option<Option<usize>>,
    /// Choose a file for this injector.
    pub injector_file: Option<usize>,
    /// Choose a file for this occluder.
    pub occluder_file: Option<usize>,
}

/// The whole panel.
pub fn ui(ui: &mut Ui, preset: &mut Preset, around: Surroundings) -> Wish {
    let mut wish = Wish::default();
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().slider_width = 110.0;
        section(ui, "Propagation", |ui| propagation::ui(ui, &mut preset.propagation, around.exceeded));
        let injectors = format!("Injectors ({})", preset.injectors.len());
        section(ui, &injectors, |ui| injectors::ui(ui, preset, around, &mut wish));
        let occluders = format!("Occluders ({})", preset.occluders.len());
        section(ui, &occluders, |ui| occluders::ui(ui, preset, &mut wish));
        section(ui, "Volume", |ui| volume(ui, preset));
    });
    wish
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
}

/// A small button with a picture for a name; `name` is what it is called aloud and in its tooltip.
pub fn small_button(ui: &mut Ui, picture: &str, name: &str) -> Response {
    ui.small_button(picture).on_hover_text(name).accessible_name(name)
}
