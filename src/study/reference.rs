//! What the light of an octree ought to be: the volumes that errors are measured against.
//!
//! - A *uniform* volume is one level of the finest size, propagated on its own. Every level of an octree
//!   is propagated by itself, so the octree's own finest level is that volume: after the same number of
//!   iterations it costs nothing more ([`uniform`]).
//! - Its *fixed point* is what it holds after all iterations there could be ([`fixed_point()`]).
//! - The *ballistic* reference is not a propagator at all: [`crate::transport::ballistic`].

use crate::field::Grid;
use crate::scene::Problem;
use crate::scene::propagation::descent::Descent;
use crate::scene::propagation::{Policy, Propagation, Snapshots};
use crate::sh::Real;
use crate::simulation::options::Wanted;
use crate::simulation::{Action, Light, Refusal, Simulation};
use crate::study::kept::Kept;
use crate::transport;
use crate::transport::kind::Precision;

/// The relative residual to which the fixed point is solved for.
const TOLERANCE: f64 = 1e-5;
/// Iterations that stand for the fixed point where none is solved for; fewer where light has died out.
const FOR_EVER: usize = 400;
/// Iterations after which that is looked at.
const LOOK_AFTER: usize = 20;
/// Light of the newest snapshot over all light, under which it has died out.
const DIED_OUT: f64 = 1e-6;

/// The uniform volume that stands beside a descent: the finest level alone, and all the light there could be in it.
#[derive(Debug)]
struct Beside {
    problem: Problem,
    light: Vec<Grid<f32>>,
}

/// Scenes and runs of the same scene that are looked at in turn.
static BESIDE: Kept<Beside> = Kept::new(2);

/// Each channel's accumulated light in the uniform volume of the same size and scheme: after as many iterations, or, as
/// a descent has no uniform volume beside it, after all there could be. `None` where that grows out of the range of
/// numbers, or memory is short.
pub fn uniform<T: Real>(simulation: &Simulation<T>) -> Option<Vec<Grid<T>>> {
    if simulation.problem().propagation.descent == Descent::Off {
        return Some(finest_level(simulation));
    }
    let mut problem = finest(simulation.problem());
    // All of them, however many the run takes.
    problem.propagation.iterations = 0;
    let made = || Some(Beside { light: all_light(&problem).ok()??, problem: problem.clone() });
    let beside = BESIDE.get(|beside| beside.problem == problem, made)?;
    Some(beside.light.iter().map(cast).collect())
}

fn finest_level<T: Real>(simulation: &Simulation<T>) -> Vec<Grid<T>> {
    simulation.lights().iter().map(|light| light.accumulated.level(0).clone()).collect()
}

fn cast<T: Real>(light: &Grid<f32>) -> Grid<T> {
    let mut grid = Grid::new(light.side());
    for (to, from) in grid.planes_mut().into_iter().zip(light.planes()) {
        to.iter_mut().zip(from).for_each(|(to, from)| *to = T::of(f64::from(*from)));
    }
    grid
}

/// The finest level of a problem alone, propagated as ever.
pub(super) fn finest(problem: &Problem) -> Problem {
    let propagation = Propagation { descent: Descent::Off, levels: Policy::Same, ..problem.propagation.clone() };
    Problem { coarsest: problem.size, propagation, ..problem.clone() }
}

/// A simulation of the finest level alone, with the scene's light injected and nothing propagated yet.
pub fn injected<T: Precision>(problem: &Problem) -> Result<Simulation<T>, Refusal> {
    let mut simulation = Simulation::new(finest(problem))?;
    simulation.act(Action::Clear);
    simulation.act(Action::Inject);
    Ok(simulation)
}

/// Each channel's light in the fixed point of the uniform volume, everything summed: solved for, or iterated where
/// the solver refuses. `None` where the light grows out of the range of numbers.
pub fn fixed_point(problem: &Problem) -> Result<Option<Vec<Grid<f32>>>, Refusal> {
    let propagation = Propagation { snapshots: Snapshots::Thesis, ..problem.propagation.clone() };
    all_light(&Problem { propagation, ..finest(problem) })
}

/// [`fixed_point()`] of a single level, of those snapshots that count.
pub(super) fn all_light(problem: &Problem) -> Result<Option<Vec<Grid<f32>>>, Refusal> {
    if let Ok(Some(found)) = transport::solve(problem, TOLERANCE, |_| true) {
        return Ok(Some(found.light));
    }
    let mut simulation = injected::<f32>(problem)?;
    let energy = |of: &Grid<f32>| of.energy().abs();
    while simulation.iteration() < FOR_EVER {
        simulation.advance(LOOK_AFTER, Wanted::Everything);
        if simulation.divergence().is_some() {
            return Ok(None);
        }
        let died_out =
            |light: &Light<f32>| energy(light.source.level(0)) <= DIED_OUT * energy(light.accumulated.level(0));
        if simulation.lights().iter().all(died_out) {
            break;
        }
    }
    Ok(Some(finest_level(&simulation)))
}
