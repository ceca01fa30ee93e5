//! Every way light travels, as siblings: the schemes of the [`lattice`] that send two bands of spherical
//! harmonics from cell to cell, and [`ordinates`] that keep their direction.

pub mod descent;
pub mod lattice;
pub mod ordinates;
pub mod team;
pub mod transparency;

use lattice::schemes;

/// The name of everything that a preset may call its scheme, the default first: the [schemes] of the lattice, then
/// [`ordinates`].
pub fn names() -> Vec<&'static str> {
    let mut names = schemes::names();
    names.push(ordinates::NAME);
    names
}
