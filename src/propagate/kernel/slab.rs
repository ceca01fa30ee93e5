//! One slab of a grid (all rows of one z) taken one iteration further, with what may be skipped in it:
//! light, sum, marks and the bits for where light may be, in one pass.

use std::ops::Range;

use super::FLOOR;
use super::form::Form;
use super::found::{Run, add_up, drop_dark, mark, part, within_cone};
use super::row::{self, Job};
use crate::field::Layout;
use crate::propagate::active::{MOST_WORDS, Row, reached, row_mask};
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

/// One slab's work: all that is read.
#[derive(Clone, Copy)]
pub(super) struct Work<'a, T> {
    pub(super) order: &'a Order<T>,
    pub(super) layout: Layout,
    pub(super) source: Source<'a, T>,
    /// The slab's number in the source.
    pub(super) z: usize,
    /// Where it is given, cells of the slab outside it may be left out.
    pub(super) need: Option<&'a [u64]>,
}

/// Takes a slab one iteration further.
pub(super) fn advance<T: Real>(work: Work<'_, T>, target: &mut Target<'_, T>) -> Tally {
    if work.layout.side() < LANES { rows::<T, 1>(work, target) } else { rows::<T, LANES>(work, target) }
}

fn rows<T: Real, const L: usize>(work: Work<'_, T>, target: &mut Target<'_, T>) -> Tally {
    let Work { layout, source, z, need, .. } = work;
    let n = layout.side();
    let per_row = target.marks.len() / n;
    let mut tally = Tally::NONE;
    if is_dark_around(source.lit, target.marks.len(), z) && target.lit.iter().all(|word| *word == 0) {
        return tally;
    }
    let lit = &source.lit[z * target.lit.len()..];
    let is_full = |words: &[u64]| words.iter().all(|word| *word == row_mask(n));
    let group = rows_together::<L>(layout);
    for first in (0..n).step_by(group) {
        let words = first * per_row..(first + group) * per_row;
        if group > 1 && is_full(&lit[words.clone()]) && need.is_none_or(|need| is_full(&need[words])) {
            full_rows::<T, L>(work, target, first..first + group, &mut tally);
        } else {
            for y in first..first + group {
                row::<T, L>(work, target, y, &mut tally);
            }
        }
    }
    tally
}

/// How many rows that are lit from end to end are computed as one stretch, with the gaps between them:
/// so many that setting a stretch up costs little, and so few that all it touches stays in the first
/// cache.
#[inline(always)]
fn rows_together<const L: usize>(layout: Layout) -> usize {
    const CELLS: usize = 512;
    let (n, row) = (layout.side(), layout.steps()[1]);
    let mut rows = 1;
    while L > 1 && rows < n && (rows * row < CELLS || !(rows * row).is_multiple_of(L)) {
        rows *= 2;
    }
    rows
}

/// Rows that are lit from end to end, as one stretch.
#[inline(always)]
fn full_rows<T: Real, const L: usize>(
    work: Work<'_, T>,
    target: &mut Target<'_, T>,
    rows: Range<usize>,
    tally: &mut Tally,
) {
    let (n, step) = (work.layout.side(), work.layout.steps()[1]);
    let start = rows.start * step;
    compute::<T, L>(work, target, start, Run { start: 0, end: rows.len() * step });
    for plane in target.planes.iter_mut().chain(target.sum.iter_mut().flatten()) {
        clear_gaps(&mut plane[start..][..rows.len() * step], n, step);
    }
    for y in rows {
        let (mut lit, mut lanes) = ([row_mask(n); MOST_WORDS], [T::ZERO; L]);
        look::<T, L>(work, target, y, Run { start: 0, end: n }, (&mut lit, &mut lanes), tally);
        finish(work, target, y, &lit, &lanes, tally);
    }
}

/// Makes the gaps between rows dark again: what a stretch of rows has written there is nobody's light.
#[inline(always)]
fn clear_gaps<T: Real>(rows: &mut [T], n: usize, step: usize) {
    for row in rows.chunks_exact_mut(step) {
        // Gaps are a few cells: a store or two, where filling would be a call.
        let (fours, rest) = row[n..].as_chunks_mut::<4>();
        match fours {
            [one] => *one = [T::ZERO; 4],
            [one, two] => (*one, *two) = ([T::ZERO; 4], [T::ZERO; 4]),
            more => more.as_flattened_mut().fill(T::ZERO),
        }
        rest.fill(T::ZERO);
    }
}

