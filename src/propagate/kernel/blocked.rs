//! Several iterations in one pass over memory, for grids that the cache does not hold.
//!
//! Iteration t + 1 of slab z needs iteration t of slabs z − 1 to z + 1 only. So a wave runs through the
//! slabs: at its s-th place slab s − t is taken through iteration t, for t = 0, 1, …, and all of that
//! lies in the cache. Source and target take turns, as when stepping: when iteration t + 1 overwrites
//! what iteration t read, nobody needs it any more.
//!
//! Threads: every thread has a run of slabs. First each does what its own slabs suffice for, one slab
//! less on either inner side with each iteration; then the wedges that are left between two runs are
//! filled in. Every slab of every iteration is computed once, from the same numbers as when stepping.

use std::ops::Range;

use super::carve::{Planes, Tied, cut_marks, runs, slab_of};
use super::slab::{Work, advance};
use super::team::share;
use super::{Level, Order, Tally, step};
use crate::field::{Layout, Marks};
use crate::sh::Real;

/// Memory that the slabs under the wave may take, in bytes, all threads together.
const CACHE: usize = 16 << 20;

/// The most iterations in one pass; more would gain nothing.
const MOST: usize = 16;

/// How many iterations of an n³ level should share a pass; 1 where stepping is as good.
pub fn depth<T: Real>(layout: Layout, threads: usize) -> usize {
    let (n, threads) = (layout.side(), threads.max(1));
    // Three grids: source, target and sum.
    let slab = 3 * 4 * layout.steps()[2] * size_of::<T>();
    // The wedges between threads' runs, 2·depth slabs wide, are left for the second half: keep them narrow.
    let narrow = if threads == 1 { MOST } else { n / (8 * threads) };
    let fits = (CACHE / (slab * threads)).saturating_sub(2).min(MOST).min(narrow);
    if n * slab <= CACHE || fits < 2 { 1 } else { fits }
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
    let (layout, n) = (level.source.layout(), level.source.side());
    // A run must be wide enough that the wedges on its two sides do not meet.
    let threads = threads.clamp(1, (n / (2 * iterations + 2)).max(1));
    let inner: Vec<usize> = (1..threads).map(|i| i * n / threads).collect();

    let ends: Vec<usize> = inner.iter().copied().chain([n]).collect();
    let shrinking = |slabs: &Range<usize>, t: usize| {
        let from = if slabs.start == 0 { 0 } else { slabs.start + t + 1 };
        from..if slabs.end == n { n } else { slabs.end - t - 1 }
    };
    let mut tally = Pass { order, layout, iterations, need }.over(level, &ends, shrinking);
    // The wedges, each slab of which is a piece.
    let is_near = |z: usize, t: usize| inner.iter().any(|end| z < end + t + 1 && z + t + 1 >= *end);
    for t in 0..if inner.is_empty() { 0 } else { iterations } {
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
        for front in part.slabs.start..part.slabs.end + self.iterations {
            for t in 0..self.iterations.min(front + 1) {
                let z = front - t;
                if !range(&part.slabs, t).contains(&z) {
                    continue;
                }
                let [a, b] = &mut part.light;
                let [a_lit, b_lit] = &mut part.lit;
                let (from, from_lit, to, to_lit) = if t % 2 == 0 { (a, a_lit, b, b_lit) } else { (b, b_lit, a, a_lit) };
                let need = self.need.map(|need| slab_of(need[t], z));
                let local = z - part.slabs.start;
                let mut target = part.tied.target(self.layout, local, to, to_lit);
                let source = from.source(from_lit);
                let work = Work { order: self.order, layout: self.layout, source, z: local, need };
                tally = tally.and(advance(work, &mut target));
            }
        }
        tally
    }
}
