//! The runs beside their curves, the best first: what the curves say at the iteration that is seen, in numbers.

use egui::{Align, Grid, RichText, ScrollArea, Sense, Ui, vec2};

use crate::app::draw::ink::color;
use crate::app::session::Session;
use crate::app::session::curves::Curves;
use crate::report::colour::Theme;
use crate::study::error::ErrorRow;

/// A run in the table.
#[derive(Clone, Debug, PartialEq)]
struct Line<'a> {
    run: &'a Curves,
    /// Its last errors up to the iteration that is seen, of all levels.
    row: Option<&'a ErrorRow>,
}

/// The table.
pub fn ui(ui: &mut Ui, session: &Session, theme: &Theme) {
    let metric = session.settings.plots.metric;
    let lines =
        ranked(session.run.all_curves(), |run| run.last(metric, session.settings.plots.level(), session.seen()));
    ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
        Grid::new("ranked runs").num_columns(5).spacing([8.0, 2.0]).striped(true).show(ui, |ui| {
            ui.small("");
            ui.small("run").on_hover_text("The best first: the one with the least L1 ratio");
            ui.small("L1").on_hover_text(format!("Σ|O − Ô| / Σ|Ô|, {}", metric.summary()));
            ui.small("best fit").on_hover_text("The L1 ratio after the one scalar that fits best");
            ui.small("ms").on_hover_text("An iteration takes this long, in the median of this run");
            ui.end_row();
            for (place, Line { run, row }) in lines.iter().enumerate() {
                let (dot, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
                ui.painter().circle_filled(dot.center(), 4.0, color(theme.curve(run.color)));
                let text = egui::Label::new(RichText::new(&run.name).small()).truncate().halign(Align::LEFT);
                let label = ui.add_sized([118.0, 14.0], text);
                let told = format!("Rank {}: {}", place + 1, run.name);
                label.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ListItem, true, &told));
                ui.small(number(row.map(|row| row.l1_ratio)));
                ui.small(number(row.and_then(|row| row.l1_best_fit)));
                ui.small(run.milliseconds().map_or("–".to_owned(), |ms| format!("{ms:.2}")));
                ui.end_row();
            }
        });
    });
}

/// The runs by their L1 ratio, least first; those of which nothing is known last.
fn ranked<'a>(runs: Vec<&'a Curves>, row: impl Fn(&'a Curves) -> Option<&'a ErrorRow>) -> Vec<Line<'a>> {
    let mut lines: Vec<Line> = runs.into_iter().map(|run| Line { run, row: row(run) }).collect();
    let l1 = |line: &Line| line.row.map_or(f64::INFINITY, |row| row.l1_ratio);
    lines.sort_by(|a, b| l1(a).total_cmp(&l1(b)));
    lines
}

fn number(value: Option<f64>) -> String {
    match value.filter(|value| value.is_finite()) {
        None => "–".to_owned(),
        Some(v) if v == 0.0 || (1e-3..1e3).contains(&v) => format!("{v:.4}"),
        Some(v) => format!("{v:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::expectation::Expectation;

    #[test]
    fn the_least_ratio_comes_first_and_what_is_not_known_last() {
        let row = |l1_ratio: f64| ErrorRow {
            iteration: 3,
            expectation: Expectation::Merged,
            level: None,
            absolute_mean: 0.0,
            absolute_max: 0.0,
            relative_mean: 0.0,
            relative_max: 0.0,
            l1_ratio,
            l1_best_fit: None,
            traced: None,
            undefined: 0,
        };
        let mut runs = ["far", "unknown", "near"].map(|name| Curves::new(name.to_owned(), 0));
        runs[0].rows = vec![row(0.5)];
        runs[2].rows = vec![row(0.1)];
        let lines = ranked(runs.iter().collect(), |run| run.last(Expectation::Merged, None, 7));
        assert_eq!(lines.iter().map(|line| line.run.name.as_str()).collect::<Vec<_>>(), ["near", "far", "unknown"]);
        assert_eq!([None, Some(0.25), Some(1e14), Some(f64::NAN)].map(number), ["–", "0.2500", "1.0e14", "–"]);
    }
}
