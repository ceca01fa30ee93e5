//! One slab of a grid (all rows of one z) taken one iteration further, with what may be skipped in it:
//! light, sum, marks and the bits for where light may be, in one pass.

use multiversion::multiversion;

use super::FLOOR;
use super::form::Form;
use super::row::{self, Out, Stretch, chunked, chunked_mut};
use crate::field::{Grid, Layout, Marks};
use crate::propagate::active::{Row, reached, row_mask};
use crate::sh::Real;

/// Cells computed at a time: an AVX-512 register of f32, two of AVX2, four of SSE or NEON.
const LANES: usize = 16;

/// The instruction set to compute with. All give the same bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Instructions {
    /// The best this processor has.
    #[default]
    Best,
    /// Nothing beyond AVX2.
    Avx2,
    /// What every processor of the architecture has: SSE2, or NEON.
    Baseline,
}

/// What an iteration does and leaves out.
#[derive(Clone, Copy, Debug)]
pub struct Order<T> {
    /// The scheme at a factor.
    pub form: Form<T>,
    /// Whether the linear form may be used; see [`super::form`].
    pub linear: bool,
    /// Whether stretches of rows that have gone dark are dropped from the bits.
    pub drop_dark: bool,
    /// The cone to look whether the new light lies in, if that is asked.
    pub cone: Option<f64>,
    /// Whether to sum up c00.
    pub energy: bool,
    /// The instruction set.
    pub instructions: Instructions,
}

/// What an iteration found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tally {
    /// Cells that were computed.
    pub visited: usize,
    /// The sum of c00, if it was asked for.
    pub energy: f64,
    /// Whether all new light lies in the cone, if that was asked.
    pub in_cone: bool,
}

impl Tally {
    /// Nothing computed yet.
    pub const NONE: Tally = Tally { visited: 0, energy: 0.0, in_cone: true };

    /// Both; sums are taken in the order of the calls, which must not depend on threads.
    pub fn and(self, other: Tally) -> Tally {
        Tally {
            visited: self.visited + other.visited,
            energy: self.energy + other.energy,
            in_cone: self.in_cone && other.in_cone,
        }
    }
}

/// Light to read: slabs in a row, with what lies before and behind them.
#[derive(Clone, Copy)]
pub(super) struct Source<'a, T> {
    pub(super) planes: [&'a [T]; 4],
    /// Where it may be lit.
    pub(super) lit: &'a [u64],
    /// Where the first of the slabs begins in the planes.
    pub(super) first: usize,
}

