//! From coarse to fine: the coarse levels start the fine ones.
//!
//! Light gets one cell further an iteration, so a fine volume needs as many iterations as light travels cells. The thesis
//! hoped that an octree would do with few (000, 4.2 and 7.1). It does if the coarse levels hand down what they know:
//!
//! ```text
//! for each level j, from the coarsest to the finest:
//!     the leaves of the stage, none finer than j                       partition
//!     the moved light q, filtered to level j                           lattice::exact::filter
//!     start from the coarser solution, sampled, then averaged          lattice::exact::sampling
//!     k iterations, ahead                                              lattice::exact::leaves
//! ```
//!
//! On the coarsest level a cell or two are solved in a few iterations; every finer one has to mend only what the
//! coarser one could not know. That is a full multigrid cycle without the way back: there is nothing to hand up, as
//! every level has its source from the scene itself and an operator that agrees with the others'.
//!
//! What a stage goes over is to choose ([`Tiling`]): all cells, leaves about the light, or the grids of nested cascades
//! about a point ([`nest`]). Such grids may also be propagated each by itself, which is no descent at all (`alone`).
//!
//! All the light is A = S + B ([`crate::transport::lattice::exact`]): the injected light S stays where it is, and B is
//! what is solved for. On the leaves of a stage the accumulated light is B and the mean of S.
//!
//! An iteration changes B by a correction, and the next one is the operator applied to it. So the source and target
//! of a stage are its corrections, as a uniform volume's are its snapshots.

mod alone;
mod channel;
#[cfg(test)]
mod conformance;
mod course;
mod first_steps;
pub mod nest;
pub(crate) mod partition;
mod sample;
mod staged;

pub use course::{Descent, Grids};
pub use first_steps::Injected;
pub use partition::Tiling;

use std::sync::Arc;

use super::kind::{Kind, Law, Setup, Transport};
use super::lattice::linear::linear_form;
use super::lattice::obstacles::{self, Obstacles};
use super::lattice::{self, exact};
use super::refusal::Refusal;
use crate::field::Levels;
use crate::scene::propagation::descent::Descent as Asked;
use crate::scene::{Problem, Propagation};
use crate::sh::Real;
use alone::Alone;
use nest::Nest;
use staged::Staged;

/// Every scheme as a kind of transport, which descends where a problem asks for it.
pub fn kinds() -> Vec<Kind> {
    let kinds = lattice::kinds().into_iter();
    kinds.map(|kind| Kind { laws, bytes, single: build::<f32>, double: Some(build::<f64>), ..kind }).collect()
}

/// A descent is ahead of its steps, is handed down as the light lies, which is not linear, and ends near the fixed point.
/// Cascades by themselves lose light at every border.
fn laws(propagation: &Propagation) -> Vec<Law> {
    let mut laws = lattice::laws(propagation);
    match propagation.descent {
        Asked::Off => {}
        Asked::Cascades { alone: true, .. } => laws.retain(|law| !matches!(law, Law::Conservation | Law::FixedPoint)),
        _ => laws.retain(|law| matches!(law, Law::Symmetry | Law::Shutters | Law::Precision)),
    }
    laws
}

fn build<T: Real>(setup: &Setup) -> Result<Box<dyn Transport<T>>, Refusal> {
    match setup.problem.propagation.descent {
        Asked::Off => lattice::Lattice::build(setup),
        Asked::Cascades { alone: true, .. } => Ok(Box::new(Alone::new(setup)?)),
        _ => Ok(Box::new(Staged::new(setup)?)),
    }
}

/// Bytes that a descent keeps beside the state, about: the source of every stage, and a quarter of that for leaves and
/// their neighbours; or what a lattice keeps.
fn bytes(problem: &Problem, sizes: Levels, channels: usize, number: usize) -> u64 {
    if !problem.propagation.descent.goes_down() {
        return lattice::bytes(problem, sizes, channels, number);
    }
    let light = 4 * number as u64 * sizes.cells() as u64;
    light * channels as u64 + light / 4 + obstacles::bytes(problem, sizes, channels, number)
}

/// Steps that light may take cell by cell before occluders stop it.
const LATEST: usize = 15;

/// The descent that a problem asks for, over levels of these sizes, for so many channels of light.
pub fn of_problem<T: Real>(problem: &Problem, sizes: Levels, channels: usize) -> Result<Descent<T>, Refusal> {
    let propagation = &problem.propagation;
    let (form, share) = linear_form::<T>(problem, "a descent")?;
    exact::residence(&share, propagation.factor, sizes.count())?;
    let tiling = match propagation.descent {
        Asked::Off | Asked::Cells => Tiling::Cells,
        Asked::Leaves { distance } => Tiling::Leaves { distance },
        Asked::Cascades { .. } => Tiling::Cascades(nest_of(problem, sizes)?),
    };
    let obstacles = Obstacles::new(problem, sizes, channels);
    if obstacles.as_ref().is_some_and(|obstacles| obstacles.passing() > LATEST) {
        return Err(Refusal::Underived {
            what: "a descent",
            setting: format!("fuzzy occluders that stop light from iteration {} on", problem.occlusion.from_iteration),
            remedy: "let them from iteration 16 at the latest",
        });
    }
    Ok(Descent::among(sizes, tiling, (form, share), propagation.snapshots, obstacles.map(Arc::new)))
}

/// The nested cascades that a problem asks for.
fn nest_of(problem: &Problem, sizes: Levels) -> Result<Nest, Refusal> {
    let asked = problem.propagation.descent;
    asked.check(sizes.finest()).map_err(|fault| Refusal::Cascades(fault.to_string()))?;
    match asked {
        Asked::Cascades { side, center, .. } => Ok(Nest::new(sizes, side, center)),
        _ => Ok(Nest::new(sizes, sizes.finest(), None)),
    }
}
