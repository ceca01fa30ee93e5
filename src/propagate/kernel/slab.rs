//! One slab of a grid (all rows of one z) taken one iteration further, with what may be skipped in it:
//! light, sum, marks and the bound on where light may be, in one pass.

use multiversion::multiversion;

use super::FLOOR;
use super::form::Form;
use super::row::{self, Out, Stretch, chunked, chunked_mut};
use crate::field::{Grid, Layout};
use crate::propagate::active::{Span, Spans, reached};
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
    /// Whether rows that have gone dark are dropped from the spans.
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
    pub(super) spans: &'a [Span],
    /// Where the first of the slabs begins in the planes.
    pub(super) first: usize,
}

/// A slab to write; its planes begin with its first row.
pub(super) struct Target<'a, T> {
    pub(super) planes: [&'a mut [T]; 4],
    pub(super) spans: &'a mut [Span],
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
    need: Option<&[Span]>,
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
    need: Option<&[Span]>,
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
    need: Option<&[Span]>,
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
    need: Option<&[Span]>,
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
    need: Option<&[Span]>,
) -> Tally {
    let n = layout.side();
    let words = target.marks.len() / n;
    let mut tally = Tally::NONE;
    for y in 0..n {
        let mut span = reached(source.spans, n, z * n + y);
        if let Some(need) = need {
            span = span.intersection(need[y]);
        }
        let wide = span.rounded(L, n);
        let start = y * layout.steps()[1];
        darken(target, start, target.spans[y], wide);
        target.spans[y] = span;
        if span.is_empty() {
            continue;
        }
        let at = source.first + z * layout.steps()[2] + start;
        compute::<T, L>(order, layout, source, at, target, start, wide);
        tally.visited += wide.len();
        let [c, x, y_, z_] = &target.planes;
        let row = [&c[start..start + n], &x[start..start + n], &y_[start..start + n], &z_[start..start + n]];
        mark(row, wide, &mut target.marks[y * words..(y + 1) * words]);
        if order.energy {
            tally.energy += sum::<T, L>(row[0], wide);
        }
        if let (true, Some(cone)) = (tally.in_cone, order.cone) {
            tally.in_cone = within_cone(part(row, wide.from(), wide.to()), cone);
        }
        if order.drop_dark {
            target.spans[y] = lit_part::<T, L>(row, wide).intersection(span);
        }
    }
    tally
}

/// Clears what an older iteration left in a row outside the stretch that is written now.
#[inline(always)]
fn darken<T: Real>(target: &mut Target<'_, T>, start: usize, old: Span, new: Span) {
    let (left, right) = if new.is_empty() {
        (old, Span::EMPTY)
    } else {
        (Span::new(old.from(), old.to().min(new.from())), Span::new(old.from().max(new.to()), old.to()))
    };
    for part in [left, right] {
        if !part.is_empty() {
            for plane in &mut target.planes {
                plane[start + part.from()..start + part.to()].fill(T::ZERO);
            }
        }
    }
}

/// The stretch `wide` of the row that begins at `at` in the source and at `start` in the target.
#[inline(always)]
fn compute<T: Real, const L: usize>(
    order: &Order<T>,
    layout: Layout,
    source: Source<'_, T>,
    at: usize,
    target: &mut Target<'_, T>,
    start: usize,
    wide: Span,
) {
    let (chunks, from) = (wide.len() / L, wide.from());
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

/// Marks the lit cells of a row within `wide`; words that are full already are passed over.
#[inline(always)]
fn mark<T: Real>(row: [&[T]; 4], wide: Span, marks: &mut [u64]) {
    let words = marks.iter_mut().enumerate().take(wide.to().div_ceil(64)).skip(wide.from() / 64);
    for (word, marked) in words {
        let (from, to) = (wide.from().max(64 * word), wide.to().min(64 * (word + 1)));
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

/// The sum of a row's numbers, lane by lane, so that neither spans nor instruction sets change it.
#[inline(always)]
fn sum<T: Real, const L: usize>(plane: &[T], wide: Span) -> f64 {
    let mut lanes = [T::ZERO; L];
    for chunk in chunked::<T, L>(&plane[wide.from()..], wide.len() / L) {
        for j in 0..L {
            lanes[j] += chunk[j];
        }
    }
    lanes.iter().map(|lane| lane.to_f64()).sum()
}

/// Whether ‖direction‖ ≤ r·c00 in every cell of a grid that is dark outside `spans`.
pub fn lies_in_cone<T: Real>(grid: &Grid<T>, spans: &Spans, r: f64) -> bool {
    let n = grid.side();
    let [c, x, y, z] = grid.planes();
    spans.rows().iter().enumerate().all(|(row, span)| {
        let start = grid.layout().row_start(row % n, row / n);
        within_cone(part([c, x, y, z], start + span.from(), start + span.to()), r)
    })
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

/// What is left of a stretch without the dark chunks at its ends.
#[inline(always)]
fn lit_part<T: Real, const L: usize>([c, x, y, z]: [&[T]; 4], wide: Span) -> Span {
    let (from, chunks) = (wide.from(), wide.len() / L);
    let row: [&[[T; L]]; 4] = [
        chunked(&c[from..], chunks),
        chunked(&x[from..], chunks),
        chunked(&y[from..], chunks),
        chunked(&z[from..], chunks),
    ];
    let (mut first, mut end) = (0, chunks);
    while first < end && is_dark(row, first) {
        first += 1;
    }
    while first < end && is_dark(row, end - 1) {
        end -= 1;
    }
    Span::new(from + first * L, from + end * L)
}

#[inline(always)]
fn is_dark<T: Real, const L: usize>([c, x, y, z]: [&[[T; L]]; 4], k: usize) -> bool {
    let mut lit = false;
    for j in 0..L {
        lit |= (c[k][j] != T::ZERO) | (x[k][j] != T::ZERO) | (y[k][j] != T::ZERO) | (z[k][j] != T::ZERO);
    }
    !lit
}
