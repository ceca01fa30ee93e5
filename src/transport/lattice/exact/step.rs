//! One iteration of [`Leaves`].
//!
//! The fixed point a = q + P·a is reached by corrections: what an iteration changes is the operator applied to what the
//! one before it changed. So grids that hold a correction, the next one and the sum serve here as they do in a uniform
//! volume, and where all leaves are finest cells the bits are the same.

use multiversion::multiversion;

use super::leaves::{Inner, Leaves, Run, Seam, Side, Way};
use crate::field::{Cell, Grid, Layout, Octree};
use crate::sh::{Real, Sh};
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::kernel::form::Share;
use crate::transport::lattice::kernel::{FLOOR, settle, settle_number};

impl<T: Real> Leaves<T> {
    /// Sets every leaf of `target` to what the operator makes of `source`: P·a in step, (I − D)⁻¹·off·a ahead. In
    /// `source` only leaves may be lit; in `target` only leaves are written.
    pub fn apply(&self, source: &Octree<T>, target: &mut Octree<T>) {
        for i in self.levels() {
            self.apply_level(i, |level| source.level(level), target.level_mut(i));
        }
    }

    /// [`Self::apply`] for the leaves of level `i`; `source` gives the light of a level.
    pub fn apply_level<'a>(&self, i: usize, source: impl Fn(usize) -> &'a Grid<T>, target: &mut Grid<T>) {
        let tier = self.tier(i);
        if tier.count == 0 {
            return;
        }
        let here = source(i);
        let planes = here.planes().each_ref().map(Vec::as_slice);
        inner_runs(&tier.inner, &tier.runs, here.layout().steps(), planes, target.planes_mut());
        let levels = self.levels();
        let finer = (i > levels.start).then(|| source(i - 1));
        let coarser = (i + 1 < levels.end).then(|| source(i + 1));
        let around = Around { here, finer: finer.unwrap_or(here), coarser: coarser.unwrap_or(here) };
        let mut planes = target.planes_mut();
        for seam in &tier.seams {
            let light = settle(self.seam(seam, &around));
            let at = seam.at as usize;
            planes.iter_mut().zip(light.0).for_each(|(plane, c)| plane[at] = c);
        }
    }

    fn seam(&self, seam: &Seam<T>, around: &Around<'_, T>) -> Sh<T> {
        let mut received = Sh::ZERO;
        for ((d, side), pass) in Direction::ALL.into_iter().zip(seam.sides).zip(seam.passes) {
            let light = match side {
                Side::Dark => continue,
                Side::Same(at) => around.here.at(at as usize),
                Side::Coarser(at) => around.coarser.at(at as usize),
                Side::Finer(at) => four(around.finer, at as usize, d.axis()),
            };
            received += send(self.share(), pass, d, light);
        }
        match self.way() {
            Way::InStep => received + seam.within.apply(around.here.at(seam.at as usize)),
            Way::Ahead => seam.within.solve(received),
        }
    }

    /// Adds to the leaves of level `i` what a source q amounts to: q in step, (I − D)⁻¹·q ahead.
    pub fn add_source(&self, i: usize, source: &Grid<T>, target: &mut Grid<T>) {
        let tier = self.tier(i);
        let [mean, direction] = tier.inner.residence;
        let (from, mut to) = (source.planes(), target.planes_mut());
        for run in &tier.runs {
            for (p, (from, to)) in from.iter().zip(&mut to).enumerate() {
                let residence = if p == 0 { mean } else { direction };
                let pairs = run.of_mut(to).iter_mut().zip(run.of(from));
                pairs.for_each(|(to, from)| *to += *from * residence);
            }
        }
        for seam in &tier.seams {
            let at = seam.at as usize;
            let light = match self.way() {
                Way::InStep => source.at(at),
                Way::Ahead => seam.within.solve(source.at(at)),
            };
            to.iter_mut().zip(light.0).for_each(|(plane, c)| plane[at] += c);
        }
    }

    /// What a source in one leaf of level `i` amounts to there, as [`Self::add_source`] has it for all.
    pub fn amounts_to(&self, i: usize, cell: Cell, source: Sh<T>) -> Sh<T> {
        let tier = self.tier(i);
        let at = Layout::new(tier.marks.side()).index(cell) as u32;
        match (tier.seams.binary_search_by_key(&at, |seam| seam.at), self.way()) {
            (Ok(_), Way::InStep) => source,
            (Ok(found), Way::Ahead) => tier.seams[found].within.solve(source),
            (Err(_), _) => {
                let ([mean, direction], Sh([c, x, y, z])) = (tier.inner.residence, source);
                Sh([c * mean, x * direction, y * direction, z * direction])
            }
        }
    }

    /// Copies the light of the leaves of level `i`.
    pub fn copy_level(&self, i: usize, from: &Grid<T>, to: &mut Grid<T>) {
        for (from, to) in from.planes().iter().zip(to.planes_mut()) {
            self.tier(i).all.iter().for_each(|run| run.of_mut(to).copy_from_slice(run.of(from)));
        }
    }

    /// The largest magnitude among the coefficients of all leaves.
    pub fn largest(&self, light: &Octree<T>) -> f64 {
        let of_plane = |plane: &[T], runs: &[Run]| {
            let of_run = |run: &Run| run.of(plane).iter().fold(T::ZERO, |most, c| c.abs().max(most));
            runs.iter().map(of_run).fold(T::ZERO, |most, c| c.max(most))
        };
        let of_level = |i: usize| {
            let planes = light.level(i).planes().iter();
            planes.map(|plane| of_plane(plane, &self.tier(i).all).to_f64()).fold(0.0, f64::max)
        };
        self.levels().map(of_level).fold(0.0, f64::max)
    }

    /// Copies the light of all leaves.
    pub fn copy(&self, from: &Octree<T>, to: &mut Octree<T>) {
        self.each(from, to, |to, from| *to = from);
    }

    /// Adds the light of all leaves.
    pub fn add(&self, from: &Octree<T>, to: &mut Octree<T>) {
        self.each(from, to, |to, from| *to += from);
    }

    /// Subtracts the light of all leaves.
    pub fn subtract(&self, from: &Octree<T>, to: &mut Octree<T>) {
        self.each(from, to, |to, from| *to += -from);
    }

    /// Makes all leaves dark.
    pub fn clear(&self, light: &mut Octree<T>) {
        for i in self.levels() {
            for plane in light.level_mut(i).planes_mut() {
                self.tier(i).all.iter().for_each(|run| run.of_mut(plane).fill(T::ZERO));
            }
        }
    }

    #[inline(always)]
    fn each(&self, from: &Octree<T>, to: &mut Octree<T>, what: impl Fn(&mut T, T) + Copy) {
        for i in self.levels() {
            for (from, to) in from.level(i).planes().iter().zip(to.level_mut(i).planes_mut()) {
                for run in &self.tier(i).all {
                    run.of_mut(to).iter_mut().zip(run.of(from)).for_each(|(to, from)| what(to, *from));
                }
            }
        }
    }
}

