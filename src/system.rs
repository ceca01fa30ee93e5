//! What the program needs of the machine that it runs on.

pub mod memory;
