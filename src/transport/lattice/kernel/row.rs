//! The innermost loops: a stretch of a row of cells from its six neighbours, in the linear and in the
//! clamped form of [`super::form`].
//!
//! Written over arrays of `L` numbers, so that the compiler makes vector code of them for whichever
//! instruction set the caller is compiled for. Products and sums are never fused, and every lane is a
//! cell of its own, so that all instruction sets give the same bits.

use multiversion::multiversion;

use super::form::{Face, Form, Share};
use super::{Instructions, settle_number};
use crate::sh::Real;

/// Stretches of cells to compute, one a row, and where they go.
pub(super) struct Job<'a, 'b, T> {
    pub(super) form: &'a Form<T>,
    /// Whether the linear form is enough.
    pub(super) linear: bool,
    pub(super) floor: T,
    /// The distances to the neighbours along x, y and z.
    pub(super) steps: [usize; 3],
    /// How many stretches there are, a row apart.
    pub(super) stretches: usize,
    /// How many chunks long each of them is.
    pub(super) chunks: usize,
    /// The source's planes c00, X, Y and Z.
    pub(super) planes: [&'a [T]; 4],
    /// Where the first stretch begins in them.
    pub(super) at: usize,
    /// Where the new light goes, from the first cell on.
    pub(super) target: [&'b mut [T]; 4],
    /// What it is added to, if anything.
    pub(super) sum: Option<[&'b mut [T]; 4]>,
}

/// Does the work with the best of the `instructions` that this processor has, in chunks of `L` cells.
pub(super) fn run<T: Real, const L: usize>(instructions: Instructions, job: Job<'_, '_, T>) {
    match instructions {
        Instructions::Best => best::<T, L>(job),
        Instructions::Avx2 => avx2::<T, L>(job),
        Instructions::Baseline => any::<T, L>(job),
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn best<T: Real, const L: usize>(job: Job<'_, '_, T>) {
    any::<T, L>(job)
}

#[multiversion(targets("x86_64+avx2+bmi2"))]
fn avx2<T: Real, const L: usize>(job: Job<'_, '_, T>) {
    any::<T, L>(job)
}

#[inline(always)]
fn any<T: Real, const L: usize>(job: Job<'_, '_, T>) {
    let Job { form, linear: is_linear, floor, steps, stretches, chunks, planes, at, mut target, mut sum } = job;
    for begin in (0..stretches).map(|i| i * steps[1]) {
        let light = Light { planes, at: at + begin, steps, chunks };
        let target = behind(&mut target, begin);
        let sum = sum.as_mut().map(|sum| behind(sum, begin));
        match (is_linear, form.side.is_some(), sum) {
            (true, _, Some(sum)) => linear::<T, L, true>(form, floor, light, target, sum),
            (true, _, None) => linear::<T, L, false>(form, floor, light, target, Default::default()),
            (false, true, Some(sum)) => clamped::<T, L, true, true>(form, floor, light, target, sum),
            (false, true, None) => clamped::<T, L, true, false>(form, floor, light, target, Default::default()),
            (false, false, Some(sum)) => clamped::<T, L, false, true>(form, floor, light, target, sum),
            (false, false, None) => clamped::<T, L, false, false>(form, floor, light, target, Default::default()),
        }
    }
}

/// The planes from `begin` on. Written out, as the `map` of arrays is not always inlined.
#[inline(always)]
pub(super) fn behind<'a, T>([c, x, y, z]: &'a mut [&mut [T]; 4], begin: usize) -> [&'a mut [T]; 4] {
    [&mut c[begin..], &mut x[begin..], &mut y[begin..], &mut z[begin..]]
}

/// What one stretch is computed from.
#[derive(Clone, Copy)]
struct Light<'a, T> {
    planes: [&'a [T]; 4],
    at: usize,
    steps: [usize; 3],
    chunks: usize,
}

/// A stretch of a plane, by the chunk, one step back and one step on along an axis.
pub(in crate::transport::lattice) type Beside<'a, T, const L: usize> = [&'a [[T; L]]; 2];

/// The stretches beside the one at `at` in `plane`, `step` away.
#[inline(always)]
fn beside<T, const L: usize>(plane: &[T], at: usize, step: usize, chunks: usize) -> Beside<'_, T, L> {
    [chunked(&plane[at - step..], chunks), chunked(&plane[at + step..], chunks)]
}

/// [`beside`] in all planes. Written out, like [`behind`].
#[inline(always)]
fn all_beside<T, const L: usize>(planes: [&[T]; 4], at: usize, step: usize, chunks: usize) -> [Beside<'_, T, L>; 4] {
    let [c, x, y, z] = planes;
    [beside(c, at, step, chunks), beside(x, at, step, chunks), beside(y, at, step, chunks), beside(z, at, step, chunks)]
}

/// The first `chunks` · L numbers, by the chunk.
#[inline(always)]
pub(in crate::transport::lattice) fn chunked<T, const L: usize>(numbers: &[T], chunks: usize) -> &[[T; L]] {
    &numbers[..chunks * L].as_chunks().0[..chunks]
}

/// [`chunked`], to write in.
#[inline(always)]
pub(in crate::transport::lattice) fn chunked_mut<T, const L: usize>(numbers: &mut [T], chunks: usize) -> &mut [[T; L]] {
    &mut numbers[..chunks * L].as_chunks_mut().0[..chunks]
}

/// Where a stretch goes in one plane: into the target, and onto the sum if `SUM`; otherwise that is empty.
struct Out<'a, T, const L: usize, const SUM: bool> {
    target: &'a mut [[T; L]],
    sum: &'a mut [[T; L]],
}

impl<'a, T: Real, const L: usize, const SUM: bool> Out<'a, T, L, SUM> {
    #[inline(always)]
    fn new(target: &'a mut [T], sum: &'a mut [T], chunks: usize) -> Self {
        Out { target: chunked_mut(target, chunks), sum: chunked_mut(sum, if SUM { chunks } else { 0 }) }
    }

