//! How the window is laid out: bars above, the scene to the left, light in the middle, errors below.

use egui::{CentralPanel, Frame, Margin, Panel, RichText, Ui};

use crate::app::lab::Lab;
use crate::app::panels::closing::Next;
use crate::app::panels::controls::{self, Surroundings};
use crate::app::panels::{compare, timeline, toolbar};
use crate::app::session::command::Command;
use crate::app::session::view::Stage;
use crate::app::worker::look::Layer;
use crate::scene::builtin;
use crate::transport::preset;

/// The height from which the plots have a size of their own, in points.
const TALL: f32 = 950.0;

impl Lab {
    /// The whole window.
    pub fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.name_window(&ctx);
        Panel::top("menu").show(ui, |ui| self.menu(ui));
        self.offer(ui);
        Panel::top("actions").show(ui, |ui| toolbar::actions(self, ui));
        Panel::bottom("foot").show(ui, |ui| self.foot(ui));
        Panel::left("scene").default_size(290.0).size_range(230.0..=480.0).show(ui, |ui| self.scene(ui));
        // A taller window has more to give to both, but glyphs need the most. What a window was given while it was
        // small is not what it is to have on a whole screen.
        let height = ui.available_height();
        let errors = (height * 0.36).max(200.0);
        let name = if height > TALL { "errors, tall" } else { "errors" };
        Panel::bottom(name).default_size(errors).size_range(90.0..=700.0).resizable(true).show(ui, |ui| {
            self.plots(ui);
        });
        Panel::bottom("timeline").show(ui, |ui| timeline::ui(self, ui));
        Panel::top("view").show(ui, |ui| toolbar::view(self, ui));
        let ground = Frame::central_panel(ui.style()).inner_margin(Margin::symmetric(8, 4));
        CentralPanel::default().frame(ground).show(ui, |ui| self.stage(ui));
        self.files.ui(ui, &self.settings.recent, &mut self.settings.plots.format);
        self.keys(&ctx);
        self.closing(&ctx);
    }

    /// The presets to choose from, and the document's file.
    fn presets(&mut self, ui: &mut Ui) {
        let line = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
        // From the right, so that the list takes what the buttons leave.
        ui.allocate_ui_with_layout(line, egui::Layout::right_to_left(egui::Align::Center), |ui| {
            toolbar::button(self, ui, Command::Save);
            toolbar::button(self, ui, Command::Open);
            let mark = if self.document.is_saved() { "" } else { " *" };
            let text = format!("{}{mark}", self.document.name());
            let list =
                egui::ComboBox::from_id_salt("presets").selected_text(text).width(ui.available_width()).truncate();
            let mut chosen = None;
            let list = list.show_ui(ui, |ui| {
                for (name, _) in builtin::PRESETS {
                    if ui.selectable_label(false, *name).clicked() {
                        chosen = Some(Next::BuiltIn((*name).to_owned()));
                    }
                }
            });
            controls::name(&list.response.on_hover_text("The presets that the program brings along"), "Preset");
            if let Some(next) = chosen {
                self.ask_to_lose(next, ui.ctx());
            }
        });
        ui.add_space(4.0);
    }

    fn scene(&mut self, ui: &mut Ui) {
        ui.add_space(4.0);
        self.presets(ui);
        self.stale_banner(ui);
        let exceeded = self.critical.exceeded(0);
        let around = Surroundings { axis: self.settings.view.axis(), placing: self.placing, exceeded };
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
        let fault = preset::check(&self.document.preset).err().map(|fault| fault.to_string());
        if fault.is_none() && !self.is_stale() {
            return;
        }
        Frame::group(ui.style()).fill(ui.visuals().faint_bg_color).show(ui, |ui| {
            ui.set_width(ui.available_width());
            if let Some(fault) = fault {
                ui.colored_label(ui.visuals().error_fg_color, fault);
                return;
            }
            ui.label(RichText::new("The scene was edited after this run.").color(ui.visuals().warn_fg_color));
            ui.horizontal(|ui| toolbar::button(self, ui, Command::Rerun));
            ui.checkbox(&mut self.settings.rerun, "Run again after every edit");
        });
        ui.add_space(4.0);
    }

    /// What went wrong, over the views.
    pub(in crate::app) fn fault(&mut self, ui: &mut Ui) {
        let Some(notice) = self.notice.clone().filter(|notice| notice.error) else { return };
        Frame::group(ui.style()).fill(ui.visuals().faint_bg_color).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    if controls::small_button(ui, "✖", "Dismiss the message").clicked() {
                        self.notice = None;
                    }
                    ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                        let label =
                            egui::Label::new(RichText::new(&notice.text).color(ui.visuals().error_fg_color)).wrap();
                        ui.add(label);
                    });
                });
            });
        });
    }

    fn foot(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            if let Some(notice) = self.notice.as_ref().filter(|notice| !notice.error) {
                ui.label(&notice.text);
                if controls::small_button(ui, "✖", "Dismiss the message").clicked() {
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
            let skipped = ui.label(format!("·  {:.0} % visited", 100.0 * p.work.share()));
            skipped.on_hover_text(format!(
                "{}. What the iterations so far left out cannot hold light yet, or has gone dark again, so the result \
                 is the same to the last bit",
                p.work
            ));
            let waited = self.waiting.is_some_and(|since| ui.input(|input| input.time) - since > 0.3);
            if waited || p.until.is_some() {
                match p.until {
                    Some(until) => {
                        let share = p.iteration as f32 / until.max(1) as f32;
                        let text = format!("{} of {until}", p.iteration);
                        let bar = ui.add(egui::ProgressBar::new(share).desired_width(140.0).text(text));
                        controls::name(&bar, "Progress of the run");
                        toolbar::button(self, ui, Command::Stop);
                    }
                    None => drop(ui.spinner()),
                }
            }
        });
    }
}