impl Run {
    fn of<T>(self, plane: &[T]) -> &[T] {
        &plane[self.at..self.at + self.length]
    }

    fn of_mut<T>(self, plane: &mut [T]) -> &mut [T] {
        &mut plane[self.at..self.at + self.length]
    }
}

/// The light that leaves of a level look at.
struct Around<'a, T> {
    here: &'a Grid<T>,
    finer: &'a Grid<T>,
    coarser: &'a Grid<T>,
}

/// The sum of the four cells that lie beside each other across `axis`, from the first on.
fn four<T: Real>(grid: &Grid<T>, at: usize, axis: usize) -> Sh<T> {
    let steps = grid.layout().steps();
    let (u, v) = (steps[(axis + 1) % 3], steps[(axis + 2) % 3]);
    (grid.at(at) + grid.at(at + u)) + (grid.at(at + v) + grid.at(at + u + v))
}

/// What comes in through the face in direction `d` from the light beyond it: `pass` are the multiples of the even and
/// of the odd numbers of the share.
#[inline]
fn send<T: Real>(share: &Share<T>, [even, odd]: [T; 2], d: Direction, light: Sh<T>) -> Sh<T> {
    let axis = d.axis() + 1;
    let Sh([c, v @ ..]) = light;
    let outward = if d.is_positive() { v[axis - 1] } else { -v[axis - 1] };
    let mut sent = light.0.map(|c| even * share.epsilon * c);
    sent[0] = even * share.alpha * c + odd * share.beta * outward;
    let along = odd * share.gamma * c + even * share.delta * outward;
    sent[axis] = if d.is_positive() { along } else { -along };
    Sh(sent)
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn inner_runs<T: Real>(
    inner: &Inner<T>,
    runs: &[Run],
    steps: [usize; 3],
    [c, x, y, z]: [&[T]; 4],
    [to_c, to_x, to_y, to_z]: [&mut [T]; 4],
) {
    let Inner { share, stay: [mean, direction], .. } = *inner;
    let [dx, dy, dz] = steps;
    for &Run { at, length } in runs {
        let beside = |plane, step| beside(plane, at, step, length);
        let (cx, cy, cz) = (beside(c, dx), beside(c, dy), beside(c, dz));
        let own = |plane| cut(plane, at, length);
        row_mean(
            &share,
            mean,
            own(c),
            [cx, cy, cz],
            [beside(x, dx), beside(y, dy), beside(z, dz)],
            &mut to_c[at..at + length],
        );
        let along = |axis, along, p, q, own, to| row_direction(&share, direction, own, [axis, along, p, q], to);
        along(cx, beside(x, dx), beside(x, dy), beside(x, dz), own(x), &mut to_x[at..at + length]);
        along(cy, beside(y, dy), beside(y, dx), beside(y, dz), own(y), &mut to_y[at..at + length]);
        along(cz, beside(z, dz), beside(z, dx), beside(z, dy), own(z), &mut to_z[at..at + length]);
    }
}

/// A stretch of a plane one step back and one step on.
type Beside<'a, T> = [&'a [T]; 2];

