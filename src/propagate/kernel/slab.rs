//! One slab of a grid (all rows of one z) taken one iteration further, with what may be skipped in it:
//! light, sum, marks and the bits for where light may be, in one pass.

use multiversion::multiversion;

use super::FLOOR;
use super::form::Form;
use super::found::{Run, add_up, drop_dark, mark, part, within_cone};
use super::row::{self, Out, Stretch, chunked_mut};
use crate::field::Layout;
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
            mark(row, run, &lit, &mut target.marks[words.clone()]);
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
    let c = chunked_mut(&mut to_c[begin..], chunks);
    let x = chunked_mut(&mut to_x[begin..], chunks);
    let y = chunked_mut(&mut to_y[begin..], chunks);
    let z = chunked_mut(&mut to_z[begin..], chunks);
    let out = match &mut target.sum {
        Some([sum_c, sum_x, sum_y, sum_z]) => [
            Out { target: c, sum: Some(chunked_mut(&mut sum_c[begin..], chunks)) },
            Out { target: x, sum: Some(chunked_mut(&mut sum_x[begin..], chunks)) },
            Out { target: y, sum: Some(chunked_mut(&mut sum_y[begin..], chunks)) },
            Out { target: z, sum: Some(chunked_mut(&mut sum_z[begin..], chunks)) },
        ],
        None => [
            Out { target: c, sum: None },
            Out { target: x, sum: None },
            Out { target: y, sum: None },
            Out { target: z, sum: None },
        ],
    };
    let (form, floor, steps): (&Form<T>, T, [usize; 3]) = (&order.form, T::of(FLOOR), layout.steps());
    match (order.linear, form.side.is_some()) {
        (true, _) => row::linear(&form.share, floor, steps, light, out),
        (false, true) => row::clamped::<T, L, true>(form, floor, steps, light, out),
        (false, false) => row::clamped::<T, L, false>(form, floor, steps, light, out),
    }
}
