//! Several iterations in one pass over memory, for grids that the cache does not hold.
//!
//! Iteration t + 1 of slab z needs iteration t of slabs z − 1 to z + 1 only. So a wave runs through the
//! slabs: at its s-th place slab s − t is taken through iteration t, for t = 0, 1, …, and all of that
//! lies in the cache. Source and target take turns, as when stepping: when iteration t + 1 overwrites
//! what iteration t read, nobody needs it any more.
//!
//! Where a few slabs are more than the cache holds, a wave takes only some of their rows, and the next wave the
//! next ones. What a row needs of its neighbours leans: iteration t of a wave does rows that lie by t steps
//! further back, so that all it needs has been done, by this wave or the one before.
//!
//! Threads: every thread has a run of slabs. First each does what its own slabs suffice for, one slab
//! less on either inner side with each iteration; then the wedges that are left between two runs are
//! filled in. Every row of every iteration is computed once, from the same numbers as when stepping.

use std::ops::Range;

use super::inspect::Run;
use super::slab::{Work, advance, grain};
use super::split::{Planes, Tied, cut_marks, runs, slab_of};
use super::{Level, Order, Tally, step};
use crate::field::{Layout, Marks};
use crate::sh::Real;
use crate::transport::team::share;

/// Memory that what is under the wave may take, in bytes, all threads together.
const CACHE: usize = 16 << 20;

/// The most iterations in one pass; more would gain nothing.
const MOST: usize = 16;

/// The iterations in one pass of a wave that takes only some rows of a slab: the more, the more rows of
/// the one before it has to fetch again.
const LEANING: usize = 8;

/// How many iterations of an n³ level should share a pass; 1 where stepping is as good.
pub fn depth<T: Real>(layout: Layout, threads: usize) -> usize {
    let (n, threads) = (layout.side(), threads.max(1));
    if n * n * row_bytes::<T>(layout) <= CACHE {
        return 1;
    }
    // The wedges between threads' runs, 2·depth slabs wide, are left for the second half: keep them narrow.
    let narrow = if threads == 1 { MOST } else { n / (8 * threads) };
    let whole = (CACHE / (n * row_bytes::<T>(layout) * threads)).saturating_sub(2);
    whole.clamp(LEANING, MOST).min(narrow).max(1)
}

/// How many rows of a slab a wave takes.
fn rows_under_wave<T: Real>(layout: Layout, iterations: usize, threads: usize) -> usize {
    let (fit, grain) = (CACHE / ((iterations + 2) * row_bytes::<T>(layout) * threads), grain(layout));
    if fit >= layout.side() { layout.side() } else { (fit - fit % grain).max(4 * grain) }
}

/// Bytes of a row in three grids: source, target and sum.
fn row_bytes<T: Real>(layout: Layout) -> usize {
    3 * 4 * layout.steps()[1] * size_of::<T>()
}

/// Takes the level `iterations` further. The newest light is then in the source if that number is even,
/// in the target if it is odd; the other one holds the light before it. Where `need` is given, cells
/// outside its t-th entry may be left out in iteration t.
pub fn advance_many<T: Real>(
    order: &Order<T>,
    level: &mut Level<'_, T>,
    iterations: usize,
    threads: usize,
    need: Option<&[&Marks]>,
) -> Tally {
    let rows = rows_under_wave::<T>(level.source.layout(), iterations, threads);
    in_waves(order, level, iterations, threads, rows, need)
}

/// [`advance_many`] with so many rows of a slab in a wave, all or a multiple of [`grain`].
pub(super) fn in_waves<T: Real>(
    order: &Order<T>,
    level: &mut Level<'_, T>,
    iterations: usize,
    threads: usize,
    rows: usize,
    need: Option<&[&Marks]>,
) -> Tally {
    let (layout, n) = (level.source.layout(), level.source.side());
    // A run must be wide enough that the wedges on its two sides do not meet.
    let threads = threads.clamp(1, (n / (2 * iterations + 2)).max(1));
    let inner: Vec<usize> = (1..threads).map(|i| i * n / threads).collect();

    let ends: Vec<usize> = inner.iter().copied().chain([n]).collect();
    let shrinking = |slabs: &Range<usize>, t: usize| {
        let from = if slabs.start == 0 { 0 } else { slabs.start + t + 1 };
        from..if slabs.end == n { n } else { slabs.end - t - 1 }
    };
    let mut tally = Pass { order, layout, iterations, rows, need }.over(level, &ends, shrinking);
    if inner.is_empty() {
        return tally;
    }
    // The wedges, each slab of which is a piece.
    let is_near = |z: usize, t: usize| inner.iter().any(|end| z < end + t + 1 && z + t + 1 >= *end);
    for t in 0..iterations {
        let ends: Vec<usize> = (1..=n).filter(|z| *z == n || is_near(z - 1, t) || is_near(*z, t)).collect();
        let mut turned = level.turned(t);
        let wanted = |slabs: &Range<usize>| is_near(slabs.start, t);
        tally = tally.and(step::over(order, &mut turned, &ends, wanted, need.map(|need| need[t])));
    }
    tally
}

