//! The foot of the window: errors, light along a line, run time against error.

mod curves;
mod errors;
mod line;
mod pareto;
mod rows;
mod table;

use egui::{Panel, Ui};

use self::rows::lasting_menu;
use super::button::fold_button;
use super::format;
use super::menu::{EXPORTS, items};
use crate::app::draw::style::theme;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::command::Command;
use crate::app::session::plots::Tab;

/// The width from which the runs are told in numbers beside their curves, in points.
const WIDE: f32 = 600.0;

/// The tabs, and what is chosen for the plot that is seen.
pub fn bar(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    ui.horizontal_wrapped(|ui| {
        fold_button(ui, "⏷", Command::FoldPlots, asks);
        let tab = session.settings.plots.tab;
        for (command, of) in
            [(Command::Errors, Tab::Errors), (Command::Line, Tab::Line), (Command::RunTime, Tab::Pareto)]
        {
            let label = ui.selectable_label(tab == of, command.name()).on_hover_text(command.tooltip(ui.ctx()));
            if label.clicked() {
                asks.command(command);
            }
        }
        ui.separator();
        match tab {
            Tab::Errors => errors::controls(ui, session, asks),
            Tab::Line => line::controls(ui, session, asks),
            Tab::Pareto => pareto::controls(ui, session, asks),
        }
        ui.separator();
        lasting_menu(ui, "Export", |ui| export(ui, session, asks));
    });
}

/// The plot that is seen, in all the room there is.
pub fn ui(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let theme = theme(ui.ctx());
    let plots = &session.plots();
    match plots.tab {
        Tab::Errors => {
            let runs = session.run.all_curves();
            if runs.len() > 1 && ui.available_width() > WIDE {
                Panel::right("ranked").exact_size(table::WIDTH).resizable(false).show(ui, |ui| {
                    table::ui(ui, session, &theme);
                });
            }
            curves::ui(ui, plots, &curves::Drawing { runs: &runs, theme: &theme, now: session.seen() });
        }
        Tab::Line => line::ui(ui, session, &theme),
        Tab::Pareto => pareto::ui(ui, session, &theme, asks),
    }
}

fn export(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    items(ui, session, &EXPORTS, asks);
    ui.separator();
    items(ui, session, &[Command::CopyCurves, Command::CopyPlots, Command::CopyGrids], asks);
    ui.separator();
    let mut plots = session.settings.plots.clone();
    format::ui(ui, &mut plots.format);
    asks.changed(&session.settings.plots, plots, |plots| Ask::Plots(Box::new(plots)));
}
