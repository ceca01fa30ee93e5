//! What cannot be run, and why.

use super::lattice::exact::Grows;
use super::lattice::levels::TooLarge;
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
    /// Nested cascades that do not fit into the volume.
    #[error("{0}")]
    Cascades(String),
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
    /// A precision that a transport is not computed in.
    #[error("\"{name}\" is computed in single precision only; choose a propagator that has double precision too")]
    Precision {
        /// The transport.
        name: &'static str,
    },
    /// Something that a graphics card does not do, or no card.
    #[error("{what}")]
    Device {
        /// What cannot be done, and what can.
        what: String,
    },
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

impl Refusal {
    /// There is nothing called `name`; `known` is what there is.
    pub fn unknown(name: &str, known: &[&'static str]) -> Self {
        Refusal::UnknownScheme { name: name.to_owned(), nearest: nearest(name, known), known: known.join(", ") }
    }
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
