//! Light that would leave the range of numbers.

use std::fmt;

use crate::sh::Real;

/// How far below the largest number light must stay: eight children are added before their mean is taken,
/// and colours are added where they are shown.
const HEADROOM: f64 = 32.0;

/// An iteration that was not done because its light could have left the range of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Divergence {
    /// The iteration that was not done; the light is that of the one before.
    pub iteration: usize,
    /// The level, 0 the finest.
    pub level: usize,
    /// Its side, in cells.
    pub side: usize,
    /// The largest magnitude among the coefficients of its source and accumulated light.
    pub largest: f64,
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Divergence { iteration, level, side, largest } = self;
        write!(
            f,
            "the light diverges: iteration {iteration} could take level {level} ({side}³), now up to {largest:.1e}, \
             out of the range of numbers"
        )
    }
}

/// The largest coefficient that light in `T` may have before an iteration is refused.
pub fn limit<T: Real>() -> f64 {
    T::LARGEST / HEADROOM
}
