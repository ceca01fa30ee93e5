//! How far the levels of an octree are from what they ought to hold (000, 6.2 and 7; MATH.md section 5).
//!
//! Every metric compares an octree O with an expectation Ô, cell by cell, in the norm
//! ‖v‖∞ = max |v_j| over the four coefficients of all three colours:
//!
//! - absolute error ‖O − Ô‖∞, mean and maximum over cells;
//! - relative error ‖O − Ô‖∞ / ‖O‖∞; where O is dark and Ô is not it is undefined, so the cell is left
//!   out of the mean and counted; where both are dark it is 0;
//! - L1 ratio Σ‖O − Ô‖∞ / Σ‖Ô‖∞, which no dark cell can blow up.
//!
//! Means divide by the cells really summed. The thesis divides by (8^l − 8)/7, which is that number only
//! if the 1³ level does not exist, as in its GPU version.

use std::fmt;

use crate::field::{Cell, Grid, downsample_into, mean_of_children};
use crate::sh::{Real, Sh};
use crate::simulation::Simulation;

/// What an octree is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Metric {
    /// Every level with the mean of its children in the next finer level of the same octree (000, 6.2).
    /// It says how much the levels disagree, not which of them is right.
    Thesis,
    /// Every level from 1 on with a uniform volume that was propagated on its own at the finest size, and
    /// then downsampled (000, 7).
    Corrected,
    /// The merged light, S(x, y, z) for every finest cell, with that uniform volume (000, 6.2).
    Merged,
    /// The merged light that has moved, S_A − S_0, with the flux that truly enters each cell along straight
    /// lines (MATH.md section 6).
    Ballistic,
}

impl Metric {
    /// All metrics.
    pub const ALL: [Metric; 4] = [Metric::Thesis, Metric::Corrected, Metric::Merged, Metric::Ballistic];

    /// Its name in files and on screen.
    pub fn name(self) -> &'static str {
        match self {
            Metric::Thesis => "thesis",
            Metric::Corrected => "corrected",
            Metric::Merged => "merged",
            Metric::Ballistic => "ballistic",
        }
    }
}

impl fmt::Display for Metric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The error of one level, or of all together, after one iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorRow {
    /// Iterations done, k; 0 is the downsampled injection.
    pub iteration: usize,
    /// What it was compared with.
    pub metric: Metric,
    /// The level, or `None` for all levels together.
    pub level: Option<usize>,
    /// Mean of ‖O − Ô‖∞, in units of SH coefficients.
    pub absolute_mean: f64,
    /// Largest ‖O − Ô‖∞.
    pub absolute_max: f64,
    /// Mean of ‖O − Ô‖∞ / ‖O‖∞ over the cells where it is defined.
    pub relative_mean: f64,
    /// Largest ‖O − Ô‖∞ / ‖O‖∞ where it is defined.
    pub relative_max: f64,
    /// Σ‖O − Ô‖∞ / Σ‖Ô‖∞; 0 where all is dark, infinite where only the expectation is.
    pub l1_ratio: f64,
    /// Cells whose relative error is undefined: dark where light was expected.
    pub undefined: usize,
}

/// Sums over cells, from which an [`ErrorRow`] is made.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    cells: usize,
    undefined: usize,
    absolute: f64,
    absolute_max: f64,
    relative: f64,
    relative_max: f64,
    expected: f64,
}

impl Tally {
    /// Takes in one cell: ‖O − Ô‖∞, ‖O‖∞ and ‖Ô‖∞.
    #[inline]
    pub fn add(&mut self, difference: f64, found: f64, expected: f64) {
        self.cells += 1;
        self.absolute += difference;
        self.absolute_max = self.absolute_max.max(difference);
        self.expected += expected;
        if found > 0.0 {
            let relative = difference / found;
            self.relative += relative;
            self.relative_max = self.relative_max.max(relative);
        } else if difference > 0.0 {
            self.undefined += 1;
        }
    }

