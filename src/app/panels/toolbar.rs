//! The algorithm's actions, in their order.

use egui::Ui;

use super::button::{button, named_button};
use crate::app::session::Session;
use crate::app::session::ask::Asks;
use crate::app::session::command::Command;

/// The bar.
pub fn ui(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    ui.horizontal(|ui| {
        for step in [Command::Clear, Command::Inject, Command::Downsample, Command::Propagate, Command::Merge] {
            button(ui, session, step, asks);
        }
        ui.separator();
        button(ui, session, Command::RunAll, asks);
        named_button(ui, session, Command::Stop, "⏹ Stop", asks);
        ui.separator();
        button(ui, session, Command::Undo, asks);
        button(ui, session, Command::Redo, asks);
    });
}
