//! What the program needs of the machine that it runs on.

pub mod file;
pub(crate) mod interrupt;
pub mod memory;
pub mod random;
pub mod text;
