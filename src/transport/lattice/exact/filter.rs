//! How light that was just sent off is handed to the next coarser level.
//!
//! The mean of eight children forgets where in the coarse cell light starts, and a coarse cell lets it out through all
//! its faces alike; so light that starts beside a face would cross it too slowly. The filter gives a part of it to the
//! neighbour there at once. Along each axis a child goes to its own parent with 1 − w, and to the parent beside it with
//! w; with the eighth of the mean that is taps of (w, 1 − w, 1 − w, w)/2 over the four nearest children.
//!
//! **w.** Far away, plane light that started in a fine cell should look as if it had started there and not in the centre
//! of its parent. Light of the decay μ is heard from x with e^(±μx). A fine cell lies h/4 beside the centre of its
//! parent (h the parent's width), and its light is given to the centres at 0 and at h. Ask for one strength f,
//!
//! ```text
//! (1 − w) + w·e^(μh) = f·e^(μh/4)          (1 − w) + w·e^(−μh) = f·e^(−μh/4)
//! ```
//!
//! Divide the two: (1 − w)·sinh t = w·sinh 3t with t = μh/4, so w = 1/(4·cosh² t), and f = cosh 2t/cosh t is the same
//! wherever in its parent light starts. At μ = 0 w = ¼, the taps of linear interpolation; where light hardly moves w → 0,
//! the mean.
//!
//! Nothing is lost between cells; what would go out of the volume does.

use super::decay::Decay;
use crate::field::{Cell, Grid};
use crate::sh::{Real, Sh};

/// Adds to `coarser`, of half the side, the filtered light of finer cells. `h` is the width of a coarse cell in finest
/// cells.
pub fn hand_over<T: Real>(
    decay: &Decay,
    h: usize,
    finer: impl IntoIterator<Item = (Cell, Sh<T>)>,
    coarser: &mut Grid<T>,
) {
    hand_over_among(decay, h, finer, coarser, |_| true);
}

/// [`hand_over`] where only the coarse cells that `there` tells take light: what would go to others, which finer ones
/// take the place of, stays in the parent.
pub fn hand_over_among<T: Real>(
    decay: &Decay,
    h: usize,
    finer: impl IntoIterator<Item = (Cell, Sh<T>)>,
    coarser: &mut Grid<T>,
    there: impl Fn(Cell) -> bool,
) {
    let n = coarser.side();
    let w = decay.filter(h as f64);
    let (own, beside) = (0.5 * (1.0 - w), 0.5 * w);
    for (cell, light) in finer {
        // Along each axis: the parent, and the one beside the child, if there is one.
        let two = cell.map(|c| {
            let parent = c / 2;
            let next = if c % 2 == 1 { Some(parent + 1).filter(|p| *p < n) } else { parent.checked_sub(1) };
            [Some((parent, own)), next.map(|next| (next, beside))]
        });
        for (z, weight_z) in two[2].iter().flatten() {
            for (y, weight_y) in two[1].iter().flatten() {
                for (x, weight_x) in two[0].iter().flatten() {
                    let to = Some([*x, *y, *z]).filter(|to| there(*to)).unwrap_or(cell.map(|c| c / 2));
                    coarser.add(to, light * T::of(weight_x * weight_y * weight_z));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn handed_over(decay: &Decay, cell: Cell) -> Grid<f64> {
        let mut coarse = Grid::new(4);
        hand_over(decay, 2, [(cell, Sh([1.0, 0.5, -0.25, 0.125]))], &mut coarse);
        coarse
    }

    #[test]
    fn a_child_is_shared_between_its_parent_and_those_beside_it() {
        let decay = Decay::new(1.146_309_91);
        let w = 0.183_004;
        let coarse = handed_over(&decay, [3, 4, 2]);
        let at = |cell| coarse.get(cell).0[0] * 8.0;
        for (cell, weight) in [
            ([1, 2, 1], (1.0 - w) * (1.0 - w) * (1.0 - w)),
            ([2, 2, 1], w * (1.0 - w) * (1.0 - w)),
            ([2, 1, 0], w * w * w),
            ([0, 2, 1], 0.0),
        ] {
            assert!((at(cell) - weight).abs() < 2e-6, "{cell:?}: {}, {weight}", at(cell));
        }
        assert_eq!(coarse.get([1, 2, 1]).0[1], 0.5 * coarse.get([1, 2, 1]).0[0]);
    }

    #[test]
    fn light_is_kept_inside_and_goes_out_at_the_border() {
        let decay = Decay::new(0.0);
        assert!((handed_over(&decay, [3, 4, 2]).energy() * 8.0 - 1.0).abs() < 1e-15);
        assert!((handed_over(&decay, [0, 4, 2]).energy() * 8.0 - 0.75).abs() < 1e-15);
    }

    #[test]
    fn what_would_go_to_a_finer_neighbour_stays_in_the_parent() {
        let mut coarse = Grid::new(4);
        let decay = Decay::new(1.146_309_91);
        hand_over_among(&decay, 2, [([3, 4, 2], Sh([1.0, 0.5, -0.25, 0.125]))], &mut coarse, |[x, ..]| x < 2);
        let whole = handed_over(&decay, [3, 4, 2]);
        assert!((coarse.energy() - whole.energy()).abs() < 1e-15);
        let gained = (coarse.get([1, 2, 1]) - whole.get([1, 2, 1])).0[0];
        let lost: f64 = whole.iter().filter(|(cell, _)| cell[0] == 2).map(|(_, light)| light.0[0]).sum();
        assert!(lost > 0.0 && (gained - lost).abs() < 1e-15, "{gained}, {lost}");
    }
}
