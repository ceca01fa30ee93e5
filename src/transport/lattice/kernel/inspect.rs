//! What a run of cells that was just computed holds: which cells are lit, their sum, whether they lie in
//! the cone, whether they have gone dark.

use multiversion::multiversion;

use super::row::chunked;
use crate::field::{Grid, Marks};
use crate::sh::Real;
use crate::transport::lattice::reach::Row;

/// Cells `start` to before `end` of a row, whole chunks; or rows of a slab.
#[derive(Clone, Copy)]
pub(super) struct Run {
    pub(super) start: usize,
    pub(super) end: usize,
}

/// Marks the lit cells of a run. Only cells that light may have reached and that have no mark yet are
/// looked at: few, behind a front that moves a cell an iteration.
#[inline(always)]
pub(super) fn mark<T: Real, const L: usize, const W: usize>(
    row: [&[T]; 4],
    run: Run,
    lit: &Row<W>,
    marks: &mut Row<W>,
) {
    let [c, x, y, z] = row;
    for at in (run.start..run.end).step_by(L) {
        let mut open = chunk(lit[at / 64] & !marks[at / 64], at, L);
        if open == 0 || is_dark::<T, L>(row, at) {
            continue;
        }
        while open != 0 {
            let bit = open.trailing_zeros() as usize;
            let i = at + bit;
            let is_lit = (c[i] != T::ZERO) | (x[i] != T::ZERO) | (y[i] != T::ZERO) | (z[i] != T::ZERO);
            marks[i / 64] |= u64::from(is_lit) << (i % 64);
            open &= open - 1;
        }
    }
}

/// The bits of the chunk of `lanes` cells that begins at cell `x`, out of its word.
#[inline(always)]
pub(super) fn chunk(word: u64, x: usize, lanes: usize) -> u64 {
    (word >> (x % 64)) & (u64::MAX >> (64 - lanes))
}

/// Adds a run's numbers lane by lane, so that neither runs nor instruction sets change the sum.
#[inline(always)]
pub(super) fn add_up<T: Real, const L: usize>(plane: &[T], run: Run, lanes: &mut [T; L]) {
    for numbers in chunked::<T, L>(&plane[run.start..], (run.end - run.start) / L) {
        for j in 0..L {
            lanes[j] += numbers[j];
        }
    }
}

/// Whether ‖direction‖ ≤ r·c00 in every cell of a grid that is dark where `lit` has no bit.
pub fn lies_in_cone<T: Real>(grid: &Grid<T>, lit: &Marks, r: f64) -> bool {
    let (n, per_row) = (grid.side(), lit.words_per_row());
    let rows = lit.words().chunks_exact(per_row).enumerate();
    rows.filter(|(_, words)| words.iter().any(|word| *word != 0))
        .all(|(row, _)| within_cone(grid.row(row % n, row / n), r))
}

/// Whether c00 is at least ‖direction‖ / r in every cell, in f64, where no square is lost.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
pub(super) fn within_cone<T: Real>([c, x, y, z]: [&[T]; 4], r: f64) -> bool {
    let len = c.len();
    let (x, y, z) = (&x[..len], &y[..len], &z[..len]);
    let mut outside = false;
    for j in 0..len {
        let [c, x, y, z] = [c[j], x[j], y[j], z[j]].map(T::to_f64);
        // Written so that a cell that is not a number is outside.
        let inside = (c >= 0.0) & (x * x + y * y + z * z <= r * r * c * c);
        outside |= !inside;
    }
    !outside
}

/// Cells `from` to before `to` of a row.
#[inline(always)]
pub(super) fn part<T>([c, x, y, z]: [&[T]; 4], from: usize, to: usize) -> [&[T]; 4] {
    [&c[from..to], &x[from..to], &y[from..to], &z[from..to]]
}

/// Takes the dark chunks at the ends of a run out of the bits.
#[inline(always)]
pub(super) fn drop_dark<T: Real, const L: usize, const W: usize>(row: [&[T]; 4], run: Run, lit: &mut Row<W>) {
    let mut drop = |x: usize| lit[x / 64] &= !(chunk(u64::MAX, 0, L) << (x % 64));
    let (mut first, mut end) = (run.start, run.end);
    while first < end && is_dark::<T, L>(row, first) {
        drop(first);
        first += L;
    }
    while first < end && is_dark::<T, L>(row, end - L) {
        end -= L;
        drop(end);
    }
}

/// Whether the chunk at cell `x` of a row is dark. Looks at c00 first: where there is light it is hardly
/// ever zero.
#[inline(always)]
fn is_dark<T: Real, const L: usize>(row: [&[T]; 4], x: usize) -> bool {
    row.iter().all(|plane| {
        let mut lit = false;
        for c in &plane[x..x + L] {
            lit |= *c != T::ZERO;
        }
        !lit
    })
}
