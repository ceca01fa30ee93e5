//! The multigrid cycle: smoothing by halves, the rest on the next coarser level.

use multiversion::multiversion;
use rayon::prelude::*;

use super::halves::{Half, Shape, parity};
use crate::propagate::kernel::form::Share;

/// From this side on slabs are shared among threads.
const PARALLEL_FROM: usize = 32;
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
    /// b + P_i·a of half 0, once half 1 is relaxed.
    gathered: Half,
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
            gathered: half(),
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
        let [even, odd] = &mut self.a;
        gather(self.shape, &self.share, 0, &self.b[0], odd, even);
        gather(self.shape, &self.share, 1, &self.b[1], even, odd);
    }

    /// Gathers half 0 after half 1 was relaxed, whose own residual is then zero; the sum of the squares of
    /// b + P_i·a − a.
    fn residual(&mut self) -> f64 {
        gather(self.shape, &self.share, 0, &self.b[0], &self.a[1], &mut self.gathered);
        let pairs = self.gathered.slabs_mut(self.shape).iter().zip(&*self.a[0].slabs_mut(self.shape));
        pairs.map(|(g, a)| f64::from(g - a).powi(2)).sum()
    }

    /// Sets the coarser level's b to the mean of the residual in its cells' children, amplified by its own
    /// residence in place of this level's, and its a to nothing.
    fn restrict(&self, coarser: &mut Level) {
        let (fine, coarse) = (self.shape, coarser.shape);
        for z in 0..coarse.n {
            let children = [2 * z, 2 * z + 1].map(|z| (self.gathered.slab(fine, z), self.a[0].slab(fine, z)));
            for plane in 0..4 {
                let band = usize::from(plane > 0);
                let scale = 0.125 * coarser.residence[band] / self.residence[band];
                for y in 0..coarse.n {
                    for x in 0..coarse.n {
                        let mut sum = 0.0;
                        for (gathered, a) in children {
                            for y in [2 * y, 2 * y + 1] {
                                let at = plane * fine.plane() + fine.start(y) + x;
                                sum += gathered[at] - a[at];
                            }
                        }
                        let half = &mut coarser.b[(x + y + z) % 2];
                        let at = z * coarse.slab() + plane * coarse.plane() + coarse.start(y) + x / 2;
                        half.slabs_mut(coarse)[at] = scale * sum;
                    }
                }
            }
        }
        coarser.a.iter_mut().for_each(|half| half.numbers.fill(0.0));
    }

    /// Adds the coarser level's a, the same for all children of a cell.
    fn correct(&mut self, coarser: &Level) {
        let (fine, coarse) = (self.shape, coarser.shape);
        let mut row = vec![0.0; coarse.n];
        for z in 0..coarse.n {
            for plane in 0..4 {
                for y in 0..coarse.n {
                    let at = plane * coarse.plane() + coarse.start(y);
                    for (x, value) in row.iter_mut().enumerate() {
                        *value = coarser.a[(x + y + z) % 2].slab(coarse, z)[at + x / 2];
                    }
                    for half in &mut self.a {
                        let slabs = half.slabs_mut(fine);
                        for (z, y) in [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(dz, dy)| (2 * z + dz, 2 * y + dy)) {
                            let at = z * fine.slab() + plane * fine.plane() + fine.start(y);
                            slabs[at..][..row.len()].iter_mut().zip(&row).for_each(|(a, c)| *a += c);
                        }
                    }
                }
            }
        }
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

/// Sets half `h` to b + P_i·other.
fn gather(shape: Shape, share: &Share<f32>, h: usize, b: &Half, other: &Half, half: &mut Half) {
    let work = |(z, out): (usize, &mut [f32])| {
        slab(shape, share, [h, z], b.slab(shape, z), other.around(shape, z), out);
    };
    let slabs = half.slabs_mut(shape);
    if shape.n >= PARALLEL_FROM {
        slabs.par_chunks_mut(shape.slab()).enumerate().for_each(work);
    } else {
        slabs.chunks_mut(shape.slab()).enumerate().for_each(work);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn slab(shape: Shape, share: &Share<f32>, [h, z]: [usize; 2], b: &[f32], around: [&[f32]; 3], out: &mut [f32]) {
    let [below, here, above] = around;
    let (width, row) = (shape.width(), shape.row());
    for y in 0..shape.n {
        let (start, s) = (shape.start(y), parity(h, y, z));
        // The neighbours in each plane: before and behind along x, y and z.
        let beside = |plane: usize| {
            let at = plane * shape.plane() + start;
            let cut = |slab, at: usize| -> &[f32] { &<[f32]>::as_ref(slab)[at..][..width] };
            [
                [cut(here, at + s - 1), cut(here, at + s)],
                [cut(here, at - row), cut(here, at + row)],
                [cut(below, at), cut(above, at)],
            ]
        };
        let light = [0, 1, 2, 3].map(beside);
        for plane in 0..4 {
            let at = plane * shape.plane() + start;
            let (b, out) = (&b[at..][..width], &mut out[at..][..width]);
            match plane {
                0 => mean(share, light, b, out),
                _ => direction(share, light, plane - 1, b, out),
            }
        }
    }
}

/// The neighbours' light in one plane: along x, y and z, before and behind.
type Beside<'a> = [[&'a [f32]; 2]; 3];

#[inline(always)]
fn mean(share: &Share<f32>, [c, x, y, z]: [Beside<'_>; 4], b: &[f32], out: &mut [f32]) {
    let (along_x, along_y, along_z) = (x[0], y[1], z[2]);
    for j in 0..out.len() {
        let mean = (c[0][0][j] + c[0][1][j]) + (c[1][0][j] + c[1][1][j]) + (c[2][0][j] + c[2][1][j]);
        let inward =
            (along_x[0][j] - along_x[1][j]) + (along_y[0][j] - along_y[1][j]) + (along_z[0][j] - along_z[1][j]);
        out[j] = b[j] + (share.alpha * mean + share.beta * inward);
    }
}

#[inline(always)]
fn direction(share: &Share<f32>, light: [Beside<'_>; 4], axis: usize, b: &[f32], out: &mut [f32]) {
    let (c, v) = (light[0][axis], light[axis + 1]);
    let [along, p, q] = [v[axis], v[(axis + 1) % 3], v[(axis + 2) % 3]];
    for j in 0..out.len() {
        let fall = c[0][j] - c[1][j];
        let across = (p[0][j] + p[1][j]) + (q[0][j] + q[1][j]);
        out[j] = b[j] + (share.gamma * fall + share.delta * (along[0][j] + along[1][j]) + share.epsilon * across);
    }
}
