//! The hierarchical index volume of (000, 4.2): which level of the octree to sample where.
//!
//! Level i of the volume holds i where O_i has received light and l − 1 elsewhere, so a bit a cell
//! says it all. The index of a finest cell is the least over the levels, and the merged light there
//! is S(x, y, z) = O_I(x / 2^I, …).

use super::grid::{Cell, Grid};
use super::octree::{Levels, Octree};
use crate::sh::Real;

/// A bit for every cell of an n³ grid: set once the cell has received light.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Marks {
    n: usize,
    words_per_row: usize,
    words: Vec<u64>,
}

impl Marks {
    /// No cell marked.
    pub fn new(n: usize) -> Self {
        let words_per_row = n.div_ceil(64);
        Marks { n, words_per_row, words: vec![0; words_per_row * n * n] }
    }

    /// Cells along a side.
    pub fn side(&self) -> usize {
        self.n
    }

    /// Whether a cell is marked.
    #[inline]
    pub fn get(&self, [x, y, z]: Cell) -> bool {
        self.words[(z * self.n + y) * self.words_per_row + x / 64] >> (x % 64) & 1 != 0
    }

    /// Marks a cell.
    #[inline]
    pub fn set(&mut self, [x, y, z]: Cell) {
        self.words[(z * self.n + y) * self.words_per_row + x / 64] |= 1 << (x % 64);
    }

    /// Marks a cell, or takes its mark away.
    #[inline]
    pub fn put(&mut self, [x, y, z]: Cell, mark: bool) {
        let (word, bit) = ((z * self.n + y) * self.words_per_row + x / 64, x % 64);
        self.words[word] = self.words[word] & !(1 << bit) | u64::from(mark) << bit;
    }

    /// The words of all rows, [`Self::words_per_row`] each, y faster than z; bit x % 64 of word x / 64 is cell x.
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// [`Self::words`], to set more.
    pub fn words_mut(&mut self) -> &mut [u64] {
        &mut self.words
    }

    /// Words that one row takes.
    pub fn words_per_row(&self) -> usize {
        self.words_per_row
    }

    /// Cells in words with any mark: how many the loops that work by the word have to visit, about.
    pub fn cells_in_touched_words(&self) -> usize {
        self.words.iter().filter(|word| **word != 0).count() * self.n.min(64)
    }

    /// Marks every cell of `grid` that is not dark.
    pub fn mark_lit<T: Real>(&mut self, grid: &Grid<T>) {
        for (cell, light) in grid.iter() {
            if !light.is_zero() {
                self.set(cell);
            }
        }
    }

    /// How many cells are marked.
    pub fn count(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// Unmarks every cell.
    pub fn clear(&mut self) {
        self.words.fill(0);
    }
}

/// Which level to sample where, kept as one [`Marks`] a level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IndexVolume {
    sizes: Levels,
    marks: Vec<Marks>,
}

impl IndexVolume {
    /// No light anywhere: every index is l − 1.
    pub fn new(sizes: Levels) -> Self {
        IndexVolume { sizes, marks: sizes.sides().map(Marks::new).collect() }
    }

    /// The sizes of its levels.
    pub fn sizes(&self) -> Levels {
        self.sizes
    }

    /// The marks of level `i`.
    pub fn level(&self, i: usize) -> &Marks {
        &self.marks[i]
    }

    /// The marks of level `i`, to set more.
    pub fn level_mut(&mut self, i: usize) -> &mut Marks {
        &mut self.marks[i]
    }

    /// I(x, y, z): the finest level that has received light around a finest cell, l − 1 where none has.
    #[inline]
    pub fn index(&self, [x, y, z]: Cell) -> usize {
        let last = self.marks.len() - 1;
        (0..last).find(|&i| self.marks[i].get([x >> i, y >> i, z >> i])).unwrap_or(last)
    }

    /// Stores S(x, y, z) of `octree` for every finest cell (000, 4.2, merging).
    pub fn merge<T: Real>(&self, octree: &Octree<T>, merged: &mut Grid<T>) {
        for cell in merged.layout().cells() {
            let i = self.index(cell);
            merged.set(cell, octree.level(i).get(cell.map(|c| c >> i)));
        }
    }

    /// Forgets all light.
    pub fn clear(&mut self) {
        self.marks.iter_mut().for_each(Marks::clear);
    }

    /// Bytes of memory it holds.
    pub fn bytes(&self) -> usize {
        self.marks.iter().map(|m| size_of_val(m.words.as_slice())).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sh::Sh;

    #[test]
    fn the_index_is_the_least_level_that_has_light() {
        let sizes = Levels::new(8, 1).unwrap();
        let mut index = IndexVolume::new(sizes);
        assert!((0..8).all(|c| index.index([c, 7 - c, c]) == 3));
        index.level_mut(2).set([1, 0, 1]);
        index.level_mut(0).set([4, 1, 6]);
        for cell in Grid::<f32>::new(8).layout().cells() {
            // The definition, word for word: the minimum over all levels of i where marked, else l − 1.
            let brute = (0..4).map(|i| if index.level(i).get(cell.map(|c| c >> i)) { i } else { 3 }).min().unwrap();
            assert_eq!(index.index(cell), brute, "{cell:?}");
        }
        assert_eq!(index.index([4, 1, 6]), 0);
        assert_eq!(index.index([5, 1, 6]), 2);
        assert_eq!(index.index([3, 1, 6]), 3);
    }

    #[test]
    fn merged_light_is_the_sample_at_every_cell() {
        let sizes = Levels::new(8, 1).unwrap();
        let mut octree = Octree::<f64>::new(sizes);
        for i in 0..4 {
            for (at, cell) in octree.level(i).layout().cells().enumerate() {
                octree.level_mut(i).set(cell, Sh([i as f64, at as f64, 1.0, -1.0]));
            }
        }
        let mut index = IndexVolume::new(sizes);
        index.level_mut(0).set([7, 7, 7]);
        index.level_mut(1).set([0, 1, 2]);
        let mut merged = Grid::new(8);
        index.merge(&octree, &mut merged);
        for (cell, found) in merged.iter() {
            let i = index.index(cell);
            assert_eq!(found, octree.level(i).get(cell.map(|c| c >> i)));
        }
        assert_eq!(merged.get([1, 2, 5]).0[0], 1.0);
    }

    #[test]
    fn marks_cross_word_borders() {
        let mut marks = Marks::new(128);
        for x in [0, 63, 64, 127] {
            marks.set([x, 3, 5]);
            assert!(marks.get([x, 3, 5]) && !marks.get([x, 5, 3]));
        }
        assert_eq!(marks.count(), 4);
    }
}
