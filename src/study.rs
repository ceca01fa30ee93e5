//! Questions put to simulations.

pub mod benchmark;
pub mod error;
pub mod random;
pub mod reference;
pub mod stability;
