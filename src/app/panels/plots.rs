//! The foot of the window: errors, light along a line, run time against error, and the inspector beside them.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Panel, PopupCloseBehavior, Ui};

use crate::app::draw::style::theme;
use crate::app::lab::Lab;
use crate::app::panels::errors::{Curves, Run, Tab};
use crate::app::panels::{controls, inspector, toolbar};
use crate::app::session::command::Command;
use crate::study::error::Metric;

/// A menu that stays open while things in it are chosen.
pub fn lasting_menu(ui: &mut Ui, text: &str, content: impl FnOnce(&mut Ui)) -> egui::Response {
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    MenuButton::new(text).config(config).ui(ui, content).0
}

/// A line of small text over a plot, no higher than it needs to be.
pub fn small_row(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    ui.spacing_mut().item_spacing.y = 2.0;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(4.0, 0.0);
        ui.spacing_mut().interact_size.y = 12.0;
        content(ui);
    });
}

/// A line over a plot that tells what its colours mean, where a legend within would lie over the points.
pub fn legend_row(ui: &mut Ui, entries: impl IntoIterator<Item = (egui::Color32, String)>) {
    small_row(ui, |ui| {
        for (ink, text) in entries {
            let (rect, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
            ui.painter().circle_filled(rect.center(), 3.5, ink);
            ui.small(text);
            ui.add_space(8.0);
        }
    });
}

impl Lab {
    pub(in crate::app) fn plots(&mut self, ui: &mut Ui) {
        let theme = theme(ui.ctx());
        ui.horizontal(|ui| {
            for (command, tab) in
                [(Command::Errors, Tab::Errors), (Command::Line, Tab::Line), (Command::RunTime, Tab::Pareto)]
            {
                let chosen = self.settings.plots.tab == tab;
                let label = ui.selectable_label(chosen, command.name()).on_hover_text(command.tooltip(ui.ctx()));
                if label.clicked() {
                    self.settings.plots.tab = tab;
                }
            }
            ui.separator();
            match self.settings.plots.tab {
                Tab::Errors => self.error_controls(ui),
                Tab::Line => self.line_controls(ui),
                Tab::Pareto => self.pareto_controls(ui),
            }
            ui.separator();
            lasting_menu(ui, "Export", |ui| self.export_menu(ui));
        });
        Panel::right("inspector").exact_size(292.0).resizable(false).show(ui, |ui| inspector::ui(self, ui, &theme));
        let now = self.seen();
        match self.settings.plots.tab {
            Tab::Errors => {
                let runs: Vec<&Run> = self.runs.iter().chain(&self.kept).collect();
                self.settings.plots.ui(ui, &Curves { runs: &runs, theme: &theme, now });
            }
            Tab::Line => self.line_plot(ui, &theme),
            Tab::Pareto => self.pareto_plot(ui, &theme),
        }
    }

    fn error_controls(&mut self, ui: &mut Ui) {
        self.settings.plots.controls(ui, self.progress.levels);
        toolbar::button(self, ui, Command::KeepRun);
        if !self.kept.is_empty() {
            lasting_menu(ui, "Kept runs", |ui| self.kept_runs(ui));
        }
        self.truth_progress(ui);
        // The present iteration alone is measured before the eye is there.
        if self.progress.until.is_none() && self.progress.behind > Metric::ALL.len() {
            ui.spinner();
            ui.label(format!("{} measurements to come", self.progress.behind));
        }
    }

    fn export_menu(&mut self, ui: &mut Ui) {
        self.items(ui, &[Command::ExportCsv, Command::ExportSvg, Command::ExportPng, Command::ExportGrids]);
        ui.separator();
        self.items(ui, &[Command::CopyCurves, Command::CopyPlots, Command::CopyGrids]);
        ui.separator();
        self.settings.plots.format.ui(ui);
    }

    /// The kept runs, to be named or dropped.
    fn kept_runs(&mut self, ui: &mut Ui) {
        let mut gone = None;
        for (i, run) in self.kept.iter_mut().enumerate() {
            ui.horizontal(|ui| {
                let edit = ui.add(egui::TextEdit::singleline(&mut run.name).desired_width(200.0));
                controls::name(&edit, &format!("Name of kept run {}", i + 1));
                if controls::small_button(ui, "✖", &format!("Drop kept run {}", i + 1)).clicked() {
                    gone = Some(i);
                }
            });
        }
        if let Some(i) = gone {
            self.kept.remove(i);
        }
    }
}
