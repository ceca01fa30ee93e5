//! What one half of a grid sends to the other, and a sweep: to the other half and back.

use std::ops::Range;

use multiversion::multiversion;

use super::chessboard::{Half, Shape, parity};
use super::lit_rows::LitRows;
use crate::transport::lattice::kernel::form::Share;
use crate::transport::lattice::kernel::row::{self, Beside, chunked, chunked_mut};
use crate::transport::team;

/// Cells computed at a time.
const LANES: usize = 16;
/// Numbers whose squares are summed in single precision, side by side.
const BLOCK: usize = 1024;
/// LitRows rows that are worth another thread's while.
const PARALLEL_FROM: usize = 500;

/// Sets the `lit` rows of half `h` to what the other half sends.
pub fn send(shape: Shape, share: &Share<f32>, h: usize, lit: &LitRows, other: &Half, to: &mut Half) {
    let piece = shape.n.div_ceil(pieces(lit));
    let run = |(i, to): (usize, &mut [f32])| {
        for (z, to) in (i * piece..).zip(to.chunks_mut(shape.slab())) {
            sent(shape, share, [h, z], lit.rows(z), other.around(shape, z), to);
        }
    };
    team::share(to.slabs_mut(shape).chunks_mut(piece * shape.slab()).enumerate().collect(), run);
}

/// One sweep from `x` to `next` on half 0:
///
/// ```text
/// rest = b + P·P·x − x        next = x + length·rest
/// ```
///
/// Returns the sum of the squares of `rest`. `lit` are the rows of half 1 that x reaches, those of half 0 that
/// they reach grow by one more; all others are left out.
pub fn sweep(shape: Shape, share: &Share<f32>, length: f32, lit: &LitRows, [b, x]: [&Half; 2], next: &mut Half) -> f64 {
    let reached = lit.grown();
    let piece = shape.n.div_ceil(pieces(&reached));
    let run = |(i, next): (usize, &mut [f32])| -> Vec<f64> {
        // What x sends to half 1, three slabs of it at a time: they stay in the cache.
        let mut moved = [(); 3].map(|()| vec![0.0; shape.slab()]);
        let send = |z: usize, moved: &mut [f32]| {
            if lit.rows(z).len() < shape.n {
                moved.fill(0.0);
            }
            sent(shape, share, [1, z], lit.rows(z), x.around(shape, z), moved);
        };
        let first = i * piece;
        if first > 0 {
            send(first - 1, &mut moved[1]);
        }
        send(first, &mut moved[2]);
        let slab = |(z, next): (usize, &mut [f32])| {
            moved.rotate_left(1);
            match z + 1 < shape.n {
                true => send(z + 1, &mut moved[2]),
                false => moved[2].fill(0.0),
            }
            let [below, here, above] = moved.each_ref().map(Vec::as_slice);
            sent(shape, share, [0, z], reached.rows(z), [below, here, above], next);
            finish(shape, length, reached.rows(z), [b.slab(shape, z), x.slab(shape, z)], next)
        };
        (first..).zip(next.chunks_mut(shape.slab())).map(slab).collect()
    };
    // A sum a slab, added in order: so many threads, the same sum.
    let pieces = next.slabs_mut(shape).chunks_mut(piece * shape.slab()).enumerate().collect();
    let sums: Vec<Vec<f64>> = team::share(pieces, run);
    sums.iter().flatten().sum()
}

