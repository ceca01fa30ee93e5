//! Time against error, as `bench` measures it: `pareto.csv`, a plot, and the fastest way to each error.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

use super::CliError;
use super::console::{self, say};
use super::numbers::decimal;
use super::output::Folder;
use crate::report::colour::Theme;
use crate::report::pareto_figure::{self, Kind};
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
    for kind in Kind::all(&all) {
        let Kind { preset, size, expectation } = kind;
        say!("\nThe fastest way to each error, {preset}, n = {size}, against {}:", expectation.reference());
        console::print(format_args!("{}", table::pareto(&pareto::front(&kind.rows(&all))).to_text()));
    }
    let size = |plots: usize| [960, 320 * plots.max(1) as u32];
    let figure = pareto_figure::figure("Time against error", &all, Theme::LIGHT, size);
    folder.write_svg_and_png("pareto", &figure.to_svg())
}
