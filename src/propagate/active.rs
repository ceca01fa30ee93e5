//! What need not be computed: which cells of a grid may hold light.
//!
//! Light moves one cell along one axis an iteration, so what may be lit next is what may be lit now and
//! its six neighbours: a bit a cell, and a few operations for sixty-four of them. The bits never leave
//! out a lit cell, so that skipping what they leave out changes no bit of the result.

use crate::field::Marks;

/// Words of the longest row there can be, 1024 cells.
pub const MOST_WORDS: usize = 16;

/// The words of one row; those behind its end are zero.
pub type Row = [u64; MOST_WORDS];

/// The cells of row number `row` that may be lit an iteration later. `words` are whole slabs of an n³
/// grid's [`Marks`]; outside them it is dark.
#[inline(always)]
pub fn reached(words: &[u64], n: usize, row: usize) -> Row {
    let per_row = n.div_ceil(64);
    let at = |row: usize| &words[row * per_row..(row + 1) * per_row];
    let (here, y) = (at(row), row % n);
    let mut reached = [0; MOST_WORDS];
    for (w, reached) in reached[..per_row].iter_mut().enumerate() {
        let before = if w > 0 { here[w - 1] >> 63 } else { 0 };
        let behind = if w + 1 < per_row { here[w + 1] << 63 } else { 0 };
        *reached = here[w] | here[w] << 1 | here[w] >> 1 | before | behind;
    }
    let mut join = |other: &[u64]| {
        for (reached, other) in reached.iter_mut().zip(other) {
            *reached |= other;
        }
    };
    if y > 0 {
        join(at(row - 1));
    }
    if y + 1 < n {
        join(at(row + 1));
    }
    if row >= n {
        join(at(row - n));
    }
    if (row + n) * per_row < words.len() {
        join(at(row + n));
    }
    // The shift may have gone over the end of a short row.
    reached[per_row - 1] &= row_mask(n);
    reached
}

/// The bits that a row's last word uses.
#[inline(always)]
pub fn row_mask(n: usize) -> u64 {
    if n < 64 { (1 << n) - 1 } else { u64::MAX }
}

/// Where light may be one iteration later.
pub fn grown(lit: &Marks) -> Marks {
    let n = lit.side();
    let mut grown = Marks::new(n);
    let per_row = lit.words_per_row();
    for (row, words) in grown.words_mut().chunks_exact_mut(per_row).enumerate() {
        words.copy_from_slice(&reached(lit.words(), n, row)[..per_row]);
    }
    grown
}

/// All bits of an n³ grid's marks set.
pub fn everywhere(n: usize) -> Marks {
    let mut all = Marks::new(n);
    all.words_mut().fill(row_mask(n));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_grows_to_the_diamond_of_its_reach() {
        for (n, from) in [(1, [0, 0, 0]), (8, [0, 7, 3]), (16, [5, 2, 9]), (128, [62, 3, 127])] {
            let mut lit = Marks::new(n);
            lit.set(from);
            for k in 1..=5 {
                lit = grown(&lit);
                let mut inside = 0;
                for cell in crate::field::Layout::new(n).cells() {
                    let distance: usize = (0..3).map(|axis| cell[axis].abs_diff(from[axis])).sum();
                    assert_eq!(lit.get(cell), distance <= k, "n = {n}, k = {k}, {cell:?}");
                    inside += usize::from(distance <= k);
                }
                // No bit outside the rows either.
                assert_eq!(lit.count(), inside);
            }
        }
    }

    #[test]
    fn everywhere_is_every_cell() {
        for n in [1, 8, 64, 128] {
            assert_eq!(everywhere(n).count(), n.pow(3));
            assert_eq!(grown(&everywhere(n)), everywhere(n));
        }
    }
}
