//! The middle of the window: grids, comparison or the light in space.

use egui::{Frame, Panel, Ui};

use crate::app::draw::glyphs::Scales;
use crate::app::draw::grids::Manner;
use crate::app::draw::style::theme;
use crate::app::lab::Lab;
use crate::app::panels::compare::{Sides, letter, sides};
use crate::app::panels::{compare, controls, legend};
use crate::app::session::view::Stage;
use crate::app::worker::look::{Light, Of, Pane, Shown};
use crate::report::colour::Theme;

impl Lab {
    pub(in crate::app) fn stage(&mut self, ui: &mut Ui) {
        self.fault(ui);
        let theme = theme(ui.ctx());
        let scales = self.scales();
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

    /// The views' scales, found anew when the light or the way of looking changes.
    fn scales(&mut self) -> Scales {
        let view = &self.settings.view;
        match &self.scales {
            Some((known, scales)) if known == view => *scales,
            _ => {
                let scales = Scales::of(view, &self.shown);
                self.scales = Some((view.clone(), scales));
                scales
            }
        }
    }

    fn flat(&mut self, ui: &mut Ui, theme: &Theme, scales: &Scales) {
        let titles: Vec<String> = self.shown.iter().map(|shown| self.title(shown)).collect();
        let marks = self.marks(theme);
        let manner = Manner { view: &self.settings.view, theme, scales, marks: &marks };
        self.pointed = self.grids.ui(ui, &self.shown, &titles, &manner);
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

    pub(in crate::app) fn title(&self, shown: &Shown) -> String {
        let Pane { light, state, minus } = shown.pane;
        let symbol = light.letter(shown.iteration);
        let forgotten = if shown.forgotten { " (iteration no longer kept)" } else { "" };
        let by_propagators = self.comparison.sides == Sides::Propagators;
        let letter = |of: Of| letter(sides(&self.others).iter().position(|side| *side == of).unwrap_or_default());
        match (self.settings.view.stage, minus) {
            (Stage::Compare, None) if by_propagators => {
                let Of::Track(track) = state.of else {
                    return format!("{}  what truly arrives", letter(state.of));
                };
                let name = self.runs.get(track).map_or("", |run| run.name.as_str());
                format!("{}  {name}:  {symbol}{forgotten}", letter(state.of))
            }
            (Stage::Compare, Some(other)) if by_propagators => {
                let of = if shown.pane.moved() { "light that has moved".to_owned() } else { symbol };
                format!("{} − {}:  {of}", letter(state.of), letter(other.of))
            }
            (Stage::Compare, Some(other)) => {
                format!("k = {} minus k = {}", shown.iteration, other.iteration.unwrap_or(self.progress.iteration))
            }
            (Stage::Compare, None) => format!("k = {}:  {} {symbol}{forgotten}", shown.iteration, light.name()),
            _ => format!("{}  {}{forgotten}", light.name(), light.symbol(shown.iteration)),
        }
    }
}
