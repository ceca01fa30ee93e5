//! Which cells of an octree are leaves, at every stage of a descent.
//!
//! Light is hard to tell from few numbers next to where it was injected, and smooth far away. So a block of level i is
//! split while it is near to injected light: while its nearest finest cell is less than r·2^(i−1) cells away along the
//! axis where it is farthest (a Chebyshev distance, 0 inside the block). From r = 2 on, leaves that touch, be it at a
//! corner, differ by one level at most, and all light that has moved one step lies in the finest leaves of every stage.
//!
//! **Nested cascades** are split where the next finer grid lies, wherever the light is ([`super::nest`]).
//!
//! Stage j has no leaf finer than level j: what would be finer is a leaf of level j.

use std::ops::Range;

use super::nest::Nest;
use crate::field::{Levels, Marks};

/// What the volume is cut into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tiling {
    /// All cells of one level at a time.
    Cells,
    /// Leaves that are fine near injected light; the distance r is 2 or more.
    Leaves {
        /// How many times half its width a block must be away from injected light to stay whole.
        distance: f64,
    },
    /// The grids of nested cascades, each without what the next finer one covers.
    Cascades(Nest),
}

/// The leaves of every stage, from the coarsest level to the finest: for each the marks of all levels, the finest
/// first. `lit` are the cells of level 0 that light was injected into.
pub fn stages(sizes: Levels, tiling: Tiling, lit: &Marks) -> Vec<Vec<Marks>> {
    let count = sizes.count();
    let split = splits(sizes, tiling, lit);
    // The cells whose parent is split; all on the coarsest level.
    let mut present = vec![filled(sizes.side(count - 1))];
    for i in (0..count - 1).rev() {
        let parents = &split[i];
        present.insert(0, children(parents));
    }
    let leaves = |i: usize| match i.checked_sub(1) {
        Some(below) => without(&present[i], &split[below]),
        None => present[0].clone(),
    };
    let level = |j: usize, i: usize| match i.cmp(&j) {
        std::cmp::Ordering::Less => Marks::new(sizes.side(i)),
        std::cmp::Ordering::Equal => present[i].clone(),
        std::cmp::Ordering::Greater => leaves(i),
    };
    (0..count).rev().map(|j| (0..count).map(|i| level(j, i)).collect()).collect()
}

/// The blocks that are split, from level 1 on.
fn splits(sizes: Levels, tiling: Tiling, lit: &Marks) -> Vec<Marks> {
    let distance = match tiling {
        Tiling::Cells => return (1..sizes.count()).map(|i| filled(sizes.side(i))).collect(),
        Tiling::Cascades(nest) => return (1..sizes.count()).map(|i| nest.cells(i - 1).parents()).collect(),
        Tiling::Leaves { distance } => distance,
    };
    let level = |i: usize| {
        // The largest whole distance below r·2^(i−1).
        let reach = ((distance * f64::from(1u32 << (i - 1))).ceil() as usize).saturating_sub(1);
        blocks_near(lit, i, reach.min(sizes.finest()))
    };
    (1..sizes.count()).map(level).collect()
}

/// All cells of a grid.
fn filled(n: usize) -> Marks {
    let mut marks = Marks::new(n);
    marks.fill();
    marks
}

/// The cells of one set that are not in the other.
pub(super) fn without(marks: &Marks, others: &Marks) -> Marks {
    let mut left = marks.clone();
    left.words_mut().iter_mut().zip(others.words()).for_each(|(word, other)| *word &= !other);
    left
}

/// The eight children of every marked cell, in a grid of twice the side.
fn children(marks: &Marks) -> Marks {
    let (n, per_row) = (marks.side(), marks.words_per_row());
    let mut children = Marks::new(2 * n);
    let wide = children.words_per_row();
    for (row, words) in marks.words().chunks_exact(per_row).enumerate() {
        let (y, z) = (row % n, row / n);
        for below in [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dy, dz)| (2 * z + dz) * 2 * n + 2 * y + dy) {
            for (w, to) in children.words_mut()[below * wide..][..wide].iter_mut().enumerate() {
                *to = twice((words[w / 2] >> (32 * (w % 2))) as u32);
            }
        }
    }
    children
}

/// Every bit two times.
fn twice(bits: u32) -> u64 {
    let mut word = u64::from(bits);
    for (shift, mask) in [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ] {
        word = (word | word << shift) & mask;
    }
    word | word << 1
}

/// The blocks of 2^i cells along a side that have a marked cell inside or at most `reach` away along each axis.
fn blocks_near(marks: &Marks, i: usize, reach: usize) -> Marks {
    let (n, per_row) = (marks.side(), marks.words_per_row());
    let mut blocks = Marks::new(n >> i);
    let around = |block: usize| (block << i).saturating_sub(reach)..n.min(((block + 1) << i) + reach);
    // One axis after the other: planes of rows, rows, and the bits of a row.
    let (mut planes, mut rows) = (vec![0; n * per_row], vec![0; per_row]);
    for z in 0..n >> i {
        any_of(marks.words(), around(z), &mut planes);
        if planes.iter().all(|word| *word == 0) {
            continue;
        }
        for y in 0..n >> i {
            any_of(&planes, around(y), &mut rows);
            (0..n >> i).filter(|x| any_in(&rows, around(*x))).for_each(|x| blocks.set([x, y, z]));
        }
    }
    blocks
}

