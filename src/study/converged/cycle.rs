//! The multigrid cycle: smoothing by halves, the rest on the next coarser level.

use multiversion::multiversion;
use rayon::prelude::*;

use super::halves::{Half, Shape, parity};
use crate::propagate::kernel::form::Share;

/// Into how many pieces a level's slabs are cut at most.
const PIECES: usize = 8;
/// From this side on slabs are shared among threads.
const PARALLEL_FROM: usize = 32;
/// Cells computed at a time.
const LANES: usize = 16;
/// Slabs of a coarser level that are worth a thread's while together.
const SLABS_A_PIECE: usize = 8;
/// Sweeps that stand for solving the coarsest level, which has few cells.
const COARSEST_SWEEPS: usize = 6;

/// One level of the octree as an equation a = b + P_i·a.
#[derive(Clone, Debug)]
pub struct Level {
    shape: Shape,
    share: Share<f32>,
    residence: [f32; 2],
    b: [Half; 2],
    a: [Half; 2],
    /// b + P_i·a − a of half 0, once half 1 is relaxed; its own is then zero.
    rest: Half,
}

impl Level {
    /// A level of side `n` ≥ 2, with its operator's five numbers and residence; dark.
    pub fn new(n: usize, share: Share<f32>, residence: [f64; 2]) -> Self {
        let shape = Shape { n };
        let half = || Half::new(shape);
        Level {
            shape,
            share,
            residence: residence.map(|r| r as f32),
            b: [half(), half()],
            a: [half(), half()],
            rest: half(),
        }
    }

    /// Sets b, and a to nothing.
    pub fn set(&mut self, b: [Half; 2]) {
        self.b = b;
        self.a.iter_mut().for_each(|half| half.numbers.fill(0.0));
    }

    /// a.
    pub fn solution(&self) -> &[Half; 2] {
        &self.a
    }

    /// One sweep: each half in turn takes the value that its equations give it.
    fn relax(&mut self) {
        let (shape, share) = (self.shape, &self.share);
        let [even, odd] = &mut self.a;
        each_slab(shape, even, |z, out| {
            gather(shape, share, [0, z], self.b[0].slab(shape, z), odd.around(shape, z), out)
        });
        each_slab(shape, odd, |z, out| {
            gather(shape, share, [1, z], self.b[1].slab(shape, z), even.around(shape, z), out)
        });
    }

    /// Finds what is left of half 0 after half 1 was relaxed; the sum of its squares.
    fn residual(&mut self) -> f64 {
        let (shape, share) = (self.shape, &self.share);
        let (b, [even, odd]) = (&self.b[0], &self.a);
        let squares = |(z, out): (usize, &mut [f32])| -> f64 {
            gather(shape, share, [0, z], b.slab(shape, z), odd.around(shape, z), out);
            subtract(shape, even.slab(shape, z), out)
        };
        // A sum a slab, added in order: so many threads, the same sum.
        let slabs = self.rest.slabs_mut(shape);
        let sums: Vec<f64> = if shape.n >= PARALLEL_FROM {
            slabs.par_chunks_mut(shape.slab()).enumerate().with_min_len(shape.n / PIECES).map(squares).collect()
        } else {
            slabs.chunks_mut(shape.slab()).enumerate().map(squares).collect()
        };
        sums.iter().sum()
    }

    /// Sets the coarser level's b to the mean of what is left in its cells' children, amplified by its own
    /// residence in place of this level's, and its a to nothing.
    fn restrict(&self, coarser: &mut Level) {
        let (fine, coarse) = (self.shape, coarser.shape);
        let scales = [0, 1].map(|band| 0.125 * coarser.residence[band] / self.residence[band]);
        let [even, odd] = &mut coarser.b;
        let work = |(z, (even, odd)): (usize, (&mut [f32], &mut [f32]))| {
            let mut sums = vec![0.0; coarse.n];
            for plane in 0..4 {
                for y in 0..coarse.n {
                    sums.fill(0.0);
                    for (z, y) in children(z, y) {
                        let at = plane * fine.plane() + fine.start(y);
                        let row = &self.rest.slab(fine, z)[at..][..coarse.n];
                        sums.iter_mut().zip(row).for_each(|(sum, rest)| *sum += rest);
                    }
                    let at = plane * coarse.plane() + coarse.start(y);
                    let scale = scales[usize::from(plane > 0)];
                    let [first, second] =
                        if (y + z) % 2 == 0 { [&mut *even, &mut *odd] } else { [&mut *odd, &mut *even] };
                    let rows = first[at..].iter_mut().zip(&mut second[at..]);
                    for ((first, second), pair) in rows.zip(sums.chunks_exact(2)) {
                        (*first, *second) = (scale * pair[0], scale * pair[1]);
                    }
                }
            }
        };
        let slab = coarse.slab();
        let pairs = even.slabs_mut(coarse).par_chunks_mut(slab).zip(odd.slabs_mut(coarse).par_chunks_mut(slab));
        pairs.enumerate().with_min_len(SLABS_A_PIECE).for_each(work);
        coarser.a.iter_mut().for_each(|half| half.numbers.fill(0.0));
    }

    /// Adds the coarser level's a, the same for all children of a cell.
    fn correct(&mut self, coarser: &Level) {
        let (fine, coarse) = (self.shape, coarser.shape);
        for half in &mut self.a {
            each_slab(fine, half, |z, out| {
                let from = [0, 1].map(|h| coarser.a[h].slab(coarse, z / 2));
                let mut row = vec![0.0; coarse.n];
                for plane in 0..4 {
                    for y in 0..coarse.n {
                        let at = plane * coarse.plane() + coarse.start(y);
                        let first = (y + z / 2) % 2;
                        let pairs = from[first][at..].iter().zip(&from[1 - first][at..]);
                        for (pair, (first, second)) in row.chunks_exact_mut(2).zip(pairs) {
                            (pair[0], pair[1]) = (*first, *second);
                        }
                        for y in [2 * y, 2 * y + 1] {
                            let at = plane * fine.plane() + fine.start(y);
                            out[at..].iter_mut().zip(&row).for_each(|(a, c)| *a += c);
                        }
                    }
                }
            });
        }
    }
}

