//! What truly arrives: light that travels in straight lines (MATH.md section 6).
//!
//! Each cell s that holds injected light is a point light at its centre, of intensity
//! I_s(ω) = max(0, c_s·Y(ω)). The flux that enters cell x is V(s, x)·∫ I_s dω over the directions in which s
//! sees the cube x, V being what the occluders on the straight line between both let through; it arrives
//! from one direction u_s, so
//!
//! ```text
//! R(x) = Σ_s Φ_s(x)·Y(u_s)
//! ```
//!
//! No propagator of the lab computes this, which is the point: all of them are judged by it alike. R is
//! compared with what a propagator moved, S_A − S_0, as it is and after the one scalar that fits best,
//! for renderers scale by taste. In every cell but the source's own the flux is the exact one
//! ([`solid_angle`]); a cell that s sees both sides of an edge of is given the light of its centre's direction.

pub mod solid_angle;
pub mod visibility;

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::error::{self, ErrorRow, Metric};
use super::reference;
use crate::field::{Cell, Grid, Layout};
use crate::propagate::geometry::Blocker;
use crate::propagate::transparency::Transparency;
use crate::scene::occluder::OcclusionMode;
use crate::scene::{Occlusion, Scene, Source};
use crate::sh::{Real, Sh};
use crate::simulation::{Simulation, SimulationError};
use solid_angle::Extent;
use visibility::Visibility;

/// R of a scene, with what it depends on.
#[derive(Clone, Debug)]
pub struct Ballistic {
    size: usize,
    sources: Vec<Source>,
    blockers: Vec<Blocker>,
    occlusion: Occlusion,
    light: Vec<Grid<f32>>,
}

impl Ballistic {
    /// Computes R on all cores. `progress` hears of the share done, 0 to 1, from any thread, and returns
    /// whether to go on; `None` if it did not want to.
    pub fn new(scene: &Scene, progress: &(dyn Fn(f64) -> bool + Sync)) -> Result<Option<Self>, SimulationError> {
        let injected = reference::injected::<f64>(scene)?;
        let extents = extents(scene.size);
        let blocks = scene.occlusion.mode != OcclusionMode::Off;
        let blockers: &[Blocker] = if blocks { &scene.blockers } else { &[] };
        let transparency = Transparency::new(scene.size, blockers);
        let visibility = transparency.as_ref().map(Visibility);
        let channels = injected.lights().len();
        let mut light = Vec::new();
        for (channel, carried) in injected.lights().iter().enumerate() {
            let points: Vec<(Cell, Sh<f64>)> =
                carried.source.level(0).iter().filter(|(_, light)| !light.is_zero()).collect();
            let part = |done: f64| progress((channel as f64 + done) / channels as f64);
            let Some(grid) = arriving(&points, &extents, visibility, scene.size, &part) else {
                return Ok(None);
            };
            light.push(grid);
        }
        let Scene { size, sources, blockers, occlusion, .. } = scene.clone();
        Ok(Some(Ballistic { size, sources, blockers, occlusion, light }))
    }

    /// Whether it is the reference of `scene`: the way light is propagated does not matter to it.
    pub fn is_of(&self, scene: &Scene) -> bool {
        self.size == scene.size
            && self.sources == scene.sources
            && self.blockers == scene.blockers
            && self.occlusion.mode == scene.occlusion.mode
    }

    /// R of each channel; zero in cells that only hold their own light.
    pub fn light(&self) -> &[Grid<f32>] {
        &self.light
    }
}

/// What a cell at each offset is seen as, x fastest, for offsets of 0 to n − 1 on each axis.
fn extents(n: usize) -> Vec<Extent> {
    let cells: Vec<Cell> = Layout::new(n).cells().collect();
    cells.par_iter().map(|cell| solid_angle::of_cell(DVec3::from_array(cell.map(|c| c as f64)))).collect()
}

