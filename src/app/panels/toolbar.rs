//! The algorithm's actions in their order, the state of the run in a place of its own, and the workspaces.

use egui::{Align, Color32, Label, Layout, RichText, Ui, vec2};

use super::button::{button, named_button};
use super::field::name;
use crate::app::session::Session;
use crate::app::session::ask::Asks;
use crate::app::session::command::Command;
use crate::app::session::view::Workspace;
use crate::transport::preset;

/// The width of the run's state, in points.
const STATE: f32 = 176.0;

/// The bar.
pub fn ui(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    ui.horizontal_wrapped(|ui| {
        workspaces(ui, session, asks);
        for step in [Command::Clear, Command::Inject, Command::Downsample, Command::Propagate, Command::Merge] {
            button(ui, session, step, asks);
        }
        ui.separator();
        button(ui, session, Command::RunAll, asks);
        button(ui, session, Command::Rerun, asks);
        named_button(ui, session, Command::Stop, "⏹ Stop", asks);
        state(ui, session);
        ui.separator();
        button(ui, session, Command::Undo, asks);
        button(ui, session, Command::Redo, asks);
    });
}

/// The workspaces, where there is more than one.
fn workspaces(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    if Workspace::FILLED.len() < 2 {
        return;
    }
    let commands = Command::ALL.iter().filter(|command| session.can(**command));
    for (command, workspace) in commands.filter_map(|command| Some((*command, command.workspace()?))) {
        let tab = ui.selectable_label(session.settings.workspace == workspace, workspace.name());
        let tab = tab.on_hover_text(command.tooltip(ui.ctx()));
        name(&tab, command.name());
        if tab.clicked() {
            asks.command(command);
        }
    }
    ui.separator();
}

/// What the run is doing: always there, so that nothing moves when it changes.
fn state(ui: &mut Ui, session: &Session) {
    let (text, ink, about) = told(ui, session);
    let size = vec2(STATE, ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_width(STATE);
        ui.add(Label::new(RichText::new(text).color(ink)).truncate()).on_hover_text(about);
    });
}

/// The state in a few words, its colour, and more about it.
fn told(ui: &Ui, session: &Session) -> (String, Color32, String) {
    let visuals = ui.visuals();
    let run = &session.run;
    if let Err(fault) = preset::check(&session.document.preset) {
        return (format!("✖ {fault}"), visuals.error_fg_color, fault.to_string());
    }
    if let Some(until) = run.progress.until {
        let about = "Iterations follow each other; Stop ends the run after the one in progress".to_owned();
        return (format!("▶ Running, {} of {until}", run.progress.iteration), visuals.text_color(), about);
    }
    if session.is_stale() {
        let about = "The scene was edited after this run. Run again takes the edits over".to_owned();
        return ("⚠ Edited since this run".to_owned(), visuals.warn_fg_color, about);
    }
    if run.is_playing() {
        return ("▶ Playing".to_owned(), visuals.text_color(), "Pause with P".to_owned());
    }
    ("⏺ Ready".to_owned(), visuals.weak_text_color(), "The results are of the scene as it is".to_owned())
}
