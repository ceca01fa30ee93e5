//! How light moves from cell to cell: what a propagation scheme is, the schemes themselves, and the
//! loops that apply one to a grid.

pub mod active;
pub mod cascaded;
pub mod face;
pub mod kernel;
pub mod scheme;
pub mod stencil;
