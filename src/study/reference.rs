//! What the light of an octree ought to be: the volumes that errors are measured against.
//!
//! - A *uniform* volume is one level of the finest size, propagated on its own. Every level of an octree
//!   is propagated by itself, so the octree's own finest level is that volume: after the same number of
//!   iterations it costs nothing more ([`uniform`]).
//! - Its fixed point is what it holds after all iterations there could be: [`crate::transport::lattice::fixed_point`].
//! - The *ballistic* reference is not a propagator at all: [`super::ballistic`].

use crate::field::Grid;
use crate::scene::Problem;
use crate::sh::Real;
use crate::simulation::{Action, Refusal, Simulation};
use crate::transport::kind::Precision;

/// Each channel's accumulated light in the uniform volume of the same size, scheme and iterations.
pub fn uniform<T: Real>(simulation: &Simulation<T>) -> Vec<Grid<T>> {
    simulation.lights().iter().map(|light| light.accumulated.level(0).clone()).collect()
}

/// A simulation of the finest level alone, with the scene's light injected and nothing propagated yet.
pub fn injected<T: Precision>(problem: &Problem) -> Result<Simulation<T>, Refusal> {
    let mut simulation = Simulation::new(Problem { coarsest: problem.size, ..problem.clone() })?;
    simulation.act(Action::Clear);
    simulation.act(Action::Inject);
    Ok(simulation)
}
