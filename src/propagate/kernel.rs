//! The loops that take one grid one iteration further.

pub mod occluded;
pub mod plain;