/// The rows (z, y) of the children of a coarse row.
fn children(z: usize, y: usize) -> [(usize, usize); 4] {
    [(2 * z, 2 * y), (2 * z, 2 * y + 1), (2 * z + 1, 2 * y), (2 * z + 1, 2 * y + 1)]
}

/// Does some work on every slab of a half.
fn each_slab(shape: Shape, half: &mut Half, work: impl Fn(usize, &mut [f32]) + Sync) {
    let slabs = half.slabs_mut(shape);
    if shape.n >= PARALLEL_FROM {
        slabs.par_chunks_mut(shape.slab()).enumerate().with_min_len(shape.n / PIECES).for_each(|(z, out)| work(z, out));
    } else {
        slabs.chunks_mut(shape.slab()).enumerate().for_each(|(z, out)| work(z, out));
    }
}

/// One V-cycle on `levels`, the finest first: a sweep, the rest of the error on the coarser levels, a sweep.
/// Returns the sum of the squares of the finest level's residual after its first sweep; if it is at most
/// `enough`, that sweep was all.
pub fn cycle(levels: &mut [Level], enough: f64) -> f64 {
    let Some((level, coarser)) = levels.split_first_mut() else {
        return 0.0;
    };
    level.relax();
    let Some(next) = coarser.first_mut() else {
        (1..COARSEST_SWEEPS).for_each(|_| level.relax());
        return level.residual();
    };
    let residual = level.residual();
    if residual > enough {
        level.restrict(next);
        cycle(coarser, 0.0);
        level.correct(&coarser[0]);
        level.relax();
    }
    residual
}

/// Takes a off what was gathered in a slab; the sum of the squares of what is left.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn subtract(shape: Shape, a: &[f32], rest: &mut [f32]) -> f64 {
    let mut squares = 0.0;
    for (rest, a) in rest.chunks_mut(shape.row()).zip(a.chunks(shape.row())) {
        let mut lanes = [0.0f32; LANES];
        for (rest, a) in rest.chunks_mut(LANES).zip(a.chunks(LANES)) {
            for ((rest, a), lane) in rest.iter_mut().zip(a).zip(&mut lanes) {
                *rest -= a;
                *lane += *rest * *rest;
            }
        }
        squares += lanes.iter().copied().map(f64::from).sum::<f64>();
    }
    squares
}

/// Sets slab z of half h to b + P_i·other, `around` being the other half's slabs z − 1 to z + 1.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn gather(shape: Shape, share: &Share<f32>, [h, z]: [usize; 2], b: &[f32], around: [&[f32]; 3], out: &mut [f32]) {
    if shape.width().is_multiple_of(LANES) {
        rows::<LANES>(shape, share, [h, z], b, around, out);
    } else {
        rows::<1>(shape, share, [h, z], b, around, out);
    }
}

#[inline(always)]
fn rows<const L: usize>(
    shape: Shape,
    share: &Share<f32>,
    [h, z]: [usize; 2],
    b: &[f32],
    [below, here, above]: [&[f32]; 3],
    out: &mut [f32],
) {
    let Share { alpha, beta, gamma, delta, epsilon } = *share;
    let (chunks, row) = (shape.width() / L, shape.row());
    for y in 0..shape.n {
        let (start, s) = (shape.start(y), parity(h, y, z));
        // The neighbours' light in each plane: before and behind along x, y and z.
        let beside = |plane: usize| -> [[&[[f32; L]]; 2]; 3] {
            let at = plane * shape.plane() + start;
            [
                [chunked(&here[at + s - 1..], chunks), chunked(&here[at + s..], chunks)],
                [chunked(&here[at - row..], chunks), chunked(&here[at + row..], chunks)],
                [chunked(&below[at..], chunks), chunked(&above[at..], chunks)],
            ]
        };
        let light = [0, 1, 2, 3].map(beside);
        let b = [0, 1, 2, 3].map(|plane| chunked::<L>(&b[plane * shape.plane() + start..], chunks));
        for k in 0..chunks {
            let mut gathered = [[0.0; L]; 4];
            for j in 0..L {
                let pair = |plane: usize, axis: usize| light[plane][axis][0][k][j] + light[plane][axis][1][k][j];
                let fall = |plane: usize, axis: usize| light[plane][axis][0][k][j] - light[plane][axis][1][k][j];
                let mean = pair(0, 0) + pair(0, 1) + pair(0, 2);
                let inward = fall(1, 0) + fall(2, 1) + fall(3, 2);
                gathered[0][j] = b[0][k][j] + (alpha * mean + beta * inward);
                for axis in 0..3 {
                    let across = pair(1 + axis, (axis + 1) % 3) + pair(1 + axis, (axis + 2) % 3);
                    let sent = gamma * fall(0, axis) + delta * pair(1 + axis, axis) + epsilon * across;
                    gathered[1 + axis][j] = b[1 + axis][k][j] + sent;
                }
            }
            for (plane, gathered) in gathered.iter().enumerate() {
                out[plane * shape.plane() + start + k * L..][..L].copy_from_slice(gathered);
            }
        }
    }
}

/// The first `chunks` · L numbers, by the chunk.
#[inline(always)]
fn chunked<const L: usize>(numbers: &[f32], chunks: usize) -> &[[f32; L]] {
    &numbers[..chunks * L].as_chunks().0[..chunks]
}
