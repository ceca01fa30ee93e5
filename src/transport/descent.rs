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
//! All the light is A = S + B ([`crate::transport::lattice::exact`]): the injected light S stays where it is, and B is
//! what is solved for. On the leaves of a stage the accumulated light is B and the mean of S.
//!
//! An iteration changes B by a correction, and the next one is the operator applied to it. So the source and target
//! of a stage are its corrections, as a uniform volume's are its snapshots.

#[cfg(test)]
mod conformance;
mod course;
pub mod partition;
mod sample;

pub use course::{Descent, Grids};
pub use partition::Tiling;

use super::lattice::exact;
use super::lattice::linear::linear_form;
use super::refusal::Refusal;
use crate::field::Levels;
use crate::scene::Problem;
use crate::sh::Real;

/// The descent that a problem asks for, over levels of these sizes.
pub fn of_problem<T: Real>(problem: &Problem, sizes: Levels) -> Result<Descent<T>, Refusal> {
    let propagation = &problem.propagation;
    let (form, share) = linear_form::<T>(problem, "a descent")?;
    exact::residence(&share, propagation.factor, sizes.count())?;
    let tiling = Tiling::of(propagation.descent).unwrap_or(Tiling::Cells);
    Ok(Descent::new(sizes, tiling, form, share, propagation.snapshots))
}
