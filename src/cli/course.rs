//! A run from injection to merge with a line for every iteration, and its errors.

use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use super::CliError;
use super::console::say;
use crate::report::number::plain;
use crate::scene::Problem;
use crate::simulation::Simulation;
use crate::study::artefacts::jump::{Jump, Steady};
use crate::study::error::ErrorRow;
use crate::study::expectation::{Expectation, References};
use crate::study::light;
use crate::system::{interrupt, memory};

/// What a run was found to do.
pub struct Course {
    /// Every error after every iteration.
    pub rows: Vec<ErrorRow>,
    /// The jumps between levels after every iteration in which light is sampled on several.
    pub jumps: Vec<(usize, Jump)>,
    /// Seconds that all actions took, measuring aside.
    pub seconds: f64,
    /// Whether Ctrl-C ended it early.
    pub interrupted: bool,
}

/// Computes what expectations need of a scene, with a bar on a terminal.
pub fn references(problem: &Problem, expectations: &[Expectation]) -> Result<References, CliError> {
    let mut references = References::default();
    for expectation in expectations {
        if expectation.needs_mesh() && problem.stage.is_none() {
            let what = format!("there is no mesh to measure light against {}", expectation.against());
            return Err(CliError::Input(format!("{what}; give the preset a `scene`, as cornell has")));
        }
        let bar = bar(1000, "{bar:40} {percent} % of what is expected, {eta} left");
        let progress = |done: f64| {
            bar.set_position((done * 1000.0) as u64);
            !interrupt::asked()
        };
        expectation.prepare(problem, &mut references, &progress);
        bar.finish_and_clear();
        if !expectation.is_ready(&references) {
            let why = "interrupted before the run began: nothing is written";
            return Err(CliError::Interrupted(why.to_owned()));
        }
    }
    Ok(references)
}

/// Grids of the finest level that measuring takes for each channel, beside the light itself: the uniform volume, the
/// merged light, and their difference.
const MEASURING: u64 = 3;

/// Refuses what could be run and not be measured, before the run.
fn check_room(simulation: &Simulation<f32>) -> Result<(), CliError> {
    let grid = 16 * (simulation.sizes().finest() as u64).pow(3);
    let needed = MEASURING * grid * simulation.channels().count() as u64;
    let Some(free) = memory::free().filter(|free| needed > *free) else { return Ok(()) };
    let (needed, free) = (memory::in_words(needed), memory::in_words(free));
    Err(CliError::Input(format!(
        "measuring the light needs {needed} of memory beside it, and {free} are free; use a smaller size"
    )))
}

/// Runs the scene, printing a line for every iteration. The light is held against every expectation that the
/// references are ready for, and jumps against what they are given.
pub fn run(
    simulation: &mut Simulation<f32>,
    references: &References,
    steady: Option<&Steady>,
) -> Result<Course, CliError> {
    check_room(simulation)?;
    let iterations = simulation.problem().actions();
    let bar = bar(iterations as u64, "{bar:40} iteration {pos} of {len}, {eta} left");
    say!("{}", LINE_HEAD);
    let (mut rows, mut jumps, mut aside) = (Vec::new(), Vec::new(), 0.0);
    let started = Instant::now();
    simulation.run(|now| {
        let began = Instant::now();
        let errors = measure(now, references);
        bar.suspend(|| say!("{}", line(now, &errors[0])));
        rows.extend(errors);
        let jump = steady.and_then(|steady| steady.jump(now));
        jumps.extend(jump.map(|jump| (now.iteration(), jump)));
        bar.set_position(now.iteration() as u64);
        aside += began.elapsed().as_secs_f64();
        !interrupt::asked()
    });
    bar.finish_and_clear();
    let seconds = started.elapsed().as_secs_f64() - aside;
    let interrupted = interrupt::asked() && simulation.iteration() < iterations;
    Ok(Course { rows, jumps, seconds, interrupted })
}

/// The errors of the present iteration, the thesis's over all levels first.
fn measure(now: &Simulation<f32>, references: &References) -> Vec<ErrorRow> {
    Expectation::ALL.into_iter().flat_map(|expectation| expectation.rows(now, references)).collect()
}

const LINE_HEAD: &str = "iteration  energy left   abs mean    abs max   rel mean    rel max  undefined";

/// As wide as its head, whatever the numbers are.
fn line(now: &Simulation<f32>, all: &ErrorRow) -> String {
    let errors = [all.absolute_mean, all.absolute_max, all.relative_mean, all.relative_max];
    let errors: String = errors.iter().map(|error| format!(" {:>10}", plain(*error, 5))).collect();
    let left = plain(light::energy_left(now), 6);
    format!("{:>9}  {left:>11}{errors}  {:>9}", all.iteration, all.undefined)
}

/// A progress bar; it hides itself where standard error is no terminal.
fn bar(length: u64, template: &str) -> ProgressBar {
    let bar = ProgressBar::new(length);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar
}
