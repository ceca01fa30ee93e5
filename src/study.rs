//! Questions put to simulations.

pub mod error;
pub mod stability;
