//! The iterations so far, to be dragged through.

use egui::{DragValue, Slider, Ui};

use crate::app::lab::Lab;
use crate::app::panels::controls::name;
use crate::app::panels::toolbar;
use crate::app::session::command::Command;
use crate::app::session::settings::PAST;

/// The timeline and the memory that it takes.
pub fn ui(lab: &mut Lab, ui: &mut Ui) {
    ui.horizontal(|ui| {
        for (command, picture) in
            [(Command::First, "⏮"), (Command::Back, "⏴"), (Command::Forward, "⏵"), (Command::Last, "⏭")]
        {
            toolbar::named_button(lab, ui, command, picture);
        }
        let (oldest, latest) = (lab.progress.oldest, lab.progress.iteration);
        let mut seen = lab.seen();
        let memory = 250.0;
        ui.spacing_mut().slider_width = (ui.available_width() - memory - 190.0).max(60.0);
        let slider = Slider::new(&mut seen, oldest..=latest.max(oldest + 1)).prefix("k = ");
        let slider = ui.add_enabled(latest > 0, slider).on_hover_text("The iteration that is shown");
        name(&slider, "Iteration shown");
        if slider.changed() {
            lab.scrub(seen.min(latest));
        }
        toolbar::button(lab, ui, Command::Restart);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let mut mib = lab.settings.past_mib;
            let field = DragValue::new(&mut mib).range(PAST).speed(4.0).suffix(" MiB");
            let field = ui
                .add(field)
                .on_hover_text("The memory that past iterations may take; what does not fit is computed again");
            name(&field, "Memory for the past");
            if field.changed() {
                lab.set_past(mib);
            }
            ui.label(format!("past: {:.0} of", lab.progress.past_bytes as f64 / f64::from(1 << 20)));
        });
    });
}
