//! What is to be said: what went wrong over the views, and the rest at the window's foot.

use egui::{Align, Frame, Label, Layout, ProgressBar, RichText, Ui};

use super::button::{button, small_button};
use super::field::name;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::command::Command;
use crate::app::worker::look::Layer;
use crate::simulation::options::Stage;

/// What went wrong, over the views.
pub fn fault(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let Some(notice) = session.notice.as_ref().filter(|notice| notice.error) else { return };
    Frame::group(ui.style()).fill(ui.visuals().faint_bg_color).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if small_button(ui, "✖", "Dismiss the message").clicked() {
                    asks.ask(Ask::Dismiss);
                }
                ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                    ui.add(Label::new(RichText::new(&notice.text).color(ui.visuals().error_fg_color)).wrap());
                });
            });
        });
    });
}

/// The foot: a message, or how far the run is.
pub fn foot(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    ui.horizontal(|ui| {
        if let Some(notice) = session.notice.as_ref().filter(|notice| !notice.error) {
            ui.label(&notice.text);
            if small_button(ui, "✖", "Dismiss the message").clicked() {
                asks.ask(Ask::Dismiss);
            }
            return;
        }
        state(ui, session);
        progress(ui, session, asks);
        if !session.messages.is_empty() {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| history(ui, session));
        }
    });
}

/// What was said so far, the latest first.
fn history(ui: &mut Ui, session: &Session) {
    ui.menu_button("Messages", |ui| {
        ui.set_max_width(520.0);
        egui::ScrollArea::vertical().max_height(280.0).show(ui, |ui| {
            for notice in session.messages.iter().rev() {
                let ink = if notice.error { ui.visuals().error_fg_color } else { ui.visuals().text_color() };
                ui.add(Label::new(RichText::new(&notice.text).color(ink)).wrap());
            }
        });
    });
}

/// What the last action changed, and what there is.
fn state(ui: &mut Ui, session: &Session) {
    let p = &session.run.progress;
    if let Some(change) = session.run.change {
        let lit = if change.newly_lit > 0 { format!(", {} cells newly lit", change.newly_lit) } else { String::new() };
        let device = if session.settings.on_card { "card" } else { "processor" };
        ui.label(format!("{}{lit} ({:.1} ms, {device})", change.action, p.seconds * 1e3));
        ui.separator();
    }
    let stage = p.stage.map_or_else(String::new, |Stage { level, done, each }| {
        format!(" ({done} of {each} on level {level}, {}³)", p.side >> level)
    });
    let level = match session.settings.view.layer {
        Layer::Merged if !p.merged => "  ·  merged view is sampled live; Merge stores it",
        _ => "",
    };
    ui.label(format!(
        "n = {}, {} levels  ·  k = {}{stage}  ·  {} of {} cells lit  ·  light {:.1} MiB{level}",
        p.side,
        p.levels,
        p.iteration,
        p.lit,
        p.cells,
        p.now_bytes as f64 / f64::from(1 << 20),
    ));
    let skipped = ui.label(format!("·  {:.0} % visited", 100.0 * p.work.share()));
    skipped.on_hover_text(format!(
        "{}. What the iterations so far left out cannot hold light yet, or has gone dark again, so the result is the \
         same to the last bit",
        p.work
    ));
}

/// How far the run is, while it lasts longer than the eye waits.
fn progress(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let p = &session.run.progress;
    let waited = session.run.waiting.is_some_and(|since| ui.input(|input| input.time) - since > 0.3);
    match p.until {
        Some(until) => {
            let share = p.iteration as f32 / until.max(1) as f32;
            let text = format!("{} of {until}", p.iteration);
            let bar = ui.add(ProgressBar::new(share).desired_width(140.0).text(text));
            name(&bar, "Progress of the run");
            button(ui, session, Command::Stop, asks);
        }
        None if waited => drop(ui.spinner()),
        None => {}
    }
}