/// A slab to write; its planes begin with its first row.
pub(super) struct Target<'a, T> {
    pub(super) planes: [&'a mut [T]; 4],
    /// Where it may be lit.
    pub(super) lit: &'a mut [u64],
    pub(super) sum: Option<[&'a mut [T]; 4]>,
    pub(super) marks: &'a mut [u64],
}

/// Takes slab number `z` of `source` one iteration further. Where `need` is given, cells outside it may
/// be left out.
pub(super) fn advance<T: Real>(
    order: &Order<T>,
    layout: Layout,
    source: Source<'_, T>,
    z: usize,
    target: &mut Target<'_, T>,
    need: Option<&[u64]>,
) -> Tally {
    match order.instructions {
        Instructions::Best => best(order, layout, source, z, target, need),
        Instructions::Avx2 => avx2(order, layout, source, z, target, need),
        Instructions::Baseline => any(order, layout, source, z, target, need),
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn best<T: Real>(
    order: &Order<T>,
    layout: Layout,
    source: Source<'_, T>,
    z: usize,
    target: &mut Target<'_, T>,
    need: Option<&[u64]>,
) -> Tally {
    any(order, layout, source, z, target, need)
}

#[multiversion(targets("x86_64+avx2+bmi2"))]
fn avx2<T: Real>(
    order: &Order<T>,
    layout: Layout,
    source: Source<'_, T>,
    z: usize,
    target: &mut Target<'_, T>,
    need: Option<&[u64]>,
) -> Tally {
    any(order, layout, source, z, target, need)
}

#[inline(always)]
fn any<T: Real>(
    order: &Order<T>,
    layout: Layout,
    source: Source<'_, T>,
    z: usize,
    target: &mut Target<'_, T>,
    need: Option<&[u64]>,
) -> Tally {
    if layout.side() < LANES {
        rows::<T, 1>(order, layout, source, z, target, need)
    } else {
        rows::<T, LANES>(order, layout, source, z, target, need)
    }
}

#[inline(always)]
fn rows<T: Real, const L: usize>(
    order: &Order<T>,
    layout: Layout,
    source: Source<'_, T>,
    z: usize,
    target: &mut Target<'_, T>,
    need: Option<&[u64]>,
) -> Tally {
    let n = layout.side();
    let per_row = target.marks.len() / n;
    let mut tally = Tally::NONE;
    if is_dark_around(source.lit, target.marks.len(), z) && target.lit.iter().all(|word| *word == 0) {
        return tally;
    }
    for y in 0..n {
        let words = y * per_row..(y + 1) * per_row;
        let mut lit = reached(source.lit, n, z * n + y);
        if let Some(need) = need {
            lit.iter_mut().zip(&need[words.clone()]).for_each(|(lit, need)| *lit &= need);
        }
        let start = y * layout.steps()[1];
        let at = source.first + z * layout.steps()[2] + start;
        let mut lanes = [T::ZERO; L];
        let mut from = 0;
        while let Some(run) = next_run::<T, L>(&lit, n, from, target, start, &words) {
            from = run.end;
            compute::<T, L>(order, layout, source, at, target, start, run);
            tally.visited += run.end - run.start;
            let [to_c, to_x, to_y, to_z] = &target.planes;
            let row = part([to_c, to_x, to_y, to_z], start, start + n);
            mark(row, run, &mut target.marks[words.clone()]);
            if order.energy {
                add_up(row[0], run, &mut lanes);
            }
            if let (true, Some(cone)) = (tally.in_cone, order.cone) {
                tally.in_cone = within_cone(part(row, run.start, run.end), cone);
            }
            if order.drop_dark {
                drop_dark::<T, L>(row, run, &mut lit);
            }
        }
        if order.energy {
            tally.energy += lanes.iter().map(|lane| lane.to_f64()).sum::<f64>();
        }
        target.lit[words].copy_from_slice(&lit[..per_row]);
    }
    tally
}

/// Whether slab `z` and the slabs beside it have no bit, of so many `words` a slab.
#[inline(always)]
fn is_dark_around(lit: &[u64], words: usize, z: usize) -> bool {
    let around = &lit[z.saturating_sub(1) * words..lit.len().min((z + 2) * words)];
    around.iter().fold(0, |any, word| any | word) == 0
}

/// Cells `start` to before `end` of a row, whole chunks.
#[derive(Clone, Copy)]
struct Run {
    start: usize,
    end: usize,
}

/// The next run of chunks from cell `from` on in which a cell may be lit. What an older iteration left in
/// the chunks on the way there is cleared.
#[inline(always)]
fn next_run<T: Real, const L: usize>(
    lit: &Row,
    n: usize,
    from: usize,
    target: &mut Target<'_, T>,
    row: usize,
    words: &std::ops::Range<usize>,
) -> Option<Run> {
    let per_row = words.len();
    if from == 0 && lit[..per_row].iter().all(|word| *word == row_mask(n)) {
        return Some(Run { start: 0, end: n });
    }
    if from == 0 && lit[..per_row].iter().chain(&target.lit[words.clone()]).all(|word| *word == 0) {
        return None;
    }
    let mut start = from;
    while start < n && chunk(lit[start / 64], start, L) == 0 {
        if chunk(target.lit[words.start + start / 64], start, L) != 0 {
            for plane in &mut target.planes {
                plane[row + start..row + start + L].fill(T::ZERO);
            }
        }
        start += L;
    }
    let mut end = start;
    while end < n && chunk(lit[end / 64], end, L) != 0 {
        end += L;
    }
    (start < n).then_some(Run { start, end })
}

/// The bits of the chunk of `lanes` cells that begins at cell `x`, out of its word.
#[inline(always)]
fn chunk(word: u64, x: usize, lanes: usize) -> u64 {
    (word >> (x % 64)) & (u64::MAX >> (64 - lanes))
}

/// A run of the row that begins at `at` in the source and at `start` in the target.
#[inline(always)]
fn compute<T: Real, const L: usize>(
    order: &Order<T>,
    layout: Layout,
    source: Source<'_, T>,
    at: usize,
    target: &mut Target<'_, T>,
    start: usize,
    run: Run,
) {
    let (chunks, from) = ((run.end - run.start) / L, run.start);
    let [c, x, y, z] = source.planes;
    let stretch = |plane| Stretch { plane, at: at + from, chunks };
    let light = [stretch(c), stretch(x), stretch(y), stretch(z)];
    let begin = start + from;
    let [to_c, to_x, to_y, to_z] = &mut target.planes;
    let mut out = [
        Out { target: chunked_mut(&mut to_c[begin..], chunks), sum: None },
        Out { target: chunked_mut(&mut to_x[begin..], chunks), sum: None },
        Out { target: chunked_mut(&mut to_y[begin..], chunks), sum: None },
        Out { target: chunked_mut(&mut to_z[begin..], chunks), sum: None },
    ];
    if let Some(sum) = &mut target.sum {
        for (out, plane) in out.iter_mut().zip(sum) {
            out.sum = Some(chunked_mut(&mut plane[begin..], chunks));
        }
    }
    let (form, floor, steps): (&Form<T>, T, [usize; 3]) = (&order.form, T::of(FLOOR), layout.steps());
    match (order.linear, form.side.is_some()) {
        (true, _) => row::linear(&form.share, floor, steps, light, out),
        (false, true) => row::clamped::<T, L, true>(form, floor, steps, light, out),
        (false, false) => row::clamped::<T, L, false>(form, floor, steps, light, out),
    }
}

/// Marks the lit cells of a run; words that are full already are passed over.
#[inline(always)]
fn mark<T: Real>(row: [&[T]; 4], run: Run, marks: &mut [u64]) {
    let words = marks.iter_mut().enumerate().take(run.end.div_ceil(64)).skip(run.start / 64);
    for (word, marked) in words {
        let (from, to) = (run.start.max(64 * word), run.end.min(64 * (word + 1)));
        let all = (u64::MAX >> (64 - (to - from))) << (from % 64);
        if *marked & all == all {
            continue;
        }
        let [c, x, y, z] = part(row, from, to);
        let mut bits = 0;
        for j in 0..to - from {
            let lit = (c[j] != T::ZERO) | (x[j] != T::ZERO) | (y[j] != T::ZERO) | (z[j] != T::ZERO);
            bits |= u64::from(lit) << j;
        }
        *marked |= bits << (from % 64);
    }
}

/// Adds a run's numbers lane by lane, so that neither runs nor instruction sets change the sum.
#[inline(always)]
fn add_up<T: Real, const L: usize>(plane: &[T], run: Run, lanes: &mut [T; L]) {
    for numbers in chunked::<T, L>(&plane[run.start..], (run.end - run.start) / L) {
        for j in 0..L {
            lanes[j] += numbers[j];
        }
    }
}

/// Whether ‖direction‖ ≤ r·c00 in every cell of a grid that is dark where `lit` has no bit.
pub fn lies_in_cone<T: Real>(grid: &Grid<T>, lit: &Marks, r: f64) -> bool {
    let (n, per_row) = (grid.side(), lit.words_per_row());
    let [c, x, y, z] = grid.planes();
    lit.words().chunks_exact(per_row).enumerate().filter(|(_, words)| words.iter().any(|word| *word != 0)).all(
        |(row, _)| {
            let start = grid.layout().row_start(row % n, row / n);
            within_cone(part([c, x, y, z], start, start + n), r)
        },
    )
}

/// Whether c00 is at least ‖direction‖ / r in every cell, in f64, where no square is lost.
#[inline(always)]
fn within_cone<T: Real>([c, x, y, z]: [&[T]; 4], r: f64) -> bool {
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
fn part<T>([c, x, y, z]: [&[T]; 4], from: usize, to: usize) -> [&[T]; 4] {
    [&c[from..to], &x[from..to], &y[from..to], &z[from..to]]
}

/// Takes the dark chunks at the ends of a run out of the bits.
#[inline(always)]
fn drop_dark<T: Real, const L: usize>(row: [&[T]; 4], run: Run, lit: &mut Row) {
    let chunks = (run.end - run.start) / L;
    let [c, x, y, z] = part(row, run.start, run.end);
    let row = [chunked::<T, L>(c, chunks), chunked(x, chunks), chunked(y, chunks), chunked(z, chunks)];
    let mut drop = |k: usize| {
        let x = run.start + k * L;
        lit[x / 64] &= !((u64::MAX >> (64 - L)) << (x % 64));
    };
    let (mut first, mut end) = (0, chunks);
    while first < end && is_dark(row, first) {
        drop(first);
        first += 1;
    }
    while first < end && is_dark(row, end - 1) {
        end -= 1;
        drop(end);
    }
}

#[inline(always)]
fn is_dark<T: Real, const L: usize>([c, x, y, z]: [&[[T; L]]; 4], k: usize) -> bool {
    let mut lit = false;
    for j in 0..L {
        lit |= (c[k][j] != T::ZERO) | (x[k][j] != T::ZERO) | (y[k][j] != T::ZERO) | (z[k][j] != T::ZERO);
    }
    !lit
}
