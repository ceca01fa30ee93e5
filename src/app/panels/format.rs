//! The choice of size and colours for exports.

use egui::{DragValue, Ui};

use crate::app::panels::field::{self, name};
use crate::app::session::format::{Format, SIDES, Size};

/// The controls.
pub fn ui(ui: &mut Ui, format: &mut Format) {
    ui.label("Size of pictures");
    for size in Size::ALL {
        ui.radio_value(&mut format.size, size, size.name());
    }
    ui.add_enabled_ui(format.size == Size::Own, |ui| {
        ui.horizontal(|ui| {
            ui.add_space(20.0);
            let [width, height] = &mut format.own;
            name(&field::add(ui, DragValue::new(width).range(SIDES).suffix(" px")), "Export width");
            ui.label("×");
            name(&field::add(ui, DragValue::new(height).range(SIDES).suffix(" px")), "Export height");
        });
    });
    ui.horizontal(|ui| {
        ui.label("Colours");
        ui.radio_value(&mut format.dark, false, "Light").on_hover_text("Dark on light, for paper");
        ui.radio_value(&mut format.dark, true, "Dark").on_hover_text("Light on dark, for a screen");
    });
}
