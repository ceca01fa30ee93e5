//! Where nested cascades lie: m grids of c³ cells about a point, cells twice as wide from each to the next.
//!
//! NVIDIA's sample for Direct3D 11 lays them about the camera, so that a volume of n = c·2^(m−1) finest cells costs
//! m·c³ cells and not n³. Grid i has cells of level i; the last one fills the volume, with as many cells as that takes
//! where the octree has no coarser level. A grid lies in whole cells of
//! the next coarser one, which is why it moves by two of its own cells at a time when its point moves, and inside the
//! volume: where the point is near to the volume's border, or beyond it, it is not in the middle of its grids.

use crate::field::{Cell, Levels, Marks};

/// Nested cascades in a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nest {
    sizes: Levels,
    side: usize,
    center: [f64; 3],
}

impl Nest {
    /// Grids of `side`³ cells about a point in finest cells, or about the volume's middle. The side must be what
    /// [`crate::scene::propagation::descent::Descent::Cascades`] asks for.
    pub fn new(sizes: Levels, side: usize, center: Option<[f64; 3]>) -> Self {
        Nest { sizes, side, center: center.unwrap_or([0.5 * sizes.finest() as f64; 3]) }
    }

    /// How many grids there are, m.
    pub fn count(&self) -> usize {
        ((self.sizes.finest() / self.side).max(1).ilog2() as usize + 1).min(self.sizes.count())
    }

    /// Cells along a side of a grid, c.
    pub fn side(&self) -> usize {
        self.side
    }

    /// The cell of level `i` in which grid `i` begins, if it is not the last.
    pub fn corner(&self, i: usize) -> Cell {
        let room = (self.sizes.finest() >> i).saturating_sub(self.side);
        self.center.map(|center| {
            let middle = center / f64::from(1u32 << i);
            // In cells of the next coarser level; a point left of the volume gives 0.
            let begins = (0.5 * (middle - 0.5 * self.side as f64)).round().max(0.0);
            (2 * begins as usize).min(room)
        })
    }

    /// The cells of level `i` in grid `i`; all, where there is no such grid because a finer one fills the volume.
    pub fn cells(&self, i: usize) -> Marks {
        let mut marks = Marks::new(self.sizes.side(i));
        if i + 1 >= self.count() {
            marks.fill();
            return marks;
        }
        let [x, y, z] = self.corner(i).map(|begins| begins..begins + self.side);
        for z in z {
            for y in y.clone() {
                x.clone().for_each(|x| marks.set([x, y, z]));
            }
        }
        marks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nest(center: [f64; 3]) -> Nest {
        Nest::new(Levels::new(64, 1).unwrap(), 16, Some(center))
    }

    #[test]
    fn grids_double_about_their_point_and_the_last_fills_the_volume() {
        let about_the_middle = Nest::new(Levels::new(64, 1).unwrap(), 16, None);
        assert_eq!(about_the_middle.count(), 3);
        assert_eq!([0, 1, 2].map(|i| about_the_middle.corner(i)), [[24; 3], [8; 3], [0; 3]]);
        assert_eq!([0, 1, 2, 3].map(|i| about_the_middle.cells(i).count()), [4096, 4096, 4096, 512]);
        // No level has cells that are four times as wide.
        let short = Nest::new(Levels::new(64, 32).unwrap(), 16, None);
        assert_eq!((short.count(), [0, 1].map(|i| short.cells(i).count())), (2, [4096, 32 * 32 * 32]));
    }

    #[test]
    fn grids_lie_in_whole_coarser_cells_inside_the_volume_and_in_one_another() {
        for center in [[0.0, 64.0, 31.0], [7.9, 11.2, 50.6], [33.0, 19.0, 62.5]] {
            let nest = nest(center);
            for i in 0..2 {
                let (inner, outer) = (nest.corner(i), nest.corner(i + 1));
                for k in 0..3 {
                    assert_eq!(inner[k] % 2, 0, "{center:?}");
                    assert!(inner[k] + 16 <= 64 >> i, "{center:?}");
                    // A coarser cell at least is between the borders, but where both are the volume's.
                    let (low, high) = (inner[k] / 2, inner[k] / 2 + 8);
                    let top = 64 >> (i + 1);
                    assert!(low > outer[k] || (low, outer[k]) == (0, 0), "{center:?}, grid {i}");
                    assert!(high < outer[k] + 16 || (high, outer[k] + 16) == (top, top), "{center:?}, grid {i}");
                }
            }
        }
    }

    #[test]
    fn grids_move_with_their_point_by_whole_coarser_cells() {
        let (here, there) = (nest([30.0, 33.0, 31.2]), nest([34.0, 29.0, 35.2]));
        let moved = |i: usize| [0, 1, 2].map(|k| there.corner(i)[k] as i64 - here.corner(i)[k] as i64);
        assert_eq!([moved(0), moved(1), moved(2)], [[4, -4, 4], [2, -2, 2], [0; 3]]);
    }
}
