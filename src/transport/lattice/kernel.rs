//! The loops that take one grid one iteration further.
//!
//! [`plain`] is the definition. The others give the same light faster: [`form`] finds in a stencil the few numbers that
//! its symmetry leaves, `row` computes a row of cells from them, `slab` a slab of rows with what may be skipped in it
//! (`inspect` looks at what came out), [`step`] one iteration, [`with_solids`] one among occluders, [`blocked`] several
//! in one pass over memory, and [`pass`] chooses between the last two. [`crate::transport::team`] is how threads share
//! that work.

pub(crate) mod blocked;
#[cfg(test)]
mod conformance;
pub(crate) mod form;
mod fuzzy;
mod gather;
mod inspect;
pub(crate) mod occluded;
pub(crate) mod pass;
pub mod plain;
pub(super) mod row;
mod slab;
mod split;
pub(crate) mod step;
pub(crate) mod with_solids;

use crate::field::{Grid, Marks};
use crate::sh::{Real, Sh};

pub use form::{Form, Share};
pub use inspect::lies_in_cone;
pub use slab::{Instructions, Order, Tally};

/// A coefficient smaller than this in magnitude is taken as zero after every iteration, in every kernel
/// and precision. Light fades exponentially; without a floor it would end in denormal numbers, which
/// many processors handle a hundred times slower and which round to themselves at p > 2, so that they
/// never go out. With it whole rows go dark in the end, and can be skipped.
pub const FLOOR: f64 = 1e-30;

/// `light` with coefficients under [`FLOOR`] made zero.
#[inline]
pub fn settle<T: Real>(light: Sh<T>) -> Sh<T> {
    Sh(light.0.map(|c| settle_number(c, T::of(FLOOR))))
}

/// `c`, or zero (never −0) if it is smaller in magnitude than `floor`.
#[inline(always)]
pub(super) fn settle_number<T: Real>(c: T, floor: T) -> T {
    if c.abs() < floor { T::ZERO } else { c }
}

/// One channel of light on one level, as the fast loops take it. All grids and marks are of one
/// size.
pub struct Level<'a, T> {
    /// S_k.
    pub source: &'a mut Grid<T>,
    /// Where S_k may be lit.
    pub source_lit: &'a mut Marks,
    /// S_{k−1}, to be overwritten.
    pub target: &'a mut Grid<T>,
    /// Where S_{k−1} may be lit.
    pub target_lit: &'a mut Marks,
    /// What the new light is added to, if anything.
    pub sum: Option<&'a mut Grid<T>>,
    /// Where light has been.
    pub marks: &'a mut Marks,
}

impl<T> Level<'_, T> {
    /// Exchanges source and target for good if `turns` is odd, so that the newest light is in the source.
    fn turn(&mut self, turns: usize) {
        if turns % 2 == 1 {
            std::mem::swap(self.source, self.target);
            std::mem::swap(self.source_lit, self.target_lit);
        }
    }

    /// The same, after `turns` exchanges of source and target.
    fn turned(&mut self, turns: usize) -> Level<'_, T> {
        let Level { source, source_lit, target, target_lit, sum, marks } = self;
        let (mut from, mut to) = ((&mut **source, &mut **source_lit), (&mut **target, &mut **target_lit));
        if turns % 2 == 1 {
            (from, to) = (to, from);
        }
        let ((source, source_lit), (target, target_lit)) = (from, to);
        Level { source, source_lit, target, target_lit, sum: sum.as_deref_mut(), marks }
    }
}
