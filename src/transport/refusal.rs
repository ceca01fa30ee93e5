//! What cannot be run, and why.

use super::lattice::exact::Grows;
use super::lattice::levels::TooLarge;
use super::lattice::scheme::Scheme;
use super::lattice::schemes;
use super::{names, ordinates};
use crate::scene::Propagation;
use crate::scene::error::nearest;
use crate::system::memory;

/// A propagation setting that cannot be run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// No scheme of that name.
    #[error("unknown scheme \"{name}\"; {}known schemes: {known}", .nearest.map_or(String::new(), |n| format!("did you mean \"{n}\"? ")))]
    UnknownScheme {
        /// The name asked for.
        name: String,
        /// The name that it may be meant to be.
        nearest: Option<&'static str>,
        /// The names there are.
        known: String,
    },
    /// A size or coarsest side that makes no octree.
    #[error("size {size} with coarsest {coarsest} makes no octree; both must be powers of two, coarsest no larger")]
    Sizes {
        /// The side of the finest level.
        size: usize,
        /// The side of the coarsest level.
        coarsest: usize,
    },
    /// A factor that is too large for a descent.
    #[error(transparent)]
    Grows(#[from] Grows),
    /// A setting that a descent, or exact levels, cannot be derived for.
    #[error("{what} cannot have {setting}; {remedy}")]
    Underived {
        /// A descent, or exact levels.
        what: &'static str,
        /// What of the setting it is.
        setting: String,
        /// What would be right.
        remedy: &'static str,
    },
    /// A factor that is too large for the levels' policy.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// More light than the machine has memory for.
    #[error(
        "a volume of side {size} needs {} of memory and {} are free; the largest size that fits is {largest}",
        memory::in_words(*needed), memory::in_words(*free)
    )]
    Memory {
        /// The side of the finest level.
        size: usize,
        /// Bytes that its light takes.
        needed: u64,
        /// Bytes that the machine has left.
        free: u64,
        /// The largest side whose light fits.
        largest: usize,
    },
}

/// The scheme of a setting, `None` for [ordinates]; an error that names what there is for any other name.
pub fn scheme_of(propagation: &Propagation) -> Result<Option<Scheme>, Refusal> {
    if propagation.scheme == ordinates::NAME { Ok(None) } else { known_scheme(&propagation.scheme).map(Some) }
}

/// The scheme of that name, or an error that names those there are.
pub fn known_scheme(name: &str) -> Result<Scheme, Refusal> {
    schemes::find(name).ok_or_else(|| Refusal::UnknownScheme {
        name: name.to_owned(),
        nearest: nearest(name, &names()),
        known: names().join(", "),
    })
}

/// Refuses light that the machine has no memory for, before any of it is allocated; `needed` tells the bytes for
/// a side.
pub fn refuse_what_does_not_fit(size: usize, needed: impl Fn(usize) -> u64) -> Result<(), Refusal> {
    let Some(free) = memory::free().filter(|free| needed(size) > *free) else { return Ok(()) };
    let mut largest = size;
    while largest > 1 && needed(largest) > free {
        largest /= 2;
    }
    Err(Refusal::Memory { size, needed: needed(size), free, largest })
}
