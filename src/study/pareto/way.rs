//! The ways to get at the light of a scene.

use std::time::Instant;

use crate::field::Grid;
use crate::scene::occluder::OcclusionMode;
use crate::scene::propagation::Policy;
use crate::scene::propagation::Snapshots;
use crate::scene::propagation::ordinates::{Lattice, Rule, Setting};
use crate::scene::{Problem, Propagation};
use crate::simulation::options::Wanted;
use crate::simulation::{Refusal, Simulation};
use crate::study::light;
use crate::study::pareto::{Propagator, Treatment};
use crate::study::reference;
use crate::transport::lattice::fixed_point::{NoFixedPoint, Solver};
use crate::transport::lattice::schemes;
use crate::transport::ordinates::{self, Ordinates, Room};
use crate::transport::transmittance::Transmittance;

/// Iterations after which a scheme is looked at.
pub(super) const ITERATIONS: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// Relative residuals to which fixed points are solved for.
const TOLERANCES: [f64; 2] = [1e-2, 1e-4];
/// Sets of directions: about so many.
const DIRECTIONS: [usize; 5] = [24, 48, 72, 128, 192];

/// A way to get at the light.
pub(super) enum Way {
    Iterate { scheme: &'static str, treatment: Treatment, iterations: usize },
    Solve { scheme: &'static str, tolerance: f64 },
    Ordinates(Lattice, Ordinates),
}

/// What every way starts from.
pub(super) struct Start {
    problem: Problem,
    pub(super) injected: Simulation<f32>,
    occluders: Option<Transmittance>,
}

/// The light of a way, and where it came from.
pub(super) struct Outcome {
    /// Everything, for the uniform reference; `None` where there is no such volume.
    pub(super) all: Option<Vec<Grid<f32>>>,
    /// What has moved, for the ballistic one.
    pub(super) moved: Vec<Grid<f32>>,
    pub(super) iterations: usize,
    pub(super) seconds: f64,
}

impl Start {
    pub(super) fn new(problem: &Problem) -> Result<Self, Refusal> {
        let problem = with(problem, schemes::names()[0], Treatment::Uniform, 0);
        let blocks = problem.occlusion.mode != OcclusionMode::Off;
        let occluders = Transmittance::new(problem.size, if blocks { &problem.solids } else { &[] });
        Ok(Start { injected: reference::injected(&problem)?, occluders, problem })
    }
}

/// The scene under a scheme and a treatment of its levels, everything summed.
pub(super) fn with(problem: &Problem, scheme: &str, treatment: Treatment, iterations: usize) -> Problem {
    let (levels, coarsest) = match treatment {
        Treatment::Octree(policy) => (policy, 1),
        Treatment::Uniform | Treatment::Converged => (Policy::default(), problem.size),
    };
    let propagation = Propagation {
        scheme: scheme.to_owned(),
        iterations,
        levels,
        snapshots: Snapshots::Thesis,
        ..problem.propagation.clone()
    };
    Problem { coarsest, propagation, ..problem.clone() }
}

/// Every way there is.
pub(super) fn all() -> Vec<Way> {
    let mut ways = Vec::new();
    for scheme in schemes::names() {
        for treatment in Treatment::ALL.into_iter().filter(|one| *one != Treatment::Converged) {
            ways.extend(ITERATIONS.map(|iterations| Way::Iterate { scheme, treatment, iterations }));
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
    pub(super) fn propagator(&self) -> Propagator {
        match self {
            Way::Iterate { scheme, .. } | Way::Solve { scheme, .. } => Propagator { scheme, setting: None },
            Way::Ordinates(lattice, ordinates) => {
                let setting = Setting { directions: ordinates.count(), rule: ordinates.rule(), lattice: *lattice };
                Propagator { scheme: ordinates::NAME, setting: Some(setting) }
            }
        }
    }

    pub(super) fn treatment(&self) -> Treatment {
        match self {
            Way::Iterate { treatment, .. } => *treatment,
            Way::Solve { .. } => Treatment::Converged,
            Way::Ordinates(..) => Treatment::Uniform,
        }
    }

    /// From the injected light to what becomes of it.
    pub(super) fn go(&self, start: &Start) -> Result<Outcome, NoFixedPoint> {
        let Start { problem, injected, occluders } = start;
        let lights = injected.lights().iter().map(|light| light.source.level(0));
        match self {
            Way::Iterate { scheme, treatment, iterations } => {
                let mut simulation = Simulation::<f32>::new(with(problem, scheme, *treatment, *iterations))?;
                let started = Instant::now();
                simulation.run_all(Wanted::Merged);
                let seconds = started.elapsed().as_secs_f64();
                let merged = simulation.lights().iter().filter_map(|light| light.merged.clone());
                let moved = light::moved(&simulation);
                Ok(Outcome { all: Some(merged.collect()), moved, iterations: *iterations, seconds })
            }
            Way::Solve { scheme, tolerance } => {
                let problem = with(problem, scheme, Treatment::Uniform, 0);
                let mut solver = Solver::for_problem(&problem)?;
                let mut all: Vec<Grid<f32>> = lights.clone().map(|_| Grid::new(problem.size)).collect();
                let mut iterations = 0;
                let started = Instant::now();
                for (light, all) in lights.clone().zip(&mut all) {
                    let found = solver.solve(light, *tolerance, all, &mut |_| true)?;
                    iterations += found.map_or(0, |found| found.sweeps);
                }
                let seconds = started.elapsed().as_secs_f64();
                let mut moved = all.clone();
                for (light, moved) in lights.zip(&mut moved) {
                    light.iter().filter(|(_, c)| !c.is_zero()).for_each(|(cell, c)| moved.add(cell, c * -1.0));
                }
                Ok(Outcome { all: Some(all), moved, iterations, seconds })
            }
            Way::Ordinates(_, ordinates) => {
                let mut room = Room::new(problem.size);
                let mut moved: Vec<Grid<f32>> = lights.clone().map(|_| Grid::new(problem.size)).collect();
                let started = Instant::now();
                for (light, moved) in lights.zip(&mut moved) {
                    ordinates.solve_in(&mut room, light, occluders.as_ref(), moved);
                }
                Ok(Outcome { all: None, moved, iterations: 1, seconds: started.elapsed().as_secs_f64() })
            }
        }
    }
}
