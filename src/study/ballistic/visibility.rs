//! What occluders let through along a straight line, walked cell by cell.

use crate::field::Cell;
use crate::propagate::geometry::Blocker;

/// How much of the light that meets a cell goes on, for the cells of an n³ volume.
#[derive(Clone, Debug)]
pub struct Visibility {
    n: usize,
    passes: Vec<f32>,
}

impl Visibility {
    /// What `blockers` let through: 1 − opacity each; `None` if there are none.
    pub fn new(n: usize, blockers: &[Blocker]) -> Option<Self> {
        let mut passes = vec![1.0; n.pow(3)];
        for blocker in blockers {
            let [x, y, z] = blocker.cell;
            passes[(z * n + y) * n + x] = 1.0 - blocker.opacity as f32;
        }
        (!blockers.is_empty()).then_some(Visibility { n, passes })
    }

    /// The share of light that gets from the centre of one cell to the centre of another, 0 to 1. The cells at
    /// both ends do not weaken it. Where the line leaves a cell exactly through an edge or a corner, it counts as
    /// the mean of the lines close by: between two cells that block, no light gets through.
    pub fn between(&self, from: Cell, to: Cell) -> f64 {
        let length: [usize; 3] = std::array::from_fn(|a| from[a].abs_diff(to[a]));
        let mut gone = [0; 3];
        let mut passed = 1.0;
        loop {
            // The line crosses its j-th border of axis a at (2·j + 1) / (2·length[a]) of its way.
            let ahead = |a: usize| (gone[a] < length[a]).then(|| (2 * gone[a] + 1, length[a]));
            let earlier = |a: (usize, usize), b: (usize, usize)| a.0 * b.1 < b.0 * a.1;
            let first = (0..3).filter_map(ahead).reduce(|best, next| if earlier(next, best) { next } else { best });
            let Some(first) = first else { return passed };
            let crossed: [bool; 3] = std::array::from_fn(|a| ahead(a).is_some_and(|next| !earlier(first, next)));
            passed *= self.corner(from, to, gone, crossed);
            for a in 0..3 {
                gone[a] += usize::from(crossed[a]);
            }
            if gone == length || passed == 0.0 {
                return passed;
            }
            passed *= self.at(from, to, gone);
        }
    }

    /// What gets past an edge or a corner: lines close by cross its borders one after the other, in every
    /// order, so this is the mean over all orders of what the cells on the way let through; 1 at a face.
    fn corner(&self, from: Cell, to: Cell, gone: [usize; 3], crossed: [bool; 3]) -> f64 {
        const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        let steps = crossed.iter().filter(|c| **c).count();
        let pass = |order: &[usize; 3]| {
            let mut at = gone;
            // The cell behind the last border is the next on the line itself, and not counted here.
            let between = order.iter().filter(|&&a| crossed[a]).take(steps - 1);
            between.fold(1.0, |passed, &a| {
                at[a] += 1;
                passed * self.at(from, to, at)
            })
        };
        ORDERS.iter().map(pass).sum::<f64>() / ORDERS.len() as f64
    }

    fn at(&self, from: Cell, to: Cell, gone: [usize; 3]) -> f64 {
        let [x, y, z] = std::array::from_fn(|a| if to[a] > from[a] { from[a] + gone[a] } else { from[a] - gone[a] });
        f64::from(self.passes[(z * self.n + y) * self.n + x])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Layout;
    use glam::DVec3;

    fn among(cells: &[(Cell, f64)]) -> Visibility {
        let blocker = |&(cell, opacity): &(Cell, f64)| Blocker { cell, normal: DVec3::X, opacity, albedo: [0.0; 3] };
        Visibility::new(8, &cells.iter().map(blocker).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn a_cell_in_between_blocks_and_the_ends_do_not() {
        let visibility = among(&[([3, 2, 1], 1.0), ([0, 0, 7], 0.25)]);
        assert_eq!(visibility.between([0, 2, 1], [7, 2, 1]), 0.0);
        assert_eq!(visibility.between([0, 2, 1], [3, 2, 1]), 1.0);
        assert_eq!(visibility.between([3, 2, 1], [7, 2, 1]), 1.0);
        assert_eq!(visibility.between([0, 0, 5], [0, 0, 6]), 1.0);
        assert_eq!(visibility.between([1, 0, 7], [0, 0, 7]), 1.0);
    }

    #[test]
    fn what_is_seen_does_not_depend_on_the_way_one_looks() {
        let visibility = among(&[([3, 2, 1], 1.0), ([2, 2, 2], 0.5), ([4, 4, 4], 0.25), ([5, 1, 6], 1.0)]);
        for a in Layout::new(8).cells().step_by(7) {
            for b in Layout::new(8).cells().step_by(5) {
                let there = visibility.between(a, b);
                assert!((there - visibility.between(b, a)).abs() < 1e-12, "{a:?}, {b:?}");
            }
        }
    }

    #[test]
    fn no_line_slips_between_cells_that_touch_along_an_edge() {
        // A slanted wall: each cell touches the next only along an edge, yet a walk by faces cannot pass it.
        let wall: Vec<(Cell, f64)> = (0..8).flat_map(|x| (0..8).map(move |z| ([x, 7 - x, z], 1.0))).collect();
        let visibility = among(&wall);
        let side = |c: Cell| (c[0] + c[1]).cmp(&7);
        for a in Layout::new(8).cells().step_by(3).filter(|c| side(*c).is_lt()) {
            for b in Layout::new(8).cells().step_by(3).filter(|c| side(*c).is_gt()) {
                assert_eq!(visibility.between(a, b), 0.0, "{a:?}, {b:?}");
            }
        }
    }
}