/// R of one channel.
fn arriving(
    points: &[(Cell, Sh<f64>)],
    extents: &[Extent],
    visibility: Option<Visibility<'_>>,
    n: usize,
    progress: &(dyn Fn(f64) -> bool + Sync),
) -> Option<Grid<f32>> {
    let (done, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let rows: Vec<Vec<Sh<f64>>> = (0..n * n)
        .into_par_iter()
        .map(|row| {
            if stopped.load(Ordering::Relaxed) {
                return Vec::new();
            }
            let arriving_at =
                |cell: Cell| points.iter().map(|point| from_one(point, cell, extents, visibility, n)).sum();
            let light = (0..n).map(|x| arriving_at([x, row % n, row / n])).collect();
            let share = (done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / (n * n) as f64;
            if !progress(share) {
                stopped.store(true, Ordering::Relaxed);
            }
            light
        })
        .collect();
    if stopped.into_inner() {
        return None;
    }
    let mut grid = Grid::new(n);
    for (row, lights) in rows.iter().enumerate() {
        for (x, light) in lights.iter().enumerate() {
            grid.set([x, row % n, row / n], light.cast());
        }
    }
    Some(grid)
}

/// Φ·Y(u) of one point light at one cell.
fn from_one(
    &(from, light): &(Cell, Sh<f64>),
    to: Cell,
    extents: &[Extent],
    visibility: Option<Visibility<'_>>,
    n: usize,
) -> Sh<f64> {
    if from == to {
        return Sh::ZERO;
    }
    let [x, y, z]: [usize; 3] = std::array::from_fn(|a| from[a].abs_diff(to[a]));
    let offset = DVec3::from_array(std::array::from_fn(|a| to[a] as f64 - from[a] as f64));
    let mirrored = extents[(z * n + y) * n + x];
    let vector = mirrored.vector * offset.signum();
    let flux = solid_angle::flux(light, offset, &Extent { vector, ..mirrored });
    if flux <= 0.0 {
        return Sh::ZERO;
    }
    let seen = visibility.map_or(1.0, |visibility| visibility.between(from, to));
    Sh::basis(offset.normalize()) * (flux * seen)
}

/// The ballistic metric on the merged light that has moved, S_A − S_0, with the injected light taken off in
/// the cells that hold any.
pub fn error<T: Real>(simulation: &Simulation<T>, truth: &Ballistic) -> Result<ErrorRow, SimulationError> {
    let moved = moved(simulation)?;
    let scales = error::channel_scales(simulation);
    let tally = error::tally(&scales, truth.size, |channel, cell| {
        (moved[channel].get(cell), truth.light[channel].get(cell).cast())
    });
    Ok(tally.row(simulation.iteration(), Metric::Ballistic, None))
}

/// The L1 ratio of the merged light that has moved, as it is and after the scalar that fits best.
pub fn best_fit(simulation: &Simulation<f32>, truth: &Ballistic) -> Result<BestFit, SimulationError> {
    Ok(l1(&error::channel_scales(simulation), &moved(simulation)?, &truth.light))
}

/// S_A − S_0 of each channel: the merged light without the light that was injected.
pub fn moved<T: Real>(simulation: &Simulation<T>) -> Result<Vec<Grid<T>>, SimulationError> {
    let scene = simulation.scene();
    let mut merged = error::sampled(simulation);
    // Whether S_0 is in the sum is the snapshots' choice; injecting anew tells.
    let injected = reference::injected::<T>(scene)?;
    for (merged, light) in merged.iter_mut().zip(injected.lights()) {
        for (cell, value) in light.accumulated.level(0).iter().filter(|(_, value)| !value.is_zero()) {
            merged.set(cell, merged.get(cell) - value);
        }
    }
    Ok(merged)
}

/// Σ‖O − R‖∞ / Σ‖R‖∞ over all cells, as it is and with O multiplied by the number that makes it least; both
/// are 0 where all is dark. `scales` says how much each channel's norm counts.
pub fn l1<T: Real>(scales: &[f64], moved: &[Grid<T>], truth: &[Grid<T>]) -> BestFit {
    let expected = total(scales, moved, truth, [0.0, 1.0]);
    let found = total(scales, moved, truth, [1.0, 0.0]);
    let difference = |scale: f64| {
        let sum = total(scales, moved, truth, [scale, 1.0]);
        if sum == 0.0 { 0.0 } else { sum / expected }
    };
    // The difference is convex in the scale. Its least value is no further off than twice the ratio of the sums.
    let (mut low, mut high) = (0.0, if found > 0.0 { 2.0 * expected / found } else { 0.0 });
    for _ in 0..40 {
        let third = (high - low) / 3.0;
        if difference(low + third) < difference(high - third) { high -= third } else { low += third }
    }
    let (raw, scale) = (difference(1.0), 0.5 * (low + high));
    let fitted = difference(scale);
    // The search ends a little beside the best; where that is 1 there is nothing to gain.
    if fitted < raw { BestFit { raw, fitted, scale } } else { BestFit { raw, fitted: raw, scale: 1.0 } }
}

/// Σ‖u·O − v·R‖∞ over all cells, the norm over all channels.
fn total<T: Real>(scales: &[f64], moved: &[Grid<T>], truth: &[Grid<T>], [u, v]: [f64; 2]) -> f64 {
    let n = moved.first().map_or(0, Grid::side);
    let norm = |cell: Cell| {
        let channels = moved.iter().zip(truth).zip(scales);
        let each =
            channels.map(|((o, r), scale)| scale * (o.get(cell).widen() * u - r.get(cell).widen() * v).max_norm());
        each.fold(0.0, f64::max)
    };
    let slab = |z: usize| -> f64 { (0..n * n).map(|i| norm([i % n, i / n, z])).sum() };
    // Slabs are summed in their order, so that the sum is the same however many cores there are.
    (0..n).into_par_iter().map(slab).collect::<Vec<f64>>().iter().sum()
}

/// An error before and after the best scalar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestFit {
    /// With the light as it is.
    pub raw: f64,
    /// With the light multiplied by `scale`.
    pub fitted: f64,
    /// The scalar that fits best.
    pub scale: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_scalar_brings_a_multiple_of_the_truth_to_no_error() {
        let mut truth = Grid::<f64>::new(2);
        truth.set([1, 0, 0], Sh([2.0, 0.0, 1.0, 0.0]));
        truth.set([0, 1, 1], Sh([0.5, 0.2, 0.0, 0.0]));
        let mut moved = truth.clone();
        moved.scale(0.25);
        let fit = l1(&[1.0, 0.5], &[moved, Grid::new(2)], &[truth, Grid::new(2)]);
        assert!((fit.raw - 0.75).abs() < 1e-12 && fit.fitted < 1e-6 && (fit.scale - 4.0).abs() < 1e-5, "{fit:?}");
    }
}
