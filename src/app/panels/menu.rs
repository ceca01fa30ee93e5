//! The menus.

use egui::{Button, MenuBar, Ui};

use super::format;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks, Next};
use crate::app::session::command::Command;
use crate::scene::builtin;

/// What can be taken home.
pub const EXPORTS: [Command; 7] = [
    Command::ExportCsv,
    Command::ExportSvg,
    Command::ExportPng,
    Command::ExportGrids,
    Command::ExportFilm,
    Command::ExportFrames,
    Command::ExportSheet,
];

/// The menu bar.
pub fn ui(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file(ui, session, asks));
        ui.menu_button("Edit", |ui| {
            items(ui, session, &[Command::Undo, Command::Redo], asks);
            ui.separator();
            items(ui, session, &[Command::CopyCurves, Command::CopyPlots, Command::CopyGrids], asks);
        });
        ui.menu_button("Run", |ui| run(ui, session, asks));
        ui.menu_button("View", |ui| view(ui, session, asks));
        ui.menu_button("Help", |ui| items(ui, session, &[Command::Palette, Command::Keys], asks));
    });
}

fn file(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    items(ui, session, &[Command::Open, Command::Gallery], asks);
    ui.menu_button("Built-in presets", |ui| {
        for (name, _) in builtin::PRESETS {
            if ui.button(*name).clicked() {
                asks.ask(Ask::Leave(Next::BuiltIn((*name).to_owned())));
            }
        }
    });
    let recent = &session.settings.recent;
    ui.add_enabled_ui(!recent.is_empty(), |ui| {
        ui.menu_button("Recent presets", |ui| {
            for path in recent {
                if ui.button(path.display().to_string()).clicked() {
                    asks.ask(Ask::Leave(Next::Open(path.clone())));
                }
            }
        });
    });
    ui.separator();
    items(ui, session, &[Command::Save, Command::SaveAs], asks);
    ui.separator();
    items(ui, session, &EXPORTS, asks);
    ui.menu_button("Size and colours of exports", |ui| {
        let mut plots = session.settings.plots.clone();
        format::ui(ui, &mut plots.format);
        asks.changed(&session.settings.plots, plots, |plots| Ask::Plots(Box::new(plots)));
    });
    ui.separator();
    items(ui, session, &[Command::Quit], asks);
}

fn run(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let steps = [Command::Clear, Command::Inject, Command::Downsample, Command::Propagate, Command::Merge];
    items(ui, session, &steps, asks);
    ui.separator();
    items(ui, session, &[Command::RunAll, Command::Rerun, Command::Play, Command::Stop, Command::KeepRun], asks);
    items(ui, session, &[Command::RunBefore, Command::RunAfter, Command::Measure], asks);
    ui.separator();
    rerun(ui, session, asks);
    device(ui, session, asks);
}

/// What iterates.
fn device(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let mut on_card = session.settings.on_card;
    ui.add_enabled(cfg!(feature = "gpu"), egui::Checkbox::new(&mut on_card, "Compute on the graphics card"))
        .on_hover_text("The light is the same to the last bit; what a card cannot do, the processor does, and says why")
        .on_disabled_hover_text("This program was built without the feature `gpu`");
    asks.changed(&session.settings.on_card, on_card, Ask::OnCard);
}

fn view(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let groups: [&[Command]; 6] = [
        &[Command::Grids, Command::Compare, Command::Space],
        &[Command::Errors, Command::Line, Command::RunTime],
        &[Command::Merged, Command::Finer, Command::Coarser, Command::NextPaint],
        &[Command::NextAxis, Command::SliceDown, Command::SliceUp, Command::WholeSlice],
        &[Command::First, Command::Back, Command::Forward, Command::Last, Command::Restart],
        &[Command::SplitPicture, Command::FalseColour, Command::RefineTruth],
    ];
    for group in groups {
        items(ui, session, group, asks);
        ui.separator();
    }
    items(ui, session, &[Command::FoldScene, Command::FoldPlots], asks);
    ui.separator();
    egui::widgets::global_theme_preference_buttons(ui);
}

/// Whether edits run again by themselves.
pub fn rerun(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let mut rerun = session.reruns();
    ui.checkbox(&mut rerun, "Run again after every edit")
        .on_hover_text("By themselves, edits of volumes up to 64³ are run again");
    asks.changed(&session.reruns(), rerun, Ask::Rerun);
}

/// Menu lines with their keys.
pub fn items(ui: &mut Ui, session: &Session, commands: &[Command], asks: &mut Asks) {
    for command in commands {
        let keys = command.shortcut().map(|keys| ui.ctx().format_shortcut(&keys)).unwrap_or_default();
        let item = Button::new(command.name()).shortcut_text(keys);
        if ui.add_enabled(session.can(*command), item).on_hover_text(command.explanation()).clicked() {
            asks.command(*command);
        }
    }
}
