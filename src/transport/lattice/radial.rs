//! An index that knows how far injected light is, in place of which levels are lit (000, 2 and 7.1).
//!
//! The thesis samples the finest level that has received light, so the level changes wherever the light of a level ends,
//! and the merged light jumps there. Here the level follows from the distance d to the nearest injected cell, in finest
//! cells, and is a fraction:
//!
//! ```text
//! t = clamp(log₂(d/ρ), 0, l − 1)            S = Σ_i max(0, 1 − |t − i|)·O_i
//! ```
//!
//! ρ the reach of the finest level, l the number of levels: neighbouring levels are blended, so that there is no border
//! at which anything could jump. Where a level has no light yet the next one that has is taken: t is at least the index
//! of the thesis. Exact levels are sampled as what they hold inside ([`super::exact::sampling`]), other ones as they are.
//!
//! Injected light is shown where it is, on the finest level; coarser ones hold its mean, which is taken from them first.

use super::exact::sampling::{self, Neighbour};
use super::kernel::step::pieces;
use crate::field::{Cell, CellList, Grid, IndexVolume, Levels, Marks, Slabs, squared_distances};
use crate::scene::Problem;
use crate::sh::{Real, Sh};
use crate::transport::state::State;
use crate::transport::team;

/// The index of a problem.
#[derive(Clone, Debug)]
pub(super) struct Radial<T> {
    /// log₂(d/ρ) within the levels there are, for every finest cell, x fastest.
    levels: Vec<f32>,
    /// By channel and by level from 1 on the means of injected light that they hold.
    means: Vec<Vec<CellList<T>>>,
    /// Whether coarse cells are sampled as what they hold inside.
    inside: bool,
}

impl<T: Real> Radial<T> {
    /// For the injected cells of a problem; ρ is `reach`.
    pub(super) fn new(problem: &Problem, sizes: Levels, reach: f64) -> Self {
        let mut injected = Marks::new(sizes.finest());
        let cells = problem.sources.iter().flat_map(|source| &source.light);
        cells.filter(|(_, light)| !light.is_zero()).for_each(|(cell, _)| injected.set(*cell));
        let last = (sizes.count() - 1) as f32;
        let level = |squared: u32| (0.5 * f64::from(squared).log2() - reach.log2()) as f32;
        let levels = match squared_distances(&injected) {
            Some(squared) => squared.into_iter().map(|squared| level(squared).clamp(0.0, last)).collect(),
            None => vec![last; sizes.finest().pow(3)],
        };
        Radial { levels, means: Vec::new(), inside: problem.propagation.levels.is_exact() }
    }

    /// Takes note that everything is dark.
    pub(super) fn clear(&mut self) {
        self.means.clear();
    }

    /// Takes note of what coarser levels hold after a downsampling: means of injected light, if nothing has moved.
    pub(super) fn downsampled(&mut self, state: &State<T>) {
        self.means.clear();
        if state.iteration > 0 {
            return;
        }
        let levels = 1..state.sizes().count();
        for light in &state.lights {
            let of_level = |i: usize| state.index.level(i).light_in(light.accumulated.level(i)).collect();
            self.means.push(levels.clone().map(of_level).collect());
        }
    }

    /// t of a finest cell.
    pub(super) fn level(&self, index: &IndexVolume, cell: Cell) -> f32 {
        let n = index.sizes().finest();
        let [x, y, z] = cell;
        self.levels[(z * n + y) * n + x].max(index.index(cell) as f32)
    }

