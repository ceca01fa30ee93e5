//! Questions put to simulations.

pub mod error;
pub mod random;
pub mod stability;
pub mod stress;
