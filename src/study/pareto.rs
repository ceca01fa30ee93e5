//! Time against error: every way to get at the light of a scene, how long it takes and how far off it is.
//!
//! Scenes are made at any size: a wall, two walls that face each other, a lobe. The ways are each scheme with
//! each policy for its levels after 1, 2, 4 … iterations, its fixed point, and discrete ordinates. Errors
//! are L1 ratios of the merged light against two references:
//!
//! - *uniform*: the fixed point of the uniform volume under the same scheme and factor, what the scheme itself
//!   is after (ordinates have no such volume);
//! - *ballistic*: what truly arrives, against the light that has moved.
//!
//! Times are medians over rounds in which all ways take turns. They hold all that is computed between the
//! injected and the merged light, but not the making of the grids.

use std::time::Instant;

use glam::DVec3;

use super::ballistic::{self, Ballistic, BestFit};
use super::converged;
use super::reference;
use crate::field::{Grid, Layout};
use crate::propagate::levels::Policy;
use crate::propagate::ordinates::Ordinates;
use crate::propagate::ordinates::directions::Lattice;
use crate::propagate::ordinates::shares::Rule;
use crate::propagate::scheme;
use crate::scene::{Occlusion, Propagation, Scene, Source};
use crate::sh::Sh;
use crate::simulation::options::Wanted;
use crate::simulation::{Light, Simulation, SimulationError};

/// Iterations after which a scheme is looked at.
const ITERATIONS: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// Iterations that stand for the fixed point where none is solved for.
const FOR_EVER: usize = 400;
/// Relative residuals to which fixed points are solved for.
const TOLERANCES: [f64; 2] = [1e-2, 1e-4];
/// The relative residual of the reference.
const REFERENCE_TOLERANCE: f64 = 1e-5;
/// Sets of directions: about so many.
const DIRECTIONS: [usize; 5] = [24, 48, 72, 128, 192];

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Sides of the volumes, powers of two.
    pub sizes: Vec<usize>,
    /// The propagation factor of every scheme.
    pub factor: f64,
    /// Rounds over all ways; medians are reported.
    pub rounds: usize,
}

/// One way on one scene against one reference, as `pareto.csv` has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The scene: one-wall, two-walls or one-lobe.
    pub preset: &'static str,
    /// The scheme, or ordinates with their lattice, rule and number of directions.
    pub scheme: String,
    /// uniform, same, consistent or converged.
    pub levels: &'static str,
    /// The side of the volume.
    pub size: usize,
    /// Iterations; cycles of the solver; 1 for the one sweep of ordinates.
    pub iterations: usize,
    /// From injection to merged light.
    pub seconds: f64,
    /// uniform or ballistic.
    pub reference: &'static str,
    /// The error as it is, and after the scalar that fits best.
    pub l1: BestFit,
}

/// The light of a way, and where it came from.
struct Outcome {
    /// Everything, for the uniform reference; `None` where there is no such volume.
    all: Option<Vec<Grid<f32>>>,
    /// What has moved, for the ballistic one.
    moved: Vec<Grid<f32>>,
    iterations: usize,
    seconds: f64,
}

/// A way to get at the light.
enum Way {
    Iterate { scheme: &'static str, levels: &'static str, iterations: usize },
    Solve { scheme: &'static str, tolerance: f64 },
    Ordinates(Lattice, Ordinates),
}

/// Measures every way; `watch` hears what is measured.
pub fn measure(plan: &Plan, mut watch: impl FnMut(&str)) -> Result<Vec<Row>, SimulationError> {
    let mut rows = Vec::new();
    for &size in &plan.sizes {
        for (preset, sources) in scenes(size) {
            watch(&format!("{preset}, n = {size}"));
            let scene = scene(size, sources, plan.factor);
            rows.extend(measure_scene(preset, &scene, plan.rounds)?);
        }
    }
    Ok(rows)
}

/// Of the ways on one scene and size against one reference those that no other beats in both time and error
/// after the best scalar, the fastest first.
pub fn front<'a>(rows: &[&'a Row]) -> Vec<&'a Row> {
    let mut sorted = rows.to_vec();
    sorted.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let mut least = f64::INFINITY;
    sorted.retain(|row| {
        let better = row.l1.fitted < least;
        least = least.min(row.l1.fitted);
        better
    });
    sorted
}