    /// Takes in all the cells of another tally.
    pub fn merge(&mut self, other: &Tally) {
        self.cells += other.cells;
        self.undefined += other.undefined;
        self.absolute += other.absolute;
        self.absolute_max = self.absolute_max.max(other.absolute_max);
        self.relative += other.relative;
        self.relative_max = self.relative_max.max(other.relative_max);
        self.expected += other.expected;
    }

    /// The row that says it.
    pub fn row(&self, iteration: usize, metric: Metric, level: Option<usize>) -> ErrorRow {
        let mean = |sum: f64, count: usize| if count == 0 { 0.0 } else { sum / count as f64 };
        ErrorRow {
            iteration,
            metric,
            level,
            absolute_mean: mean(self.absolute, self.cells),
            absolute_max: self.absolute_max,
            relative_mean: mean(self.relative, self.cells - self.undefined),
            relative_max: self.relative_max,
            l1_ratio: if self.absolute == 0.0 { 0.0 } else { self.absolute / self.expected },
            undefined: self.undefined,
        }
    }
}

/// The thesis's metric on the accumulated light, for all levels together first, then for each level from 1 on.
pub fn thesis<T: Real>(simulation: &Simulation<T>) -> Vec<ErrorRow> {
    let scales = channel_scales(simulation);
    let per_level: Vec<Tally> = (1..simulation.sizes().count())
        .map(|i| {
            let of = |level: usize| -> Vec<&Grid<T>> {
                simulation.lights().iter().map(|light| light.accumulated.level(level)).collect()
            };
            let (finer, coarser) = (of(i - 1), of(i));
            tally(&scales, coarser[0].side(), |channel, cell| {
                (coarser[channel].get(cell), mean_of_children(finer[channel], cell))
            })
        })
        .collect();
    rows(simulation.iteration(), Metric::Thesis, &per_level)
}

/// The corrected metric on the accumulated light, rows as in [`thesis`]. `uniform` holds each channel's light
/// in a uniform volume of the finest size, after the same iterations or after all
/// ([`super::reference`] has both).
pub fn corrected<T: Real>(simulation: &Simulation<T>, uniform: &[Grid<T>]) -> Vec<ErrorRow> {
    let scales = channel_scales(simulation);
    let mut expected: Vec<Grid<T>> = uniform.to_vec();
    let mut per_level = Vec::new();
    for i in 1..simulation.sizes().count() {
        let side = simulation.sizes().side(i);
        for grid in &mut expected {
            let mut coarser = Grid::new(side);
            downsample_into(grid, &mut coarser);
            *grid = coarser;
        }
        per_level.push(tally(&scales, side, |channel, cell| {
            (simulation.lights()[channel].accumulated.level(i).get(cell), expected[channel].get(cell))
        }));
    }
    rows(simulation.iteration(), Metric::Corrected, &per_level)
}

/// The merged metric: the sample of the accumulated octree at every finest cell, merged or not yet, against
/// a uniform volume as in [`corrected`].
pub fn merged<T: Real>(simulation: &Simulation<T>, uniform: &[Grid<T>]) -> ErrorRow {
    let sampled = sampled(simulation);
    let tally = tally(&channel_scales(simulation), simulation.sizes().finest(), |channel, cell| {
        (sampled[channel].get(cell), uniform[channel].get(cell))
    });
    tally.row(simulation.iteration(), Metric::Merged, None)
}

/// What merging would store now, for each channel.
pub(super) fn sampled<T: Real>(simulation: &Simulation<T>) -> Vec<Grid<T>> {
    let sample = |channel| {
        let mut grid = Grid::new(simulation.sizes().finest());
        simulation.sample(channel, &mut grid);
        grid
    };
    (0..simulation.lights().len()).map(sample).collect()
}

/// The largest multiple of each channel among the three colours: what a channel's norm counts with.
pub(super) fn channel_scales<T: Real>(simulation: &Simulation<T>) -> Vec<f64> {
    let channels = simulation.channels();
    let scale = |c| channels.rgb().iter().filter(|s| s.channel == c).map(|s| s.scale).fold(0.0, f64::max);
    (0..channels.count()).map(scale).collect()
}

