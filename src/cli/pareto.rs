//! Time against error, as `bench` measures it: `pareto.csv`, a plot, and the fastest way to each error.

use std::io::IsTerminal;

use indicatif::ProgressBar;

use super::CliError;
use super::output::Folder;
use crate::report::colour::Theme;
use crate::report::plot::{Curve, Dash, Figure, Plot};
use crate::report::table;
use crate::study::pareto::{self, Plan, Row};

/// A propagation factor from the command line.
pub fn factor(text: &str) -> Result<f64, String> {
    let factor = text.parse().ok().filter(|p: &f64| p.is_finite() && *p >= 0.0);
    factor.ok_or_else(|| "a factor is a finite number, zero or more".to_owned())
}

/// Measures, prints what nothing beats, and writes the files.
pub fn run(plan: &Plan, folder: &Folder) -> Result<(), CliError> {
    let bar = if std::io::stderr().is_terminal() { ProgressBar::new_spinner() } else { ProgressBar::hidden() };
    let rows = pareto::measure(plan, |now| {
        bar.set_message(now.to_owned());
        bar.tick();
    })?;
    bar.finish_and_clear();
    let all: Vec<&Row> = rows.iter().collect();
    folder.write_table("pareto.csv", &table::pareto(&all))?;
    for (preset, size, reference) in kinds(&rows) {
        println!("\nThe fastest way to each error, {preset}, n = {size}, against {reference}:");
        print!("{}", table::pareto(&pareto::front(&of_kind(&rows, (preset, size, reference)))).to_text());
    }
    let largest = plan.sizes.iter().copied().max().unwrap_or_default();
    folder.write_svg_and_png("pareto", &figure(&rows, largest).to_svg())
}

/// What errors can be compared within: a scene, a size and a reference.
type Kind<'a> = (&'a str, usize, &'static str);

fn kinds(rows: &[Row]) -> Vec<Kind<'_>> {
    let mut kinds: Vec<Kind> = rows.iter().map(|row| (row.preset.as_str(), row.size, row.reference)).collect();
    kinds.sort_unstable();
    kinds.dedup();
    kinds
}

fn of_kind<'a>(rows: &'a [Row], kind: Kind) -> Vec<&'a Row> {
    rows.iter().filter(|row| (row.preset.as_str(), row.size, row.reference) == kind).collect()
}

/// Best-fit error over time at one size, a plot for each scene and reference: `cascaded` by each way, the
/// ordinates, and what nothing beats.
fn figure(rows: &[Row], size: usize) -> Figure {
    let plots = kinds(rows).into_iter().filter(|kind| kind.1 == size).map(|kind @ (preset, _, reference)| {
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
