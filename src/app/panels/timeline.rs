//! The iterations so far, to be dragged through.

use egui::{DragValue, Slider, Ui};

use super::button::{button, named_button};
use super::field::{self, name};
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::command::Command;
use crate::app::session::settings::{PACE, PAST};

/// The time of a scene that moves, the timeline of iterations, and the memory that it takes.
pub fn ui(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    if let Some(times) = session.document.preset.times() {
        moment(ui, session, times, asks);
    }
    ui.horizontal(|ui| {
        for (command, picture) in [(Command::First, "⏮"), (Command::Back, "⏴")] {
            named_button(ui, session, command, picture, asks);
        }
        let play = if session.run.is_playing() { "⏸" } else { "▶" };
        named_button(ui, session, Command::Play, play, asks);
        for (command, picture) in [(Command::Forward, "⏵"), (Command::Last, "⏭")] {
            named_button(ui, session, command, picture, asks);
        }
        let looping = ui.selectable_label(session.settings.looping, "⟲");
        name(&looping.clone().on_hover_text(Command::Loop.tooltip(ui.ctx())), Command::Loop.name());
        if looping.clicked() {
            asks.command(Command::Loop);
        }
        let mut pace = session.settings.pace;
        let field = DragValue::new(&mut pace).range(PACE).speed(0.1).max_decimals(1).suffix(" /s");
        name(&field::add(ui, field).on_hover_text("Iterations a second while playing"), "Pace");
        asks.changed(&session.settings.pace, pace, Ask::Pace);
        let progress = &session.run.progress;
        let (oldest, latest) = (progress.oldest, progress.iteration);
        let mut seen = session.seen();
        // A narrow window has room for the slider alone.
        let room = ui.available_width();
        let memory = if room > 620.0 { 250.0 } else { 0.0 };
        ui.spacing_mut().slider_width = (room - memory - 190.0).max(60.0);
        let slider = Slider::new(&mut seen, oldest..=latest.max(oldest + 1)).prefix("k = ");
        let slider = ui.add_enabled(latest > 0, slider).on_hover_text("The iteration that is shown");
        name(&slider, "Iteration shown");
        if slider.changed() {
            asks.ask(Ask::Scrub(seen.min(latest)));
        }
        button(ui, session, Command::Restart, asks);
        if memory == 0.0 {
            return;
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let mut mib = session.settings.past_mib;
            let field = DragValue::new(&mut mib).range(PAST).speed(4.0).suffix(" MiB");
            let field = field::add(ui, field)
                .on_hover_text("The memory that past iterations may take; what does not fit is computed again");
            name(&field, "Memory for the past");
            asks.changed(&session.settings.past_mib, mib, Ask::Past);
            ui.label(format!("past: {:.0} of", progress.past_bytes as f64 / f64::from(1 << 20)));
        });
    });
}

/// The time of a scene in which light moves; another one is another run.
fn moment(ui: &mut Ui, session: &Session, [first, last]: [f64; 2], asks: &mut Asks) {
    ui.horizontal(|ui| {
        ui.label("Scene at");
        ui.spacing_mut().slider_width = (ui.available_width() - 140.0).max(60.0);
        let mut time = session.run.moment.unwrap_or(first).clamp(first, last);
        let slider = Slider::new(&mut time, first..=last).max_decimals(3).suffix(" s");
        let slider = ui.add_enabled(last > first, slider);
        name(&slider.clone().on_hover_text("When injectors are where their paths have them"), "Time of the scene");
        if slider.changed() {
            asks.ask(Ask::Moment(time));
        }
    });
}
