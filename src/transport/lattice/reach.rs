//! What need not be computed: which cells of a grid may hold light.
//!
//! Light moves one cell along one axis an iteration, so what may be lit next is what may be lit now and
//! its six neighbours: a bit a cell, and a few operations for sixty-four of them. The bits never leave
//! out a lit cell, so that skipping what they leave out changes no bit of the result.

use crate::field::{Marks, row_mask};

/// The words of one row, as many as [`Marks::words_per_row`]; the bits behind its end are zero.
pub type Row<const W: usize> = [u64; W];

/// The cells of row number `row` that may be lit an iteration later. `rows` are whole slabs of an n³
/// grid's [`Marks`]; outside them it is dark.
#[inline(always)]
pub fn reached<const W: usize>(rows: &[Row<W>], n: usize, row: usize) -> Row<W> {
    let (here, y) = (&rows[row], row % n);
    let mut reached = [0; W];
    for (w, reached) in reached.iter_mut().enumerate() {
        let before = if w > 0 { here[w - 1] >> 63 } else { 0 };
        let behind = if w + 1 < W { here[w + 1] << 63 } else { 0 };
        *reached = here[w] | here[w] << 1 | here[w] >> 1 | before | behind;
    }
    let mut join = |other: &Row<W>| {
        for (reached, other) in reached.iter_mut().zip(other) {
            *reached |= other;
        }
    };
    if y > 0 {
        join(&rows[row - 1]);
    }
    if y + 1 < n {
        join(&rows[row + 1]);
    }
    if row >= n {
        join(&rows[row - n]);
    }
    if let Some(behind) = rows.get(row + n) {
        join(behind);
    }
    // The shift may have gone over the end of a short row.
    reached[W - 1] &= row_mask(n);
    reached
}

/// Where light may be one iteration later.
pub fn grown(lit: &Marks) -> Marks {
    match lit.words_per_row() {
        1 => grown_by::<1>(lit),
        2 => grown_by::<2>(lit),
        4 => grown_by::<4>(lit),
        8 => grown_by::<8>(lit),
        _ => grown_by::<16>(lit),
    }
}

fn grown_by<const W: usize>(lit: &Marks) -> Marks {
    let n = lit.side();
    let mut grown = Marks::new(n);
    let (rows, _) = lit.words().as_chunks::<W>();
    for (row, words) in grown.words_mut().as_chunks_mut::<W>().0.iter_mut().enumerate() {
        *words = reached(rows, n, row);
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
