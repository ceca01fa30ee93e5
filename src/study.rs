//! Questions put to simulations.

pub mod artefacts;
pub(crate) mod benchmark;
pub mod compare;
pub mod difference;
pub mod expectation;
pub mod fit;
pub mod identify;
mod kept;
pub mod laws;
pub mod light;
pub mod motion;
pub mod octree;
pub mod pareto;
pub mod pattern;
pub mod picture;
pub mod profile;
pub(crate) mod race;
pub mod reference;
pub mod stability;
pub mod stress;
pub mod surface;

pub use expectation::error;
