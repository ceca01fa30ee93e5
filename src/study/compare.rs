//! Propagators side by side: the same scene under several schemes, and in numbers what each makes of it.
//!
//! What is said of the octree (errors, artefacts) is taken from the merged light, which is what people see. What
//! is said of the scheme (energy left, centroid, reach, convergence) is taken from level 0, a uniform volume
//! by itself. Light is measured by its c00, summed over red, green and blue.

mod places;
mod probe;

use std::time::{Duration, Instant};

use crate::scene::Problem;
use crate::simulation::options::{Device, Options};
use crate::simulation::{Action, Refusal, Simulation};
use crate::study::artefacts::Artefacts;
use crate::study::artefacts::jump::Steady;
use crate::study::error::ErrorRow;
use crate::study::expectation::{Expectation, References};
use crate::study::light::{self, Brightness};
use places::Places;

/// The most iterations that convergence is waited for.
pub const PATIENCE: usize = 256;
/// The share of all light so far under which the newest snapshot counts as nothing more.
const CONVERGED: f64 = 0.01;

/// What one scheme makes of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The scheme's name.
    pub scheme: String,
    /// The merged light against what was expected.
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
    /// What goes wrong with its light: leaks, light behind its own source, jumps between levels, negative light.
    pub artefacts: Artefacts,
    /// The iteration from which on a snapshot holds less than 1 % of all light so far on level 0; `None` if
    /// that takes more than [`PATIENCE`] iterations.
    pub converged: Option<usize>,
    /// The median time of an iteration on all levels, on a graphics card with the reading of its light.
    pub iteration_time: Duration,
    /// Why the processor computed, where another device was asked for.
    pub not_there: Option<String>,
}

/// Runs `scene` under the scheme called `scheme`, its other settings unchanged, and holds its merged light against an
/// expectation; `None` if that is of levels, or is not ready. The processor iterates where `device` cannot.
pub fn run(
    problem: &Problem,
    scheme: &str,
    expectation: Expectation,
    references: &References,
    device: Device,
) -> Result<Option<Finding>, Refusal> {
    let mut problem = expectation.prepared(problem.clone());
    problem.propagation.scheme = scheme.to_owned();
    let places = Places::of(&problem);
    let anisotropy = probe::anisotropy(&problem.propagation)?;
    let iterations = problem.actions();
    let (mut simulation, not_there) =
        Simulation::<f32>::with_fallback(problem, Options { device, ..Options::default() })?;
    for action in [Action::Clear, Action::Inject, Action::Downsample] {
        simulation.act(action);
    }
    let brightness = Brightness::new(simulation.channels());
    let finest = |simulation: &Simulation<f32>| {
        brightness.of_grids(simulation.lights().iter().map(|light| light.source.level(0)))
    };
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
    let Some(held) = expectation.of(&simulation, references) else { return Ok(None) };
    let (Some(error), Some(fit)) = (held.rows().first().copied(), held.best_fit()) else { return Ok(None) };
    let artefacts = Artefacts::of(&simulation, Steady::of(simulation.problem())?.as_ref())?;

    let (energy_left, side) = (light::energy_left(&simulation), simulation.sizes().finest());
    let mut converged = converged(&energies);
    while converged.is_none() && energies.len() <= PATIENCE {
        simulation.act(Action::Propagate);
        energies.push(finest(&simulation).iter().sum());
        converged = self::converged(&energies);
    }
    let centroid = light::centroid(side, &moved);
    let start = light::centroid(side, &injected);
    Ok(Some(Finding {
        scheme: scheme.to_owned(),
        error,
        l1_fitted: fit.fitted,
        energy_left,
        centroid,
        shift: centroid.iter().zip(start).map(|(c, s)| (c - s).powi(2)).sum::<f64>().sqrt(),
        reach: places.reach(&moved, 0.9),
        anisotropy,
        artefacts,
        converged,
        iteration_time: median(times),
        not_there,
    }))
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