#[inline(always)]
fn beside<T>(plane: &[T], at: usize, step: usize, length: usize) -> Beside<'_, T> {
    [cut(plane, at - step, length), cut(plane, at + step, length)]
}

#[inline(always)]
fn cut<T>(plane: &[T], at: usize, length: usize) -> &[T] {
    &plane[at..at + length]
}

/// Both to one length, which frees the loops of tests.
#[inline(always)]
fn both<'a, T>([a, b]: Beside<'a, T>, n: usize) -> Beside<'a, T> {
    [&a[..n], &b[..n]]
}

#[inline(always)]
fn row_mean<T: Real>(
    share: &Share<T>,
    stay: T,
    own: &[T],
    [cx, cy, cz]: [Beside<'_, T>; 3],
    [x, y, z]: [Beside<'_, T>; 3],
    to: &mut [T],
) {
    let n = to.len();
    let (cx, cy, cz) = (both(cx, n), both(cy, n), both(cz, n));
    let (x, y, z, own) = (both(x, n), both(y, n), both(z, n), &own[..n]);
    for j in 0..n {
        let mean = (cx[0][j] + cx[1][j]) + (cy[0][j] + cy[1][j]) + (cz[0][j] + cz[1][j]);
        let inward = (x[0][j] - x[1][j]) + (y[0][j] - y[1][j]) + (z[0][j] - z[1][j]);
        to[j] = settle_number(share.alpha * mean + share.beta * inward + stay * own[j], T::of(FLOOR));
    }
}

#[inline(always)]
fn row_direction<T: Real>(share: &Share<T>, stay: T, own: &[T], [c, along, p, q]: [Beside<'_, T>; 4], to: &mut [T]) {
    let n = to.len();
    let (c, along, p, q, own) = (both(c, n), both(along, n), both(p, n), both(q, n), &own[..n]);
    for j in 0..n {
        let fall = c[0][j] - c[1][j];
        let along = along[0][j] + along[1][j];
        let across = (p[0][j] + p[1][j]) + (q[0][j] + q[1][j]);
        let value = share.gamma * fall + share.delta * along + share.epsilon * across;
        to[j] = settle_number(value + stay * own[j], T::of(FLOOR));
    }
}