/// Sets `to` to what any of the chunks of its length holds.
fn any_of(words: &[u64], chunks: Range<usize>, to: &mut [u64]) {
    to.fill(0);
    let length = to.len();
    for chunk in words[chunks.start * length..chunks.end * length].chunks_exact(length) {
        to.iter_mut().zip(chunk).for_each(|(to, word)| *to |= word);
    }
}

/// Whether any of these bits is set; of a word bit 0 is the first.
fn any_in(words: &[u64], bits: Range<usize>) -> bool {
    let last = bits.end - 1;
    let mask = |w: usize| {
        let from = if w == bits.start / 64 { u64::MAX << (bits.start % 64) } else { u64::MAX };
        let to = if w == last / 64 { u64::MAX >> (63 - last % 64) } else { u64::MAX };
        from & to
    };
    (bits.start / 64..=last / 64).any(|w| words[w] & mask(w) != 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Cell, Layout};

    fn lit(n: usize, cells: impl IntoIterator<Item = Cell>) -> Marks {
        let mut marks = Marks::new(n);
        cells.into_iter().for_each(|cell| marks.set(cell));
        marks
    }

    fn sizes(n: usize) -> Levels {
        Levels::new(n, 1).unwrap()
    }

    fn updates(n: usize, distance: f64, lit: &Marks) -> usize {
        stages(sizes(n), Tiling::Leaves { distance }, lit).iter().flatten().map(Marks::count).sum()
    }

    #[test]
    fn so_many_cells_are_touched_by_one_iteration_of_every_stage() {
        let walls = lit(32, (0..1024).flat_map(|i| [[0, i % 32, i / 32], [31, i % 32, i / 32]]));
        let lobe = lit(32, [[16, 16, 16]]);
        let floor = (0..1024).map(|i| [i % 32, 0, i / 32]);
        let mixed = lit(32, floor.chain((0..128).map(|i| [4 + i % 8, 4 + i / 8, 6])));
        for (marks, two, three) in [(&walls, 6313, 12361), (&lobe, 601, 2694), (&mixed, 5347, 8875)] {
            assert_eq!((updates(32, 2.0, marks), updates(32, 3.0, marks)), (two, three));
        }
        let all: usize = stages(sizes(32), Tiling::Cells, &lobe).iter().flatten().map(Marks::count).sum();
        assert_eq!(all, 37_449);
    }

    #[test]
    fn every_stage_tiles_the_volume_once_and_leaves_that_touch_differ_by_one_level() {
        let marks = lit(16, [[3, 9, 14], [0, 0, 0]]);
        let by_distance = [2.0, 2.5, 3.0].map(|distance| (16, Tiling::Leaves { distance }));
        let points = [None, Some([1.0, 16.5, 32.0]), Some([10.7, 13.0, 21.0])];
        let nested = points.map(|point| (32, Tiling::Cascades(Nest::new(sizes(32), 8, point))));
        for (n, tiling) in by_distance.into_iter().chain(nested) {
            for (stage, leaves) in stages(sizes(n), tiling, &marks).iter().enumerate() {
                let level = |cell: Cell| {
                    let holding = (0..leaves.len()).filter(|i| leaves[*i].get(cell.map(|c| c >> i)));
                    let found: Vec<usize> = holding.collect();
                    assert_eq!(found.len(), 1, "{cell:?} lies in {found:?}");
                    found[0]
                };
                for cell in Layout::new(n).cells() {
                    let here = level(cell);
                    assert!(here + stage + 1 >= leaves.len(), "finer than its stage");
                    for next in (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]) {
                        let next = [0, 1, 2].map(|k| (cell[k] + next[k]).clamp(1, n) - 1);
                        assert!(level(next).abs_diff(here) <= 1, "{tiling:?}: {cell:?}, {next:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_near_is_found_along_all_axes_and_across_words() {
        for (n, i, reach) in [(16, 0, 1), (16, 2, 5), (16, 4, 16), (128, 1, 70), (128, 0, 63), (128, 5, 64)] {
            let centre = [n / 2 + 3, n - 2, 1];
            let near = blocks_near(&lit(n, [centre]), i, reach);
            let expected = |block: Cell| {
                let beside = |k: usize| (block[k] << i..(block[k] + 1) << i).any(|c| c.abs_diff(centre[k]) <= reach);
                (0..3).all(beside)
            };
            assert_eq!(near.side(), n >> i);
            assert!(Layout::new(n >> i).cells().all(|block| near.get(block) == expected(block)), "{n}, {i}, {reach}");
        }
    }

    #[test]
    fn without_light_the_coarsest_cells_stay_whole() {
        let stages = stages(sizes(8), Tiling::Leaves { distance: 2.0 }, &Marks::new(8));
        assert!(stages.iter().all(|leaves| leaves[3].count() == 1 && leaves[..3].iter().all(|m| m.count() == 0)));
    }
}