/// What all parts of a pass have in common.
struct Pass<'a, T> {
    order: &'a Order<T>,
    layout: Layout,
    iterations: usize,
    /// How many rows of a slab a wave takes.
    rows: usize,
    need: Option<&'a [&'a Marks]>,
}

/// A run of slabs with all that is written in it: source and target, then sum and marks.
struct Part<'a, T> {
    slabs: Range<usize>,
    light: [Planes<'a, T>; 2],
    lit: [&'a mut [u64]; 2],
    tied: Tied<'a, T>,
}

impl<T: Real> Pass<'_, T> {
    /// Cuts the level at `ends` and sends a wave through the slabs of each run, over those that `range`
    /// gives for iteration t.
    fn over(
        &self,
        level: &mut Level<'_, T>,
        ends: &[usize],
        range: impl Fn(&Range<usize>, usize) -> Range<usize> + Sync,
    ) -> Tally {
        let light = Planes::cut(level.source, ends).into_iter().zip(Planes::cut(level.target, ends));
        let lit = cut_marks(level.source_lit, ends).into_iter().zip(cut_marks(level.target_lit, ends));
        let tied = Tied::cut(level.sum.as_deref_mut(), level.marks, ends);
        let parts = runs(ends).zip(light).zip(lit.zip(tied));
        let parts: Vec<Part<'_, T>> =
            parts.map(|((slabs, (a, b)), ((c, d), tied))| Part { slabs, light: [a, b], lit: [c, d], tied }).collect();
        let run = |mut part: Part<'_, T>| self.wave(&mut part, &range);
        share(parts, run).into_iter().fold(Tally::NONE, Tally::and)
    }

    fn wave(&self, part: &mut Part<'_, T>, range: &impl Fn(&Range<usize>, usize) -> Range<usize>) -> Tally {
        let mut tally = Tally::NONE;
        for rows in self.waves() {
            for front in part.slabs.start..part.slabs.end + self.iterations {
                for t in 0..self.iterations.min(front + 1) {
                    let (z, rows) = (front - t, rows(t));
                    if range(&part.slabs, t).contains(&z) && rows.start < rows.end {
                        tally = tally.and(self.advance(part, t, z, rows));
                    }
                }
            }
        }
        tally
    }

    /// The rows that each wave takes in iteration t.
    fn waves(&self) -> impl Iterator<Item = impl Fn(usize) -> Run> {
        let (n, rows, lean) = (self.layout.side(), self.rows, grain(self.layout));
        let count = if rows == n { 1 } else { (n + lean * (self.iterations - 1)).div_ceil(rows) };
        (0..count).map(move |wave| {
            move |t: usize| {
                let back = |row: usize| if count == 1 { row } else { row.saturating_sub(lean * t) };
                Run { start: back(wave * rows), end: back((wave + 1) * rows).min(n) }
            }
        })
    }

    /// Takes some rows of slab z through iteration t.
    fn advance(&self, part: &mut Part<'_, T>, t: usize, z: usize, rows: Run) -> Tally {
        let [a, b] = &mut part.light;
        let [a_lit, b_lit] = &mut part.lit;
        let (from, from_lit, to, to_lit) =
            if t.is_multiple_of(2) { (a, a_lit, b, b_lit) } else { (b, b_lit, a, a_lit) };
        let need = self.need.map(|need| slab_of(need[t], z));
        let z = z - part.slabs.start;
        let mut target = part.tied.target(self.layout, z, to, to_lit);
        let source = from.source(from_lit);
        advance(Work { order: self.order, layout: self.layout, source, z, rows, need }, &mut target)
    }
}
