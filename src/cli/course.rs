//! A run from injection to merge with a line for every iteration, and its errors.

use std::io::IsTerminal;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use crate::scene::Problem;
use crate::simulation::Simulation;
use crate::study::error::ErrorRow;
use crate::study::expectation::{Expectation, References};

/// What a run was found to do.
pub struct Course {
    /// Every error after every iteration.
    pub rows: Vec<ErrorRow>,
    /// Seconds that all actions took, measuring aside.
    pub seconds: f64,
}

/// Computes what expectations need of a scene, with a bar on a terminal.
pub fn references(problem: &Problem, expectations: &[Expectation]) -> References {
    let mut references = References::default();
    for expectation in expectations {
        let bar = bar(1000, "{bar:40} {percent} % of what truly arrives, {eta} left");
        let progress = |done: f64| {
            bar.set_position((done * 1000.0) as u64);
            true
        };
        expectation.prepare(problem, &mut references, &progress);
        bar.finish_and_clear();
    }
    references
}

/// Runs the scene, printing a line for every iteration. The light is held against every expectation that the
/// references are ready for.
pub fn run(simulation: &mut Simulation<f32>, references: &References) -> Course {
    let iterations = simulation.problem().propagation.iterations;
    let bar = bar(iterations as u64, "{bar:40} iteration {pos} of {len}, {eta} left");
    println!("{}", LINE_HEAD);
    let (mut rows, mut aside) = (Vec::new(), 0.0);
    let started = Instant::now();
    simulation.run(|now| {
        let began = Instant::now();
        let errors = measure(now, references);
        bar.suspend(|| println!("{}", line(now, &errors[0])));
        rows.extend(errors);
        bar.set_position(now.iteration() as u64);
        aside += began.elapsed().as_secs_f64();
        true
    });
    bar.finish_and_clear();
    let seconds = started.elapsed().as_secs_f64() - aside;
    Course { rows, seconds }
}

/// The errors of the present iteration, the thesis's over all levels first.
fn measure(now: &Simulation<f32>, references: &References) -> Vec<ErrorRow> {
    Expectation::ALL.into_iter().flat_map(|expectation| expectation.rows(now, references)).collect()
}

const LINE_HEAD: &str = "iteration   energy left      abs mean       abs max      rel mean       rel max  undefined";

fn line(now: &Simulation<f32>, all: &ErrorRow) -> String {
    let energy: f64 = now.lights().iter().map(|light| light.source.level(0).energy()).sum();
    format!(
        "{:>9}  {energy:>12.6}  {:>12.5e}  {:>12.5e}  {:>12.5e}  {:>12.5e}  {:>9}",
        all.iteration, all.absolute_mean, all.absolute_max, all.relative_mean, all.relative_max, all.undefined
    )
}

/// A progress bar on a terminal, none elsewhere.
fn bar(length: u64, template: &str) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(length);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}
