//! Propagators side by side: the same scene under several schemes, and in numbers what each makes of it.
//!
//! What is said of the octree (errors, leak) is taken from the merged light, which is what people see. What
//! is said of the scheme (energy left, centroid, reach, convergence) is taken from level 0, a uniform volume
//! by itself. Light is measured by its c00, summed over red, green and blue.

mod places;
mod probe;

use std::time::{Duration, Instant};

use crate::field::Grid;
use crate::scene::Problem;
use crate::simulation::{Action, Light, Refusal, Simulation};
use crate::study::ballistic;
use crate::study::error::{self, ErrorRow};
use crate::study::reference;
use crate::transport::ballistic::Ballistic;
use places::Places;

/// The most iterations that convergence is waited for.
pub const PATIENCE: usize = 256;
/// The share of all light so far under which the newest snapshot counts as nothing more.
const CONVERGED: f64 = 0.01;

/// What the merged light is compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reference {
    /// A uniform volume of the finest size, propagated as often by the same scheme (000, 6.2): what the
    /// octree costs.
    #[default]
    Uniform,
    /// What truly arrives along straight lines, against the light that has moved: what the scheme costs.
    Ballistic,
}

impl Reference {
    /// All there are.
    pub const ALL: [Reference; 2] = [Reference::Uniform, Reference::Ballistic];

    /// Its name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Reference::Uniform => "uniform",
            Reference::Ballistic => "ballistic",
        }
    }

    /// Computes what of it is the same for every scheme.
    pub fn of(self, problem: &Problem) -> Truth {
        match self {
            Reference::Uniform => Truth(None),
            Reference::Ballistic => Truth(Ballistic::new(problem, &|_| true)),
        }
    }
}

/// A reference made ready for one scene: the ballistic light, or none where each scheme has its own.
#[derive(Clone, Debug)]
pub struct Truth(Option<Ballistic>);

impl Truth {
    /// The error of the merged light, and its L1 ratio after the scalar that fits best.
    fn error(&self, simulation: &Simulation<f32>) -> (ErrorRow, f64) {
        let (row, found, expected) = match &self.0 {
            None => {
                let uniform = reference::uniform(simulation);
                (error::merged(simulation, &uniform), error::sampled(simulation), uniform)
            }
            Some(truth) => {
                let row = ballistic::error(simulation, truth);
                (row, ballistic::moved(simulation), truth.light().to_vec())
            }
        };
        (row, ballistic::l1(&error::channel_scales(simulation), &found, &expected).fitted)
    }
}

/// What one scheme makes of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The scheme's name.
    pub scheme: String,
    /// The merged light against the reference.
    pub error: ErrorRow,
    /// The L1 ratio of that error after the scalar that fits best: renderers scale by taste.
    pub l1_fitted: f64,
    /// The light of the last snapshot over that injected, on level 0: 1 where none is lost.
    pub energy_left: f64,
    /// The mean place of the light that has moved, S_1 + … + S_k of level 0, in cells (x, y, z).
    pub centroid: [f64; 3],
    /// How far that lies from the mean place of the injected light, in cells.
    pub shift: f64,
    /// The fewest steps from the nearest injected cell within which 90 % of the moved light lies, on
    /// level 0. A step goes to a face's neighbour; occluders do not count.
    pub reach: usize,
    /// Light on an axis over light on a diagonal, equally far (7 and 6.93 cells) from an even point light
    /// in a free 32³ volume, after 32 iterations: 1 where the scheme has no preferred directions.
    pub anisotropy: f64,
    /// The mean light of cells behind closed occluders over that of cells before them, in the merged light.
    /// `None` where nothing is closed off from the light.
    pub leak: Option<f64>,
    /// The iteration from which on a snapshot holds less than 1 % of all light so far on level 0; `None` if
    /// that takes more than [`PATIENCE`] iterations.
    pub converged: Option<usize>,
    /// The median time of an iteration on all levels.
    pub iteration_time: Duration,
}

/// Runs `problem` under the scheme called `scheme`, its other settings unchanged, and compares it with a
/// reference that was made for it.
pub fn run(problem: &Problem, scheme: &str, truth: &Truth) -> Result<Finding, Refusal> {
    let mut problem = problem.clone();
    problem.propagation.scheme = scheme.to_owned();
    let places = Places::of(&problem);
    let anisotropy = probe::anisotropy(&problem.propagation)?;
    let iterations = problem.propagation.iterations;
    let mut simulation = Simulation::<f32>::new(problem)?;
    for action in [Action::Clear, Action::Inject, Action::Downsample] {
        simulation.act(action);
    }
    let weights = channel_weights(&simulation);
    let finest = |simulation: &Simulation<f32>| brightness(&weights, simulation.lights(), |l| l.source.level(0));
    let injected = finest(&simulation);
    let mut moved = vec![0.0; injected.len()];
    let mut energies = vec![injected.iter().sum::<f64>()];
    let mut times = Vec::new();
    for _ in 0..iterations {
        let started = Instant::now();
        simulation.act(Action::Propagate);
        times.push(started.elapsed());
        let snapshot = finest(&simulation);
        energies.push(snapshot.iter().sum());
        moved.iter_mut().zip(&snapshot).for_each(|(sum, light)| *sum += light);
    }
    simulation.act(Action::Merge);
    let (error, l1_fitted) = truth.error(&simulation);
    let merged = brightness(&weights, simulation.lights(), |l| l.merged.as_ref().unwrap_or(l.accumulated.level(0)));

    let energy_left = ratio(energies[iterations], energies[0]);
    let mut converged = converged(&energies);
    while converged.is_none() && energies.len() <= PATIENCE {
        simulation.act(Action::Propagate);
        energies.push(finest(&simulation).iter().sum());
        converged = self::converged(&energies);
    }
    let centroid = places.centroid(&moved);
    let start = places.centroid(&injected);
    Ok(Finding {
        scheme: scheme.to_owned(),
        error,
        l1_fitted,
        energy_left,
        centroid,
        shift: centroid.iter().zip(start).map(|(c, s)| (c - s).powi(2)).sum::<f64>().sqrt(),
        reach: places.reach(&moved, 0.9),
        anisotropy,
        leak: places.leak(&merged),
        converged,
        iteration_time: median(times),
    })
}

/// How often each channel's light counts in red, green and blue together.
fn channel_weights(simulation: &Simulation<f32>) -> Vec<f64> {
    let mut weights = vec![0.0; simulation.channels().count()];
    for share in simulation.channels().rgb() {
        weights[share.channel] += share.scale;
    }
    weights
}

/// The light of every cell of one grid a channel, x fastest.
fn brightness<'a>(
    weights: &[f64],
    lights: &'a [Light<f32>],
    grid: impl Fn(&'a Light<f32>) -> &'a Grid<f32>,
) -> Vec<f64> {
    let mut sums = Vec::new();
    for (weight, light) in weights.iter().zip(lights) {
        let grid = grid(light);
        sums.resize(grid.side().pow(3), 0.0);
        sums.iter_mut().zip(grid.iter()).for_each(|(sum, (_, light))| *sum += weight * f64::from(light.0[0]));
    }
    sums
}

/// The first iteration that adds less than [`CONVERGED`] of all light so far; `energies` start with the injected.
fn converged(energies: &[f64]) -> Option<usize> {
    let mut sum = 0.0;
    energies.iter().enumerate().position(|(k, energy)| {
        sum += energy;
        k > 0 && *energy < CONVERGED * sum
    })
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort();
    times.get(times.len() / 2).copied().unwrap_or_default()
}

/// `a` over `b`, 0 where both are.
fn ratio(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a / b }
}
