//! Questions put to simulations.

pub mod error;
pub mod reference;
pub mod stability;
