//! How light moves from cell to cell: what a propagation scheme is, the schemes themselves, and the
//! loops that apply one to a grid.

pub mod active;
pub mod axial;
pub mod barrier;
pub mod blog;
pub mod cascaded;
pub mod cone;
pub mod face;
pub mod geometry;
pub mod kernel;
pub mod levels;
pub mod ordinates;
pub mod reflective;
pub mod scheme;
pub mod stencil;
pub mod transparency;

/// The name of everything that a preset may call its scheme, the default first: the [schemes](scheme), then
/// [`ordinates`].
pub fn names() -> Vec<&'static str> {
    let mut names = scheme::names();
    names.push(ordinates::NAME);
    names
}
