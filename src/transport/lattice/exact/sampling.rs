//! What a coarse cell holds inside: light that decays along each axis as its neighbours say, with the cell's mean.
//!
//! A cell of h planes with the mean a, slope s along an axis and its centre at c holds at the plane x
//!
//! ```text
//! a·e^(s·(x − c))/m(s, h)          m(s, h) = (1/h)·Σ e^(s·(x − c)) = sinh(sh/2)/(h·sinh(s/2))
//! ```
//!
//! times the same for the other two axes; all four coefficients alike. The division by m keeps the mean, whatever s.
//!
//! **The slope** is what makes the neighbour's c00 come out as it is: if light went on with the slope s beyond the
//! border, a neighbour of hₙ planes whose centre is δ away would hold the mean c·e^(±sδ)·m(s, hₙ)/m(s, h). As
//! sinh 2t = 2·sinh t·cosh t, m(s, 2h)/m(s, h) = cosh(sh/2). So with R = cₙ/c, w the smaller of the two widths and
//! u = e^(±sw)
//!
//! ```text
//! R = u                               of one size
//! R = u^(3/2)·cosh(½·ln u) = ½(u² + u)     the neighbour twice as wide:  u = 4R/(1 + √(1 + 8R))
//! R = u^(3/2)/cosh(½·ln u) = 2u²/(u + 1)   half as wide:                 u = ¼(R + √(R² + 8R))
//! ```
//!
//! Both sides give a slope; their mean is taken, within ±[`STEEPEST`]. A side without light, without positive light or
//! outside the volume gives none. Finest cells need no slope.

use crate::field::Cell;

/// The largest slope, in e-foldings a finest cell. Light that is steeper than this is so faint at its far end that
/// nobody will miss it.
pub const STEEPEST: f64 = 2.5;

/// A neighbour of a cell along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// Its width in finest cells: the cell's own, or half or twice as much.
    pub width: f64,
    /// Its c00; the mean of all there are on this side.
    pub mean: f64,
}

/// The slope along an axis of a cell of `width` finest cells with c00 = `mean`, between the neighbours at smaller and at
/// larger coordinates.
pub fn slope(width: f64, mean: f64, [below, above]: [Option<Neighbour>; 2]) -> f64 {
    if width <= 1.0 || mean <= 0.0 {
        return 0.0;
    }
    let towards = |there: Option<Neighbour>| {
        let there = there.filter(|there| there.mean > 0.0)?;
        Some(outward(width, there.width, there.mean / mean))
    };
    let found = [towards(below).map(|s| -s), towards(above)];
    let count = found.iter().flatten().count();
    if count == 0 { 0.0 } else { found.into_iter().flatten().sum::<f64>() / count as f64 }
}

/// The slope towards a neighbour of `there` finest cells from one of `here`, whose c00 is `ratio` times as large.
fn outward(here: f64, there: f64, ratio: f64) -> f64 {
    // No square of it overflows, and what it stands for is far steeper than the steepest.
    let ratio = ratio.min(1e150);
    let u = if here == there {
        ratio
    } else if here < there {
        4.0 * ratio / (1.0 + (1.0 + 8.0 * ratio).sqrt())
    } else {
        0.25 * (ratio + (ratio * (ratio + 8.0)).sqrt())
    };
    (u.ln() / here.min(there)).clamp(-STEEPEST, STEEPEST)
}

/// What the mean of a cell of `width` finest cells is multiplied with along one axis for each of its two halves:
/// e^(±t)/cosh t with t = s·width/4.
pub fn halves(s: f64, width: f64) -> [f64; 2] {
    shares((0.5 * s * width).exp())
}

/// [`halves`] of a cell between two neighbours of its own width, or none: as [`slope`] has it, without logarithms.
pub fn halves_between(width: f64, mean: f64, [below, above]: [Option<f64>; 2]) -> [f64; 2] {
    if width <= 1.0 || mean <= 0.0 {
        return [1.0; 2];
    }
    let most = (STEEPEST * width).exp();
    // e^(s·width) towards larger coordinates, as each side has it.
    let rise =
        |there: Option<f64>| there.filter(|there| *there > 0.0).map(|there| (there / mean).clamp(1.0 / most, most));
    match [rise(below).map(|r| 1.0 / r), rise(above)] {
        [Some(a), Some(b)] => shares((a * b).sqrt().sqrt()),
        [Some(a), None] | [None, Some(a)] => shares(a.sqrt()),
        [None, None] => [1.0; 2],
    }
}

