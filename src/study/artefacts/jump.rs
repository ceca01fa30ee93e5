//! Jumps where the sample goes over from one level of the octree to another (000, 6.1, figures 14 and 17).
//!
//! With S the merged light, as the transport shows it inside its cells, and U the fixed point of the uniform volume,
//! which has no levels, both as c00, the jump between two finest cells that share a face and are sampled on different
//! levels is
//!
//! ```text
//! | ln(S / S') − ln(U / U') |
//! ```
//!
//! and the number is its mean over all such pairs where U and U' are above a thousandth of U's largest: 0 where the
//! merged light changes by no other factor than it ought to, 0.69 where it is twice that. Where one of the two
//! samples is dark, or negative, there is no logarithm: such pairs are left out and counted.

use crate::field::{Cell, Layout};
use crate::scene::Problem;
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
    /// The largest of them.
    pub max: f64,
    /// Pairs of neighbours over which that is the mean.
    pub pairs: usize,
    /// Pairs left out because one of the two is dark or negative.
    pub undefined: usize,
}

/// U, that jumps in any state of a problem are held against.
#[derive(Clone, Debug)]
pub struct Steady {
    /// The brightness of every finest cell, x fastest.
    light: Vec<f64>,
}

impl Steady {
    /// For the states of a problem; `None` where it has no levels between which light could jump, or the uniform volume
    /// no fixed point.
    ///
    /// # Errors
    /// Where memory is short.
    pub fn of(problem: &Problem) -> Result<Option<Self>, Refusal> {
        if problem.coarsest == problem.size {
            return Ok(None);
        }
        let brightness = Brightness::new(&problem.channels());
        let uniform = reference::fixed_point(problem)?;
        Ok(uniform.map(|uniform| Steady { light: brightness.of_grids(&uniform) }))
    }

    /// The jumps of a state; `None` where all finest cells that count are sampled on one level.
    pub fn jump<T: Real>(&self, state: &Simulation<T>) -> Option<Jump> {
        let merged = Brightness::new(state.channels()).merged(state);
        let jump = between(borders(state), state.sizes().finest(), [&merged, &self.light]);
        Some(jump).filter(|jump| jump.pairs + jump.undefined > 0)
    }
}

/// The jumps of a state, as [`Steady`] has them.
///
/// # Errors
/// Where memory is short.
pub fn of<T: Precision>(state: &Simulation<T>) -> Result<Option<Jump>, Refusal> {
    Ok(Steady::of(state.problem())?.and_then(|steady| steady.jump(state)))
}

/// The jumps between pairs of cells of an n³ volume, given S and U in every cell, x fastest.
fn between(pairs: impl Iterator<Item = [Cell; 2]>, n: usize, [merged, uniform]: [&[f64]; 2]) -> Jump {
    let least = LEAST * uniform.iter().copied().fold(0.0, f64::max);
    let mut jump = Jump::default();
    let mut sum = 0.0;
    for pair in pairs {
        let [here, there] = pair.map(|[x, y, z]| (z * n + y) * n + x);
        if uniform[here].min(uniform[there]) <= least {
            continue;
        }
        if merged[here] > 0.0 && merged[there] > 0.0 {
            let off = ((merged[here] / merged[there]).ln() - (uniform[here] / uniform[there]).ln()).abs();
            sum += off;
            jump.max = jump.max.max(off);
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
    let n = state.sizes().finest();
    let pairs = Layout::new(n).cells().flat_map(move |cell| {
        (0..3).filter(move |axis| cell[*axis] + 1 < n).map(move |axis| {
            let mut next = cell;
            next[axis] += 1;
            [cell, next]
        })
    });
    pairs.filter(|[cell, next]| state.sampled_level(*cell) != state.sampled_level(*next))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_too_much_is_its_logarithm_and_right_light_has_no_jump() {
        // Two cells in a row of a 2³ volume; U falls to a third, S is twice as bright there as it should be.
        let pair = || std::iter::once([[0, 0, 0], [1, 0, 0]]);
        let uniform = [3.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let brighter = uniform.map(|light| 5.0 * light);
        assert!(between(pair(), 2, [&brighter, &uniform]).mean < 1e-15, "a scale of its own does not count");
        let twice = [3.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let jump = between(pair(), 2, [&twice, &uniform]);
        assert!((jump.mean - std::f64::consts::LN_2).abs() < 1e-15 && jump.max == jump.mean);
        let dark = [3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let jump = between(pair(), 2, [&dark, &uniform]);
        assert_eq!((jump.pairs, jump.undefined), (0, 1));
        // What is fainter than a thousandth of the brightest cell does not count.
        let faint = [3.0, 2e-3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(between(pair(), 2, [&twice, &faint]), Jump::default());
    }
}
