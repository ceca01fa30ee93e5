//! Questions put to simulations.

pub mod error;
