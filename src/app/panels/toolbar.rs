//! The two bars: the algorithm's actions, and how light is looked at.

use egui::{Button, ComboBox, DragValue, Ui};

use crate::app::lab::Lab;
use crate::app::panels::controls::name;
use crate::app::session::command::Command;
use crate::app::session::settings::{DECADES, FULL, PACE};
use crate::app::session::view::{Heat, Scaling, Stage, hue_name, paint_name};
use crate::app::worker::look::Layer;
use crate::report::colour::Paint;
use crate::report::glyph::Hue;
use crate::report::slice::Axis;

/// A command as a button.
pub fn button(lab: &mut Lab, ui: &mut Ui, command: Command) {
    named_button(lab, ui, command, command.name());
}

/// The same, with other words or a picture on it.
pub fn named_button(lab: &mut Lab, ui: &mut Ui, command: Command, label: &str) {
    let button = ui.add_enabled(lab.can(command), Button::new(label)).on_hover_text(command.tooltip(ui.ctx()));
    name(&button, command.name());
    if button.clicked() {
        let ctx = ui.ctx().clone();
        lab.perform(command, &ctx);
    }
}

/// The actions, in the algorithm's order.
pub fn actions(lab: &mut Lab, ui: &mut Ui) {
    ui.horizontal(|ui| {
        for step in [Command::Clear, Command::Inject, Command::Downsample, Command::Propagate, Command::Merge] {
            button(lab, ui, step);
        }
        ui.separator();
        button(lab, ui, Command::RunAll);
        let play = if lab.is_playing() { "⏸ Pause" } else { "▶ Play" };
        named_button(lab, ui, Command::Play, play);
        let pace = DragValue::new(&mut lab.settings.pace).range(PACE).speed(0.1).max_decimals(1).suffix(" /s");
        name(&ui.add(pace).on_hover_text("Iterations a second while playing"), "Pace");
        named_button(lab, ui, Command::Stop, "⏹ Stop");
        ui.separator();
        button(lab, ui, Command::Undo);
        button(lab, ui, Command::Redo);
    });
}

/// How light is looked at.
pub fn view(lab: &mut Lab, ui: &mut Ui) {
    ui.horizontal(|ui| {
        for (command, stage) in
            [(Command::Grids, Stage::Grids), (Command::Compare, Stage::Compare), (Command::Space, Stage::Space)]
        {
            let chosen = lab.settings.view.stage == stage;
            let tab = ui.selectable_label(chosen, command.name()).on_hover_text(command.tooltip(ui.ctx()));
            if tab.clicked() {
                let ctx = ui.ctx().clone();
                lab.perform(command, &ctx);
            }
        }
        ui.separator();
        let (levels, side) = (lab.progress.levels.max(1), lab.progress.side.max(1));
        let view = &mut lab.settings.view;
        let layers = std::iter::once(Layer::Merged).chain((0..levels).map(Layer::Level));
        combo(ui, "Level", 108.0, &view.layer.name(), |ui| {
            for layer in layers {
                ui.selectable_value(&mut view.layer, layer, layer.name());
            }
        });
        for axis in Axis::ALL {
            let (across, letter) = (axis.across(), Axis::name(axis.across()));
            let tab = ui.selectable_label(view.across == across, letter);
            let tab = tab.on_hover_text(format!("Cut across {letter} (A for the next axis)"));
            name(&tab, &format!("Cut across {letter}"));
            if tab.clicked() {
                view.across = across;
            }
        }
        let slice = DragValue::new(&mut view.index).range(0..=side - 1).speed(0.15).prefix("= ");
        name(&ui.add(slice).on_hover_text("Where to cut, in finest cells (Page Up, Page Down)"), "Slice index");
        ui.separator();
        scale(ui, view);
        ui.separator();
        ui.menu_button("Layers", |ui| {
            ui.set_min_width(190.0);
            layers_menu(ui, view);
        });
    });
}

fn combo(ui: &mut Ui, full_name: &str, width: f32, text: &str, content: impl FnOnce(&mut Ui)) {
    let combo = ComboBox::from_id_salt(full_name).selected_text(text).width(width);
    let response = combo.show_ui(ui, content).response.on_hover_text(full_name);
    name(&response, full_name);
}

fn scale(ui: &mut Ui, view: &mut crate::app::session::view::View) {
    combo(ui, "Glyph scale", 104.0, view.scaling.name(), |ui| {
        for scaling in Scaling::ALL {
            ui.selectable_value(&mut view.scaling, scaling, scaling.name());
        }
    });
    if view.scaling == Scaling::Log {
        let decades = DragValue::new(&mut view.decades).range(DECADES).speed(0.05).suffix(" decades").max_decimals(1);
        name(&ui.add(decades).on_hover_text("Powers of ten from a full glyph to none"), "Decades");
    }
    if view.scaling != Scaling::PerGlyph {
        ui.checkbox(&mut view.fit, "Fit").on_hover_text("The brightest glyph fills its cell");
        if !view.fit {
            let full = DragValue::new(&mut view.full).range(FULL).speed(0.002).max_decimals(6);
            name(&ui.add(full).on_hover_text("The intensity that fills a cell, per steradian"), "Full intensity");
        }
    }
    combo(ui, "Glyph colour", 112.0, paint_name(view.paint()), |ui| {
        for (i, paint) in Paint::ALL.into_iter().enumerate() {
            ui.selectable_value(&mut view.paint, i, paint_name(paint));
        }
    });
}

fn layers_menu(ui: &mut Ui, view: &mut crate::app::session::view::View) {
    ui.checkbox(&mut view.glyphs, "Glyphs");
    ui.checkbox(&mut view.negative, "Negative lobes").on_hover_text("What a clamp removes, in a colour of its own");
    ui.checkbox(&mut view.cells, "Cell edges");
    ui.checkbox(&mut view.levels, "Index volume").on_hover_text("Which level each finest cell is sampled from");
    ui.checkbox(&mut view.occluders, "Occluders");
    ui.separator();
    ui.label("Heat map");
    for heat in Heat::ALL {
        ui.radio_value(&mut view.heat, heat, heat.name());
    }
    ui.separator();
    ui.label("Light shown");
    for (i, hue) in Hue::ALL.into_iter().enumerate() {
        ui.radio_value(&mut view.hue, i, hue_name(hue));
    }
    ui.separator();
    ui.checkbox(&mut view.linked, "Zoom and pan together");
}
