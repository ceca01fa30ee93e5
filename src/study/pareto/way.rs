//! The ways to get at the light of a scene that are measured.

use std::time::Instant;

use crate::field::Grid;
use crate::propagate::levels::Policy;
use crate::propagate::ordinates::Ordinates;
use crate::propagate::ordinates::directions::Lattice;
use crate::propagate::ordinates::shares::Rule;
use crate::propagate::scheme;
use crate::scene::preset::Snapshots;
use crate::scene::{Propagation, Scene};
use crate::simulation::options::Wanted;
use crate::simulation::{Light, Simulation};
use crate::study::converged;

/// Iterations after which a scheme is looked at.
pub const ITERATIONS: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// Relative residuals to which fixed points are solved for.
const TOLERANCES: [f64; 2] = [1e-2, 1e-4];
/// Sets of directions: about so many.
const DIRECTIONS: [usize; 5] = [24, 48, 72, 128, 192];

/// The light of a way, and where it came from.
pub struct Outcome {
    /// Everything, for the uniform reference; `None` where there is no such volume.
    pub all: Option<Vec<Grid<f32>>>,
    /// What has moved, for the ballistic one.
    pub moved: Vec<Grid<f32>>,
    pub iterations: usize,
    pub seconds: f64,
}

/// A way to get at the light.
pub enum Way {
    Iterate { scheme: &'static str, levels: &'static str, iterations: usize },
    Solve { scheme: &'static str, tolerance: f64 },
    Ordinates(Lattice, Ordinates),
}

/// A scheme with each policy for its levels, and on the finest level alone.
pub fn iterated(scheme: &'static str, iterations: &[usize]) -> Vec<Way> {
    let levels = ["uniform", Policy::Same.name(), Policy::Consistent.name()];
    let each = |levels| iterations.iter().map(move |&iterations| Way::Iterate { scheme, levels, iterations });
    levels.into_iter().flat_map(each).collect()
}

/// Every way that is measured on a scene that is made.
pub fn ways() -> Vec<Way> {
    let mut ways = Vec::new();
    for scheme in scheme::names() {
        ways.extend(iterated(scheme, &ITERATIONS));
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
    pub fn scheme(&self) -> String {
        match self {
            Way::Iterate { scheme, .. } | Way::Solve { scheme, .. } => (*scheme).to_owned(),
            Way::Ordinates(lattice, ordinates) => {
                format!("ordinates-{}-{}-{}", lattice.name(), ordinates.rule().name(), ordinates.count())
            }
        }
    }

    pub fn levels(&self) -> &'static str {
        match self {
            Way::Iterate { levels, .. } => levels,
            Way::Solve { .. } => "converged",
            Way::Ordinates(..) => "uniform",
        }
    }

    /// From the scene to its light; `injected` holds what of it has not moved.
    pub fn go(&self, scene: &Scene, injected: &Simulation<f32>) -> Result<Outcome, converged::Refusal> {
        match self {
            Way::Iterate { scheme, levels, iterations } => {
                let mut simulation = Simulation::<f32>::new(with(scene, scheme, levels, *iterations))?;
                let started = Instant::now();
                simulation.run_all(Wanted::Merged);
                let seconds = started.elapsed().as_secs_f64();
                let merged = simulation.lights().iter().filter_map(|light| light.merged.clone());
                Ok(Outcome::new(injected, merged.collect(), *iterations, seconds))
            }
            Way::Solve { scheme, tolerance } => {
                let scene = with(scene, scheme, "uniform", 0);
                let started = Instant::now();
                let found = converged::solve(&scene, *tolerance, |_| true)?;
                let seconds = started.elapsed().as_secs_f64();
                let (light, cycles) = found.map_or((Vec::new(), 0), |found| (found.light, found.cycles));
                Ok(Outcome::new(injected, light, cycles, seconds))
            }
            Way::Ordinates(_, ordinates) => {
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
    fn new(injected: &Simulation<f32>, all: Vec<Grid<f32>>, iterations: usize, seconds: f64) -> Self {
        let mut moved = all.clone();
        for (moved, light) in moved.iter_mut().zip(injected.lights()) {
            for (cell, value) in light.source.level(0).iter().filter(|(_, value)| !value.is_zero()) {
                moved.set(cell, moved.get(cell) - value);
            }
        }
        Outcome { all: Some(all), moved, iterations, seconds }
    }
}

/// The scene under a scheme: `levels` is uniform for a single level, or a policy's name. The sum counts the
/// injected light, as the fixed point does.
pub fn with(scene: &Scene, scheme: &str, levels: &str, iterations: usize) -> Scene {
    let policy = Policy::ALL.into_iter().find(|policy| policy.name() == levels);
    let propagation = Propagation {
        scheme: scheme.to_owned(),
        iterations,
        levels: policy.unwrap_or_default(),
        snapshots: Snapshots::Thesis,
        ..scene.propagation.clone()
    };
    let coarsest = if policy.is_some() { scene.coarsest } else { scene.size };
    Scene { coarsest, propagation, ..scene.clone() }
}
