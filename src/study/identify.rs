//! Is a port right? From two or three dumps of its grid: what it does, which of the known mistakes it makes, or which
//! law it breaks.
//!
//! 1. [`layout`]: which index and which number of the file is what, from the pattern that was injected.
//! 2. [`injection`]: what was injected, against what should have been.
//! 3. [`search`] and [`fit`]: for each geometry, clamp, border and order of updates the next dump is linear in the
//!    weights, so least squares finds them with their error bars; a geometry is right if nothing but rounding is left.
//! 4. [`weights`]: which scheme and factor, or which mistake, those weights are.
//! 5. [`iterations`]: what later iterations keep and what is summed, from the later dumps.
//! 6. [`laws`]: what an unknown port breaks.
//!
//! A mistake is never named while a scheme that is right fits as well. [`catalogue`] holds the mistakes.

pub(crate) mod beside;
pub(crate) mod catalogue;
pub(crate) mod files;
pub(crate) mod fit;
pub(crate) mod injection;
pub(crate) mod iterations;
pub(crate) mod laws;
pub(crate) mod layout;
pub(crate) mod light;
pub(crate) mod port;
pub(crate) mod search;
pub(crate) mod verdict;
pub(crate) mod weights;

mod judge;

use std::collections::BTreeMap;

pub use beside::{Beside, beside};
pub use files::Role;
use injection::Injection;
pub use layout::{Axes, Coefficients, Dump, Layout};
pub use light::{Storage, half};
pub use verdict::{Judgement, Named, Verdict};

use super::pattern::Pattern;

/// The dumps of a port.
#[derive(Clone, Debug)]
pub struct Dumps {
    /// The grid after injection.
    pub injected: Dump,
    /// The source grids by iteration; the first is needed.
    pub source: BTreeMap<usize, Dump>,
    /// The accumulated grids by iteration.
    pub accumulated: BTreeMap<usize, Dump>,
}

/// Why dumps cannot be looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unusable {
    /// No dump of the first iteration.
    #[error("the dump of the first iteration is missing; give --source 1=FILE")]
    NoFirst,
    /// Dumps of several sizes.
    #[error("the dumps are of {0}³ and {1}³ cells; dump one grid throughout")]
    Sizes(usize, usize),
    /// The pattern is for another size.
    #[error("the pattern has {pattern}³ cells, the dumps have {dumps}³; inject the pattern of the dumps' size")]
    PatternSize {
        /// Of the pattern.
        pattern: usize,
        /// Of the dumps.
        dumps: usize,
    },
    /// Nothing was injected.
    #[error("the injected grid is dark; dump it after the lights are injected and before the first iteration")]
    Dark,
    /// A number that is none.
    #[error("{which} holds a number that is infinite or none; the port divides by zero or overflows")]
    NotFinite {
        /// Which dump.
        which: &'static str,
    },
}

/// Looks at the dumps of a port that was given `pattern`, or a scene of its own. `hidden` marks the cells that an
/// occluder may reach, in the order of [`light::Light::cells`]; none where it is empty.
pub fn identify(dumps: &Dumps, pattern: Option<&Pattern>, hidden: &[bool]) -> Result<Verdict, Unusable> {
    let side = dumps.injected.side;
    check(dumps, pattern)?;
    let injection: Option<Injection> = pattern.and_then(|pattern| injection::read(&dumps.injected, pattern));
    let layout = injection.as_ref().map_or_else(|| guessed(dumps), |injection| injection.layout);
    // A port that grows without bound may overflow: what is finite is looked at.
    let mut finite = dumps.clone();
    finite.source.retain(|_, dump| is_finite(dump));
    finite.accumulated.retain(|_, dump| is_finite(dump));
    let lost = dumps.source.len() + dumps.accumulated.len() - finite.source.len() - finite.accumulated.len();
    let hidden = if hidden.is_empty() { vec![false; side.pow(3)] } else { hidden.to_vec() };
    let mut verdict = judge::judge(&finite, layout, injection, hidden);
    let negative = |dump: &Dump| dump.numbers.iter().flatten().any(|c| *c < 0.0);
    if pattern.is_some() && !negative(&dumps.injected) {
        let text = "No number of the injected grid is negative: an unsigned format loses where light goes. Use a signed \
                    or floating-point format.";
        verdict.notes.push(text.to_owned());
    }
    if lost > 0 {
        verdict.notes.push(format!("{lost} of the later dumps overflow and are left out."));
    }
    Ok(verdict)
}

fn is_finite(dump: &Dump) -> bool {
    dump.numbers.iter().flatten().all(|c| c.is_finite())
}

fn check(dumps: &Dumps, pattern: Option<&Pattern>) -> Result<(), Unusable> {
    let side = dumps.injected.side;
    if !dumps.source.contains_key(&1) {
        return Err(Unusable::NoFirst);
    }
    for dump in dumps.source.values().chain(dumps.accumulated.values()) {
        if dump.side != side {
            return Err(Unusable::Sizes(side, dump.side));
        }
    }
    for (which, dump) in [("the injected grid", &dumps.injected), ("the grid after iteration 1", &dumps.source[&1])] {
        if !is_finite(dump) {
            return Err(Unusable::NotFinite { which });
        }
    }
    if let Some(pattern) = pattern.filter(|pattern| pattern.side() != side) {
        return Err(Unusable::PatternSize { pattern: pattern.side(), dumps: side });
    }
    if dumps.injected.numbers.iter().flatten().all(|c| *c == 0.0) {
        return Err(Unusable::Dark);
    }
    Ok(())
}

/// The layout to start from where no pattern tells it: the lab's axes, and c00 where the numbers are never negative.
fn guessed(dumps: &Dumps) -> Layout {
    let Some(first) = dumps.source.get(&1) else {
        return Layout { axes: Axes::LAB, coefficients: Coefficients::PUBLISHED };
    };
    let lowest = |j: usize| dumps.injected.numbers.iter().map(|c| c[j]).fold(f64::INFINITY, f64::min);
    let sum = |j: usize| dumps.injected.numbers.iter().chain(&first.numbers).map(|c| c[j]).sum::<f64>();
    let positive = (0..4).filter(|j| lowest(*j) >= 0.0 && sum(*j) > 0.0);
    let mean = positive.max_by(|a, b| sum(*a).total_cmp(&sum(*b))).unwrap_or(0);
    let coefficients = match mean {
        0 => Coefficients::PUBLISHED,
        3 => Coefficients { order: [1, 2, 3, 0], signs: [1.0; 4] },
        1 => Coefficients { order: [1, 0, 2, 3], signs: [1.0; 4] },
        _ => Coefficients { order: [1, 2, 0, 3], signs: [1.0; 4] },
    };
    Layout { axes: Axes::LAB, coefficients }
}
