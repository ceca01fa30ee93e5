//! What is chosen over the light in space.

use egui::{DragValue, RichText, Ui};

use super::field::{self, name};
use super::legend;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::worker::look::Light;

/// The bar.
pub fn bar(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let (mut comparison, mut space) = (session.comparison.clone(), session.sight.space);
    ui.horizontal_wrapped(|ui| {
        for light in Light::ALL {
            ui.selectable_value(&mut comparison.light, light, light.name());
        }
        ui.separator();
        ui.selectable_value(&mut space.lobes, false, "Cubes");
        ui.selectable_value(&mut space.lobes, true, "Lobes");
        ui.separator();
        ui.label("from");
        let threshold = DragValue::new(&mut space.threshold).range(0.0..=1.0).speed(0.001).max_decimals(4);
        let threshold =
            field::add(ui, threshold).on_hover_text("The share of the strongest light below which cells are left out");
        name(&threshold, "Threshold");
        if let Some(cloud) = &session.sight.cloud {
            let strongest = legend::number(cloud.strongest);
            ui.label(format!("of the strongest c00 = {strongest}:  {} cells", cloud.cells.len()));
            if let Some((level, found)) = cloud.coarsened {
                let text = format!("level {level} is the finest shown: {found} cells are more than can be drawn");
                ui.label(RichText::new(text).color(ui.visuals().warn_fg_color));
            }
            if cloud.left_out > 0 {
                let text = format!("{} weaker ones left out", cloud.left_out);
                ui.label(RichText::new(text).color(ui.visuals().warn_fg_color));
            }
        }
    });
    asks.changed(&session.comparison, comparison, Ask::Comparison);
    asks.changed(&session.sight.space, space, Ask::Space);
}
