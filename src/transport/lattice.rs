//! Light as two bands of spherical harmonics a cell, sent from each cell to its six neighbours: what a propagation
//! scheme is, the [schemes] themselves, and the loops that apply one to a grid.

pub mod active;
pub mod barrier;
pub mod exact;
pub mod face;
pub mod fixed_point;
pub mod geometry;
pub mod kernel;
pub mod levels;
pub mod linear;
pub mod scheme;
pub mod schemes;
pub mod stencil;
