//! Commands as buttons, with their names, tooltips and keys.

use egui::{Button, Response, Ui};

use super::field::name;
use crate::app::session::Session;
use crate::app::session::ask::Asks;
use crate::app::session::command::Command;

/// A command as a button.
pub fn button(ui: &mut Ui, session: &Session, command: Command, asks: &mut Asks) {
    named_button(ui, session, command, command.name(), asks);
}

/// The same, with other words or a picture on it.
pub fn named_button(ui: &mut Ui, session: &Session, command: Command, label: &str, asks: &mut Asks) {
    let button = ui.add_enabled(session.can(command), Button::new(label)).on_hover_text(command.tooltip(ui.ctx()));
    name(&button, command.name());
    if button.clicked() {
        asks.command(command);
    }
}

/// A small button for a command that folds a panel or opens it, with a triangle that shows which way.
pub fn fold_button(ui: &mut Ui, triangle: &str, command: Command, asks: &mut Asks) {
    let button = ui.small_button(triangle).on_hover_text(command.tooltip(ui.ctx()));
    name(&button, command.name());
    if button.clicked() {
        asks.command(command);
    }
}

/// A small button with a picture for a name; `name` is what it is called aloud and in its tooltip.
pub fn small_button(ui: &mut Ui, picture: &str, name: &str) -> Response {
    ui.small_button(picture).on_hover_text(name).accessible_name(name)
}
