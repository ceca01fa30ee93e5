//! One iteration of [`Leaves`].
//!
//! The fixed point a = q + P·a is reached by corrections: what an iteration changes is the operator applied to what the
//! one before it changed. So grids that hold a correction, the next one and the sum serve here as they do in a uniform
//! volume, and where all leaves are finest cells the bits are the same.

use std::ops::Range;

use multiversion::multiversion;

use super::leaves::{Inner, Leaves, Run, Seam, Tier, Way};
use super::meeting::{Beyond, Meeting};
use super::touched::Touched;
use crate::field::{Cell, Grid, Layout, Octree, Slabs};
use crate::sh::{Real, Sh};
use crate::transport::lattice::kernel::form::Share;
use crate::transport::lattice::kernel::step::pieces;
use crate::transport::lattice::kernel::{FLOOR, settle, settle_number};
use crate::transport::team;

impl<T: Real> Leaves<T> {
    /// Sets every leaf of `target` to what the operator makes of `source`: P·a in step, (I − D)⁻¹·off·a ahead. In
    /// `target` only leaves are written.
    pub fn apply(&self, source: &Octree<T>, target: &mut Octree<T>) {
        for i in self.levels() {
            self.apply_level(i, |level| source.level(level), target.level_mut(i), None);
        }
    }

    /// [`Self::apply`], and adds the new light to `sum`.
    pub fn advance(&self, source: &Octree<T>, target: &mut Octree<T>, sum: &mut Octree<T>) {
        for i in self.levels() {
            self.apply_level(i, |level| source.level(level), target.level_mut(i), Some(sum.level_mut(i)));
        }
    }

    /// [`Self::apply`] for the leaves of level `i`; `source` gives the light of a level. The new light is added to `sum`.
    pub fn apply_level<'a>(
        &self,
        i: usize,
        source: impl Fn(usize) -> &'a Grid<T>,
        target: &mut Grid<T>,
        sum: Option<&mut Grid<T>>,
    ) {
        let tier = self.tier(i);
        if tier.count == 0 {
            return;
        }
        let here = source(i);
        let levels = self.levels();
        let finer = if i > levels.start { source(i - 1) } else { here };
        let coarser = if i + 1 < levels.end { source(i + 1) } else { here };
        let planes = |grid: &'a Grid<T>| grid.planes().each_ref().map(Vec::as_slice);
        let around = Around {
            here: planes(here),
            finer: planes(finer),
            coarser: planes(coarser),
            steps: here.layout().steps(),
            finer_steps: finer.layout().steps(),
        };
        let ends = tier.ends();
        let sums: Vec<Option<Slabs<'_, T>>> = match sum {
            Some(sum) => sum.cut(&ends).into_iter().map(Some).collect(),
            None => ends.iter().map(|_| None).collect(),
        };
        let parts = target.cut(&ends).into_iter().zip(sums);
        team::share(parts.collect(), |(mut target, mut sum): (Slabs<'_, T>, Option<Slabs<'_, T>>)| {
            let range = target.places();
            let mut to =
                To { begin: target.begin(), light: target.planes_mut(), sum: sum.as_mut().map(|sum| sum.planes_mut()) };
            inner_runs(&tier.inner, among(&tier.runs, |run| run.at, &range), &around, &mut to);
            let seams = among(&tier.seams, |seam| seam.at as usize, &range);
            match self.way() {
                Way::InStep => seams_in_step(seams, &tier.meetings, &around, &mut to),
                Way::Ahead => seams_ahead(seams, &tier.meetings, &around, &mut to),
            }
            let touched = among(&tier.touched, |touched| touched.at as usize, &range);
            touched.iter().for_each(|leaf| to.put(leaf.at as usize, around.touched(leaf)));
        });
    }

    /// Makes `light`, the means a, what `next` has for all leaves of level `i`, and `next` the change.
    pub fn exchange(&self, i: usize, next: &mut Grid<T>, light: &mut Grid<T>) {
        let tier = self.tier(i);
        let ends = tier.ends();
        let parts = next.cut(&ends).into_iter().zip(light.cut(&ends));
        team::share(parts.collect(), |(mut next, mut light): (Slabs<'_, T>, Slabs<'_, T>)| {
            let all = among(&tier.all, |run| run.at, &next.places());
            let begin = next.begin();
            for (next, light) in next.planes_mut().into_iter().zip(light.planes_mut()) {
                pairs(all, begin, next, light, |next, light| {
                    let new = *next;
                    *next = settle_number(new - *light, T::of(FLOOR));
                    *light = new;
                });
            }
        });
    }

    /// Adds to the leaves of level `i` what a source q amounts to: q in step, (I − D)⁻¹·q ahead. The source is given by
    /// cells in the order of memory; those that are no leaves are left out.
    pub fn add_source<'a>(&self, i: usize, source: impl IntoIterator<Item = &'a (Cell, Sh<T>)>, target: &mut Grid<T>) {
        let tier = self.tier(i);
        let layout = target.layout();
        let mut to = target.planes_mut();
        let mut seams = tier.seams.as_slice();
        for (cell, light) in source.into_iter().filter(|(cell, _)| tier.marks.get(*cell)) {
            let at = layout.index(*cell);
            while seams.first().is_some_and(|seam| (seam.at as usize) < at) {
                seams = &seams[1..];
            }
            let seam = seams.first().filter(|seam| seam.at as usize == at);
            let light = self.amount(tier, at as u32, seam, *light);
            to.iter_mut().zip(light.0).for_each(|(plane, c)| plane[at] += c);
        }
    }

    /// What a source in one leaf of level `i` amounts to there, as [`Self::add_source`] has it for all.
    pub fn amounts_to(&self, i: usize, cell: Cell, source: Sh<T>) -> Sh<T> {
        let tier = self.tier(i);
        let at = Layout::new(tier.marks.side()).index(cell) as u32;
        let seam = tier.seams.binary_search_by_key(&at, |seam| seam.at).ok();
        self.amount(tier, at, seam.map(|found| &tier.seams[found]), source)
    }

    /// What a source amounts to in a leaf at a place: one that is touched, at a seam, or an inner one.
    fn amount(&self, tier: &Tier<T>, at: u32, seam: Option<&Seam>, source: Sh<T>) -> Sh<T> {
        if let Ok(found) = tier.touched.binary_search_by_key(&at, |touched| touched.at) {
            return tier.touched[found].residence.times(source);
        }
        match (seam, self.way()) {
            (Some(_), Way::InStep) => source,
            (Some(seam), Way::Ahead) => tier.meetings[seam.meeting as usize].within.solve(source),
            (None, _) => {
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

    /// Makes the leaves of level `i` dark.
    pub fn clear_level(&self, i: usize, light: &mut Grid<T>) {
        for plane in light.planes_mut() {
            self.tier(i).all.iter().for_each(|run| run.of_mut(plane).fill(T::ZERO));
        }
    }
}

impl<T> Tier<T> {
    /// Where runs of slabs end that take about the same time, as many as threads go well with.
    fn ends(&self) -> Vec<usize> {
        let all = self.work.last().copied().unwrap_or_default();
        let pieces = pieces(rayon::current_num_threads(), all);
        let end = |k: usize| self.work.partition_point(|work| work * pieces < k * all) + 1;
        let mut ends: Vec<usize> = (1..pieces).map(end).chain([self.marks.side()]).collect();
        ends.dedup();
        ends
    }
}

/// Those of `items`, which are in the order of memory, that lie at these places.
fn among<'a, I>(items: &'a [I], at: impl Fn(&I) -> usize, places: &Range<usize>) -> &'a [I] {
    let first = items.partition_point(|item| at(item) < places.start);
    let end = items.partition_point(|item| at(item) < places.end);
    &items[first..end]
}