/// In how many pieces the slabs are best cut.
fn pieces(lit: &LitRows) -> usize {
    if lit.count() < PARALLEL_FROM { 1 } else { rayon::current_num_threads() }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn sent(shape: Shape, share: &Share<f32>, [h, z]: [usize; 2], lit: Range<usize>, other: [&[f32]; 3], to: &mut [f32]) {
    match shape.width() {
        width if width.is_multiple_of(LANES) => rows::<LANES>(shape, share, [h, z], lit, other, to),
        width if width.is_multiple_of(4) => rows::<4>(shape, share, [h, z], lit, other, to),
        _ => rows::<1>(shape, share, [h, z], lit, other, to),
    }
}

/// Sets rows of slab z of half h to what comes in, `other` being the other half's slabs z − 1 to z + 1.
// No closure is handed to anything here: it would not be compiled for the instruction set.
#[inline(always)]
fn rows<const L: usize>(
    shape: Shape,
    share: &Share<f32>,
    [h, z]: [usize; 2],
    lit: Range<usize>,
    other: [&[f32]; 3],
    to: &mut [f32],
) {
    let (chunks, step, plane) = (shape.width() / L, shape.row(), shape.plane());
    let (to_c, to) = to.split_at_mut(plane);
    let (to_x, to) = to.split_at_mut(plane);
    let (to_y, to_z) = to.split_at_mut(plane);
    for y in lit {
        let (start, s) = (shape.start(y), parity(h, y, z));
        let near = Near { other, start, s, step, chunks };
        let (c, vx, vy, vz) =
            (near.beside::<L>(0), near.beside::<L>(plane), near.beside::<L>(2 * plane), near.beside::<L>(3 * plane));
        let (to_c, to_x) = (chunked_mut(&mut to_c[start..], chunks), chunked_mut(&mut to_x[start..], chunks));
        let (to_y, to_z) = (chunked_mut(&mut to_y[start..], chunks), chunked_mut(&mut to_z[start..], chunks));
        // A plane at a time: few neighbours at once, as in the kernel's own loops.
        for (k, to) in to_c.iter_mut().enumerate() {
            *to = row::mean::<f32, L>(share, c, [vx[0], vy[1], vz[2]], k);
        }
        for (k, to) in to_x.iter_mut().enumerate() {
            *to = row::direction::<f32, L>(share, c[0], vx[0], [vx[1], vx[2]], k);
        }
        for (k, to) in to_y.iter_mut().enumerate() {
            *to = row::direction::<f32, L>(share, c[1], vy[1], [vy[0], vy[2]], k);
        }
        for (k, to) in to_z.iter_mut().enumerate() {
            *to = row::direction::<f32, L>(share, c[2], vz[2], [vz[0], vz[1]], k);
        }
    }
}

/// What lies around one row, in slabs z − 1 to z + 1 of the other half.
#[derive(Clone, Copy)]
struct Near<'a> {
    other: [&'a [f32]; 3],
    start: usize,
    s: usize,
    /// From a row to the next.
    step: usize,
    chunks: usize,
}

impl<'a> Near<'a> {
    /// The neighbours before and behind along x, y and z, in the plane that begins at `plane`.
    #[inline(always)]
    fn beside<const L: usize>(self, plane: usize) -> [Beside<'a, f32, L>; 3] {
        let Near { other: [below, here, above], start, s, step, chunks } = self;
        let at = plane + start;
        [
            [chunked(&here[at + s - 1..], chunks), chunked(&here[at + s..], chunks)],
            [chunked(&here[at - step..], chunks), chunked(&here[at + step..], chunks)],
            [chunked(&below[at..], chunks), chunked(&above[at..], chunks)],
        ]
    }
}

/// Takes rows of a slab from what comes in to x + length · rest; the sum of the squares of the rest.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn finish(shape: Shape, length: f32, lit: Range<usize>, [b, x]: [&[f32]; 2], next: &mut [f32]) -> f64 {
    let mut squares = 0.0;
    for plane in 0..4 {
        let run = plane * shape.plane() + shape.start(lit.start)..plane * shape.plane() + shape.start(lit.end);
        let (b, x, next) = (&b[run.clone()], &x[run.clone()], &mut next[run]);
        for ((next, b), x) in next.chunks_mut(BLOCK).zip(b.chunks(BLOCK)).zip(x.chunks(BLOCK)) {
            let mut lanes = [0.0f32; LANES];
            let ((next, more), (b, more_b), (x, more_x)) =
                (next.as_chunks_mut::<LANES>(), b.as_chunks::<LANES>(), x.as_chunks::<LANES>());
            let (b, x) = (&b[..next.len()], &x[..next.len()]);
            for k in 0..next.len() {
                for j in 0..LANES {
                    let rest = (b[k][j] + next[k][j]) - x[k][j];
                    next[k][j] = x[k][j] + length * rest;
                    lanes[j] += rest * rest;
                }
            }
            for j in 0..more.len() {
                let rest = (more_b[j] + more[j]) - more_x[j];
                more[j] = more_x[j] + length * rest;
                lanes[j] += rest * rest;
            }
            squares += lanes.iter().copied().map(f64::from).sum::<f64>();
        }
    }
    squares
}