    #[inline(always)]
    fn put(&mut self, k: usize, floor: T, value: [T; L]) {
        let mut settled = value;
        for c in &mut settled {
            *c = settle_number(*c, floor);
        }
        self.target[k] = settled;
        if SUM {
            for (a, b) in self.sum[k].iter_mut().zip(settled) {
                *a += b;
            }
        }
    }
}

/// The linear form: plane by plane, from the numbers of the neighbours that go into each.
#[inline(always)]
fn linear<T: Real, const L: usize, const SUM: bool>(
    form: &Form<T>,
    floor: T,
    Light { planes: [c, x, y, z], at, steps: [dx, dy, dz], chunks }: Light<'_, T>,
    target: [&mut [T]; 4],
    sum: [&mut [T]; 4],
) {
    let [to_c, to_x, to_y, to_z] = target;
    let [sum_c, sum_x, sum_y, sum_z] = sum;
    let beside = |plane, step| beside::<T, L>(plane, at, step, chunks);
    let out = |target, sum| Out::<T, L, SUM>::new(target, sum, chunks);
    let (c_x, c_y, c_z) = (beside(c, dx), beside(c, dy), beside(c, dz));
    let (x_x, y_y, z_z) = (beside(x, dx), beside(y, dy), beside(z, dz));
    let across_x = [beside(x, dy), beside(x, dz)];
    let across_y = [beside(y, dx), beside(y, dz)];
    let across_z = [beside(z, dx), beside(z, dy)];
    linear_mean(&form.share, floor, [c_x, c_y, c_z], [x_x, y_y, z_z], out(to_c, sum_c));
    linear_direction(&form.share, floor, c_x, x_x, across_x, out(to_x, sum_x));
    linear_direction(&form.share, floor, c_y, y_y, across_y, out(to_y, sum_y));
    linear_direction(&form.share, floor, c_z, z_z, across_z, out(to_z, sum_z));
}

#[inline(always)]
fn linear_mean<T: Real, const L: usize, const SUM: bool>(
    share: &Share<T>,
    floor: T,
    c: [Beside<'_, T, L>; 3],
    inward: [Beside<'_, T, L>; 3],
    mut out: Out<'_, T, L, SUM>,
) {
    for k in 0..out.target.len() {
        out.put(k, floor, mean(share, c, inward, k));
    }
}

#[inline(always)]
fn linear_direction<T: Real, const L: usize, const SUM: bool>(
    share: &Share<T>,
    floor: T,
    c: Beside<'_, T, L>,
    along: Beside<'_, T, L>,
    across: [Beside<'_, T, L>; 2],
    mut out: Out<'_, T, L, SUM>,
) {
    for k in 0..out.target.len() {
        out.put(k, floor, direction(share, c, along, across, k));
    }
}

/// c00 of chunk `k` in the linear form: from the neighbours' c00 along x, y and z, and from what of each flows
/// along its own axis.
#[inline(always)]
pub(in crate::transport::lattice) fn mean<T: Real, const L: usize>(
    share: &Share<T>,
    [cx, cy, cz]: [Beside<'_, T, L>; 3],
    [x, y, z]: [Beside<'_, T, L>; 3],
    k: usize,
) -> [T; L] {
    let mut value = [T::ZERO; L];
    for j in 0..L {
        let mean = (cx[0][k][j] + cx[1][k][j]) + (cy[0][k][j] + cy[1][k][j]) + (cz[0][k][j] + cz[1][k][j]);
        let inward = (x[0][k][j] - x[1][k][j]) + (y[0][k][j] - y[1][k][j]) + (z[0][k][j] - z[1][k][j]);
        value[j] = share.alpha * mean + share.beta * inward;
    }
    value
}

/// X, Y or Z of chunk `k` in the linear form: from c00 along its axis, and from its own plane along and across it.
#[inline(always)]
pub(in crate::transport::lattice) fn direction<T: Real, const L: usize>(
    share: &Share<T>,
    c: Beside<'_, T, L>,
    along: Beside<'_, T, L>,
    [p, q]: [Beside<'_, T, L>; 2],
    k: usize,
) -> [T; L] {
    let mut value = [T::ZERO; L];
    for j in 0..L {
        let fall = c[0][k][j] - c[1][k][j];
        let along = along[0][k][j] + along[1][k][j];
        let across = (p[0][k][j] + p[1][k][j]) + (q[0][k][j] + q[1][k][j]);
        value[j] = share.gamma * fall + share.delta * along + share.epsilon * across;
    }
    value
}

/// The clamped form, face by face. `SIDES`: whether there are side faces.
#[inline(always)]
fn clamped<T: Real, const L: usize, const SIDES: bool, const SUM: bool>(
    form: &Form<T>,
    floor: T,
    Light { planes, at, steps, chunks }: Light<'_, T>,
    target: [&mut [T]; 4],
    sum: [&mut [T]; 4],
) {
    let [to_c, to_x, to_y, to_z] = target;
    let [sum_c, sum_x, sum_y, sum_z] = sum;
    let out = |target, sum| Out::<T, L, SUM>::new(target, sum, chunks);
    let (mut to_c, mut to_x) = (out(to_c, sum_c), out(to_x, sum_x));
    let (mut to_y, mut to_z) = (out(to_y, sum_y), out(to_z, sum_z));
    let [x, y, z] = steps;
    let (x, y, z) =
        (all_beside(planes, at, x, chunks), all_beside(planes, at, y, chunks), all_beside(planes, at, z, chunks));
    for k in 0..chunks {
        let mut sums = [[T::ZERO; L]; 4];
        let [c, a, b, d] = &mut sums;
        for (side, down) in [(0, false), (1, true)] {
            let at = |plane: Beside<'_, T, L>| plane[side][k];
            share_clamped::<T, L, SIDES>(form, down, [at(x[0]), at(x[1]), at(x[2]), at(x[3])], [c, a, b, d]);
            share_clamped::<T, L, SIDES>(form, down, [at(y[0]), at(y[2]), at(y[1]), at(y[3])], [c, b, a, d]);
            share_clamped::<T, L, SIDES>(form, down, [at(z[0]), at(z[3]), at(z[1]), at(z[2])], [c, d, a, b]);
        }
        let [c, a, b, d] = sums;
        to_c.put(k, floor, c);
        to_x.put(k, floor, a);
        to_y.put(k, floor, b);
        to_z.put(k, floor, d);
    }
}

/// Adds what one neighbour sends. Planes come as c00, along the way, and the two across it; `down` says
/// that the way leads to smaller indices.
#[inline(always)]
fn share_clamped<T: Real, const L: usize, const SIDES: bool>(
    form: &Form<T>,
    down: bool,
    [c, along, p, q]: [[T; L]; 4],
    [to_c, to_along, to_p, to_q]: [&mut [T; L]; 4],
) {
    let ahead = &form.ahead;
    let turn = |c: T| if down { -c } else { c };
    let (seen, sent) = (turn(ahead.sampler[1]), turn(ahead.lobe[1]));
    for j in 0..L {
        let flux = (ahead.sampler[0] * c[j] + seen * along[j]).max(ahead.least);
        to_c[j] += ahead.lobe[0] * flux;
        to_along[j] += sent * flux;
    }
    if let (true, Some(side)) = (SIDES, &form.side) {
        let (seen, sent) = (turn(side.sampler[1]), turn(side.lobe[1]));
        for j in 0..L {
            let both = side.sampler[0] * c[j] + seen * along[j];
            let (p_up, p_down) = opposite(side, both, p[j]);
            let (q_up, q_down) = opposite(side, both, q[j]);
            let flux = (p_up + p_down) + (q_up + q_down);
            to_c[j] += side.lobe[0] * flux;
            to_along[j] += sent * flux;
            to_p[j] += side.lobe[2] * (p_up - p_down);
            to_q[j] += side.lobe[2] * (q_up - q_down);
        }
    }
}

/// The fluxes through two side faces that lie opposite each other.
#[inline(always)]
fn opposite<T: Real>(side: &Face<T>, both: T, across: T) -> (T, T) {
    let part = side.sampler[2] * across;
    ((both + part).max(side.least), (both - part).max(side.least))
}
