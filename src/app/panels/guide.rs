//! What to look for in the preset that was opened, below the views until it is dismissed.

use egui::{Align, Label, Layout, RichText, Ui};

use super::button::small_button;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};

/// The paragraph.
pub fn ui(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let Some(guide) = &session.guide else { return };
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if small_button(ui, "✖", "Dismiss what to look for").clicked() {
            asks.ask(Ask::DismissGuide);
        }
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            ui.add(Label::new(RichText::new(format!("👁 {guide}")).small()).wrap());
        });
    });
}
