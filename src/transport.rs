//! Every way light travels, as siblings: the schemes of the [`lattice`] that send two bands of spherical
//! harmonics from cell to cell, [`ordinates`] that keep their direction, and the [`ballistic`] reference, which is
//! what truly arrives.
//!
//! All of them take a [`Problem`](crate::scene::Problem) and grids; none knows the simulation that steps it.

pub mod ballistic;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod lattice;
pub mod ordinates;
pub mod preset;
mod refusal;
pub mod team;
pub mod transparency;

pub use refusal::{Refusal, known_scheme, refuse_what_does_not_fit, scheme_of};

use crate::scene::Propagation;
use crate::scene::error::{Fault, nearest, quote};
use lattice::schemes;

/// The name of everything that a preset may call its scheme, the default first: the [schemes] of the lattice, then
/// [`ordinates`].
pub fn names() -> Vec<&'static str> {
    let mut names = schemes::names();
    names.push(ordinates::NAME);
    names
}

/// Whether there is a transport of the name that a setting asks for.
pub fn check(propagation: &Propagation) -> Result<(), Fault> {
    let known = names();
    if known.contains(&propagation.scheme.as_str()) {
        return Ok(());
    }
    let what = format!("the scheme {} is not known", quote(&propagation.scheme));
    let remedy = match nearest(&propagation.scheme, &known) {
        Some(near) => format!("did you mean `{near}`? Known are {}", known.join(", ")),
        None => format!("known are {}", known.join(", ")),
    };
    Err(Fault::new(what, remedy).field("scheme"))
}
