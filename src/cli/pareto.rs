//! Time against error, as `bench` measures it: `pareto.csv`, a plot, and the fastest way to each error.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

use super::CliError;
use super::console::{self, say};
use super::numbers::decimal;
use super::output::Folder;
use crate::report::colour::Theme;
use crate::report::plot::{Curve, Dash, Figure, Plot};
use crate::report::table;
use crate::scene::Problem;
use crate::study::pareto::{self, Row};

/// A propagation factor from the command line.
pub fn factor(text: &str) -> Result<f64, String> {
    let factor = Some(decimal(text)?).filter(|p| p.is_finite() && *p >= 0.0);
    factor.ok_or_else(|| "a factor is a finite number, zero or more".to_owned())
}

/// Measures every scene, prints what nothing beats, and writes the files.
pub fn run(scenes: &[(String, Problem)], rounds: usize, folder: &Folder) -> Result<(), CliError> {
    let terminal = std::io::stderr().is_terminal();
    let mut rows = Vec::new();
    for (i, (name, problem)) in scenes.iter().enumerate() {
        let bar = if terminal { ProgressBar::new(1000) } else { ProgressBar::hidden() };
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent} %") {
            bar.set_style(style);
        }
        bar.set_message(format!("{name}, n = {} ({} of {})", problem.size, i + 1, scenes.len()));
        let measured = pareto::measure(name, problem, rounds, &|share| {
            bar.set_position((1000.0 * share) as u64);
            true
        })?;
        rows.extend(measured.unwrap_or_default());
        bar.finish_and_clear();
    }
    let all: Vec<&Row> = rows.iter().collect();
    folder.write_table("pareto.csv", &table::pareto(&all))?;
    for kind in kinds(&rows) {
        let Kind { preset, size, reference } = kind;
        say!("\nThe fastest way to each error, {preset}, n = {size}, against {reference}:");
        console::print(format_args!("{}", table::pareto(&pareto::front(&of_kind(&rows, kind))).to_text()));
    }
    folder.write_svg_and_png("pareto", &figure(&rows).to_svg())
}

/// What errors can be compared within.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Kind<'a> {
    preset: &'a str,
    size: usize,
    reference: &'a str,
}

impl<'a> Kind<'a> {
    fn of(row: &'a Row) -> Self {
        Kind { preset: &row.preset, size: row.size, reference: row.reference }
    }
}

/// Every kind, in the order of the rows.
fn kinds(rows: &[Row]) -> Vec<Kind<'_>> {
    let mut kinds = Vec::new();
    for kind in rows.iter().map(Kind::of) {
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    kinds
}

fn of_kind<'a>(rows: &'a [Row], kind: Kind<'_>) -> Vec<&'a Row> {
    rows.iter().filter(|row| Kind::of(row) == kind).collect()
}

/// Best-fit error over time, a plot for each scene (at its largest size) and reference: `cascaded` by each way, the
/// ordinates, and what nothing beats.
fn figure(rows: &[Row]) -> Figure {
    let largest = |kind: &Kind<'_>| rows.iter().all(|row| row.preset != kind.preset || row.size <= kind.size);
    let plots = kinds(rows).into_iter().filter(largest).map(|kind| {
        let Kind { preset, size, reference } = kind;
        let rows = of_kind(rows, kind);
        let point = |row: &&Row| [(row.seconds * 1e3).log10(), row.l1.fitted];
        let ways = ["uniform", "same", "consistent", "converged"];
        let mut curves: Vec<Curve> = vec![Curve {
            name: "what nothing beats".to_owned(),
            points: pareto::front(&rows).iter().map(point).collect(),
            color: 0,
            dash: Dash::Dotted,
        }];
        for (color, levels) in ways.into_iter().enumerate() {
            let ours = rows.iter().filter(|row| row.scheme == "cascaded" && row.levels == levels);
            let points = ours.map(point).collect();
            curves.push(Curve { name: format!("cascaded, {levels}"), points, color: color + 1, dash: Dash::Solid });
        }
        for (i, name) in ["ordinates-octahedral-donor", "ordinates-octahedral-faces"].into_iter().enumerate() {
            let ours = rows.iter().filter(|row| row.scheme.starts_with(name));
            let points = ours.map(point).collect();
            let color = ways.len() + 1 + i;
            curves.push(Curve { name: name.replace('-', ", "), points, color, dash: Dash::Solid });
        }
        curves.retain(|curve| !curve.points.is_empty());
        Plot {
            title: format!("{preset}, n = {size}, against {reference}"),
            x_label: "log₁₀ of the time in ms".to_owned(),
            y_label: "L1 error, best fit".to_owned(),
            log_y: true,
            curves,
            marks: Vec::new(),
        }
    });
    let plots: Vec<Plot> = plots.collect();
    let height = 320 * plots.len().max(1) as u32;
    Figure { title: "Time against error".to_owned(), plots, theme: Theme::LIGHT, size: [960, height] }
}
