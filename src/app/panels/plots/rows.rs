//! Lines of small text and menus over plots.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{PopupCloseBehavior, Ui};

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
