//! The light of one state beside what it ought to be: cell by cell, as rows, and after the best scalar.

use super::error::{CellError, ErrorRow, Tally, Traced};
use super::truths::{PictureTruth, SurfaceTruth};
use super::{Expectation, References};
use crate::field::{Cell, Grid, Layout, downsample_into, mean_of_children};
use crate::render::image::Image;
use crate::render::rgb::Rgb;
use crate::render::seen::Seen;
use crate::scene::propagation::descent::Descent;
use crate::sh::{Real, Sh};
use crate::simulation::Simulation;
use crate::study::fit::{BestFit, l1};
use crate::study::picture::Difference;
use crate::study::surface::{self, Surfaces};
use crate::study::{light, reference};

/// A state under one expectation.
#[derive(Debug)]
pub struct Held<'a, T> {
    expectation: Expectation,
    state: &'a Simulation<T>,
    /// How much each channel's norm counts: its largest multiple among the three colours.
    scales: Vec<f64>,
    /// The uniform volume of each channel, where the state's finest level is not that volume.
    uniform: Option<Vec<Grid<T>>>,
    compared: Compared<'a, T>,
}

/// What is compared; grids are of the finest size, one a channel.
#[derive(Debug)]
enum Compared<'a, T> {
    /// Levels with their children.
    Children,
    /// Levels with the finest one.
    Levels,
    /// What merging would store now, with the finest level.
    Merged(Vec<Grid<T>>),
    /// The merged light, for what truly arrives without what was injected, with grids that were had before.
    Given(Vec<Grid<T>>, &'a [Grid<f32>]),
    /// What the patches of a mesh's surface receive, with what truly reaches them.
    Surface(Vec<Rgb>, &'a SurfaceTruth),
    /// What a camera sees, with the true picture.
    Picture(Seen, &'a PictureTruth),
}

impl<'a, T: Real> Held<'a, T> {
    pub(super) fn new(expectation: Expectation, state: &'a Simulation<T>, references: &'a References) -> Option<Self> {
        let compared = match expectation {
            Expectation::Thesis => Compared::Children,
            Expectation::Corrected => Compared::Levels,
            Expectation::Merged => Compared::Merged(light::sampled(state)),
            Expectation::Ballistic => Compared::Given(light::moved(state), references.ballistic.as_deref()?.light()),
            Expectation::Run => Compared::Given(light::sampled(state), references.run.as_deref()?),
            Expectation::Surface => {
                let truth = references.surface.as_deref()?;
                Compared::Surface(truth.found(state), truth)
            }
            Expectation::Picture => {
                let truth = references.picture.as_deref()?;
                Compared::Picture(truth.seen(state)?, truth)
            }
        };
        // The finest level of a descent has been started by coarser ones.
        let descends = state.problem().propagation.descent != Descent::Off;
        let against_uniform = matches!(expectation, Expectation::Corrected | Expectation::Merged);
        let uniform = if descends && against_uniform { Some(reference::uniform(state)?) } else { None };
        Some(Held { expectation, state, scales: light::channel_scales(state.channels()), uniform, compared })
    }

    /// The uniform volume.
    fn uniform(&self, channel: usize) -> &Grid<T> {
        let found = self.uniform.as_ref().and_then(|uniform| uniform.get(channel));
        found.unwrap_or(self.state.lights()[channel].accumulated.level(0))
    }

    /// The errors: of all levels together first, then, where levels are told apart, of each from 1 on.
    pub fn rows(&self) -> Vec<ErrorRow> {
        let levels = 1..self.state.sizes().count();
        match &self.compared {
            Compared::Children => {
                let tallies = levels.map(|level| {
                    self.tally(self.state.sizes().side(level), |channel, cell| {
                        let octree = &self.state.lights()[channel].accumulated;
                        (octree.level(level).get(cell), mean_of_children(octree.level(level - 1), cell))
                    })
                });
                self.of_levels(&tallies.collect::<Vec<_>>())
            }
            Compared::Levels => {
                let lights = self.state.lights();
                let mut expected: Vec<Grid<T>> = Vec::new();
                let tallies = levels.map(|level| {
                    let side = self.state.sizes().side(level);
                    let finer = |channel: usize| expected.get(channel).unwrap_or(self.uniform(channel));
                    let coarser = (0..lights.len()).map(|channel| {
                        let mut coarser = Grid::new(side);
                        downsample_into(finer(channel), &mut coarser);
                        coarser
                    });
                    expected = coarser.collect();
                    self.tally(side, |channel, cell| {
                        (lights[channel].accumulated.level(level).get(cell), expected[channel].get(cell))
                    })
                });
                self.of_levels(&tallies.collect::<Vec<_>>())
            }
            Compared::Merged(merged) => {
                let tally = self.tally(self.state.sizes().finest(), |channel, cell| {
                    (merged[channel].get(cell), self.uniform(channel).get(cell))
                });
                vec![self.row(&tally, None)]
            }
            Compared::Given(light, given) => {
                let tally = self.tally(self.state.sizes().finest(), |channel, cell| {
                    (light[channel].get(cell), given[channel].get(cell).cast())
                });
                let l1_best_fit = self.best_fit().map(|fit| fit.fitted);
                vec![ErrorRow { l1_best_fit, ..self.row(&tally, None) }]
            }
            Compared::Surface(found, truth) => vec![self.surface_row(found, truth)],
            Compared::Picture(seen, truth) => vec![self.picture_row(seen, truth)],
        }
    }

    /// The error of the irradiance [W/m²] of surfaces, each patch by its area.
    fn surface_row(&self, found: &[Rgb], truth: &SurfaceTruth) -> ErrorRow {
        let mut tally = Tally::default();
        for (i, (patch, found)) in truth.patches().all().iter().zip(found).enumerate() {
            let expected = truth.lit().indirect(i);
            tally.add_weighed(patch.area, norm(|c| found[c] - expected[c]), norm(|c| found[c]), norm(|c| expected[c]));
        }
        let surfaces = surface::compare(truth.patches(), found, truth.lit());
        ErrorRow {
            l1_ratio: surfaces.l1,
            l1_best_fit: Some(surfaces.l1_fitted),
            traced: Some(Traced {
                mean_ratio: surfaces.mean_ratio,
                correlation: Some(surfaces.correlation),
                picture: None,
                noise: surfaces.noise,
            }),
            ..self.row(&tally, None)
        }
    }

    /// The error of the radiance [W/(m²·sr)] of pixels.
    fn picture_row(&self, seen: &Seen, truth: &PictureTruth) -> ErrorRow {
        let compared = truth.compare(seen);
        let tally = pixels(&truth.image(), &seen.total());
        let fitted = pixels(&truth.image(), &seen.scaled(compared.scale));
        let Difference { rmse, rel_mse, flip, mean_ratio } = compared.raw;
        ErrorRow {
            l1_best_fit: Some(self.row(&fitted, None).l1_ratio),
            traced: Some(Traced {
                mean_ratio,
                correlation: None,
                picture: Some([rmse, rel_mse, flip]),
                noise: truth.noise(),
            }),
            ..self.row(&tally, None)
        }
    }

    /// The L1 error as it is and after the scalar that fits best; `None` where levels are told apart.
    pub fn best_fit(&self) -> Option<BestFit> {
        match &self.compared {
            Compared::Children | Compared::Levels => None,
            Compared::Merged(merged) => {
                let uniform: Vec<&Grid<T>> = (0..merged.len()).map(|channel| self.uniform(channel)).collect();
                Some(l1(&self.scales, merged, &uniform))
            }
            Compared::Given(light, given) => Some(l1(&self.scales, light, given)),
            Compared::Surface(found, truth) => {
                let Surfaces { l1, l1_fitted, scale, .. } = surface::compare(truth.patches(), found, truth.lit());
                Some(BestFit { raw: l1, fitted: l1_fitted, scale })
            }
            Compared::Picture(seen, truth) => {
                let scale = truth.compare(seen).scale;
                let row = self.picture_row(seen, truth);
                Some(BestFit { raw: row.l1_ratio, fitted: row.l1_best_fit?, scale })
            }
        }
    }

    /// The error of a cell of a level, in red, green and blue together; `None` where nothing is expected there: on
    /// level 0 where levels are told apart, outside the octree, and where what is held is no light of cells. What has no levels is held by the mean over a
    /// coarse cell.
    pub fn cell(&self, level: usize, cell: Cell) -> Option<CellError> {
        let known = if self.expectation.has_levels() { 1 } else { 0 };
        if !(known..self.state.sizes().count()).contains(&level) || self.expectation.needs_mesh() {
            return None;
        }
        let (mut difference, mut found) = (0.0f64, 0.0f64);
        for (channel, scale) in self.scales.iter().enumerate() {
            let [is, ought] = self.pair(channel, level, cell);
            difference = difference.max(scale * (is - ought).max_norm());
            found = found.max(scale * is.max_norm());
        }
        Some(CellError::new(difference, found))
    }

    /// What a channel of a cell holds, and what it ought to.
    fn pair(&self, channel: usize, level: usize, cell: Cell) -> [Sh<f64>; 2] {
        let octree = &self.state.lights()[channel].accumulated;
        match &self.compared {
            Compared::Children => {
                [octree.level(level).get(cell).widen(), mean_of_children(octree.level(level - 1), cell).widen()]
            }
            Compared::Levels => {
                [octree.level(level).get(cell).widen(), mean_within(self.uniform(channel), level, cell)]
            }
            Compared::Merged(merged) => {
                [mean_within(&merged[channel], level, cell), mean_within(self.uniform(channel), level, cell)]
            }
            Compared::Given(light, given) => {
                [mean_within(&light[channel], level, cell), mean_within(&given[channel], level, cell)]
            }
            Compared::Surface(..) | Compared::Picture(..) => [Sh::ZERO; 2],
        }
    }

    /// Compares every cell of an n³ grid; `pair` gives what a channel holds and what it ought to.
    fn tally(&self, n: usize, pair: impl Fn(usize, Cell) -> (Sh<T>, Sh<T>)) -> Tally {
        let mut tally = Tally::default();
        for cell in Layout::new(n).cells() {
            let (mut difference, mut found, mut expected) = (0.0f64, 0.0f64, 0.0f64);
            for (channel, scale) in self.scales.iter().enumerate() {
                let (is, ought) = pair(channel, cell);
                difference = difference.max(scale * (is.widen() - ought.widen()).max_norm());
                found = found.max(scale * is.max_norm().to_f64());
                expected = expected.max(scale * ought.max_norm().to_f64());
            }
            tally.add(difference, found, expected);
        }
        tally
    }

    /// The row of all levels together, then one for each, the first of `per_level` being level 1.
    fn of_levels(&self, per_level: &[Tally]) -> Vec<ErrorRow> {
        let mut all = Tally::default();
        per_level.iter().for_each(|level| all.merge(level));
        let each = per_level.iter().zip(1..).map(|(tally, level)| self.row(tally, Some(level)));
        std::iter::once(self.row(&all, None)).chain(each).collect()
    }

    fn row(&self, tally: &Tally, level: Option<usize>) -> ErrorRow {
        tally.row(self.state.iteration(), self.expectation, level)
    }
}

/// The largest of three colours.
fn norm(of: impl Fn(usize) -> f64) -> f64 {
    (0..3).map(|c| of(c).abs()).fold(0.0, f64::max)
}

/// Two pictures pixel by pixel.
fn pixels(truth: &Image, found: &Image) -> Tally {
    let mut tally = Tally::default();
    for (truth, found) in truth.pixels().iter().zip(found.pixels()) {
        let (truth, found) = (truth.map(f64::from), found.map(f64::from));
        tally.add(norm(|c| found[c] - truth[c]), norm(|c| found[c]), norm(|c| truth[c]));
    }
    tally
}

/// The mean of all finest cells within a cell of `level`.
fn mean_within<T: Real>(finest: &Grid<T>, level: usize, cell: Cell) -> Sh<f64> {
    let span = 1 << level;
    let [x0, y0, z0] = cell.map(|c| c * span);
    let inside = Layout::new(span).cells().map(|[x, y, z]| finest.get([x0 + x, y0 + y, z0 + z]).widen());
    let sum: Sh<f64> = inside.sum();
    sum * (span as f64).powi(-3)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::scene::{Occlusion, Problem, Propagation, Source};
    use crate::simulation::Action;

    fn run(coarsest: usize) -> Simulation<f32> {
        let source =
            Source { color: [1.0, 0.5, 0.0], light: vec![([3, 1, 2], Sh::lobe(DVec3::X))], ..Source::default() };
        let problem = Problem {
            size: 8,
            coarsest,
            sources: vec![source],
            solids: Vec::new(),
            occlusion: Occlusion::default(),
            propagation: Propagation { iterations: 3, ..Propagation::default() },
            ..Problem::default()
        };
        let mut simulation = Simulation::new(problem).unwrap();
        simulation.run(|_| true);
        simulation
    }

    /// Every expectation, ready for a state.
    fn each(state: &Simulation<f32>) -> Vec<(Expectation, References)> {
        let ready = |expectation: Expectation| {
            // The other run is dark.
            let run = light::sampled(state).iter().map(|grid| Grid::new(grid.side())).collect();
            let mut references = References { run: Some(run), ..References::default() };
            expectation.prepare(state.problem(), &mut references, &|_| true);
            assert!(expectation.is_ready(&references));
            (expectation, references)
        };
        Expectation::ALL.into_iter().filter(|one| !one.needs_mesh()).map(ready).collect()
    }

    #[test]
    fn a_uniform_volume_has_no_error_where_it_is_what_is_expected() {
        let state = run(8);
        for (expectation, references) in each(&state) {
            let rows = expectation.of(&state, &references).unwrap().rows();
            assert_eq!(rows.len(), 1, "{expectation}: no level but the finest");
            let differs = matches!(expectation, Expectation::Ballistic | Expectation::Run);
            assert_eq!(rows[0].absolute_max == 0.0, !differs, "{expectation}");
        }
    }

    #[test]
    fn the_largest_error_of_a_row_is_the_largest_of_its_cells() {
        let state = run(1);
        for (expectation, references) in each(&state) {
            let held = expectation.of(&state, &references).unwrap();
            let rows = held.rows();
            assert_eq!(rows.len(), if expectation.has_levels() { 4 } else { 1 }, "{expectation}");
            for row in rows.iter().filter(|row| row.level.is_some() != (rows.len() == 1)) {
                let level = row.level.unwrap_or(0);
                let cells = Layout::new(8 >> level).cells().filter_map(|cell| held.cell(level, cell));
                let largest = cells.map(|error| error.absolute).fold(0.0, f64::max);
                assert!((largest - row.absolute_max).abs() < 1e-6 && largest > 0.0, "{expectation}, level {level}");
            }
            assert_eq!(held.cell(0, [3, 1, 2]).is_none(), expectation.has_levels());
            assert_eq!(held.cell(4, [0; 3]), None);
            assert_eq!(held.best_fit().is_none(), expectation.has_levels());
            assert_eq!(rows[0].l1_best_fit.is_some(), expectation.is_scaled_by_taste());
        }
    }

    #[test]
    fn what_is_not_computed_yet_is_not_held_against_anything() {
        let (state, references) = (run(1), References::default());
        for expectation in [Expectation::Ballistic, Expectation::Run] {
            assert!(!expectation.is_ready(&references));
            assert!(expectation.of(&state, &references).is_none());
        }
    }

    #[test]
    fn a_run_is_no_way_off_itself_and_as_far_off_its_multiple_as_that_says() {
        let state = run(1);
        let held = |factor: f32| {
            let mut run = light::sampled(&state);
            run.iter_mut().for_each(|grid| grid.scale(factor));
            let references = References { run: Some(run.into()), ..References::default() };
            Expectation::Run.rows(&state, &references)[0]
        };
        assert_eq!((held(1.0).l1_ratio, held(1.0).l1_best_fit), (0.0, Some(0.0)));
        // Powers of two are exact: |O − 2 O| / |2 O| is a half, and one scalar takes it all away.
        assert_eq!(held(2.0).l1_ratio, 0.5);
        assert!(held(2.0).l1_best_fit < Some(1e-6));
    }

    #[test]
    fn where_nothing_has_moved_all_that_should_have_is_missing() {
        let mut references = References::default();
        let mut state = run(1);
        Expectation::Ballistic.prepare(state.problem(), &mut references, &|_| true);
        state.act(Action::Clear);
        state.act(Action::Inject);
        let row = Expectation::Ballistic.rows(&state, &references)[0];
        assert_eq!((row.l1_ratio, row.l1_best_fit, row.relative_max), (1.0, Some(1.0), 0.0));
        let truth = references.ballistic.unwrap();
        let lit = truth.light()[0].iter().filter(|(_, light)| !light.is_zero()).count();
        assert_eq!(row.undefined, lit);
    }
}
