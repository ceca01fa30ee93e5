//! Where a grid may be lit, by the row: light spreads by a row a half sweep, and what it cannot have reached is
//! left out.

use std::ops::Range;

use crate::field::Marks;

/// The rows of each slab that may be lit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LitRows(Vec<Range<usize>>);

impl LitRows {
    /// No row of a grid of side `n`.
    pub fn nowhere(n: usize) -> Self {
        LitRows(vec![0..0; n])
    }

    /// In each slab all from the first row that has a mark to the last.
    pub fn rows_of(marks: &Marks) -> Self {
        let n = marks.side();
        let mut lit = LitRows::nowhere(n);
        for (row, words) in marks.words().chunks_exact(marks.words_per_row()).enumerate() {
            if words.iter().any(|word| *word != 0) {
                let (y, z) = (row % n, row / n);
                lit.0[z] = hull(&lit.0[z], &(y..y + 1));
            }
        }
        lit
    }

    /// Whether all rows may be lit.
    pub fn is_everywhere(&self) -> bool {
        self.count() == self.0.len().pow(2)
    }

    /// The lit rows of slab `z`.
    pub fn rows(&self, z: usize) -> Range<usize> {
        self.0[z].clone()
    }

    /// Every lit row (y, z).
    pub fn all(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.0.iter().enumerate().flat_map(|(z, rows)| rows.clone().map(move |y| (y, z)))
    }

    /// The rows that may be lit after a half sweep.
    pub fn grown(&self) -> Self {
        let n = self.0.len();
        let slab = |z: usize| {
            let here = &self.0[z];
            let wider = if here.is_empty() { 0..0 } else { here.start.saturating_sub(1)..(here.end + 1).min(n) };
            let around = [z.checked_sub(1), Some(z + 1).filter(|z| *z < n)];
            around.into_iter().flatten().fold(wider, |rows, z| hull(&rows, &self.0[z]))
        };
        LitRows((0..n).map(slab).collect())
    }

    /// How many rows may be lit.
    pub fn count(&self) -> usize {
        self.0.iter().map(Range::len).sum()
    }
}

fn hull(a: &Range<usize>, b: &Range<usize>) -> Range<usize> {
    match (a.is_empty(), b.is_empty()) {
        (true, _) => b.clone(),
        (_, true) => a.clone(),
        _ => a.start.min(b.start)..a.end.max(b.end),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_grow_to_the_diamond_of_their_reach() {
        let n = 8;
        let mut marks = Marks::new(n);
        marks.set([3, 2, 5]);
        let mut lit = LitRows::rows_of(&marks);
        for reach in 0..=12 {
            let wanted = |&(y, z): &(usize, usize)| y.abs_diff(2) + z.abs_diff(5) <= reach;
            let wanted: Vec<_> = (0..n).flat_map(|z| (0..n).map(move |y| (y, z))).filter(wanted).collect();
            assert_eq!(lit.all().collect::<Vec<_>>(), wanted, "reach {reach}");
            assert_eq!((lit.count(), lit.is_everywhere()), (wanted.len(), wanted.len() == n * n));
            lit = lit.grown();
        }
    }
}
