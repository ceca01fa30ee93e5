//! Iterating to the fixed point against solving for it, as `bench` measures it: a table and `converged.csv`.

use std::io::IsTerminal;

use indicatif::ProgressBar;

use super::CliError;
use super::console::{self, say};
use super::output::Folder;
use crate::report::table::Table;
use crate::study::race::{self, Plan};
use crate::transport::solve::NoFixedPoint;

/// The factors of `cascaded`: what the thesis uses, and NVIDIA's cascades.
const FACTORS: [f64; 2] = [3.0, 3.8];
/// The relative residual that both have to reach.
const TOLERANCE: f64 = 1e-4;

impl From<NoFixedPoint> for CliError {
    fn from(refusal: NoFixedPoint) -> Self {
        CliError::Failed(refusal.to_string())
    }
}

/// Measures, prints and writes the file.
pub fn run(sizes: Vec<usize>, rounds: usize, folder: &Folder) -> Result<(), CliError> {
    let bar = if std::io::stderr().is_terminal() { ProgressBar::new_spinner() } else { ProgressBar::hidden() };
    let plan = Plan { sizes, factors: FACTORS.to_vec(), tolerance: TOLERANCE, rounds };
    let rows = race::run(&plan, |now| {
        bar.set_message(now.to_owned());
        bar.tick();
    })?;
    bar.finish_and_clear();
    let mut table = Table::new([
        "scene",
        "size",
        "factor",
        "iterations",
        "iterating_ms",
        "sweeps",
        "solving_ms",
        "ratio",
        "residual",
    ]);
    for row in &rows {
        table.push([
            row.scene.into(),
            row.size.into(),
            row.factor.into(),
            row.iterations.into(),
            (1e3 * row.iterating).into(),
            row.found.sweeps.into(),
            (1e3 * row.solving).into(),
            (row.iterating / row.solving).into(),
            row.found.residual.into(),
        ]);
    }
    say!("\nThe fixed point, iterated to and solved for, to a relative residual of {TOLERANCE:e}:");
    console::print(format_args!("{}", table.to_text()));
    folder.write_table("converged.csv", &table)
}