fn measure_scene(preset: &'static str, scene: &Scene, rounds: usize) -> Result<Vec<Row>, SimulationError> {
    let Some(truth) = Ballistic::new(scene, &|_| true)? else {
        return Ok(Vec::new());
    };
    let mut fixed_points = Vec::new();
    for name in scheme::names() {
        fixed_points.push((name, fixed_point(&with(scene, name, "uniform", FOR_EVER))?));
    }
    let mut ways = ways();
    let mut outcomes = Vec::new();
    // Ways that a scheme refuses are left out.
    ways.retain(|way| match way.go(scene) {
        Ok(outcome) => {
            outcomes.push(outcome);
            true
        }
        Err(_) => false,
    });
    let mut times = vec![Vec::new(); ways.len()];
    for _ in 0..rounds {
        for (way, times) in ways.iter().zip(&mut times) {
            times.extend(way.go(scene).map(|outcome| outcome.seconds));
        }
    }
    let scales = vec![1.0; truth.light().len()];
    let mut rows = Vec::new();
    for ((way, outcome), mut times) in ways.iter().zip(&outcomes).zip(times) {
        times.sort_by(f64::total_cmp);
        let seconds = times.get(times.len() / 2).copied().unwrap_or_default();
        let row = |reference, l1| Row {
            preset,
            scheme: way.scheme(),
            levels: way.levels(),
            size: scene.size,
            iterations: outcome.iterations,
            seconds,
            reference,
            l1,
        };
        let fixed_point = fixed_points.iter().find(|(name, _)| *name == way.scheme());
        if let (Some(all), Some((_, uniform))) = (&outcome.all, fixed_point) {
            rows.push(row("uniform", ballistic::l1(&scales, all, uniform)));
        }
        rows.push(row("ballistic", ballistic::l1(&scales, &outcome.moved, truth.light())));
    }
    Ok(rows)
}

fn ways() -> Vec<Way> {
    let mut ways = Vec::new();
    for scheme in scheme::names() {
        for levels in ["uniform", Policy::Same.name(), Policy::Consistent.name()] {
            ways.extend(ITERATIONS.map(|iterations| Way::Iterate { scheme, levels, iterations }));
        }
        ways.extend(TOLERANCES.map(|tolerance| Way::Solve { scheme, tolerance }));
    }
    for lattice in Lattice::ALL {
        for rule in Rule::ALL {
            ways.extend(DIRECTIONS.map(|count| Way::Ordinates(lattice, Ordinates::new(lattice, count, rule))));
        }
    }
    ways
}

impl Way {
    fn scheme(&self) -> String {
        match self {
            Way::Iterate { scheme, .. } | Way::Solve { scheme, .. } => (*scheme).to_owned(),
            Way::Ordinates(lattice, ordinates) => {
                format!("ordinates-{}-{}-{}", lattice.name(), ordinates.rule().name(), ordinates.count())
            }
        }
    }

    fn levels(&self) -> &'static str {
        match self {
            Way::Iterate { levels, .. } => levels,
            Way::Solve { .. } => "converged",
            Way::Ordinates(..) => "uniform",
        }
    }

    /// From the scene to its light.
    fn go(&self, scene: &Scene) -> Result<Outcome, converged::Refusal> {
        match self {
            Way::Iterate { scheme, levels, iterations } => {
                let mut simulation = Simulation::<f32>::new(with(scene, scheme, levels, *iterations))?;
                let started = Instant::now();
                simulation.run_all(Wanted::Merged);
                let seconds = started.elapsed().as_secs_f64();
                let merged = simulation.lights().iter().filter_map(|light| light.merged.clone());
                Ok(Outcome::new(scene, merged.collect(), *iterations, seconds))
            }
            Way::Solve { scheme, tolerance } => {
                let scene = with(scene, scheme, "uniform", 0);
                let started = Instant::now();
                let found = converged::solve(&scene, *tolerance, |_| true)?;
                let seconds = started.elapsed().as_secs_f64();
                let (light, cycles) = found.map_or((Vec::new(), 0), |found| (found.light, found.cycles));
                Ok(Outcome::new(&scene, light, cycles, seconds))
            }
            Way::Ordinates(_, ordinates) => {
                let injected = reference::injected::<f32>(scene)?;
                let solve = |light: &Light<f32>| ordinates.solve(light.source.level(0), None);
                let started = Instant::now();
                let moved = injected.lights().iter().map(solve).collect();
                Ok(Outcome { all: None, moved, iterations: 1, seconds: started.elapsed().as_secs_f64() })
            }
        }
    }
}