    /// Sets `merged` to the light of a channel.
    pub(super) fn sample(&self, state: &State<T>, channel: usize, merged: &mut Grid<T>) {
        let accumulated = &state.lights[channel].accumulated;
        let moved = |i: usize| {
            let mut level = accumulated.level(i).clone();
            let means = self.means.get(channel).and_then(|means| means.get(i - 1));
            means.into_iter().flatten().for_each(|(cell, light)| level.add(*cell, *light * T::of(-1.0)));
            level
        };
        let coarser: Vec<Grid<T>> = (1..state.sizes().count()).map(moved).collect();
        let n = merged.side();
        let pieces = pieces(rayon::current_num_threads(), n.pow(3)).min(n);
        let ends: Vec<usize> = (1..=pieces).map(|k| k * n / pieces).collect();
        team::share(merged.cut(&ends), |mut merged: Slabs<'_, T>| {
            let slabs = merged.range();
            let cells = slabs.clone().flat_map(|z| (0..n * n).map(move |i| [i % n, i / n, z]));
            let levels: Vec<f32> = cells.clone().map(|cell| self.level(&state.index, cell)).collect();
            for (cell, t) in cells.zip(&levels) {
                let finest = if *t < 1.0 { accumulated.level(0).get(cell) * T::of(share(*t, 0)) } else { Sh::ZERO };
                merged.set(cell, finest);
            }
            let share = |i: usize, [x, y, z]: Cell| share(levels[((z - slabs.start) * n + y) * n + x], i);
            for (i, level) in (1..).zip(&coarser) {
                let rows = slabs.start >> i..((slabs.end - 1) >> i) + 1;
                let side = level.side();
                for cell in rows.flat_map(|z| (0..side * side).map(move |k| [k % side, k / side, z])) {
                    self.add(level, (i, cell), |cell| share(i, cell), &mut merged);
                }
            }
        });
    }

    /// Adds the light of a cell of level `i` to those of its finest cells that lie in the slabs, each by its share.
    fn add(&self, level: &Grid<T>, (i, cell): (usize, Cell), share: impl Fn(Cell) -> f64, merged: &mut Slabs<'_, T>) {
        let light = level.get(cell);
        if light.is_zero() {
            return;
        }
        let width = 1usize << i;
        let slabs = merged.range();
        let [x, y, z] = cell.map(|c| c * width..(c + 1) * width);
        let z = z.start.max(slabs.start)..z.end.min(slabs.end);
        let inside = std::cell::OnceCell::new();
        for finest in z.flat_map(|z| y.clone().flat_map(move |y| [[y, z]])) {
            for x in x.clone() {
                let at = [x, finest[0], finest[1]];
                let share = share(at);
                if share > 0.0 {
                    let planes = inside.get_or_init(|| self.planes(level, (i, cell)));
                    let times: f64 = (0..3).map(|axis| planes[axis][at[axis] - cell[axis] * width]).product();
                    merged.add(at, light * T::of(share * times));
                }
            }
        }
    }

    /// What the mean of a cell is multiplied with at its planes, along each axis.
    fn planes(&self, level: &Grid<T>, (i, cell): (usize, Cell)) -> [Vec<f64>; 3] {
        let width = 1usize << i;
        let mean = |cell: Cell| level.get(cell).0[0].to_f64();
        [0, 1, 2].map(|axis| {
            let beside = |by: isize| {
                let mut next = cell;
                next[axis] = cell[axis].checked_add_signed(by).filter(|c| *c < level.side())?;
                Some(Neighbour { width: width as f64, mean: mean(next) })
            };
            let slope =
                if self.inside { sampling::slope(width as f64, mean(cell), [beside(-1), beside(1)]) } else { 0.0 };
            let mut planes = Vec::new();
            sampling::planes(slope, width, &mut planes);
            planes
        })
    }

    /// Bytes of memory that it holds.
    pub(super) fn bytes(&self) -> usize {
        let means: usize = self.means.iter().flatten().map(Vec::capacity).sum();
        size_of_val(self.levels.as_slice()) + means * size_of::<(Cell, Sh<T>)>()
    }
}

/// The share of level `i` in what is shown at t.
fn share(t: f32, i: usize) -> f64 {
    (1.0 - (f64::from(t) - i as f64).abs()).max(0.0)
}
