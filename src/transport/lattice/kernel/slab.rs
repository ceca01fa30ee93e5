//! One slab of a grid (all rows of one z) taken one iteration further, with what may be skipped in it:
//! light, sum, marks and the bits for where light may be, in one pass.

use std::ops::Range;

use super::FLOOR;
use super::form::Form;
use super::inspect::{Run, add_up, chunk, drop_dark, mark, part, within_cone};
use super::row::{self, Job, behind};
use crate::field::{Layout, row_mask};
use crate::sh::Real;
use crate::transport::lattice::reach::{Row, reached};

/// Cells computed at a time: an AVX-512 register of f32, two of AVX2, four of SSE or NEON.
const LANES: usize = 16;

/// The most rows that are computed together.
const MOST_TOGETHER: usize = 16;

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
    /// The rows of it to compute: a multiple of [`grain`] from the first to before the last.
    pub(super) rows: Run,
    /// Where it is given, cells of the slab outside it may be left out.
    pub(super) need: Option<&'a [u64]>,
}

/// How many rows together, with the gaps between them, are whole chunks.
pub(super) fn grain(layout: Layout) -> usize {
    let [_, row, _] = layout.steps();
    [1, 2, 4, 8].into_iter().find(|rows| (rows * row).is_multiple_of(LANES)).unwrap_or(LANES)
}

/// Takes a slab one iteration further. Its side is a power of two up to 1024.
pub(super) fn advance<T: Real>(work: Work<'_, T>, target: &mut Target<'_, T>) -> Tally {
    // Cells at a time, and words a row.
    match work.layout.side() {
        0..4 => rows::<T, 1, 1>(work, target),
        4 => rows::<T, 4, 1>(work, target),
        8 => rows::<T, 8, 1>(work, target),
        16..=64 => rows::<T, LANES, 1>(work, target),
        128 => rows::<T, LANES, 2>(work, target),
        256 => rows::<T, LANES, 4>(work, target),
        512 => rows::<T, LANES, 8>(work, target),
        _ => rows::<T, LANES, 16>(work, target),
    }
}

fn rows<T: Real, const L: usize, const W: usize>(work: Work<'_, T>, target: &mut Target<'_, T>) -> Tally {
    let Work { layout, source, z, rows, need, .. } = work;
    let mut tally = Tally::NONE;
    if is_dark_around(source.lit, target.marks.len(), z) && target.lit.iter().all(|word| *word == 0) {
        return tally;
    }
    let (n, group) = (layout.side(), rows_together::<L>(layout));
    if is_old_news(work, target) {
        return throughout::<T, L, W>(work, target, group);
    }
    let (source_lit, need) = (source.lit.as_chunks().0, need.map(|need| need.as_chunks::<W>().0));
    for first in (rows.start..rows.end).step_by(group) {
        let mut lit = [[0; W]; MOST_TOGETHER];
        let lit = &mut lit[..group.min(rows.end - first)];
        for (y, lit) in (first..).zip(&mut *lit) {
            *lit = reached(source_lit, n, z * n + y);
            if let Some(need) = need {
                lit.iter_mut().zip(&need[y]).for_each(|(lit, need)| *lit &= need);
            }
        }
        // Where some rows stay dark the others are better off alone.
        let is_dense = lit.iter().all(|lit| *lit != [0; W]);
        let mut first = first;
        for lit in lit.chunks_mut(if is_dense { lit.len() } else { 1 }) {
            together::<T, L, W>(work, target, first, lit, &mut tally);
            first += lit.len();
        }
    }
    tally
}

/// Whether a slab was lit all over before, is marked and needed all over, and nothing is asked: then only
/// whether something goes dark is left to look at.
#[inline(always)]
fn is_old_news<T: Real>(Work { order, layout, source, z, need, .. }: Work<'_, T>, target: &Target<'_, T>) -> bool {
    let (words, all) = (target.marks.len(), row_mask(layout.side()));
    let is_full = |words: &[u64]| words.iter().all(|word| *word == all);
    let is_asked = order.energy || order.cone.is_some();
    let before = [&source.lit[z * words..(z + 1) * words], target.lit, target.marks];
    !is_asked && before.into_iter().chain(need).all(is_full)
}

