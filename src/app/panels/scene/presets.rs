//! The presets to choose from, and the document's file.

use egui::{Align, ComboBox, Layout, Ui};

use crate::app::panels::button::{button, fold_button};
use crate::app::panels::field::name;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks, Next};
use crate::app::session::command::Command;
use crate::scene::builtin;

/// The line.
pub fn ui(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let line = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
    // From the right, so that the list takes what the buttons leave.
    ui.allocate_ui_with_layout(line, Layout::right_to_left(Align::Center), |ui| {
        fold_button(ui, "⏴", Command::FoldScene, asks);
        button(ui, session, Command::Save, asks);
        button(ui, session, Command::Open, asks);
        // Before the name, where a long one does not cut it off.
        let mark = if session.document.is_saved() { "" } else { "⏺ " };
        let text = format!("{mark}{}", session.document.name());
        let list = ComboBox::from_id_salt("presets").selected_text(text).width(ui.available_width()).truncate();
        let list = list.show_ui(ui, |ui| {
            for (name, _) in builtin::PRESETS {
                if ui.selectable_label(false, *name).clicked() {
                    asks.ask(Ask::Leave(Next::BuiltIn((*name).to_owned())));
                }
            }
        });
        name(&list.response.on_hover_text("The presets that the program brings along"), "Preset");
    });
    ui.add_space(4.0);
}
