//! The runs beside their curves, the best first: what the curves say at the iteration that is seen, in numbers.

use egui::{Align, Grid, Layout, RichText, ScrollArea, Sense, Ui, vec2};

use crate::app::draw::ink::color;
use crate::app::session::Session;
use crate::app::session::asides::flaws::{self, Flaws};
use crate::app::session::curves::Curves;
use crate::app::worker::look::Of;
use crate::report::colour::Theme;
use crate::study::error::ErrorRow;
use crate::study::expectation::Expectation;

/// How wide the table is, in points.
pub const WIDTH: f32 = 348.0;

/// The room for a run's name, in points.
const NAME: f32 = 104.0;

/// What the columns tell, and what that means.
const COLUMNS: [(&str, &str); 7] = [
    ("", ""),
    ("run", "The best first: the one with the least L1 ratio; ★ is what the others are held against"),
    ("L1", "Σ|O − Ô| / Σ|Ô|"),
    ("best fit", "The L1 ratio after the one scalar that fits best"),
    ("leak", "Light behind occluders over light there without them: 0 behind a wall that holds all back"),
    ("jump", "Where levels meet, the mean of |ln(S/S') − ln(U/U')| with U the uniform volume's: 0 is no jump"),
    ("ms", "An iteration takes this long, in the median of this run"),
];

/// A run in the table.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line<'a> {
    run: &'a Curves,
    /// Whether the others are held against it.
    star: bool,
    /// Its last errors up to the iteration that is seen, of all levels.
    row: Option<&'a ErrorRow>,
    /// What goes wrong with its light, once that is known.
    flaws: Option<Flaws>,
}

/// The table.
pub fn ui(ui: &mut Ui, session: &Session, theme: &Theme) {
    let lines = ranked(lines(session));
    let summary = session.metric().summary();
    ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
        Grid::new("ranked runs").num_columns(COLUMNS.len()).min_col_width(8.0).spacing([7.0, 2.0]).striped(true).show(
            ui,
            |ui| {
                for (name, about) in COLUMNS {
                    let about = if name == "L1" { format!("{about}. {summary}") } else { about.to_owned() };
                    ui.small(name).on_hover_text(about);
                }
                ui.end_row();
                let mut place = 0;
                for line in &lines {
                    place += usize::from(!line.star);
                    told(ui, line, place, theme);
                    ui.end_row();
                }
            },
        );
        if session.run.progress.side > flaws::UP_TO {
            ui.weak(RichText::new(format!("Leaks and jumps are found out up to {}³.", flaws::UP_TO)).small());
        }
    });
}

/// A row of the table.
fn told(ui: &mut Ui, line: &Line, place: usize, theme: &Theme) {
    let Line { run, star, row, flaws } = *line;
    let (dot, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
    ui.painter().circle_filled(dot.center(), 4.0, color(theme.curve(run.color)));
    let mark = if star { "★ " } else { "" };
    let text = egui::Label::new(RichText::new(format!("{mark}{}", run.name)).small()).truncate();
    let left = Layout::left_to_right(Align::Center);
    let label = ui.allocate_ui_with_layout(vec2(NAME, 14.0), left, |ui| {
        ui.set_width(NAME);
        ui.add(text)
    });
    let label = label.inner.on_hover_text(&run.name);
    let told = if star { format!("Star: {}", run.name) } else { format!("Rank {place}: {}", run.name) };
    label.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ListItem, true, &told));
    // The name of the run stands beside each number, for those who do not see the row.
    let cell = |ui: &mut Ui, column: usize, text: String| {
        let told = format!("{} of {}: {text}", COLUMNS[column].0, run.name);
        ui.small(text).widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &told));
    };
    cell(ui, 2, number(row.map(|row| row.l1_ratio)));
    cell(ui, 3, number(row.and_then(|row| row.l1_best_fit)));
    cell(ui, 4, share(flaws.and_then(|flaws| flaws.leak)));
    cell(ui, 5, share(flaws.and_then(|flaws| flaws.jump)));
    cell(ui, 6, run.milliseconds().map_or("–".to_owned(), |ms| format!("{ms:.2}")));
}

/// The runs with what is known of them.
fn lines(session: &Session) -> Vec<Line<'_>> {
    let (metric, level, seen) = (session.metric(), session.plots().level(), session.seen());
    let star = (metric == Expectation::Run).then(|| session.star());
    let present = session.run.curves.iter().enumerate().map(|(track, run)| Line {
        run,
        star: star == Some(Of::Track(track)),
        row: run.last(metric, level, seen),
        flaws: session.flaws().and_then(|flaws| flaws.get(track).copied()),
    });
    let kept = session.run.kept.iter();
    let kept = kept.map(|run| Line { run, star: false, row: run.last(metric, level, seen), flaws: None });
    present.chain(kept).collect()
}

/// What the others are held against, then they by their L1 ratio, least first; those of which nothing is known last.
fn ranked(mut lines: Vec<Line>) -> Vec<Line> {
    let l1 = |line: &Line| line.row.map_or(f64::INFINITY, |row| row.l1_ratio);
    lines.sort_by(|a, b| b.star.cmp(&a.star).then(l1(a).total_cmp(&l1(b))));
    lines
}

/// A number of which three digits tell all that there is to compare.
fn share(value: Option<f64>) -> String {
    value.filter(|value| value.is_finite()).map_or_else(|| "–".to_owned(), |value| format!("{value:.3}"))
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
        let names = |star: &str| {
            let line =
                |run| Line { run, star: run.name == star, row: run.last(Expectation::Merged, None, 7), flaws: None };
            let lines = ranked(runs.iter().map(line).collect());
            lines.iter().map(|line| line.run.name.clone()).collect::<Vec<_>>()
        };
        assert_eq!(names("none"), ["near", "far", "unknown"]);
        assert_eq!(names("far"), ["far", "near", "unknown"]);
        assert_eq!([None, Some(0.25), Some(1e14), Some(f64::NAN)].map(number), ["–", "0.2500", "1.0e14", "–"]);
    }
}
