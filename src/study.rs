//! Questions put to simulations.

pub mod ballistic;
pub mod benchmark;
pub mod compare;
pub mod converged;
pub mod error;
pub mod expectation;
pub mod light;
pub mod pareto;
pub mod profile;
pub mod random;
pub mod reference;
pub mod stability;
pub mod stress;
