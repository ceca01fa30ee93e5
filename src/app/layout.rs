//! How the window is laid out: bars above, the scene to the left, light in the middle, errors below.

use egui::{Button, CentralPanel, Context, Frame, Margin, MenuBar, Panel, RichText, Ui};

use super::closing::Next;
use super::command::Command;
use super::compare::{Sides, letter};
use super::controls::{self, Surroundings};
use super::glyphs::Scales;
use super::lab::Lab;
use super::look::{Layer, Light, Pane};
use super::view::Stage;
use super::{compare, inspector, legend, timeline, toolbar};
use crate::report::colour::Theme;
use crate::scene::builtin;

/// The report's colours for the window's theme.
pub fn theme(ctx: &Context) -> Theme {
    if ctx.global_style().visuals.dark_mode { Theme::DARK } else { Theme::LIGHT }
}

impl Lab {
    /// The whole window.
    pub fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        Panel::top("menu").show(ui, |ui| self.menu(ui));
        Panel::top("actions").show(ui, |ui| toolbar::actions(self, ui));
        Panel::bottom("foot").show(ui, |ui| self.foot(ui));
        Panel::left("scene").default_size(290.0).size_range(230.0..=480.0).show(ui, |ui| self.scene(ui));
        Panel::bottom("errors").default_size(230.0).size_range(90.0..=700.0).resizable(true).show(ui, |ui| {
            self.errors(ui);
        });
        Panel::bottom("timeline").show(ui, |ui| timeline::ui(self, ui));
        Panel::top("view").show(ui, |ui| toolbar::view(self, ui));
        let ground = Frame::central_panel(ui.style()).inner_margin(Margin::symmetric(8, 4));
        CentralPanel::default().frame(ground).show(ui, |ui| self.stage(ui));
        self.files.ui(ui, &self.settings.recent);
        self.keys(&ctx);
        self.closing(&ctx);
    }

    fn menu(&mut self, ui: &mut Ui) {
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
                ui.separator();
                self.items(ui, &[Command::Quit]);
            });
            ui.menu_button("Edit", |ui| self.items(ui, &[Command::Undo, Command::Redo, Command::CopyCurves]));
            ui.menu_button("Run", |ui| {
                let steps = [Command::Clear, Command::Inject, Command::Downsample, Command::Propagate, Command::Merge];
                self.items(ui, &steps);
                ui.separator();
                self.items(ui, &[Command::RunAll, Command::Rerun, Command::Play, Command::Stop, Command::KeepRun]);
                ui.separator();
                ui.checkbox(&mut self.settings.rerun, "Run again after every edit");
            });
            ui.menu_button("View", |ui| {
                self.items(ui, &[Command::Grids, Command::Compare, Command::Space]);
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
            ui.separator();
            let mark = if self.document.is_saved() { "" } else { " (edited)" };
            ui.label(RichText::new(format!("{}{mark}", self.document.name())).weak());
        });
    }

    /// Menu lines with their keys.
    fn items(&mut self, ui: &mut Ui, commands: &[Command]) {
        for command in commands {
            let keys = command.shortcut().map(|keys| ui.ctx().format_shortcut(&keys)).unwrap_or_default();
            let item = Button::new(command.name()).shortcut_text(keys);
            if ui.add_enabled(self.can(*command), item).on_hover_text(command.explanation()).clicked() {
                let ctx = ui.ctx().clone();
                self.perform(*command, &ctx);
            }
        }
    }

    fn scene(&mut self, ui: &mut Ui) {
        ui.add_space(4.0);
        self.stale_banner(ui);
        let around = Surroundings { axis: self.settings.view.axis(), placing: self.placing };
        if self.settings.view.stage == Stage::Compare {
            ui.label(RichText::new("Compared propagators").strong());
            compare::propagators(self, ui);
            ui.separator();
        }
        let wish = controls::ui(ui, &mut self.document.preset, around);
        self.grant(wish);
    }

    /// Says that the results are of another scene, and offers to run again.
    fn stale_banner(&mut self, ui: &mut Ui) {
        let problem = self.document.preset.check().err().map(|problem| problem.to_string());
        if problem.is_none() && !self.is_stale() {
            return;
        }
        Frame::group(ui.style()).fill(ui.visuals().faint_bg_color).show(ui, |ui| {
            ui.set_width(ui.available_width());
            if let Some(problem) = problem {
                ui.colored_label(ui.visuals().error_fg_color, problem);
                return;
            }
            ui.label(RichText::new("The scene was edited after this run.").color(ui.visuals().warn_fg_color));
            ui.horizontal(|ui| toolbar::button(self, ui, Command::Rerun));
            ui.checkbox(&mut self.settings.rerun, "Run again after every edit");
        });
        ui.add_space(4.0);
    }

    fn stage(&mut self, ui: &mut Ui) {
        let theme = theme(ui.ctx());
        let scales = Scales::of(&self.settings.view, &self.shown);
        Panel::bottom("legend").show_separator_line(false).frame(Frame::NONE).show(ui, |ui| {
            legend::ui(ui, &self.settings.view, &scales, &self.shown, &theme);
        });
        match self.settings.view.stage {
            Stage::Grids => self.flat(ui, &theme, &scales),
            Stage::Compare => {
                compare::bar(self, ui);
                self.flat(ui, &theme, &scales);
            }
            Stage::Space => self.space(ui, &theme, &scales),
        }
    }

    fn flat(&mut self, ui: &mut Ui, theme: &Theme, scales: &Scales) {
        let titles: Vec<String> = self.shown.iter().map(|shown| self.title(shown)).collect();
        let marks = self.marks(theme);
        let view = &self.settings.view;
        self.pointed = self.grids.ui(ui, &self.shown, &titles, view, theme, scales, &marks);
        if let Some(pointed) = self.pointed {
            if pointed.double_clicked {
                self.pick(pointed);
            } else if pointed.clicked {
                self.click(pointed);
            }
        }
    }

    /// The light in space, with the slice beside it.
    fn space(&mut self, ui: &mut Ui, theme: &Theme, scales: &Scales) {
        ui.horizontal_wrapped(|ui| {
            for light in Light::ALL {
                ui.selectable_value(&mut self.comparison.light, light, light.name());
            }
            ui.separator();
            let eye = &mut self.space.eye;
            ui.selectable_value(&mut eye.lobes, false, "Cubes");
            ui.selectable_value(&mut eye.lobes, true, "Lobes");
            ui.separator();
            ui.label("from");
            let threshold = egui::DragValue::new(&mut eye.threshold).range(0.0..=1.0).speed(0.001).max_decimals(4);
            let threshold =
                ui.add(threshold).on_hover_text("The share of the strongest light below which cells are left out");
            controls::name(&threshold, "Threshold");
            if let Some(cloud) = &self.cloud {
                let left_out = if cloud.left_out > 0 {
                    format!(", {} weaker ones left out", cloud.left_out)
                } else {
                    String::new()
                };
                ui.label(format!(
                    "of the strongest c00 = {}:  {} cells{left_out}",
                    legend::number(cloud.strongest),
                    cloud.cells.len()
                ));
            }
        });
        let side = ui.available_height().min(ui.available_width() * 0.4);
        Panel::right("slice beside").show_separator_line(false).exact_size(side).frame(Frame::NONE).show(ui, |ui| {
            self.flat(ui, theme, scales);
        });
        if let Some(cloud) = self.cloud.clone() {
            self.space.ui(ui, &cloud, &self.settings.view, theme);
        }
    }

    pub(super) fn title(&self, shown: &super::look::Shown) -> String {
        let Pane { light, state, minus } = shown.pane;
        let symbol = light.symbol(shown.iteration);
        let forgotten = if shown.forgotten { " (iteration no longer kept)" } else { "" };
        let by_propagators = self.comparison.sides == Sides::Propagators;
        match (self.settings.view.stage, minus) {
            (Stage::Compare, None) if by_propagators => {
                let name = self.runs.get(state.track).map_or("", |run| run.name.as_str());
                format!("{}  {name}:  {symbol}{forgotten}", letter(state.track))
            }
            (Stage::Compare, Some(other)) if by_propagators => {
                format!("{} − {}:  difference of {symbol}", letter(state.track), letter(other.track))
            }
            (Stage::Compare, Some(other)) => {
                format!("k = {} minus k = {}", shown.iteration, other.iteration.unwrap_or(self.progress.iteration))
            }
            (Stage::Compare, None) => format!("k = {}:  {} {symbol}{forgotten}", shown.iteration, light.name()),
            _ => format!("{}  {symbol}{forgotten}", light.name()),
        }
    }

    fn errors(&mut self, ui: &mut Ui) {
        let theme = theme(ui.ctx());
        let seen = self.seen();
        ui.horizontal(|ui| {
            ui.label(RichText::new("Errors").strong());
            let runs: Vec<&super::errors::Run> = self.runs.iter().chain(&self.kept).collect();
            self.settings.plots.controls(ui, &runs);
            ui.separator();
            toolbar::button(self, ui, Command::KeepRun);
            if !self.kept.is_empty()
                && ui.button("Forget kept").on_hover_text("Drop the curves of earlier runs").clicked()
            {
                self.kept.clear();
            }
            ui.menu_button("Export", |ui| {
                self.items(ui, &[Command::ExportCsv, Command::ExportSvg, Command::ExportPng, Command::CopyCurves]);
            });
        });
        Panel::right("inspector").exact_size(250.0).resizable(false).show(ui, |ui| inspector::ui(self, ui, &theme));
        let runs: Vec<&super::errors::Run> = self.runs.iter().chain(&self.kept).collect();
        self.settings.plots.ui(ui, &runs, &theme, seen);
    }

    fn foot(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            if let Some(notice) = &self.notice {
                let ink = if notice.error { ui.visuals().error_fg_color } else { ui.visuals().text_color() };
                let label = ui.colored_label(ink, &notice.text);
                controls::name(&label, &notice.text);
                if ui.small_button("✖").on_hover_text("Dismiss").accessible_name("Dismiss the message").clicked() {
                    self.notice = None;
                }
                return;
            }
            let p = &self.progress;
            if let Some(change) = self.change {
                let lit = if change.newly_lit > 0 {
                    format!(", {} cells newly lit", change.newly_lit)
                } else {
                    String::new()
                };
                ui.label(format!("{}{lit} ({:.1} ms)", change.action, p.seconds * 1e3));
                ui.separator();
            }
            let mib = |bytes: usize| bytes as f64 / (1 << 20) as f64;
            let level = match self.settings.view.layer {
                Layer::Merged if !p.merged => "  ·  merged view is sampled live; Merge stores it",
                _ => "",
            };
            ui.label(format!(
                "n = {}, {} levels  ·  k = {}  ·  {} of {} cells lit  ·  light {:.1} MiB{level}",
                p.side,
                p.levels,
                p.iteration,
                p.lit,
                p.cells,
                mib(p.now_bytes),
            ));
            let waited = self.waiting.is_some_and(|since| ui.input(|input| input.time) - since > 0.3);
            if waited || p.until.is_some() {
                ui.spinner();
                if let Some(until) = p.until {
                    ui.label(format!("iteration {} of {until}", p.iteration));
                }
            }
        });
    }

    fn keys(&mut self, ctx: &Context) {
        let mut open = self.keys_open;
        egui::Window::new("Keyboard reference").open(&mut open).resizable(false).default_width(420.0).show(ctx, |ui| {
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
            });
        });
        self.keys_open = open;
    }
}
