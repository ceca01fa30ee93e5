//! Jumps where the sample goes over from one level of the octree to another (000, 6.1, figures 14 and 17).
//!
//! With S the merged light and U the fixed point of the uniform volume, which has no levels, both as c00, the
//! jump between two finest cells that share a face and are sampled on different levels is
//!
//! ```text
//! | ln(S / S') − ln(U / U') |
//! ```
//!
//! and the number is its mean over all such pairs where U and U' are above a thousandth of U's largest: 0 where the
//! merged light changes by no other factor than it ought to, 0.69 where it is twice that. Where one of the two
//! samples is dark, or negative, there is no logarithm: such pairs are left out and counted.

use crate::field::{Cell, Layout};
use crate::sh::Real;
use crate::simulation::{Refusal, Simulation};
use crate::study::light::Brightness;
use crate::study::reference;
use crate::transport::kind::Precision;

/// The part of the uniform volume's brightest cell under which its light does not count.
const LEAST: f64 = 1e-3;

/// What is wrong at the borders between levels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jump {
    /// The mean of |ln(S/S') − ln(U/U')|; 0 where no pair is counted.
    pub mean: f64,
    /// Pairs of neighbours over which that is the mean.
    pub pairs: usize,
    /// Pairs left out because one of the two is dark or negative.
    pub undefined: usize,
}

/// The jumps of a state; `None` where all finest cells that count are sampled on one level, or the uniform volume has
/// no fixed point.
///
/// # Errors
/// Where memory is short.
pub fn of<T: Precision>(state: &Simulation<T>) -> Result<Option<Jump>, Refusal> {
    if borders(state).next().is_none() {
        return Ok(None);
    }
    let Some(uniform) = reference::fixed_point(state.problem())? else { return Ok(None) };
    let brightness = Brightness::new(&state.problem().channels());
    let jump = between(state, &brightness.of_grids(&uniform));
    Ok(Some(jump).filter(|jump| jump.pairs + jump.undefined > 0))
}

/// The jumps of a state, `uniform` being the brightness of every finest cell as it ought to be, x fastest.
fn between<T: Real>(state: &Simulation<T>, uniform: &[f64]) -> Jump {
    let n = state.sizes().finest();
    let merged = Brightness::new(state.channels()).of_merged(state);
    let least = LEAST * uniform.iter().copied().fold(0.0, f64::max);
    let at = |[x, y, z]: Cell| (z * n + y) * n + x;
    let ought = |cell: Cell| uniform[at(cell)];
    let mut jump = Jump::default();
    let mut sum = 0.0;
    for pair in borders(state).filter(|pair| pair.iter().all(|cell| ought(*cell) > least)) {
        let [here, there] = pair.map(|cell| merged[at(cell)]);
        if here > 0.0 && there > 0.0 {
            sum += ((here / there).ln() - (ought(pair[0]) / ought(pair[1])).ln()).abs();
            jump.pairs += 1;
        } else {
            jump.undefined += 1;
        }
    }
    if jump.pairs > 0 {
        jump.mean = sum / jump.pairs as f64;
    }
    jump
}

/// The pairs of finest cells that share a face and are sampled on different levels.
fn borders<T: Real>(state: &Simulation<T>) -> impl Iterator<Item = [Cell; 2]> {
    let (n, index) = (state.sizes().finest(), state.index());
    let pairs = Layout::new(n).cells().flat_map(move |cell| {
        (0..3).filter(move |axis| cell[*axis] + 1 < n).map(move |axis| {
            let mut next = cell;
            next[axis] += 1;
            [cell, next]
        })
    });
    pairs.filter(|[cell, next]| index.index(*cell) != index.index(*next))
}
