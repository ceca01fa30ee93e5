//! What occluders let through along a straight line, walked cell by cell.

use std::cmp::Ordering;

use crate::field::Cell;
use crate::transport::transmittance::Transmittance;

/// Lines of sight among the cells of a volume.
#[derive(Clone, Debug)]
pub struct Visibility<'a> {
    cells: &'a Transmittance,
    n: usize,
    /// At (x, y, z) of (n + 1)³, x fastest: how many cells below x, below y and below z weaken light.
    below: Vec<u32>,
}

impl<'a> Visibility<'a> {
    /// Of an n³ volume.
    pub fn new(cells: &'a Transmittance, n: usize) -> Self {
        let side = n + 1;
        let mut below = vec![0u32; side.pow(3)];
        for z in 0..n {
            for y in 0..n {
                let mut row = 0;
                for x in 0..n {
                    row += u32::from(cells.least([x, y, z]) != 1.0);
                    let at = |y: usize, z: usize| (z * side + y) * side + x + 1;
                    below[at(y + 1, z + 1)] = row + below[at(y, z + 1)] + below[at(y + 1, z)] - below[at(y, z)];
                }
            }
        }
        Visibility { cells, n, below }
    }

    /// Whether no cell of the box that has both cells as its corners weakens light.
    fn is_clear(&self, from: Cell, to: Cell) -> bool {
        let side = self.n + 1;
        let low: Cell = std::array::from_fn(|a| from[a].min(to[a]));
        let high: Cell = std::array::from_fn(|a| from[a].max(to[a]) + 1);
        let upto = |x: usize, y: usize, z: usize| i64::from(self.below[(z * side + y) * side + x]);
        let slab = |z: usize| {
            upto(high[0], high[1], z) - upto(low[0], high[1], z) - upto(high[0], low[1], z) + upto(low[0], low[1], z)
        };
        slab(high[2]) == slab(low[2])
    }

    /// The share of light that gets from the centre of one cell to the centre of another, 0 to 1. The cells at
    /// both ends do not weaken it. Where the line leaves a cell exactly through an edge or a corner, it takes
    /// all ways around at once: between two cells that block no light gets through.
    pub fn between(&self, from: Cell, to: Cell) -> f64 {
        if self.is_clear(from, to) {
            return 1.0;
        }
        let length: [usize; 3] = std::array::from_fn(|a| from[a].abs_diff(to[a]));
        let mut gone = [0; 3];
        let mut passed = 1.0;
        loop {
            // The line crosses its j-th border of axis a at (2·j + 1) / (2·length[a]) of its way.
            let mut first = (1, 0); // later than all
            let mut crossed = [false; 3];
            for a in (0..3).filter(|a| gone[*a] < length[*a]) {
                let next = (2 * gone[a] + 1, length[a]);
                match (next.0 * first.1).cmp(&(first.0 * next.1)) {
                    Ordering::Less => (first, crossed) = (next, std::array::from_fn(|b| b == a)),
                    Ordering::Equal => crossed[a] = true,
                    Ordering::Greater => {}
                }
            }
            if crossed.iter().filter(|c| **c).count() > 1 {
                passed *= self.corner(from, to, gone, crossed);
            }
            for a in 0..3 {
                gone[a] += usize::from(crossed[a]);
            }
            if gone == length || passed == 0.0 {
                return passed;
            }
            passed *= self.at(from, to, gone);
        }
    }

    /// What gets by an edge or a corner: the mean over the ways around it that cross one face at a time, of
    /// what the cells on the way let through. 1 where a face is crossed.
    fn corner(&self, from: Cell, to: Cell, gone: [usize; 3], crossed: [bool; 3]) -> f64 {
        let axes: Vec<usize> = (0..3).filter(|a| crossed[*a]).collect();
        let after =
            |steps: &[usize]| self.at(from, to, std::array::from_fn(|a| gone[a] + usize::from(steps.contains(&a))));
        match axes[..] {
            [a, b] => (after(&[a]) + after(&[b])) / 2.0,
            [x, y, z] => {
                let ways = [[x, y], [x, z], [y, x], [y, z], [z, x], [z, y]];
                ways.map(|[first, second]| after(&[first]) * after(&[first, second])).iter().sum::<f64>() / 6.0
            }
            _ => 1.0,
        }
    }

    fn at(&self, from: Cell, to: Cell, gone: [usize; 3]) -> f64 {
        let step = |a: usize| if to[a] > from[a] { from[a] + gone[a] } else { from[a] - gone[a] };
        f64::from(self.cells.least([0, 1, 2].map(step)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Layout;
    use crate::scene::Solid;
    use glam::DVec3;

    fn among(cells: &[(Cell, f64)]) -> Transmittance {
        let blocker = |&(cell, opacity): &(Cell, f64)| Solid::new(cell, DVec3::X, opacity, [0.0; 3]);
        Transmittance::new(8, &cells.iter().map(blocker).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn a_cell_in_between_blocks_and_the_ends_do_not() {
        let cells = among(&[([3, 2, 1], 1.0), ([0, 0, 7], 0.25)]);
        let visibility = Visibility::new(&cells, 8);
        assert_eq!(visibility.between([0, 2, 1], [7, 2, 1]), 0.0);
        assert_eq!(visibility.between([0, 2, 1], [3, 2, 1]), 1.0);
        assert_eq!(visibility.between([3, 2, 1], [7, 2, 1]), 1.0);
        assert_eq!(visibility.between([0, 0, 5], [0, 0, 6]), 1.0);
        assert_eq!(visibility.between([1, 0, 7], [0, 0, 7]), 1.0);
    }

    #[test]
    fn what_is_seen_does_not_depend_on_the_way_one_looks() {
        let cells = among(&[([3, 2, 1], 1.0), ([2, 2, 2], 0.5), ([4, 4, 4], 0.25), ([5, 1, 6], 1.0)]);
        let visibility = Visibility::new(&cells, 8);
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
        let cells = among(&wall);
        let visibility = Visibility::new(&cells, 8);
        let side = |c: Cell| (c[0] + c[1]).cmp(&7);
        for a in Layout::new(8).cells().step_by(3).filter(|c| side(*c).is_lt()) {
            for b in Layout::new(8).cells().step_by(3).filter(|c| side(*c).is_gt()) {
                assert_eq!(visibility.between(a, b), 0.0, "{a:?}, {b:?}");
            }
        }
    }
}
