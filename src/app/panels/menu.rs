//! The menus, the window's title and the keyboard reference.

use egui::{Button, Context, MenuBar, RichText, Ui};

use crate::app::lab::Lab;
use crate::app::panels::closing::Next;
use crate::app::session::command::Command;
use crate::scene::builtin;

impl Lab {
    pub(in crate::app) fn menu(&mut self, ui: &mut Ui) {
        MenuBar::new().ui(ui, |ui| {
            ui.menu_button("File", |ui| {
                self.items(ui, &[Command::Open]);
                ui.menu_button("Built-in presets", |ui| {
                    for (name, _) in builtin::PRESETS {
                        if ui.button(*name).clicked() {
                            self.ask_to_lose(Next::BuiltIn((*name).to_owned()), ui.ctx());
                        }
                    }
                });
                ui.add_enabled_ui(!self.settings.recent.is_empty(), |ui| {
                    ui.menu_button("Recent presets", |ui| {
                        for path in self.settings.recent.clone() {
                            if ui.button(path.display().to_string()).clicked() {
                                self.ask_to_lose(Next::Open(path), ui.ctx());
                            }
                        }
                    });
                });
                ui.separator();
                self.items(ui, &[Command::Save, Command::SaveAs]);
                ui.separator();
                self.items(ui, &[Command::ExportCsv, Command::ExportSvg, Command::ExportPng, Command::ExportGrids]);
                ui.menu_button("Size and colours of exports", |ui| self.settings.plots.format.ui(ui));
                ui.separator();
                self.items(ui, &[Command::Quit]);
            });
            ui.menu_button("Edit", |ui| {
                self.items(ui, &[Command::Undo, Command::Redo]);
                ui.separator();
                self.items(ui, &[Command::CopyCurves, Command::CopyPlots, Command::CopyGrids]);
            });
            ui.menu_button("Run", |ui| {
                let steps = [Command::Clear, Command::Inject, Command::Downsample, Command::Propagate, Command::Merge];
                self.items(ui, &steps);
                ui.separator();
                self.items(ui, &[Command::RunAll, Command::Rerun, Command::Play, Command::Stop, Command::KeepRun]);
                self.items(ui, &[Command::Measure]);
                ui.separator();
                ui.checkbox(&mut self.settings.rerun, "Run again after every edit");
            });
            ui.menu_button("View", |ui| {
                self.items(ui, &[Command::Grids, Command::Compare, Command::Space]);
                ui.separator();
                self.items(ui, &[Command::Errors, Command::Line, Command::RunTime]);
                ui.separator();
                self.items(ui, &[Command::Merged, Command::Finer, Command::Coarser]);
                ui.separator();
                self.items(ui, &[Command::NextAxis, Command::SliceDown, Command::SliceUp, Command::WholeSlice]);
                ui.separator();
                self.items(ui, &[Command::First, Command::Back, Command::Forward, Command::Last, Command::Restart]);
                ui.separator();
                egui::widgets::global_theme_preference_buttons(ui);
            });
            ui.menu_button("Help", |ui| self.items(ui, &[Command::Keys]));
        });
    }

    /// Menu lines with their keys.
    pub(in crate::app) fn items(&mut self, ui: &mut Ui, commands: &[Command]) {
        for command in commands {
            let keys = command.shortcut().map(|keys| ui.ctx().format_shortcut(&keys)).unwrap_or_default();
            let item = Button::new(command.name()).shortcut_text(keys);
            if ui.add_enabled(self.can(*command), item).on_hover_text(command.explanation()).clicked() {
                let ctx = ui.ctx().clone();
                self.perform(*command, &ctx);
            }
        }
    }

    /// The window's title tells the document, and whether it is saved.
    pub(in crate::app) fn name_window(&mut self, ctx: &Context) {
        let mark = if self.document.is_saved() { "" } else { " (edited)" };
        let title = format!("{}{mark} – lpv-lab", self.document.name());
        if self.window_title != title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.window_title = title;
        }
    }

    pub(in crate::app) fn keys(&mut self, ctx: &Context) {
        let mut open = self.keys_open;
        let window = egui::Window::new("Keyboard reference").open(&mut open).resizable(false).default_width(420.0);
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
        self.keys_open = open;
    }
}
