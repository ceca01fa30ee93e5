//! The L1 error, as it is and after the one scalar that fits best.

use std::borrow::Borrow;

use rayon::prelude::*;

use crate::field::Grid;
use crate::sh::{Real, Sh};

/// Halvings of the range in which the best scalar lies.
const HALVINGS: usize = 30;
/// Cells whose errors are summed together.
const PIECE: usize = 4096;

/// An error before and after the best scalar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestFit {
    /// With the light as it is.
    pub raw: f64,
    /// With the light multiplied by `scale`.
    pub fitted: f64,
    /// The scalar that fits best.
    pub scale: f64,
}

/// Σ‖O − R‖∞ / Σ‖R‖∞ over all cells, as it is and with O multiplied by the number that makes it least; both
/// are 0 where all is dark. `scales` says how much each channel's norm counts.
///
/// ```
/// use lpv_lab::field::Grid;
/// use lpv_lab::sh::Sh;
/// use lpv_lab::study::fit::l1;
///
/// let mut truth = Grid::<f32>::new(2);
/// truth.set([1, 0, 1], Sh([2.0, 0.0, 1.0, 0.0]));
/// let mut half = truth.clone();
/// half.scale(0.5);
/// let fit = l1(&[1.0], &[half], &[truth]);
/// assert!((fit.raw - 0.5).abs() < 1e-6 && fit.fitted < 1e-6 && (fit.scale - 2.0).abs() < 1e-5);
/// ```
pub fn l1<T: Real, U: Real>(scales: &[f64], moved: &[impl Borrow<Grid<T>>], truth: &[impl Borrow<Grid<U>>]) -> BestFit {
    let cells = lit(scales, moved, truth);
    let channels = scales.len();
    let [found, expected] = [[1.0, 0.0], [0.0, 1.0]].map(|weights| total(&cells, channels, weights).0);
    let difference = |scale: f64| {
        let (sum, slope) = total(&cells, channels, [scale, 1.0]);
        (if sum == 0.0 { 0.0 } else { sum / expected }, slope)
    };
    // The difference is convex in the scale. Its least value is no further off than twice the ratio of the sums.
    let (mut low, mut high) = (0.0, if found > 0.0 { 2.0 * expected / found } else { 0.0 });
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if difference(middle).1 > 0.0 { high = middle } else { low = middle }
    }
    let (raw, scale) = (difference(1.0).0, 0.5 * (low + high));
    let fitted = difference(scale).0;
    // The search ends a little beside the best; where that is 1 there is nothing to gain.
    if fitted < raw { BestFit { raw, fitted, scale } } else { BestFit { raw, fitted: raw, scale: 1.0 } }
}

/// What one channel of a cell holds, and what it should hold, each multiplied by the channel's scale.
type Pair<T> = [Sh<T>; 2];

/// The cells in which anything is lit, all channels of a cell in a row.
fn lit<T: Real, U: Real>(
    scales: &[f64],
    moved: &[impl Borrow<Grid<T>>],
    truth: &[impl Borrow<Grid<U>>],
) -> Vec<Pair<T>> {
    let Some(layout) = moved.first().map(|grid| grid.borrow().layout()) else { return Vec::new() };
    let moved = || moved.iter().map(Borrow::borrow);
    let truth = || truth.iter().map(Borrow::borrow);
    let mut cells = Vec::new();
    for i in layout.cells().map(|cell| layout.index(cell)) {
        let pair = |((o, r), scale): ((&Grid<T>, &Grid<U>), &f64)| {
            [o.at(i), r.at(i).cast()].map(|sh: Sh<T>| sh * T::of(*scale))
        };
        let start = cells.len();
        cells.extend(moved().zip(truth()).zip(scales).map(pair));
        if cells[start..].iter().flatten().all(|sh| sh.is_zero()) {
            cells.truncate(start);
        }
    }
    cells
}

/// Σ‖u·O − v·R‖∞, the norm over all channels, and its slope in u.
fn total<T: Real>(cells: &[Pair<T>], channels: usize, [u, v]: [f64; 2]) -> (f64, f64) {
    let cell = |pairs: &[Pair<T>]| {
        let (mut norm, mut slope) = (0.0, 0.0);
        for [o, r] in pairs {
            for (o, r) in o.0.iter().zip(r.0) {
                let (o, difference) = (o.to_f64(), u * o.to_f64() - v * r.to_f64());
                if difference.abs() > norm {
                    (norm, slope) = (difference.abs(), o * difference.signum());
                }
            }
        }
        (norm, slope)
    };
    let add = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
    let piece = |piece: &[Pair<T>]| piece.chunks_exact(channels).map(cell).fold((0.0, 0.0), add);
    // Pieces are summed in their order, so that the sum is the same however many cores there are.
    let sums: Vec<(f64, f64)> = cells.par_chunks(PIECE * channels.max(1)).map(piece).collect();
    sums.into_iter().fold((0.0, 0.0), add)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_scalar_brings_a_multiple_of_the_truth_to_no_error() {
        let mut truth = Grid::<f64>::new(2);
        truth.set([1, 0, 0], Sh([2.0, 0.0, 1.0, 0.0]));
        truth.set([0, 1, 1], Sh([0.5, 0.2, 0.0, 0.0]));
        let mut moved = truth.clone();
        moved.scale(0.25);
        let fit = l1(&[1.0, 0.5], &[moved, Grid::new(2)], &[truth, Grid::new(2)]);
        assert!((fit.raw - 0.75).abs() < 1e-12 && fit.fitted < 1e-6 && (fit.scale - 4.0).abs() < 1e-5, "{fit:?}");
    }
}
