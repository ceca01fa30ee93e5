//! Time against error: every way to get at the light of a scene, how long it takes and how far off it is.
//!
//! Scenes are made at any size: a wall, two walls that face each other, a lobe; or one is given. The ways are each
//! scheme with each policy for its levels after 1, 2, 4 … iterations; of scenes that are made also its fixed
//! point, and discrete ordinates. Errors are L1 ratios of the merged light against two references:
//!
//! - *uniform*: the fixed point of the uniform volume under the same scheme and factor, what the scheme itself
//!   is after (ordinates have no such volume);
//! - *ballistic*: what truly arrives, against the light that has moved.
//!
//! Times are medians over rounds in which all ways take turns. They hold all that is computed between the
//! injected and the merged light, but not the making of the grids.

mod way;

use glam::DVec3;

use super::ballistic::{self, Ballistic, BestFit};
use super::{converged, error, reference};
use crate::field::{Grid, Layout};
use crate::propagate::scheme;
use crate::scene::{Occlusion, Propagation, Scene, Source};
use crate::sh::Sh;
use crate::simulation::{Simulation, SimulationError};
use way::{Way, iterated, ways, with};

/// Iterations after which schemes are looked at on a scene that is given.
const FEW_ITERATIONS: [usize; 5] = [1, 2, 4, 8, 16];
/// Iterations that stand for the fixed point where none is solved for.
const FOR_EVER: usize = 400;
/// The relative residual of the reference.
const REFERENCE_TOLERANCE: f64 = 1e-5;

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
    /// The scene: one-wall, two-walls, one-lobe, or the name of one that was given.
    pub preset: String,
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

/// Measures every way; `watch` hears what is measured.
pub fn measure(plan: &Plan, mut watch: impl FnMut(&str)) -> Result<Vec<Row>, SimulationError> {
    let mut rows = Vec::new();
    for &size in &plan.sizes {
        for (preset, sources) in scenes(size) {
            watch(&format!("{preset}, n = {size}"));
            let scene = scene(size, sources, plan.factor);
            let Some(truth) = Ballistic::new(&scene, &|_| true)? else { continue };
            rows.extend(measure_ways(preset, &scene, ways(), &truth, plan.rounds, &mut |_| true)?.unwrap_or_default());
        }
    }
    Ok(rows)
}

/// Measures each scheme with each policy for its levels on a scene. `watch` hears of the share done, 0 to 1, and
/// returns whether to go on; `None` if it did not want to.
pub fn measure_scene(
    name: &str,
    scene: &Scene,
    truth: &Ballistic,
    rounds: usize,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<Option<Vec<Row>>, SimulationError> {
    let ways = scheme::names().into_iter().flat_map(|scheme| iterated(scheme, &FEW_ITERATIONS)).collect();
    measure_ways(name, scene, ways, truth, rounds, watch)
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

fn measure_ways(
    preset: &str,
    scene: &Scene,
    ways: Vec<Way>,
    truth: &Ballistic,
    rounds: usize,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<Option<Vec<Row>>, SimulationError> {
    let schemes = scheme::names();
    let steps = (schemes.len() + ways.len() * (1 + rounds)) as f64;
    let mut done = 0;
    let mut step = |within: bool| {
        done += usize::from(!within);
        watch(done as f64 / steps)
    };
    let mut fixed_points = Vec::new();
    for name in schemes {
        let scene = with(scene, name, "uniform", FOR_EVER);
        let Some(light) = fixed_point(&scene, &mut || step(true))? else { return Ok(None) };
        fixed_points.push((name, light));
        step(false);
    }
    let injected = reference::injected::<f32>(scene)?;
    let (mut tried, mut outcomes) = (Vec::new(), Vec::new());
    for way in ways {
        // Ways that a scheme refuses are left out.
        if let Ok(outcome) = way.go(scene, &injected) {
            tried.push(way);
            outcomes.push(outcome);
        }
        if !step(false) {
            return Ok(None);
        }
    }
    let mut times = vec![Vec::new(); tried.len()];
    for _ in 0..rounds {
        for (way, times) in tried.iter().zip(&mut times) {
            times.extend(way.go(scene, &injected).map(|outcome| outcome.seconds));
            if !step(false) {
                return Ok(None);
            }
        }
    }
    let scales = error::channel_scales(&injected);
    let mut rows = Vec::new();
    for ((way, outcome), mut times) in tried.iter().zip(&outcomes).zip(times) {
        times.sort_by(f64::total_cmp);
        let seconds = times.get(times.len() / 2).copied().unwrap_or_default();
        let row = |reference, l1| Row {
            preset: preset.to_owned(),
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
    Ok(Some(rows))
}

/// The fixed point of the uniform volume, solved for or iterated; `None` once `go_on` does not want to.
fn fixed_point(scene: &Scene, go_on: &mut dyn FnMut() -> bool) -> Result<Option<Vec<Grid<f32>>>, SimulationError> {
    if let Ok(found) = converged::solve(scene, REFERENCE_TOLERANCE, |_| go_on()) {
        return Ok(found.map(|found| found.light));
    }
    let mut simulation = Simulation::<f32>::new(scene.clone())?;
    let mut wanted = true;
    simulation.run(|_| {
        wanted = go_on();
        wanted
    });
    Ok(wanted.then(|| reference::uniform(&simulation)))
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
    use super::way::ITERATIONS;
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
    fn a_scene_with_colours_and_occluders_is_measured_until_nobody_wants_to_know() {
        let text = "(version: 1, size: 4, injectors: [(kind: Wall(side: NegX), color: (1, 0.5, 0))], \
                    occluders: [(kind: Box(from: (2, 0, 0), to: (2, 1, 1)))])";
        let preset = crate::scene::Preset::parse(text, std::path::Path::new("test")).unwrap();
        let scene = Scene::build(&preset, std::path::Path::new("")).unwrap();
        let truth = Ballistic::new(&scene, &|_| true).unwrap().unwrap();
        let mut shares = Vec::new();
        let mut watch = |share| {
            shares.push(share);
            true
        };
        let rows = measure_scene("mine", &scene, &truth, 1, &mut watch).unwrap().unwrap();
        assert_eq!(rows.len(), 2 * 3 * FEW_ITERATIONS.len() * scheme::names().len());
        assert!(rows.iter().all(|row| row.preset == "mine" && row.l1.fitted <= row.l1.raw));
        assert!(shares.is_sorted() && shares.last() == Some(&1.0));
        assert_eq!(measure_scene("mine", &scene, &truth, 1, &mut |share| share < 0.5).unwrap(), None);
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let row = |seconds: f64, fitted: f64| Row {
            preset: "one-wall".to_owned(),
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
