//! Questions put to simulations.

pub mod benchmark;
pub mod compare;
pub mod error;
pub mod expectation;
pub mod fit;
pub mod light;
pub mod pareto;
pub mod profile;
pub mod race;
pub mod random;
pub mod reference;
pub mod stability;
pub mod stress;
