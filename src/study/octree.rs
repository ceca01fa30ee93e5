//! What an octree can do: how near to all the light there will ever be its merged light is after few iterations, and
//! how many cells that takes.
//!
//! A uniform volume needs as many iterations as light travels cells. The thesis hoped that an octree gets there in few
//! (000, 4.2). So every way to use one is held against the fixed point of the uniform volume, after k iterations (of
//! every level, where the coarse ones start the fine), and against the uniform volume after as many.

use std::time::Instant;

use super::fit::l1;
use super::light::channel_scales;
use super::reference;
use crate::field::Grid;
use crate::scene::Problem;
use crate::scene::propagation::descent::Descent;
use crate::scene::propagation::{Index, Policy, Propagation, Snapshots};
use crate::simulation::options::Wanted;
use crate::simulation::{Refusal, Simulation};
use crate::transport::lattice::fixed_point::Solver;
use crate::transport::solve::{NoFixedPoint, Solve};

/// A way to use an octree, or none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// The finest level alone.
    Uniform,
    /// An octree in which every level is propagated by itself.
    Levels(Policy),
    /// Exact levels ahead of the finest, sampled by how far injected light is: the reach of the finest level, in cells.
    Radial(f64),
    /// The coarse levels start the fine ones.
    Descent(Descent),
    /// The fixed point of the finest level, solved for to a relative residual; sweeps count as iterations.
    Solver(f64),
}

impl Way {
    /// Every way; leaves at the given distances, and nested cascades of the given sides about the volume's middle, alone and
    /// two-way.
    pub fn all(distances: &[f64], sides: &[usize]) -> Vec<Way> {
        let mut ways = vec![Way::Uniform];
        ways.extend(Policy::ALL.map(Way::Levels));
        ways.push(Way::Radial(Index::REACH));
        ways.push(Way::Descent(Descent::Cells));
        ways.extend(distances.iter().map(|distance| Way::Descent(Descent::Leaves { distance: *distance })));
        let cascades = |alone| move |side: &usize| Way::Descent(Descent::Cascades { side: *side, center: None, alone });
        ways.extend(sides.iter().map(cascades(true)));
        ways.extend(sides.iter().map(cascades(false)));
        ways.push(Way::Solver(SOLVED_TO));
        ways
    }

    /// Its name in tables.
    pub fn name(self) -> String {
        match self {
            Way::Uniform => "uniform".to_owned(),
            Way::Levels(policy) => policy.name().to_owned(),
            Way::Radial(reach) => format!("radial-{reach}"),
            Way::Descent(descent) if descent.goes_down() => format!("descent-{}", descent.name()),
            Way::Descent(descent) => descent.name(),
            Way::Solver(_) => "solver".to_owned(),
        }
    }

    /// The problem as this way runs it for `iterations`.
    fn with(self, problem: &Problem, iterations: usize) -> Problem {
        let index = if let Way::Radial(reach) = self { Index::Radial { reach } } else { Index::Thesis };
        let (coarsest, levels, descent) = match self {
            Way::Uniform | Way::Solver(_) => (problem.size, Policy::Same, Descent::Off),
            Way::Levels(policy) => (problem.coarsest, policy, Descent::Off),
            Way::Radial(_) => (problem.coarsest, Policy::Ahead, Descent::Off),
            Way::Descent(descent) => (problem.coarsest, Policy::Same, about(descent, problem.propagation.descent)),
        };
        let propagation = Propagation {
            iterations,
            levels,
            index,
            descent,
            snapshots: Snapshots::Thesis,
            ..problem.propagation.clone()
        };
        Problem { coarsest, propagation, ..problem.clone() }
    }
}

/// The same descent, with cascades about the point that a preset has them about.
fn about(descent: Descent, preset: Descent) -> Descent {
    match (descent, preset) {
        (Descent::Cascades { side, center: None, alone }, Descent::Cascades { center, .. }) => {
            Descent::Cascades { side, center, alone }
        }
        _ => descent,
    }
}

/// The relative residual that the solver's row is solved to.
const SOLVED_TO: f64 = 1e-2;

