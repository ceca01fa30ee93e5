//! The hierarchical index volume of (000, 4.2): which level of the octree to sample where.
//!
//! Level i of the volume holds i where O_i has received light and l − 1 elsewhere, so a bit a cell
//! says it all. The index of a finest cell is the least over the levels, and the merged light there
//! is S(x, y, z) = O_I(x / 2^I, …).

use std::ops::Range;

use rayon::prelude::*;

use super::grid::{Cell, Grid};
use super::octree::{Levels, Octree};
use crate::sh::{Real, Sh};

/// Cells that are looked at together for whether any is lit.
const RUN: usize = 16;

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

    /// Marks every cell of `grid`, which is of the same side, that is not dark.
    pub fn mark_lit<T: Real>(&mut self, grid: &Grid<T>) {
        let n = self.n;
        let mark = |(row, words): (usize, &mut [u64])| {
            let planes = grid.row(row % n, row / n);
            for from in (0..n).step_by(RUN) {
                let run = from..n.min(from + RUN);
                if planes.iter().all(|plane| plane[run.clone()].iter().fold(true, |dark, c| dark & (*c == T::ZERO))) {
                    continue;
                }
                for x in run.filter(|x| planes.iter().any(|plane| plane[*x] != T::ZERO)) {
                    words[x / 64] |= 1 << (x % 64);
                }
            }
        };
        // Fewer cells are not worth another thread's while.
        const ALONE: usize = 1 << 16;
        self.words.par_chunks_exact_mut(self.words_per_row).enumerate().with_min_len(ALONE / n).for_each(mark);
    }

    /// The cells of half as large a grid that have a marked cell among their eight children. The side must be two
    /// at least.
    pub fn parents(&self) -> Marks {
        let mut parents = Marks::new(self.n / 2);
        let (n, per_row) = (self.n, self.words_per_row);
        let of_row = |y: usize, z: usize| &self.words[(z * n + y) * per_row..][..per_row];
        for (row, parents) in parents.words.chunks_exact_mut(parents.words_per_row).enumerate() {
            let (y, z) = (2 * (row % (n / 2)), 2 * (row / (n / 2)));
            let four = [of_row(y, z), of_row(y + 1, z), of_row(y, z + 1), of_row(y + 1, z + 1)];
            for w in 0..per_row {
                let any = four.iter().fold(0, |any, words| any | words[w]);
                parents[w / 2] |= pairs(any) << (32 * (w % 2));
            }
        }
        parents
    }

    /// The marked cells, x fastest.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        self.cells_of(0..self.n)
    }

    /// The marked cells in slabs of these z, x fastest.
    pub fn cells_of(&self, slabs: Range<usize>) -> impl Iterator<Item = Cell> + '_ {
        let (n, per_row) = (self.n, self.words_per_row);
        let words = n * per_row * slabs.start..n * per_row * slabs.end;
        words.clone().zip(&self.words[words]).flat_map(move |(i, word)| {
            let (row, first) = (i / per_row, 64 * (i % per_row));
            let mut left = *word;
            std::iter::from_fn(move || {
                let bit = (left != 0).then(|| left.trailing_zeros() as usize)?;
                left &= left - 1;
                Some([first + bit, row % n, row / n])
            })
        })
    }

    /// The marked cells with their light in `grid`, which is of the same side, x fastest.
    pub fn light_in<'a, T: Real>(&'a self, grid: &'a Grid<T>) -> impl Iterator<Item = (Cell, Sh<T>)> + 'a {
        self.cells().map(|cell| (cell, grid.get(cell)))
    }

    /// How many cells are marked.
    pub fn count(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// Marks every cell.
    pub fn fill(&mut self) {
        self.words.fill(row_mask(self.n));
    }

    /// Unmarks every cell.
    pub fn clear(&mut self) {
        self.words.fill(0);
    }
}

/// The bits that each word of an n³ grid's [`Marks`] uses: all but in the one word of a row shorter than it.
#[inline(always)]
pub fn row_mask(n: usize) -> u64 {
    if n < 64 { (1 << n) - 1 } else { u64::MAX }
}

/// Bit i of the result: whether bit 2i or bit 2i + 1 is set.
fn pairs(word: u64) -> u64 {
    let mut bits = (word | word >> 1) & 0x5555_5555_5555_5555;
    // Every step moves the upper half of each group next to the lower.
    for (shift, mask) in [
        (1, 0x3333_3333_3333_3333),
        (2, 0x0f0f_0f0f_0f0f_0f0f),
        (4, 0x00ff_00ff_00ff_00ff),
        (8, 0x0000_ffff_0000_ffff),
        (16, 0x0000_0000_ffff_ffff),
    ] {
        bits = (bits | bits >> shift) & mask;
    }
    bits
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
        // Most cells show the finest level: take its rows, and then what is coarser in them.
        merged.copy_from(octree.level(0));
        let finest = &self.marks[0];
        for (row, words) in finest.words.chunks_exact(finest.words_per_row).enumerate() {
            for (w, lit) in words.iter().enumerate() {
                let mut dark = !lit & row_mask(finest.n);
                while dark != 0 {
                    let cell = [64 * w + dark.trailing_zeros() as usize, row % finest.n, row / finest.n];
                    let i = self.index(cell);
                    merged.set(cell, octree.level(i).get(cell.map(|c| c >> i)));
                    dark &= dark - 1;
                }
            }
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
    fn marked_cells_come_in_order() {
        let mut marks = Marks::new(128);
        for cell in [[127, 0, 0], [3, 1, 0], [64, 1, 0], [0, 0, 5]] {
            marks.set(cell);
        }
        assert_eq!(marks.cells().collect::<Vec<_>>(), [[127, 0, 0], [3, 1, 0], [64, 1, 0], [0, 0, 5]]);
        assert_eq!(marks.cells_of(1..6).collect::<Vec<_>>(), [[0, 0, 5]]);
    }

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
    fn marks_are_those_that_looking_at_every_cell_gives() {
        for n in [2, 16, 128] {
            let mut grid = Grid::<f32>::new(n);
            for i in [0, 1, n / 2, n - 1] {
                grid.set([i, n - 1 - i, i / 2], Sh([0.0, 0.0, -1.0, 0.0]));
            }
            let (mut found, mut parents) = (Marks::new(n), Marks::new(n / 2));
            found.set([1, 0, 0]);
            found.mark_lit(&grid);
            for (cell, light) in grid.iter() {
                let is_marked = cell == [1, 0, 0] || !light.is_zero();
                assert_eq!(found.get(cell), is_marked, "{cell:?}");
                if is_marked {
                    parents.set(cell.map(|c| c / 2));
                }
            }
            assert_eq!(found.parents(), parents);
        }
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
