//! The keyboard reference.

use egui::{Context, RichText};

use crate::app::session::command::Command;

/// The reference, while it is open.
pub fn ui(ctx: &Context, open: &mut bool) {
    let window = egui::Window::new("Keyboard reference").open(open).resizable(false).default_width(420.0);
    let middle = ctx.content_rect().center();
    window.pivot(egui::Align2::CENTER_CENTER).default_pos(middle).show(ctx, |ui| {
        egui::ScrollArea::vertical().max_height(480.0).show(ui, |ui| {
            egui::Grid::new("keys").num_columns(3).striped(true).show(ui, |ui| {
                for command in Command::ALL {
                    let Some(keys) = command.shortcut() else { continue };
                    ui.label(RichText::new(ui.ctx().format_shortcut(&keys)).monospace());
                    ui.label(command.name());
                    ui.label(RichText::new(command.explanation()).weak());
                    ui.end_row();
                }
            });
            ui.add_space(6.0);
            ui.label("In a view: scroll to zoom, drag to pan, click a cell to pin it.");
            ui.label("Double-click a cell to add a single injector, or to pick up the one that is there.");
            ui.label("In 3D: drag to orbit, Shift and drag to pan, scroll to zoom, double-click to reset.");
            ui.label("Drag a number to change it, or click it and type.");
            ui.label("Ctrl and + or − make everything larger or smaller.");
        });
    });
}