/// One way on one scene after so many iterations, as `octree.csv` has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The scene.
    pub preset: String,
    /// The scheme.
    pub scheme: String,
    /// The propagation factor.
    pub factor: f64,
    /// The side of the volume.
    pub size: usize,
    /// The way ([`Way::name`]).
    pub way: String,
    /// Iterations, of every level in a descent.
    pub iterations: usize,
    /// Cells that one iteration touches; in a descent one of every level.
    pub cells: usize,
    /// Cells touched by all iterations.
    pub updates: usize,
    /// From the dark to the merged light, the making of grids aside: the median over the rounds.
    pub seconds: f64,
    /// The L1 ratio of the merged light against the fixed point of the uniform volume.
    pub converged: f64,
    /// The L1 ratio against the uniform volume after as many iterations.
    pub after: f64,
}

/// Measures every way on a scene, called `name` in the rows, after each of `iterations`; times are medians of `rounds`.
/// Ways that refuse the scene are left out. `progress` hears of the share done, and returns whether to go on.
pub fn measure(
    name: &str,
    problem: &Problem,
    (ways, iterations): (&[Way], &[usize]),
    rounds: usize,
    progress: &dyn Fn(f64) -> bool,
) -> Result<Option<Vec<Row>>, Refusal> {
    // Light that grows for ever converges to nothing that it could be held against.
    let Some(converged) = reference::fixed_point(&Way::Uniform.with(problem, 0))? else { return Ok(Some(Vec::new())) };
    let mut rows = Vec::new();
    let total = (ways.len() * iterations.len()) as f64;
    for &k in iterations {
        let uniform = run(Way::Uniform, problem, k)?;
        for way in ways {
            if !progress(rows.len() as f64 / total) {
                return Ok(None);
            }
            let Ok(found) = outcome(*way, problem, k) else { continue };
            let again = (1..rounds).filter_map(|_| outcome(*way, problem, k).ok());
            let mut seconds: Vec<f64> = again.map(|again| again.seconds).chain([found.seconds]).collect();
            seconds.sort_by(f64::total_cmp);
            let error = |expected: &[Grid<f32>]| l1(&found.scales, &found.light, expected).raw;
            rows.push(Row {
                preset: name.to_owned(),
                scheme: problem.propagation.scheme.clone(),
                factor: problem.propagation.factor,
                size: problem.size,
                way: way.name(),
                iterations: found.iterations,
                cells: found.cells,
                updates: found.updates,
                seconds: seconds[seconds.len() / 2],
                converged: error(&converged),
                after: error(&uniform.light),
            });
        }
    }
    Ok(Some(rows))
}

/// What a way makes of a scene.
struct Outcome {
    light: Vec<Grid<f32>>,
    scales: Vec<f64>,
    iterations: usize,
    cells: usize,
    updates: usize,
    seconds: f64,
}

fn outcome(way: Way, problem: &Problem, k: usize) -> Result<Outcome, NoFixedPoint> {
    match way {
        Way::Solver(tolerance) => solve(problem, tolerance),
        _ => Ok(run(way, problem, k)?),
    }
}

fn run(way: Way, problem: &Problem, k: usize) -> Result<Outcome, Refusal> {
    let mut simulation = Simulation::<f32>::new(way.with(problem, k))?;
    let started = Instant::now();
    simulation.run_all(Wanted::Merged);
    let seconds = started.elapsed().as_secs_f64();
    let channels = simulation.lights().len();
    // What may be left out aside, levels that are propagated by themselves touch every cell in every iteration.
    let updates = match way {
        Way::Descent(_) => simulation.work().visited / channels,
        _ => simulation.sizes().cells() * k,
    };
    let light = simulation.lights().iter().filter_map(|light| light.merged.clone()).collect();
    let scales = channel_scales(simulation.channels());
    Ok(Outcome { light, scales, iterations: k, cells: updates / k.max(1), updates, seconds })
}

fn solve(problem: &Problem, tolerance: f64) -> Result<Outcome, NoFixedPoint> {
    let problem = Way::Uniform.with(problem, 0);
    let injected = reference::injected::<f32>(&problem)?;
    let mut solver = Solver::for_problem(&problem)?;
    let mut light: Vec<Grid<f32>> = injected.lights().iter().map(|_| Grid::new(problem.size)).collect();
    let mut sweeps = 0;
    let started = Instant::now();
    for (from, to) in injected.lights().iter().zip(&mut light) {
        let found = solver.solve(from.source.level(0), tolerance, to, &mut |_| true)?;
        sweeps = sweeps.max(found.map_or(0, |found| found.sweeps));
    }
    let seconds = started.elapsed().as_secs_f64();
    let cells = problem.size.pow(3);
    let scales = channel_scales(injected.channels());
    Ok(Outcome { light, scales, iterations: sweeps, cells, updates: cells * sweeps, seconds })
}