/// Does something with every pair of numbers of the runs, in parts of planes that begin at `begin`.
#[inline(always)]
fn pairs<T>(runs: &[Run], begin: usize, a: &mut [T], b: &mut [T], what: impl Fn(&mut T, &mut T)) {
    for run in runs {
        let range = run.at - begin..run.at - begin + run.length;
        a[range.clone()].iter_mut().zip(&mut b[range]).for_each(|(a, b)| what(a, b));
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

/// The light that leaves of a level look at, and the steps from cell to cell in planes of it.
struct Around<'a, T> {
    here: [&'a [T]; 4],
    finer: [&'a [T]; 4],
    coarser: [&'a [T]; 4],
    steps: [usize; 3],
    finer_steps: [usize; 3],
}

impl<T: Real> Around<'_, T> {
    /// What comes in at a seam.
    #[inline(always)]
    fn received(&self, seam: &Seam, meeting: &Meeting<T>) -> Sh<T> {
        let mut sum = Sh::ZERO;
        self.receive::<0>([0, 1], seam, meeting, &mut sum);
        self.receive::<1>([2, 3], seam, meeting, &mut sum);
        self.receive::<2>([4, 5], seam, meeting, &mut sum);
        sum
    }

    /// Adds what comes in through the two faces across an axis.
    #[inline(always)]
    fn receive<const AXIS: usize>(&self, faces: [usize; 2], seam: &Seam, meeting: &Meeting<T>, sum: &mut Sh<T>) {
        for face in faces {
            let Some(light) = self.beyond::<AXIS>(meeting.beyond[face], seam.sides[face]) else { continue };
            let Share { alpha, beta, gamma, delta, epsilon } = meeting.shares[face];
            let [c, along] = [light.0[0], light.0[1 + AXIS]];
            sum.0[0] += alpha * c + beta * along;
            sum.0[1 + AXIS] += gamma * c + delta * along;
            sum.0[1 + (AXIS + 1) % 3] += epsilon * light.0[1 + (AXIS + 1) % 3];
            sum.0[1 + (AXIS + 2) % 3] += epsilon * light.0[1 + (AXIS + 2) % 3];
        }
    }

    /// The light beyond a face across an axis, if any can be.
    #[inline(always)]
    fn beyond<const AXIS: usize>(&self, beyond: Beyond, at: u32) -> Option<Sh<T>> {
        let at = at as usize;
        Some(match beyond {
            Beyond::Dark => return None,
            Beyond::Same => at_place(self.here, at),
            Beyond::Coarser => at_place(self.coarser, at),
            Beyond::Finer => {
                let (u, v) = (self.finer_steps[(AXIS + 1) % 3], self.finer_steps[(AXIS + 2) % 3]);
                let there = |at| at_place(self.finer, at);
                (there(at) + there(at + u)) + (there(at + v) + there(at + u + v))
            }
        })
    }

    /// What is in a touched leaf an iteration later.
    fn touched(&self, leaf: &Touched<T>) -> Sh<T> {
        let mut sum = leaf.stays.times(at_place(self.here, leaf.at as usize));
        for (face, (beyond, at)) in leaf.beyond.into_iter().zip(leaf.sides).enumerate() {
            let light = match face / 2 {
                0 => self.beyond::<0>(beyond, at),
                1 => self.beyond::<1>(beyond, at),
                _ => self.beyond::<2>(beyond, at),
            };
            if let Some(light) = light {
                sum += leaf.shares[face].times(light);
            }
        }
        sum
    }
}

#[inline(always)]
fn at_place<T: Real>(planes: [&[T]; 4], at: usize) -> Sh<T> {
    let [c, x, y, z] = planes;
    Sh([c[at], x[at], y[at], z[at]])
}

/// Where the light of leaves goes: parts of the planes of a level that begin at `begin`.
struct To<'a, T> {
    begin: usize,
    light: [&'a mut [T]; 4],
    /// What the new light is added to, if anything.
    sum: Option<[&'a mut [T]; 4]>,
}

impl<T: Real> To<'_, T> {
    /// Stores the light of a leaf.
    #[inline(always)]
    fn put(&mut self, at: usize, light: Sh<T>) {
        let (light, at) = (settle(light).0, at - self.begin);
        self.light.iter_mut().zip(light).for_each(|(plane, c)| plane[at] = c);
        if let Some(sum) = &mut self.sum {
            sum.iter_mut().zip(light).for_each(|(plane, c)| plane[at] += c);
        }
    }

    /// Adds what was stored in a run to the sum.
    #[inline(always)]
    fn add_up(&mut self, Run { at, length }: Run) {
        let range = at - self.begin..at - self.begin + length;
        for (light, sum) in self.light.iter().zip(self.sum.iter_mut().flatten()) {
            sum[range.clone()].iter_mut().zip(&light[range.clone()]).for_each(|(sum, c)| *sum += *c);
        }
    }
}

#[inline(always)]
fn seams<T: Real>(
    seams: &[Seam],
    meetings: &[Meeting<T>],
    around: &Around<'_, T>,
    to: &mut To<'_, T>,
    stays: impl Fn(&Meeting<T>, Sh<T>, usize) -> Sh<T>,
) {
    for seam in seams {
        let meeting = &meetings[seam.meeting as usize];
        let at = seam.at as usize;
        to.put(at, stays(meeting, around.received(seam, meeting), at));
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn seams_in_step<T: Real>(of: &[Seam], meetings: &[Meeting<T>], around: &Around<'_, T>, to: &mut To<'_, T>) {
    let stays = |meeting: &Meeting<T>, received, at| received + meeting.within.apply(at_place(around.here, at));
    seams(of, meetings, around, to, stays);
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn seams_ahead<T: Real>(of: &[Seam], meetings: &[Meeting<T>], around: &Around<'_, T>, to: &mut To<'_, T>) {
    seams(of, meetings, around, to, |meeting, received, _| meeting.within.solve(received));
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn inner_runs<T: Real>(inner: &Inner<T>, runs: &[Run], around: &Around<'_, T>, to: &mut To<'_, T>) {
    let Inner { share, stay: [mean, direction], .. } = *inner;
    let Around { here: [c, x, y, z], steps: [dx, dy, dz], .. } = *around;
    for run in runs {
        let Run { at, length } = *run;
        let beside = |plane, step| beside(plane, at, step, length);
        let (cx, cy, cz) = (beside(c, dx), beside(c, dy), beside(c, dz));
        let own = |plane| cut(plane, at, length);
        let row = at - to.begin..at - to.begin + length;
        let [to_c, to_x, to_y, to_z] = &mut to.light;
        row_mean(
            &share,
            mean,
            own(c),
            [cx, cy, cz],
            [beside(x, dx), beside(y, dy), beside(z, dz)],
            &mut to_c[row.clone()],
        );
        let along = |axis, along, p, q, own, to| row_direction(&share, direction, own, [axis, along, p, q], to);
        along(cx, beside(x, dx), beside(x, dy), beside(x, dz), own(x), &mut to_x[row.clone()]);
        along(cy, beside(y, dy), beside(y, dx), beside(y, dz), own(y), &mut to_y[row.clone()]);
        along(cz, beside(z, dz), beside(z, dx), beside(z, dy), own(z), &mut to_z[row.clone()]);
        to.add_up(*run);
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