/// The halves where light rises by `rise` from one to the other.
fn shares(rise: f64) -> [f64; 2] {
    let low = 2.0 / (1.0 + rise);
    [low, 2.0 - low]
}

/// Sets `planes` to what the mean of a cell of `width` finest cells is multiplied with at its planes, along one axis.
pub fn planes(s: f64, width: usize, planes: &mut Vec<f64>) {
    // From the bright end on, so that a slope and its opposite give the same numbers.
    let fall = (-s.abs()).exp();
    planes.clear();
    planes.extend(std::iter::successors(Some(1.0), |c| Some(c * fall)).take(width));
    let mean = planes.iter().sum::<f64>() / width as f64;
    planes.iter_mut().for_each(|c| *c /= mean);
    if s > 0.0 {
        planes.reverse();
    }
}

/// The eight children of a cell with what they take of its mean, from what [`halves`] gives for each axis.
pub fn children([x, y, z]: Cell, halves: [[f64; 2]; 3]) -> impl Iterator<Item = (Cell, f64)> {
    (0..8).map(move |i| {
        let [dx, dy, dz] = [i & 1, i >> 1 & 1, i >> 2];
        ([2 * x + dx, 2 * y + dy, 2 * z + dz], halves[0][dx] * halves[1][dy] * halves[2][dz])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_and_halves_keep_the_mean_whatever_the_slope() {
        for width in [2usize, 4, 32, 512] {
            for s in [0.0, 1e-7, -0.3, 1.1, STEEPEST, -STEEPEST] {
                let mut planes = Vec::new();
                super::planes(s, width, &mut planes);
                let mean = planes.iter().sum::<f64>() / width as f64;
                assert!((mean - 1.0).abs() < 1e-9, "s = {s}, h = {width}: {mean}");
                let [low, high] = halves(s, width as f64);
                assert!((0.5 * (low + high) - 1.0).abs() < 1e-9, "s = {s}, h = {width}");
                let first = planes[..width / 2].iter().sum::<f64>() / (width / 2) as f64;
                let [bright, next] = if s > 0.0 { [width - 1, width - 2] } else { [0, 1] };
                assert!((planes[next] / planes[bright] - (-s.abs()).exp()).abs() < 1e-12);
                assert!((first - low).abs() < 1e-9 * low.max(1.0));
            }
        }
    }

    #[test]
    fn light_that_decays_exponentially_is_found_again_from_means_of_any_size() {
        let s = -0.8f64;
        // The mean of e^(sx) over planes from `from` on.
        let mean = |from: i32, width: i32| {
            (from..from + width).map(|x| (s * f64::from(x)).exp()).sum::<f64>() / f64::from(width)
        };
        for (below, here, above) in [(4, 4, 4), (2, 4, 8), (8, 4, 2), (1, 2, 2)] {
            let neighbour = |from, width: i32| Some(Neighbour { width: f64::from(width), mean: mean(from, width) });
            let found = slope(f64::from(here), mean(0, here), [neighbour(-below, below), neighbour(here, above)]);
            assert!((found - s).abs() < 1e-12, "{below}, {here}, {above}: {found}");
        }
    }

    #[test]
    fn between_neighbours_of_its_width_a_cell_is_halved_by_its_slope() {
        for (below, above) in [(Some(0.2), Some(3.0)), (None, Some(1e-9)), (Some(1e-30), None), (Some(-1.0), Some(4.0))]
        {
            let neighbour = |mean: Option<f64>| mean.map(|mean| Neighbour { width: 4.0, mean });
            let wanted = halves(slope(4.0, 0.7, [neighbour(below), neighbour(above)]), 4.0);
            let found = halves_between(4.0, 0.7, [below, above]);
            assert!(
                (0..2).all(|k| (found[k] - wanted[k]).abs() < 1e-12),
                "{below:?}, {above:?}: {found:?}, {wanted:?}"
            );
        }
    }

    #[test]
    fn where_nothing_is_known_light_is_even() {
        let dark = Some(Neighbour { width: 4.0, mean: 0.0 });
        assert_eq!(slope(4.0, 1.0, [None, dark]), 0.0);
        assert_eq!(slope(4.0, -1.0, [None, Some(Neighbour { width: 4.0, mean: 1.0 })]), 0.0);
        assert_eq!(slope(1.0, 1.0, [None, Some(Neighbour { width: 1.0, mean: 9.0 })]), 0.0);
        let faint = Some(Neighbour { width: 4.0, mean: 1e-30 });
        assert_eq!(slope(4.0, 1.0, [None, faint]), -STEEPEST);
    }
}
