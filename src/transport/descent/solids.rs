//! What stands in the way of a descent.

use crate::field::Marks;
use crate::transport::lattice::kernel::occluded::Hard;
use crate::transport::lattice::stencil::Stencil;

/// Hard occluders, and the scheme that they act in.
#[derive(Clone, Debug)]
pub struct Solids<T> {
    /// The occluders.
    pub hard: Hard<T>,
    /// The occupied cells.
    pub occupied: Marks,
    /// The scheme, clamps and all.
    pub stencil: Stencil<T>,
}
