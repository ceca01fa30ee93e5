//! A full octree: levels O_0 (n³, the finest) to the coarsest, each the mean of its children (000, 4.2).

use super::grid::{Cell, Grid};
use crate::sh::{Real, Sh};

/// The sizes of an octree's levels: level i has side n / 2^i, down to the coarsest side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Levels {
    finest: usize,
    coarsest: usize,
}

impl Levels {
    /// Levels from side `finest` down to side `coarsest`, both powers of two and `coarsest` ≤ `finest`;
    /// `None` otherwise.
    pub fn new(finest: usize, coarsest: usize) -> Option<Self> {
        let fits = finest.is_power_of_two() && coarsest.is_power_of_two() && coarsest <= finest;
        fits.then_some(Levels { finest, coarsest })
    }

    /// The same with another side of level 0, a power of two; the coarsest level is as small or smaller.
    pub fn with_finest(&self, finest: usize) -> Self {
        Levels { finest, coarsest: self.coarsest.min(finest) }
    }

    /// How many levels there are, l.
    pub fn count(&self) -> usize {
        (self.finest / self.coarsest).ilog2() as usize + 1
    }

    /// The side of level 0, n.
    pub fn finest(&self) -> usize {
        self.finest
    }

    /// The side of the last level.
    pub fn coarsest(&self) -> usize {
        self.coarsest
    }

    /// The side of level `i`.
    pub fn side(&self, i: usize) -> usize {
        self.finest >> i
    }

    /// The sides of all levels, finest first.
    pub fn sides(&self) -> impl Iterator<Item = usize> + use<> {
        let finest = self.finest;
        (0..self.count()).map(move |i| finest >> i)
    }

    /// Cells in all levels together.
    pub fn cells(&self) -> usize {
        self.sides().map(|side| side.pow(3)).sum()
    }
}

/// One channel of light on every level.
#[derive(Clone, Debug, PartialEq)]
pub struct Octree<T> {
    sizes: Levels,
    grids: Vec<Grid<T>>,
}

impl<T: Real> Octree<T> {
    /// A dark octree.
    pub fn new(sizes: Levels) -> Self {
        Octree { sizes, grids: sizes.sides().map(Grid::new).collect() }
    }

    /// The sizes of its levels.
    pub fn sizes(&self) -> Levels {
        self.sizes
    }

    /// Level `i`, 0 the finest.
    pub fn level(&self, i: usize) -> &Grid<T> {
        &self.grids[i]
    }

    /// Level `i`, to write in.
    pub fn level_mut(&mut self, i: usize) -> &mut Grid<T> {
        &mut self.grids[i]
    }

    /// All levels, finest first.
    pub fn levels(&self) -> &[Grid<T>] {
        &self.grids
    }

    /// All levels, to write in.
    pub fn levels_mut(&mut self) -> &mut [Grid<T>] {
        &mut self.grids
    }

    /// Makes every level dark.
    pub fn clear(&mut self) {
        self.grids.iter_mut().for_each(Grid::clear);
    }

    /// Takes over every cell of an octree of the same sizes.
    pub fn copy_from(&mut self, other: &Self) {
        for (to, from) in self.grids.iter_mut().zip(&other.grids) {
            to.copy_from(from);
        }
    }

    /// Fills every level but the finest with the mean of its children (000, 4.2, eq. 11).
    pub fn downsample(&mut self) {
        for i in 1..self.grids.len() {
            let (finer, coarser) = self.grids.split_at_mut(i);
            downsample_into(&finer[i - 1], &mut coarser[0]);
        }
    }

    /// Bytes of memory it holds.
    pub fn bytes(&self) -> usize {
        self.grids.iter().map(Grid::bytes).sum()
    }
}

/// The mean of the eight children in the next finer level, Ô(x, y, z) of (000, 6.2).
#[inline]
pub fn mean_of_children<T: Real>(finer: &Grid<T>, [x, y, z]: Cell) -> Sh<T> {
    let i = finer.layout().index([2 * x, 2 * y, 2 * z]);
    let [dx, dy, dz] = finer.layout().steps();
    // Pairs first: the mean of a constant is then that constant, to the last bit.
    let pair = |i: usize| finer.at(i) + finer.at(i + dx);
    let quad = |i: usize| pair(i) + pair(i + dy);
    (quad(i) + quad(i + dz)) * T::of(0.125)
}

/// Sets every cell of `coarser` to the mean of its eight children in `finer`, of twice the side.
pub fn downsample_into<T: Real>(finer: &Grid<T>, coarser: &mut Grid<T>) {
    let n = coarser.side();
    for (y, z) in (0..n).flat_map(|z| (0..n).map(move |y| (y, z))) {
        let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dy, dz)| finer.row(2 * y + dy, 2 * z + dz));
        for (p, to) in coarser.row_mut(y, z).into_iter().enumerate() {
            // In the order of `mean_of_children`.
            let [a, b, c, d] = four.map(|row| row[p].as_chunks::<2>().0);
            for (x, to) in to.iter_mut().enumerate() {
                let pair = |row: &[[T; 2]]| row[x][0] + row[x][1];
                *to = ((pair(a) + pair(b)) + (pair(c) + pair(d))) * T::of(0.125);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_go_down_to_the_coarsest_and_nothing_else_is_accepted() {
        let levels = Levels::new(32, 1).unwrap();
        assert_eq!(levels.sides().collect::<Vec<_>>(), [32, 16, 8, 4, 2, 1]);
        assert_eq!(Levels::new(32, 2).unwrap().count(), 5);
        assert_eq!(Levels::new(1, 1).unwrap().count(), 1);
        for (finest, coarsest) in [(24, 1), (0, 0), (8, 16), (8, 3), (8, 0)] {
            assert_eq!(Levels::new(finest, coarsest), None);
        }
    }

    #[test]
    fn a_constant_stays_itself_on_every_level() {
        let mut octree = Octree::<f32>::new(Levels::new(16, 1).unwrap());
        let light = Sh([0.3, -0.1, 0.7, 0.011]);
        for cell in octree.level(0).layout().cells() {
            octree.level_mut(0).set(cell, light);
        }
        octree.downsample();
        assert!(octree.levels().iter().flat_map(Grid::iter).all(|(_, found)| found == light));
    }

    #[test]
    fn rows_are_downsampled_to_what_every_cell_by_itself_gives() {
        let mut finer = Grid::<f32>::new(8);
        for (i, cell) in finer.layout().cells().enumerate() {
            finer.set(cell, Sh([0.1, -0.7, 1.3, 1e-7]) * (1.0 / (i + 1) as f32));
        }
        let mut coarser = Grid::new(4);
        downsample_into(&finer, &mut coarser);
        assert!(coarser.iter().all(|(cell, light)| light == mean_of_children(&finer, cell)));
    }

    #[test]
    fn a_parent_is_the_mean_of_its_own_eight_children() {
        let mut octree = Octree::<f64>::new(Levels::new(4, 1).unwrap());
        octree.level_mut(0).set([3, 0, 2], Sh([8.0, 16.0, -8.0, 4.0]));
        octree.downsample();
        assert_eq!(octree.level(1).get([1, 0, 1]), Sh([1.0, 2.0, -1.0, 0.5]));
        assert_eq!(octree.level(1).energy(), 1.0);
        assert_eq!(octree.level(2).get([0, 0, 0]), Sh([0.125, 0.25, -0.125, 0.0625]));
    }
}