/// A slab that is lit and marked all over.
#[inline(always)]
fn throughout<T: Real, const L: usize, const W: usize>(
    work: Work<'_, T>,
    target: &mut Target<'_, T>,
    group: usize,
) -> Tally {
    let Work { order, layout, rows, .. } = work;
    let (n, row) = (layout.side(), layout.steps()[1]);
    let whole = Run { start: 0, end: n };
    for first in (rows.start..rows.end).step_by(group) {
        let together = first..rows.end.min(first + group);
        compute::<T, L>(work, target, together.clone(), whole);
        for y in together.filter(|_| order.drop_dark) {
            let [c, ..] = &target.planes;
            if c[y * row] == T::ZERO || c[y * row + n - 1] == T::ZERO {
                let cells = part(shared(&target.planes), y * row, y * row + n);
                drop_dark::<T, L, W>(cells, whole, &mut target.lit.as_chunks_mut().0[y]);
            }
        }
    }
    Tally { visited: n * (rows.end - rows.start), ..Tally::NONE }
}

/// How many rows are computed together: so many that setting their loops up costs little, and so few that
/// all they touch stays in the first cache.
#[inline(always)]
fn rows_together<const L: usize>(layout: Layout) -> usize {
    const CELLS: usize = 512;
    let (n, row) = (layout.side(), layout.steps()[1]);
    let mut rows = 1;
    while L > 1 && rows < n.min(MOST_TOGETHER) && (rows * row < CELLS || !(rows * row).is_multiple_of(L)) {
        rows *= 2;
    }
    rows
}

/// Rows from `first` on, each with where it may be lit: every chunk of them in which one may be.
#[inline(always)]
fn together<T: Real, const L: usize, const W: usize>(
    work: Work<'_, T>,
    target: &mut Target<'_, T>,
    first: usize,
    lit: &mut [Row<W>],
    tally: &mut Tally,
) {
    let (layout, n) = (work.layout, work.layout.side());
    let rows = first..first + lit.len();
    let (mut any, mut before) = ([0; W], [0; W]);
    for (lit, was_lit) in lit.iter().zip(&target.lit.as_chunks::<W>().0[rows.clone()]) {
        any.iter_mut().zip(lit).for_each(|(any, lit)| *any |= lit);
        before.iter_mut().zip(was_lit).for_each(|(before, lit)| *before |= lit);
    }
    if any.iter().chain(&before).all(|word| *word == 0) {
        return;
    }
    clear_between::<T, L, W>(target, layout, rows.clone(), &any, &before);
    for run in runs::<L, W>(&any, n) {
        compute::<T, L>(work, target, rows.clone(), run);
    }
    for (y, lit) in rows.zip(lit) {
        let mut lanes = [T::ZERO; L];
        for run in runs::<L, W>(&any, n) {
            tally.visited += run.end - run.start;
            if !holds_no_news::<T, W>(work, target, y, run) {
                look::<T, L, W>(work, target, y, run, (lit, &mut lanes), tally);
            }
        }
        if work.order.energy {
            tally.energy += lanes.iter().map(|lane| lane.to_f64()).sum::<f64>();
        }
        target.lit.as_chunks_mut().0[y] = *lit;
    }
}

/// The runs of chunks with any bit in them, or with few chunks between such.
#[inline(always)]
fn runs<const L: usize, const W: usize>(lit: &Row<W>, n: usize) -> impl Iterator<Item = Run> {
    /// To begin another run costs about as much as so many chunks.
    const BRIDGED: usize = 2;
    let is_lit = move |x: &usize| chunk(lit[*x / 64], *x, L) != 0;
    let mut from = 0;
    std::iter::from_fn(move || {
        let start = (from..n).step_by(L).find(is_lit)?;
        let mut end = start;
        while let Some(next) = (end..n.min(end + (BRIDGED + 1) * L)).step_by(L).find(is_lit) {
            end = next + L;
        }
        from = end;
        Some(Run { start, end })
    })
}

/// Clears what an older iteration has left in chunks that this one will not write.
#[inline(always)]
fn clear_between<T: Real, const L: usize, const W: usize>(
    target: &mut Target<'_, T>,
    layout: Layout,
    rows: Range<usize>,
    lit: &Row<W>,
    before: &Row<W>,
) {
    let is_left = |x: &usize| chunk(before[x / 64], *x, L) != 0 && chunk(lit[x / 64], *x, L) == 0;
    for x in (0..layout.side()).step_by(L).filter(is_left) {
        for start in rows.clone().map(|y| y * layout.steps()[1] + x) {
            for plane in &mut target.planes {
                plane[start..start + L].fill(T::ZERO);
            }
        }
    }
}