impl Outcome {
    /// Of all light, what has moved is without the injected one.
    fn new(scene: &Scene, all: Vec<Grid<f32>>, iterations: usize, seconds: f64) -> Self {
        let mut moved = all.clone();
        for (cell, light) in scene.sources.iter().flat_map(|source| &source.light) {
            moved.iter_mut().for_each(|grid| grid.set(*cell, grid.get(*cell) - light.cast()));
        }
        Outcome { all: Some(all), moved, iterations, seconds }
    }
}

/// The fixed point of the uniform volume, solved for or iterated.
fn fixed_point(scene: &Scene) -> Result<Vec<Grid<f32>>, SimulationError> {
    if let Ok(Some(found)) = converged::solve(scene, REFERENCE_TOLERANCE, |_| true) {
        return Ok(found.light);
    }
    let mut simulation = Simulation::<f32>::new(scene.clone())?;
    simulation.run_all(Wanted::Everything);
    Ok(reference::uniform(&simulation))
}

/// The scene under a scheme: `levels` is uniform for a single level, or a policy's name.
fn with(scene: &Scene, scheme: &str, levels: &str, iterations: usize) -> Scene {
    let policy = Policy::ALL.into_iter().find(|policy| policy.name() == levels);
    let propagation = Propagation {
        scheme: scheme.to_owned(),
        iterations,
        levels: policy.unwrap_or_default(),
        ..scene.propagation.clone()
    };
    let coarsest = if policy.is_some() { 1 } else { scene.size };
    Scene { coarsest, propagation, ..scene.clone() }
}

fn scene(size: usize, sources: Vec<Source>, factor: f64) -> Scene {
    Scene {
        size,
        coarsest: 1,
        sources,
        blockers: Vec::new(),
        occlusion: Occlusion::default(),
        propagation: Propagation { factor, ..Propagation::default() },
    }
}

/// White light on one channel.
fn scenes(n: usize) -> [(&'static str, Vec<Source>); 3] {
    let wall = |x: usize, way: DVec3| {
        let cells = Layout::new(n).cells().filter(move |cell| cell[0] == x);
        Source { color: [1.0; 3], light: cells.map(|cell| (cell, Sh::lobe(way))).collect() }
    };
    let lobe = Source { color: [1.0; 3], light: vec![([n / 2; 3], Sh::lobe(DVec3::X))] };
    [
        ("one-wall", vec![wall(0, DVec3::X)]),
        ("two-walls", vec![wall(0, DVec3::X), wall(n - 1, DVec3::NEG_X)]),
        ("one-lobe", vec![lobe]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_is_measured_against_what_it_can_be_and_errors_fall() {
        let plan = Plan { sizes: vec![8], factor: 3.0, rounds: 1 };
        let rows = measure(&plan, |_| {}).unwrap();
        let of = |scheme: &str, levels: &str, reference: &str| -> Vec<&Row> {
            let rows = rows.iter().filter(|row| row.preset == "one-wall" && row.scheme == scheme);
            rows.filter(|row| row.levels == levels && row.reference == reference).collect()
        };
        let uniform = of("cascaded", "uniform", "uniform");
        assert_eq!(uniform.iter().map(|row| row.iterations).collect::<Vec<_>>(), ITERATIONS);
        assert!(uniform.windows(2).all(|pair| pair[1].l1.raw < pair[0].l1.raw));
        assert!(uniform[5].l1.raw < 1e-3);
        assert_eq!(of("cascaded", "consistent", "ballistic").len(), ITERATIONS.len());
        assert!(of("cascaded", "converged", "uniform")[1].l1.raw < 1e-3);
        assert!(rows.iter().all(|row| row.l1.fitted <= row.l1.raw));
        assert!(rows.iter().all(|row| !row.scheme.starts_with("ordinates") || row.reference == "ballistic"));
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let row = |seconds: f64, fitted: f64| Row {
            preset: "one-wall",
            scheme: "cascaded".to_owned(),
            levels: "same",
            size: 8,
            iterations: 1,
            seconds,
            reference: "uniform",
            l1: BestFit { raw: fitted, fitted, scale: 1.0 },
        };
        let rows = [row(3.0, 0.1), row(1.0, 0.5), row(2.0, 0.6), row(4.0, 0.1), row(5.0, 0.05)];
        let all: Vec<&Row> = rows.iter().collect();
        let times: Vec<f64> = front(&all).iter().map(|row| row.seconds).collect();
        assert_eq!(times, [1.0, 3.0, 5.0]);
    }
}
