//! How light is looked at: grids, comparison or space, which level, where it is cut, and how glyphs are drawn.

use egui::{ComboBox, DragValue, Ui};

use super::field::{self, name};
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::command::Command;
use crate::app::session::items::Tool;
use crate::app::session::settings::{DECADES, FULL};
use crate::app::session::view::{Fill, Heat, Scaling, Stage, View, hue_name, paint_name};
use crate::app::worker::look::Layer;
use crate::report::colour::Paint;
use crate::report::glyph::Hue;
use crate::report::slice::Axis;

/// The bar.
pub fn ui(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let mut view = session.settings.view.clone();
    ui.horizontal_wrapped(|ui| {
        for (command, stage) in
            [(Command::Grids, Stage::Grids), (Command::Compare, Stage::Compare), (Command::Space, Stage::Space)]
        {
            let tab = ui.selectable_label(view.stage == stage, command.name());
            if tab.on_hover_text(command.tooltip(ui.ctx())).clicked() {
                asks.command(command);
            }
        }
        ui.separator();
        tools(ui, session, asks);
        ui.separator();
        cut(ui, session, &mut view);
        ui.separator();
        scale(ui, &mut view);
        ui.separator();
        ui.menu_button("Layers", |ui| {
            ui.set_min_width(190.0);
            layers_menu(ui, &mut view);
        });
    });
    asks.changed(&session.settings.view, view, |view| Ask::View(Box::new(view)));
}

/// What the pointer does in the views.
fn tools(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    for (command, tool, picture) in [
        (Command::SelectTool, Tool::Select, "⬉"),
        (Command::LightTool, Tool::Light, "☀"),
        (Command::OccluderTool, Tool::Occluder, "⬛"),
        (Command::ProbeTool, Tool::Probe, "⌖"),
    ] {
        let button = ui.selectable_label(session.tool == tool, picture).on_hover_text(command.tooltip(ui.ctx()));
        name(&button, command.name());
        if button.clicked() {
            asks.command(command);
        }
    }
}

/// Which level, and where it is cut.
fn cut(ui: &mut Ui, session: &Session, view: &mut View) {
    let progress = &session.run.progress;
    let layers = std::iter::once(Layer::Merged).chain((0..progress.levels.max(1)).map(Layer::Level));
    combo(ui, "Level", 108.0, &view.layer.name(), |ui| {
        for layer in layers {
            ui.selectable_value(&mut view.layer, layer, layer.name());
        }
    });
    for axis in Axis::ALL {
        let letter = Axis::name(axis.across());
        let tab = ui.selectable_label(view.axis == axis, letter);
        let tab = tab.on_hover_text(format!("Cut across {letter} (A for the next axis)"));
        name(&tab, &format!("Cut across {letter}"));
        if tab.clicked() {
            view.axis = axis;
        }
    }
    let slice = DragValue::new(&mut view.index).range(0..=progress.side.max(1) - 1).speed(0.15).prefix("= ");
    name(&field::add(ui, slice).on_hover_text("Where to cut, in finest cells (Page Up, Page Down)"), "Slice index");
}

fn combo(ui: &mut Ui, full_name: &str, width: f32, text: &str, content: impl FnOnce(&mut Ui)) {
    let combo = ComboBox::from_id_salt(full_name).selected_text(text).width(width);
    let response = combo.show_ui(ui, content).response.on_hover_text(full_name);
    name(&response, full_name);
}

fn scale(ui: &mut Ui, view: &mut View) {
    combo(ui, "Glyph scale", 104.0, view.scaling.name(), |ui| {
        for scaling in Scaling::ALL {
            ui.selectable_value(&mut view.scaling, scaling, scaling.name());
        }
    });
    if view.scaling == Scaling::Log {
        let decades = DragValue::new(&mut view.decades).range(DECADES).speed(0.05).suffix(" decades").max_decimals(1);
        name(&field::add(ui, decades).on_hover_text("Powers of ten from a full glyph to none"), "Decades");
    }
    if view.scaling != Scaling::PerGlyph {
        combo(ui, "Brightest glyph", 112.0, view.fill.name(), |ui| {
            for fill in Fill::ALL {
                ui.selectable_value(&mut view.fill, fill, fill.name()).on_hover_text(fill.about());
            }
        });
        if view.fill == Fill::Fixed {
            let full = DragValue::new(&mut view.full).range(FULL).speed(0.002).max_decimals(6);
            name(
                &field::add(ui, full).on_hover_text("The intensity that fills a cell, per steradian"),
                "Full intensity",
            );
        }
    }
    combo(ui, "Glyph colour", 112.0, paint_name(view.paint), |ui| {
        for paint in Paint::ALL {
            ui.selectable_value(&mut view.paint, paint, paint_name(paint));
        }
    });
}

fn layers_menu(ui: &mut Ui, view: &mut View) {
    ui.checkbox(&mut view.glyphs, "Glyphs");
    ui.checkbox(&mut view.negative, "Negative lobes").on_hover_text("What a clamp removes, in a colour of its own");
    ui.checkbox(&mut view.flux, "Centre and flux")
        .on_hover_text("A dot in each cell's middle and a tick towards where its light goes, where there is room");
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
    ui.checkbox(&mut view.hues, "Hues in their own colours")
        .on_hover_text("Where glyphs tell directions, light that is not white is shown in its own colours");
    for hue in Hue::ALL {
        ui.radio_value(&mut view.hue, hue, hue_name(hue));
    }
    ui.separator();
    ui.checkbox(&mut view.linked, "Zoom and pan together");
}