/// Whether there is nothing to be found in a run: nothing is asked, all its cells are marked, and its ends
/// are lit.
#[inline(always)]
fn holds_no_news<T: Real, const W: usize>(work: Work<'_, T>, target: &Target<'_, T>, y: usize, run: Run) -> bool {
    let Work { order, layout, .. } = work;
    let (n, start, [c, ..]) = (layout.side(), y * layout.steps()[1], &target.planes);
    let is_whole = run.end - run.start == n;
    let is_lit = !order.drop_dark || (c[start] != T::ZERO && c[start + n - 1] != T::ZERO);
    let is_asked = order.energy || order.cone.is_some();
    is_whole && !is_asked && is_lit && target.marks.as_chunks().0[y] == [row_mask(n); W]
}

/// Makes the gaps between rows dark again: what a stretch of rows has written there is nobody's light.
#[inline(always)]
fn clear_gaps<T: Real>(rows: &mut [T], n: usize, step: usize) {
    for row in rows.chunks_exact_mut(step) {
        // Gaps are a few cells: a store or two, where filling would be a call.
        match &mut row[n..] {
            [one] => *one = T::ZERO,
            gap => match gap.as_chunks_mut::<4>() {
                ([one], []) => *one = [T::ZERO; 4],
                ([one, two], []) => (*one, *two) = ([T::ZERO; 4], [T::ZERO; 4]),
                _ => gap.fill(T::ZERO),
            },
        }
    }
}

/// Looks at a run of row `y` that was just computed: marks its lit cells, and whatever else is asked for.
#[inline(always)]
fn look<T: Real, const L: usize, const W: usize>(
    Work { order, layout, .. }: Work<'_, T>,
    target: &mut Target<'_, T>,
    y: usize,
    run: Run,
    (lit, lanes): (&mut Row<W>, &mut [T; L]),
    tally: &mut Tally,
) {
    let (start, end) = (y * layout.steps()[1], y * layout.steps()[1] + layout.side());
    let row = part(shared(&target.planes), start, end);
    mark::<T, L, W>(row, run, lit, &mut target.marks.as_chunks_mut().0[y]);
    if order.energy {
        add_up(row[0], run, lanes);
    }
    if let (true, Some(cone)) = (tally.in_cone, order.cone) {
        tally.in_cone = within_cone(part(row, run.start, run.end), cone);
    }
    if order.drop_dark {
        drop_dark::<T, L, W>(row, run, lit);
    }
}

/// Whether slab `z` and the slabs beside it have no bit, of so many `words` a slab.
#[inline(always)]
fn is_dark_around(lit: &[u64], words: usize, z: usize) -> bool {
    let around = &lit[z.saturating_sub(1) * words..lit.len().min((z + 2) * words)];
    around.iter().fold(0, |any, word| any | word) == 0
}

/// The planes, to read.
#[inline(always)]
fn shared<'a, T>([c, x, y, z]: &'a [&mut [T]; 4]) -> [&'a [T]; 4] {
    [c, x, y, z]
}

/// A run of cells in some rows.
#[inline(always)]
fn compute<T: Real, const L: usize>(work: Work<'_, T>, target: &mut Target<'_, T>, rows: Range<usize>, run: Run) {
    let Work { order: Order { form, linear, instructions, .. }, layout, source, z, .. } = work;
    let [_, row_step, slab] = layout.steps();
    let begin = rows.start * row_step + run.start;
    // Rows without a dark chunk are one stretch, with the gaps between them.
    let is_whole = rows.len() > 1 && run.end - run.start == layout.side();
    let cells = if is_whole { rows.len() * row_step } else { run.end - run.start };
    let job = Job {
        form,
        linear: *linear,
        floor: T::of(FLOOR),
        steps: layout.steps(),
        stretches: if is_whole { 1 } else { rows.len() },
        chunks: cells / L,
        planes: source.planes,
        at: source.first + z * slab + begin,
        target: behind(&mut target.planes, begin),
        sum: target.sum.as_mut().map(|sum| behind(sum, begin)),
    };
    row::run::<T, L>(*instructions, job);
    if is_whole {
        for plane in target.planes.iter_mut().chain(target.sum.iter_mut().flatten()) {
            clear_gaps(&mut plane[begin..begin + cells], layout.side(), row_step);
        }
    }
}
