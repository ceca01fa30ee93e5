//! What the error plots show, chosen over them.

use egui::{ComboBox, TextEdit, Ui};

use super::rows::lasting_menu;
use crate::app::panels::button::{button, small_button};
use crate::app::panels::field::name;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::command::Command;
use crate::app::session::curves::Curves;
use crate::app::session::plots::Plots;
use crate::report::error_figure::Measure;
use crate::study::expectation::Expectation;

/// The controls over the plots.
pub fn controls(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let mut plots = session.settings.plots.clone();
    choices(ui, &mut plots, session.run.progress.levels);
    asks.changed(&session.settings.plots, plots, |plots| Ask::Plots(Box::new(plots)));
    button(ui, session, Command::KeepRun, asks);
    if !session.run.kept.is_empty() {
        let mut kept = session.run.kept.clone();
        lasting_menu(ui, "Kept runs", |ui| kept_runs(ui, &mut kept));
        asks.changed(&session.run.kept, kept, Ask::Kept);
    }
    truth(ui, session, asks);
    // The present iteration alone is measured before the eye is there.
    let progress = &session.run.progress;
    if progress.until.is_none() && progress.behind > Expectation::ALL.len() {
        ui.spinner();
        ui.label(format!("{} measurements to come", progress.behind));
    }
}

/// Which errors are drawn; `levels` are those of the octree.
fn choices(ui: &mut Ui, plots: &mut Plots, levels: usize) {
    let chosen = plots.metric;
    let choice = ComboBox::from_id_salt("metric").selected_text(metric_name(chosen)).width(76.0).show_ui(ui, |ui| {
        // What needs a truth of the mesh stands in the Picture workspace.
        for metric in Expectation::ALL.into_iter().filter(|metric| !metric.needs_mesh()) {
            ui.selectable_value(&mut plots.metric, metric, metric_name(metric)).on_hover_text(about(metric));
        }
    });
    name(&choice.response.on_hover_text(about(chosen)), "Error metric");
    let text = |level: Option<usize>| level.map_or("All levels".to_owned(), |level| format!("Level {level}"));
    ui.add_enabled_ui(chosen.has_levels(), |ui| {
        let shown = text(plots.level());
        let choice = ComboBox::from_id_salt("error level").selected_text(shown).width(76.0).show_ui(ui, |ui| {
            for level in std::iter::once(None).chain((1..levels).map(Some)) {
                ui.selectable_value(&mut plots.level, level, text(level));
            }
        });
        name(&choice.response, "Error level");
    });
    let menu = lasting_menu(ui, "Curves", |ui| {
        for (measure, drawn) in Measure::ALL.into_iter().zip(&mut plots.groups) {
            ui.checkbox(drawn, measure.title());
        }
        ui.separator();
        ui.checkbox(&mut plots.average, "Average —").on_hover_text("Solid lines; of L1 ratios, as they are");
        ui.checkbox(&mut plots.maximum, "Maximum - -").on_hover_text("Broken lines; of L1 ratios, the best fit");
        ui.separator();
        ui.checkbox(&mut plots.log, "Log axis")
            .on_hover_text("A logarithmic vertical axis; errors of zero are left out");
    });
    menu.on_hover_text("Which errors are drawn, and how");
}

/// What the choice of a metric says.
fn metric_name(metric: Expectation) -> &'static str {
    if metric == Expectation::Run { "★ star" } else { metric.name() }
}

/// What a metric compares, in a line.
fn about(metric: Expectation) -> &'static str {
    match metric {
        Expectation::Run => "The merged light against the run with the star; of a lone run against its uniform volume",
        metric => metric.summary(),
    }
}

/// The kept runs, to be named or dropped.
fn kept_runs(ui: &mut Ui, kept: &mut Vec<Curves>) {
    let mut gone = None;
    for (i, run) in kept.iter_mut().enumerate() {
        ui.horizontal(|ui| {
            let edit = ui.add(TextEdit::singleline(&mut run.name).desired_width(200.0));
            name(&edit, &format!("Name of kept run {}", i + 1));
            if small_button(ui, "✖", &format!("Drop kept run {}", i + 1)).clicked() {
                gone = Some(i);
            }
        });
    }
    if let Some(i) = gone {
        kept.remove(i);
    }
}

/// How far what truly arrives is, and a way to call it off or begin again; nothing once it is known.
fn truth(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    if let Some(share) = session.asides.truth.share() {
        let bar = egui::ProgressBar::new(share as f32).desired_width(140.0).show_percentage();
        ui.label("Straight lines");
        name(&ui.add(bar), "Progress of the straight lines");
        let cancel = ui.button("Cancel").on_hover_text("Do without what truly arrives");
        name(&cancel, "Cancel the straight lines");
        if cancel.clicked() {
            asks.ask(Ask::SeekTruth(false));
        }
    } else if session.truth_is_given_up() {
        ui.label("What truly arrives was not computed.");
        if ui.button("Compute it").clicked() {
            asks.ask(Ask::SeekTruth(true));
        }
    }
}
