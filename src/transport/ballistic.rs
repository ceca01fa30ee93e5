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
//! No propagator of the lab computes this, which is the point: all of them are judged by it alike.
//! In every cell but the source's own the flux is the exact one
//! ([`solid_angle`]); a cell that s sees both sides of an edge of is given the light of its centre's direction.

mod pattern;
pub(crate) mod solid_angle;
pub(crate) mod visibility;

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::transmittance::Transmittance;
use crate::field::{Cell, Grid, Layout};
use crate::scene::{Occlusion, Problem, Solid, Source};
use crate::sh::Sh;
use solid_angle::Extent;
use visibility::Visibility;

/// R of a scene, with what it depends on.
#[derive(Clone, Debug)]
pub struct Ballistic {
    size: usize,
    sources: Vec<Source>,
    solids: Vec<Solid>,
    occlusion: Occlusion,
    light: Vec<Grid<f32>>,
}

impl Ballistic {
    /// Computes R on all cores. `progress` hears of the share done, 0 to 1, from any thread, and returns
    /// whether to go on; `None` if it did not want to.
    pub fn new(problem: &Problem, progress: &(dyn Fn(f64) -> bool + Sync)) -> Option<Self> {
        let injected = problem.injected::<f64>(&problem.channels());
        let extents = extents(problem.size);
        let transparency = Transmittance::of(problem);
        let visibility = transparency.as_ref().map(|cells| Visibility::new(cells, problem.size));
        let channels = injected.len();
        let mut light = Vec::new();
        for (channel, carried) in injected.iter().enumerate() {
            let points: Vec<(Cell, Sh<f64>)> = carried.iter().filter(|(_, light)| !light.is_zero()).collect();
            let part = |done: f64| progress((channel as f64 + done) / channels as f64);
            light.push(arriving(&points, &extents, visibility.as_ref(), problem.size, &part)?);
        }
        let Problem { size, sources, solids, occlusion, .. } = problem.clone();
        Some(Ballistic { size, sources, solids, occlusion, light })
    }

    /// Cells along a side.
    pub fn side(&self) -> usize {
        self.size
    }

    /// Whether it is the reference of `problem`: the way light is propagated does not matter to it.
    pub fn is_of(&self, problem: &Problem) -> bool {
        self.size == problem.size
            && self.sources == problem.sources
            && self.solids == problem.solids
            && self.occlusion.mode == problem.occlusion.mode
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
    visibility: Option<&Visibility<'_>>,
    n: usize,
    progress: &(dyn Fn(f64) -> bool + Sync),
) -> Option<Grid<f32>> {
    let (done, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let patterns = if visibility.is_none() { pattern::of_equals(points, extents, n) } else { Vec::new() };
    let rows: Vec<Vec<Sh<f64>>> = (0..n * n)
        .into_par_iter()
        .map(|row| {
            if stopped.load(Ordering::Relaxed) {
                return Vec::new();
            }
            let (y, z) = (row % n, row / n);
            let mut light = vec![Sh::ZERO; n];
            if patterns.is_empty() {
                for (x, light) in light.iter_mut().enumerate() {
                    *light = points.iter().map(|point| from_one(point, [x, y, z], extents, visibility, n)).sum();
                }
            }
            patterns.iter().for_each(|pattern| pattern.add_row(y, z, &mut light));
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
    visibility: Option<&Visibility<'_>>,
    n: usize,
) -> Sh<f64> {
    let arrived = arrived_at(light, [0, 1, 2].map(|a| to[a] as isize - from[a] as isize), extents, n);
    match visibility {
        Some(visibility) if !arrived.is_zero() => arrived * visibility.between(from, to),
        _ => arrived,
    }
}

/// Φ·Y(u) of a point light at the cell that is `offset` away, up to n − 1 on each axis, if nothing is in between.
fn arrived_at(light: Sh<f64>, offset: [isize; 3], extents: &[Extent], n: usize) -> Sh<f64> {
    if offset == [0; 3] {
        return Sh::ZERO;
    }
    let [x, y, z] = offset.map(isize::unsigned_abs);
    let offset = DVec3::from_array(offset.map(|c| c as f64));
    let mirrored = extents[(z * n + y) * n + x];
    let vector = mirrored.vector * offset.signum();
    let flux = solid_angle::flux(light, offset, &Extent { vector, ..mirrored });
    if flux <= 0.0 { Sh::ZERO } else { Sh::basis(offset.normalize()) * flux }
}
