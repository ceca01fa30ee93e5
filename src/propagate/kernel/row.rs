//! The innermost loops: a stretch of a row of cells from its six neighbours, in the linear and in the
//! clamped form of [`super::form`].
//!
//! Written over arrays of `L` numbers, so that the compiler makes vector code of them for whichever
//! instruction set the caller is compiled for. Products and sums are never fused, and every lane is a
//! cell of its own, so that all instruction sets give the same bits.

use super::form::{Face, Form, Share};
use super::settle_number;
use crate::sh::Real;

/// A stretch of a row in one plane of the source.
#[derive(Clone, Copy)]
pub(super) struct Stretch<'a, T> {
    /// The whole plane.
    pub(super) plane: &'a [T],
    /// Where the stretch begins.
    pub(super) at: usize,
    /// How many times L cells it is long.
    pub(super) chunks: usize,
}

/// The same stretch one step back and one step on along an axis.
type Beside<'a, T, const L: usize> = [&'a [[T; L]]; 2];

impl<'a, T> Stretch<'a, T> {
    #[inline(always)]
    fn beside<const L: usize>(self, step: usize) -> Beside<'a, T, L> {
        let Stretch { plane, at, chunks } = self;
        [chunked(&plane[at - step..], chunks), chunked(&plane[at + step..], chunks)]
    }
}

/// The first `chunks` · L numbers, by the chunk.
#[inline(always)]
pub(super) fn chunked<T, const L: usize>(numbers: &[T], chunks: usize) -> &[[T; L]] {
    &numbers[..chunks * L].as_chunks().0[..chunks]
}

/// [`chunked`], to write in.
#[inline(always)]
pub(super) fn chunked_mut<T, const L: usize>(numbers: &mut [T], chunks: usize) -> &mut [[T; L]] {
    &mut numbers[..chunks * L].as_chunks_mut().0[..chunks]
}

/// Where a stretch goes in one plane: into the target, and onto the sum if there is one.
pub(super) struct Out<'a, T, const L: usize> {
    pub(super) target: &'a mut [[T; L]],
    pub(super) sum: Option<&'a mut [[T; L]]>,
}

impl<T: Real, const L: usize> Out<'_, T, L> {
    #[inline(always)]
    fn put(&mut self, k: usize, floor: T, value: [T; L]) {
        let mut settled = value;
        for c in &mut settled {
            *c = settle_number(*c, floor);
        }
        self.target[k] = settled;
        if let Some(sum) = &mut self.sum {
            for (a, b) in sum[k].iter_mut().zip(settled) {
                *a += b;
            }
        }
    }
}

/// The linear form: every number of every neighbour once for each of the four planes it goes into.
/// `steps` are the distances to the neighbours along x, y and z.
#[inline(always)]
pub(super) fn linear<T: Real, const L: usize>(
    share: &Share<T>,
    floor: T,
    steps: [usize; 3],
    [c, x, y, z]: [Stretch<'_, T>; 4],
    out: [Out<'_, T, L>; 4],
) {
    let [dx, dy, dz] = steps;
    let [to_c, to_x, to_y, to_z] = out;
    let (c_x, c_y, c_z) = (c.beside(dx), c.beside(dy), c.beside(dz));
    let (x_x, x_y, x_z) = (x.beside(dx), x.beside(dy), x.beside(dz));
    let (y_x, y_y, y_z) = (y.beside(dx), y.beside(dy), y.beside(dz));
    let (z_x, z_y, z_z) = (z.beside(dx), z.beside(dy), z.beside(dz));
    linear_mean(share, floor, [c_x, c_y, c_z], [x_x, y_y, z_z], to_c);
    linear_direction(share, floor, c_x, x_x, [x_y, x_z], to_x);
    linear_direction(share, floor, c_y, y_y, [y_x, y_z], to_y);
    linear_direction(share, floor, c_z, z_z, [z_x, z_y], to_z);
}

#[inline(always)]
fn linear_mean<T: Real, const L: usize>(
    share: &Share<T>,
    floor: T,
    [cx, cy, cz]: [Beside<'_, T, L>; 3],
    [x, y, z]: [Beside<'_, T, L>; 3],
    mut out: Out<'_, T, L>,
) {
    for k in 0..out.target.len() {
        let mut value = [T::ZERO; L];
        for j in 0..L {
            let mean = (cx[0][k][j] + cx[1][k][j]) + (cy[0][k][j] + cy[1][k][j]) + (cz[0][k][j] + cz[1][k][j]);
            let inward = (x[0][k][j] - x[1][k][j]) + (y[0][k][j] - y[1][k][j]) + (z[0][k][j] - z[1][k][j]);
            value[j] = share.alpha * mean + share.beta * inward;
        }
        out.put(k, floor, value);
    }
}

#[inline(always)]
fn linear_direction<T: Real, const L: usize>(
    share: &Share<T>,
    floor: T,
    c: Beside<'_, T, L>,
    along: Beside<'_, T, L>,
    [p, q]: [Beside<'_, T, L>; 2],
    mut out: Out<'_, T, L>,
) {
    for k in 0..out.target.len() {
        let mut value = [T::ZERO; L];
        for j in 0..L {
            let fall = c[0][k][j] - c[1][k][j];
            let along = along[0][k][j] + along[1][k][j];
            let across = (p[0][k][j] + p[1][k][j]) + (q[0][k][j] + q[1][k][j]);
            value[j] = share.gamma * fall + share.delta * along + share.epsilon * across;
        }
        out.put(k, floor, value);
    }
}

/// The clamped form, face by face. `SIDES`: whether there are side faces.
#[inline(always)]
pub(super) fn clamped<T: Real, const L: usize, const SIDES: bool>(
    form: &Form<T>,
    floor: T,
    steps: [usize; 3],
    light: [Stretch<'_, T>; 4],
    out: [Out<'_, T, L>; 4],
) {
    let [dx, dy, dz] = steps;
    let [mut to_c, mut to_x, mut to_y, mut to_z] = out;
    let beside = |step: usize| light.map(|stretch| stretch.beside::<L>(step));
    let (x, y, z) = (beside(dx), beside(dy), beside(dz));
    for k in 0..to_c.target.len() {
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
