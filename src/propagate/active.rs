//! What need not be computed: which part of each row of a grid may hold light.
//!
//! Light moves one cell along one axis an iteration, so what a row may hold next is what it and its
//! four neighbours hold now, one cell wider. [`Spans`] keep that bound for every row and every
//! iteration at the cost of four bytes a row. They never leave out a lit cell, so that skipping what
//! lies outside changes no bit of the result.

use crate::field::Marks;

/// The cells of one row that may hold light: x from `from` to before `to`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Span {
    from: u16,
    to: u16,
}

impl Span {
    /// No cell.
    pub const EMPTY: Span = Span { from: 0, to: 0 };

    /// Cells `from` to before `to`; empty where that is none.
    #[inline(always)]
    pub fn new(from: usize, to: usize) -> Self {
        // A row is far shorter than 65536 cells: n³ of them would not fit any memory.
        if from < to { Span { from: from as u16, to: to as u16 } } else { Span::EMPTY }
    }

    /// Whether there is no cell in it.
    #[inline(always)]
    pub fn is_empty(self) -> bool {
        self.from >= self.to
    }

    /// The first cell.
    #[inline(always)]
    pub fn from(self) -> usize {
        usize::from(self.from)
    }

    /// The cell after the last.
    #[inline(always)]
    pub fn to(self) -> usize {
        usize::from(self.to)
    }

    /// How many cells.
    #[inline(always)]
    pub fn len(self) -> usize {
        self.to().saturating_sub(self.from())
    }

    /// The least span that holds both.
    #[inline(always)]
    pub fn union(self, other: Span) -> Span {
        match (self.is_empty(), other.is_empty()) {
            (true, _) => other,
            (_, true) => self,
            _ => Span { from: self.from.min(other.from), to: self.to.max(other.to) },
        }
    }

    /// The cells in both.
    #[inline(always)]
    pub fn intersection(self, other: Span) -> Span {
        Span::new(self.from().max(other.from()), self.to().min(other.to()))
    }

    /// One cell wider on both sides, within a row of `n`.
    #[inline(always)]
    pub fn grown(self, n: usize) -> Span {
        if self.is_empty() { self } else { Span::new(self.from().saturating_sub(1), (self.to() + 1).min(n)) }
    }

    /// Widened to whole multiples of `lanes` cells, within a row of `n`.
    #[inline(always)]
    pub fn rounded(self, lanes: usize, n: usize) -> Span {
        Span::new(self.from() / lanes * lanes, self.to().next_multiple_of(lanes).min(n))
    }
}

/// A [`Span`] for each row of an n³ grid, y faster than z.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spans {
    n: usize,
    rows: Vec<Span>,
}

impl Spans {
    /// No light anywhere.
    pub fn dark(n: usize) -> Self {
        Spans { n, rows: vec![Span::EMPTY; n * n] }
    }

    /// Light may be everywhere.
    pub fn full(n: usize) -> Self {
        Spans { n, rows: vec![Span::new(0, n); n * n] }
    }

    /// Light may be between the first and the last marked cell of each row.
    pub fn of_marks(n: usize, marks: &Marks) -> Self {
        let per_row = marks.words_per_row();
        let rows = marks.words().chunks_exact(per_row).map(|words| {
            let first = words.iter().position(|w| *w != 0);
            let last = words.iter().rposition(|w| *w != 0);
            match (first, last) {
                (Some(a), Some(b)) => {
                    let from = 64 * a + words[a].trailing_zeros() as usize;
                    let to = 64 * (b + 1) - words[b].leading_zeros() as usize;
                    Span::new(from, to)
                }
                _ => Span::EMPTY,
            }
        });
        Spans { n, rows: rows.collect() }
    }

    /// Cells along a side.
    pub fn side(&self) -> usize {
        self.n
    }

    /// All rows, y faster than z.
    pub fn rows(&self) -> &[Span] {
        &self.rows
    }

    /// All rows, to write in.
    pub fn rows_mut(&mut self) -> &mut [Span] {
        &mut self.rows
    }

    /// How many cells may hold light.
    pub fn cells(&self) -> usize {
        self.rows.iter().map(|span| span.len()).sum()
    }

    /// Where light may be one iteration later.
    pub fn grown(&self) -> Self {
        let n = self.n;
        let rows = (0..n * n).map(|row| reached(&self.rows, n, row)).collect();
        Spans { n, rows }
    }
}

/// What row number `row` may hold after an iteration. `rows` are whole slabs of `n` rows; outside them
/// it is dark.
#[inline(always)]
pub fn reached(rows: &[Span], n: usize, row: usize) -> Span {
    let y = row % n;
    let mut span = rows[row].grown(n);
    if y > 0 {
        span = span.union(rows[row - 1]);
    }
    if y + 1 < n {
        span = span.union(rows[row + 1]);
    }
    if row >= n {
        span = span.union(rows[row - n]);
    }
    if row + n < rows.len() {
        span = span.union(rows[row + n]);
    }
    span
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_of_marks_hold_every_marked_cell_and_end_at_one() {
        let n = 128;
        let mut marks = Marks::new(n);
        for cell in [[3, 5, 7], [90, 5, 7], [127, 0, 0], [64, 127, 127]] {
            marks.set(cell);
        }
        let spans = Spans::of_marks(n, &marks);
        let at = |y: usize, z: usize| spans.rows()[z * n + y];
        assert_eq!(at(5, 7), Span::new(3, 91));
        assert_eq!(at(0, 0), Span::new(127, 128));
        assert_eq!(at(127, 127), Span::new(64, 65));
        assert_eq!(spans.cells(), 88 + 1 + 1);
    }

    #[test]
    fn a_cell_grows_to_the_diamond_of_its_reach() {
        let n = 16;
        let from = [5usize, 2, 9];
        let mut marks = Marks::new(n);
        marks.set(from);
        let mut spans = Spans::of_marks(n, &marks);
        for k in 1..=9 {
            spans = spans.grown();
            let mut inside = 0;
            for z in 0..n {
                for y in 0..n {
                    let left = k as isize - (y.abs_diff(from[1]) + z.abs_diff(from[2])) as isize;
                    let span = spans.rows()[z * n + y];
                    for x in 0..n {
                        let reachable = left >= x.abs_diff(from[0]) as isize;
                        assert_eq!(span.from() <= x && x < span.to(), reachable, "k = {k}, ({x}, {y}, {z})");
                        inside += usize::from(reachable);
                    }
                }
            }
            assert_eq!(spans.cells(), inside);
        }
    }

    #[test]
    fn rounding_stays_in_the_row() {
        assert_eq!(Span::new(17, 33).rounded(16, 64), Span::new(16, 48));
        assert_eq!(Span::new(1, 3).rounded(16, 8), Span::new(0, 8));
        assert!(Span::EMPTY.rounded(16, 64).is_empty());
        assert!(Span::EMPTY.grown(8).is_empty());
    }
}
