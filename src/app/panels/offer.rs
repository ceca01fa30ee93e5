//! The bar that offers unsaved work of a window that crashed.

use egui::{Panel, RichText, Ui};

use crate::app::session::ask::{Ask, Asks, Next};

/// The bar; `offer` says what is offered.
pub fn ui(ui: &mut Ui, offer: &str, asks: &mut Asks) {
    Panel::top("recovery").show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            if ui.button("Recover").on_hover_text("Open it, to be looked at and saved").clicked() {
                asks.ask(Ask::Leave(Next::Recover));
            }
            if ui.button("Discard").on_hover_text("Delete it for good").clicked() {
                asks.ask(Ask::DiscardRecovered);
            }
            // Behind the buttons, so that these stay where they are while the work grows older.
            ui.label(RichText::new(offer).color(ui.visuals().warn_fg_color));
        });
    });
}
