//! The ways to get at the light of a scene.

use std::time::Instant;

use crate::field::Grid;
use crate::scene::propagation::descent::Descent;
use crate::scene::propagation::{Policy, Snapshots};
use crate::scene::{Problem, Propagation};
use crate::simulation::options::Wanted;
use crate::simulation::{Refusal, Simulation};
use crate::study::expectation::Expectation;
use crate::study::expectation::truths::SurfaceTruth;
use crate::study::light;
use crate::study::pareto::Treatment;
use crate::study::reference;
use crate::study::surface::Surfaces;
use crate::transport::solve::NoFixedPoint;
use crate::transport::{Kind, find, kinds};

/// Iterations after which a scheme is looked at.
pub(super) const ITERATIONS: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// A way to get at the light.
pub(super) enum Way {
    Iterate { propagation: Propagation, treatment: Treatment, iterations: usize },
    Solve { propagation: Propagation, tolerance: f64 },
}

/// What every way starts from.
pub(super) struct Start {
    problem: Problem,
    pub(super) injected: Simulation<f32>,
}

/// The light of a way, and where it came from.
pub(super) struct Outcome {
    /// Everything, for the uniform reference.
    pub(super) all: Vec<Grid<f32>>,
    /// What has moved, for the ballistic one.
    pub(super) moved: Vec<Grid<f32>>,
    pub(super) iterations: usize,
    pub(super) seconds: f64,
}

impl Start {
    pub(super) fn new(problem: &Problem) -> Result<Self, Refusal> {
        let problem = with(problem, kinds()[0].name, Treatment::Uniform, 0);
        Ok(Start { injected: reference::injected(&problem)?, problem })
    }
}

/// The scene under a scheme and a treatment of its levels, everything summed.
pub(super) fn with(problem: &Problem, scheme: &str, treatment: Treatment, iterations: usize) -> Problem {
    let (levels, descent, coarsest) = match treatment {
        Treatment::Octree(policy) => (policy, Descent::Off, 1),
        Treatment::Descent => (Policy::default(), problem.propagation.descent, 1),
        Treatment::Uniform | Treatment::Converged => (Policy::default(), Descent::Off, problem.size),
    };
    let propagation = Propagation {
        scheme: scheme.to_owned(),
        iterations,
        levels,
        descent,
        snapshots: Snapshots::Thesis,
        ..problem.propagation.clone()
    };
    Problem { coarsest, propagation, ..problem.clone() }
}

/// Every way there is, in the setting that a scene has.
pub(super) fn all(propagation: &Propagation) -> Vec<Way> {
    let mut ways = Vec::new();
    for kind in kinds() {
        let named = Propagation { scheme: kind.name.to_owned(), ..propagation.clone() };
        for propagation in (kind.variants)(&named) {
            let asked = |treatment: &Treatment| match treatment {
                Treatment::Descent => propagation.descent != Descent::Off,
                Treatment::Converged => false,
                Treatment::Uniform | Treatment::Octree(_) => true,
            };
            for treatment in Treatment::ALL.into_iter().filter(|one| kind.can.levels && asked(one)) {
                ways.extend(ITERATIONS.map(|iterations| {
                    let propagation = propagation.clone();
                    Way::Iterate { propagation, treatment, iterations }
                }));
            }
            let tolerances = kind.tolerances.iter();
            ways.extend(tolerances.map(|&tolerance| Way::Solve { propagation: propagation.clone(), tolerance }));
        }
    }
    ways
}

impl Way {
    pub(super) fn propagation(&self) -> &Propagation {
        let (Way::Iterate { propagation, .. } | Way::Solve { propagation, .. }) = self;
        propagation
    }

    pub(super) fn kind(&self) -> &'static Kind {
        // The names are those of kinds.
        find(&self.propagation().scheme).unwrap_or(&kinds()[0])
    }

    pub(super) fn treatment(&self) -> Treatment {
        match self {
            Way::Iterate { treatment, .. } => *treatment,
            Way::Solve { .. } if self.kind().can.levels => Treatment::Converged,
            Way::Solve { .. } => Treatment::Uniform,
        }
    }

    /// How far what it gives to the surfaces of a scene is from what truly reaches them. It is run once more for that,
    /// outside of all times: whoever solves for the light of cells does not know what surfaces receive.
    pub(super) fn on_surfaces(&self, start: &Start, truth: &SurfaceTruth) -> Result<Surfaces, Refusal> {
        let problem = Problem { propagation: self.propagation().clone(), ..start.problem.clone() };
        let iterations = if let Way::Iterate { iterations, .. } = self { *iterations } else { 0 };
        let problem = Expectation::Surface.prepared(with(&problem, self.kind().name, self.treatment(), iterations));
        let mut simulation = Simulation::<f32>::new(problem)?;
        match self {
            Way::Iterate { .. } => drop(simulation.run_all(Wanted::Everything)),
            Way::Solve { .. } => drop(simulation.settle(|_| true)),
        }
        Ok(truth.compare(&simulation))
    }

    /// From the injected light to what becomes of it.
    pub(super) fn go(&self, start: &Start) -> Result<Outcome, NoFixedPoint> {
        let Start { problem, injected } = start;
        let problem = Problem { propagation: self.propagation().clone(), ..problem.clone() };
        let scheme = self.kind().name;
        match self {
            Way::Iterate { treatment, iterations, .. } => {
                let mut simulation = Simulation::<f32>::new(with(&problem, scheme, *treatment, *iterations))?;
                let started = Instant::now();
                simulation.run_all(Wanted::Merged);
                let seconds = started.elapsed().as_secs_f64();
                let merged = simulation.lights().iter().filter_map(|light| light.merged.clone());
                let moved = light::moved(&simulation);
                Ok(Outcome { all: merged.collect(), moved, iterations: *iterations, seconds })
            }
            Way::Solve { tolerance, .. } => {
                let problem = with(&problem, scheme, Treatment::Uniform, 0);
                let mut solver = (self.kind().solver)(&problem)?;
                let lights = injected.lights().iter().map(|light| light.source.level(0));
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
                Ok(Outcome { all, moved, iterations, seconds })
            }
        }
    }
}