/// Compares every cell of an n³ grid; `pair` gives what was found and what was expected in a channel.
pub(super) fn tally<T: Real>(scales: &[f64], n: usize, pair: impl Fn(usize, Cell) -> (Sh<T>, Sh<T>)) -> Tally {
    let mut tally = Tally::default();
    for cell in crate::field::Layout::new(n).cells() {
        let (mut difference, mut found, mut expected) = (0.0f64, 0.0f64, 0.0f64);
        for (channel, scale) in scales.iter().enumerate() {
            let (is, ought) = pair(channel, cell);
            difference = difference.max(scale * (is.widen() - ought.widen()).max_norm());
            found = found.max(scale * is.max_norm().to_f64());
            expected = expected.max(scale * ought.max_norm().to_f64());
        }
        tally.add(difference, found, expected);
    }
    tally
}

/// The row of all levels together, then one for each level, the first of `per_level` being level 1.
fn rows(iteration: usize, metric: Metric, per_level: &[Tally]) -> Vec<ErrorRow> {
    let mut all = Tally::default();
    per_level.iter().for_each(|level| all.merge(level));
    let each = per_level.iter().zip(1..).map(|(tally, i)| tally.row(iteration, metric, Some(i)));
    std::iter::once(all.row(iteration, metric, None)).chain(each).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Occlusion, Problem, Propagation, Source};
    use glam::DVec3;

    #[test]
    fn a_tally_counts_what_the_definitions_say() {
        let mut tally = Tally::default();
        tally.add(0.0, 0.0, 0.0); // dark, expected dark: error 0
        tally.add(0.3, 0.0, 0.3); // dark, expected light: undefined
        tally.add(0.5, 1.0, 1.5);
        tally.add(0.2, 0.1, 0.1);
        let row = tally.row(7, Metric::Thesis, Some(2));
        assert!((row.absolute_mean - 0.25).abs() < 1e-15);
        assert_eq!(row.absolute_max, 0.5);
        assert!((row.relative_mean - (0.0 + 0.5 + 2.0) / 3.0).abs() < 1e-15);
        assert_eq!(row.relative_max, 2.0);
        assert!((row.l1_ratio - 1.0 / 1.9).abs() < 1e-15);
        assert_eq!((row.undefined, row.iteration, row.level), (1, 7, Some(2)));
    }

    #[test]
    fn joined_tallies_are_one_tally() {
        let cells = [(0.0, 0.0, 0.0), (0.3, 0.0, 0.3), (0.5, 1.0, 1.5), (0.2, 0.1, 0.1)];
        let of = |cells: &[(f64, f64, f64)]| {
            let mut tally = Tally::default();
            cells.iter().for_each(|&(d, f, e)| tally.add(d, f, e));
            tally
        };
        let mut joined = of(&cells[..2]);
        joined.merge(&of(&cells[2..]));
        let row = |t: Tally| t.row(0, Metric::Thesis, None);
        assert_eq!(row(joined), row(of(&cells)));
    }

    #[test]
    fn a_uniform_volume_has_no_error_by_any_metric() {
        let source =
            Source { color: [1.0, 0.5, 0.0], light: vec![([3, 1, 2], Sh::lobe(DVec3::X))], ..Source::default() };
        let problem = Problem {
            size: 4,
            coarsest: 4,
            sources: vec![source],
            solids: Vec::new(),
            occlusion: Occlusion::default(),
            propagation: Propagation { iterations: 3, ..Propagation::default() },
            ..Problem::default()
        };
        let mut simulation = Simulation::<f32>::new(problem).unwrap();
        simulation.run(|_| true);
        let uniform = super::super::reference::uniform(&simulation);
        assert_eq!(corrected(&simulation, &uniform).len(), 1); // no level but the finest
        assert_eq!(merged(&simulation, &uniform).absolute_max, 0.0);
        let dark = vec![Grid::new(4)];
        assert_eq!(merged(&simulation, &dark).l1_ratio, f64::INFINITY);
    }
}