/// One row, run by run of what may be lit in it.
#[inline(always)]
fn row<T: Real, const L: usize>(work: Work<'_, T>, target: &mut Target<'_, T>, y: usize, tally: &mut Tally) {
    let Work { layout, source, z, need, .. } = work;
    let n = layout.side();
    let per_row = target.marks.len() / n;
    let words = y * per_row..(y + 1) * per_row;
    let mut lit = reached(source.lit, n, z * n + y);
    if let Some(need) = need {
        lit.iter_mut().zip(&need[words.clone()]).for_each(|(lit, need)| *lit &= need);
    }
    let start = y * layout.steps()[1];
    let (mut from, mut lanes) = (0, [T::ZERO; L]);
    while let Some(run) = next_run::<T, L>(&lit, n, from, target, start, &words) {
        from = run.end;
        compute::<T, L>(work, target, start, run);
        look::<T, L>(work, target, y, run, (&mut lit, &mut lanes), tally);
    }
    finish(work, target, y, &lit, &lanes, tally);
}

/// Looks at a run of row `y` that was just computed: marks its lit cells, and whatever else is asked for.
#[inline(always)]
fn look<T: Real, const L: usize>(
    Work { order, layout, .. }: Work<'_, T>,
    target: &mut Target<'_, T>,
    y: usize,
    run: Run,
    (lit, lanes): (&mut Row, &mut [T; L]),
    tally: &mut Tally,
) {
    let n = layout.side();
    let (start, per_row) = (y * layout.steps()[1], target.marks.len() / n);
    let row = part(target.planes.each_ref().map(|plane| &**plane), start, start + n);
    tally.visited += run.end - run.start;
    mark(row, run, lit, &mut target.marks[y * per_row..(y + 1) * per_row]);
    if order.energy {
        add_up(row[0], run, lanes);
    }
    if let (true, Some(cone)) = (tally.in_cone, order.cone) {
        tally.in_cone = within_cone(part(row, run.start, run.end), cone);
    }
    if order.drop_dark {
        drop_dark::<T, L>(row, run, lit);
    }
}

/// Keeps what was found in row `y`.
#[inline(always)]
fn finish<T: Real, const L: usize>(
    work: Work<'_, T>,
    target: &mut Target<'_, T>,
    y: usize,
    lit: &Row,
    lanes: &[T; L],
    tally: &mut Tally,
) {
    if work.order.energy {
        tally.energy += lanes.iter().map(|lane| lane.to_f64()).sum::<f64>();
    }
    let per_row = target.lit.len() / work.layout.side();
    target.lit[y * per_row..(y + 1) * per_row].copy_from_slice(&lit[..per_row]);
}

/// Whether slab `z` and the slabs beside it have no bit, of so many `words` a slab.
#[inline(always)]
fn is_dark_around(lit: &[u64], words: usize, z: usize) -> bool {
    let around = &lit[z.saturating_sub(1) * words..lit.len().min((z + 2) * words)];
    around.iter().fold(0, |any, word| any | word) == 0
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
    words: &Range<usize>,
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

/// A run of cells, counted from a row that begins at `start` in the target.
#[inline(always)]
fn compute<T: Real, const L: usize>(work: Work<'_, T>, target: &mut Target<'_, T>, start: usize, run: Run) {
    let Work { order: Order { form, linear, instructions, .. }, layout, source, z, .. } = work;
    let begin = start + run.start;
    let job = Job {
        form,
        linear: *linear,
        floor: T::of(FLOOR),
        steps: layout.steps(),
        chunks: (run.end - run.start) / L,
        planes: source.planes,
        at: source.first + z * layout.steps()[2] + begin,
        target: target.planes.each_mut().map(|plane| &mut plane[begin..]),
        sum: target.sum.as_mut().map(|sum| sum.each_mut().map(|plane| &mut plane[begin..])),
    };
    row::run::<T, L>(*instructions, job);
}
