//! What occluders let through along a straight line, walked cell by cell.

use crate::field::Cell;
use crate::propagate::transparency::Transparency;

/// Lines of sight among the cells of a volume.
#[derive(Clone, Copy, Debug)]
pub struct Visibility<'a>(pub &'a Transparency);

impl Visibility<'_> {
    /// The share of light that gets from the centre of one cell to the centre of another, 0 to 1. The cells at
    /// both ends do not weaken it. Where the line leaves a cell exactly through an edge or a corner, it takes
    /// all ways around at once: between two cells that block no light gets through.
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
        f64::from(self.0.at([0, 1, 2].map(step)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Layout;
    use crate::propagate::geometry::Blocker;
    use glam::DVec3;

    fn among(cells: &[(Cell, f64)]) -> Transparency {
        let blocker = |&(cell, opacity): &(Cell, f64)| Blocker { cell, normal: DVec3::X, opacity, albedo: [0.0; 3] };
        Transparency::new(8, &cells.iter().map(blocker).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn a_cell_in_between_blocks_and_the_ends_do_not() {
        let cells = among(&[([3, 2, 1], 1.0), ([0, 0, 7], 0.25)]);
        let visibility = Visibility(&cells);
        assert_eq!(visibility.between([0, 2, 1], [7, 2, 1]), 0.0);
        assert_eq!(visibility.between([0, 2, 1], [3, 2, 1]), 1.0);
        assert_eq!(visibility.between([3, 2, 1], [7, 2, 1]), 1.0);
        assert_eq!(visibility.between([0, 0, 5], [0, 0, 6]), 1.0);
        assert_eq!(visibility.between([1, 0, 7], [0, 0, 7]), 1.0);
    }

    #[test]
    fn what_is_seen_does_not_depend_on_the_way_one_looks() {
        let cells = among(&[([3, 2, 1], 1.0), ([2, 2, 2], 0.5), ([4, 4, 4], 0.25), ([5, 1, 6], 1.0)]);
        let visibility = Visibility(&cells);
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
        let visibility = Visibility(&cells);
        let side = |c: Cell| (c[0] + c[1]).cmp(&7);
        for a in Layout::new(8).cells().step_by(3).filter(|c| side(*c).is_lt()) {
            for b in Layout::new(8).cells().step_by(3).filter(|c| side(*c).is_gt()) {
                assert_eq!(visibility.between(a, b), 0.0, "{a:?}, {b:?}");
            }
        }
    }
}
