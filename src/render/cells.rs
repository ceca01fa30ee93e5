//! From light in cells to light on a surface (000, 3.2.4; 001, 4.3).
//!
//! At p = 4 the accumulated light of a cell is the flux per steradian that passes *through* it. A cube of side s has
//! 1.5·s² of area across a direction, in the mean over directions; so a surface with normal n in it gets
//!
//! ```text
//! E = max(0, c·L(−n)) / (1.5·s²)
//! ```
//!
//! which is right to 2 % for every n. Where c is taken from is [`Sampling`]. A level's cells hold the mean of the finest
//! cells in them, so s is the finest cell's side for every level. In a cell whose solid stops light at the cell's border
//! little is held; there E is what arrived at the solid ([`Arrivals`]).

use std::iter::Sum;
use std::ops::Mul;

use glam::DVec3;

use super::rgb::Rgb;
use crate::field::{Cell, Channels, Grid, Marks};
use crate::scene::placement::Placement;
use crate::sh::{Real, Sh};
use crate::transport::arrivals::Arrivals;

/// The mean area of a unit cube across a direction.
const ACROSS: f64 = 1.5;
/// How far off the surface the damped sample looks, in cells (NVIDIA's sample).
const DAMPED_AT: f64 = 0.2;

/// Where on the way to a surface its light is taken from the cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Sampling {
    /// The cell that the surface lies in (000).
    #[default]
    Nearest,
    /// Between the eight nearest cells (003).
    Trilinear,
    /// Between those of the eight nearest cells that a surface passes through (001, 4.3); the nearest cell where none
    /// does.
    Occupied,
    /// Trilinear, times the cosine between the light's direction and the direction of its change along the normal
    /// (NVIDIA's sample): light that gets stronger towards what is behind a surface came through it.
    Damped,
    /// The cell half a cell off the surface along its normal: before it, not in it.
    Before,
}

impl Sampling {
    /// All there are.
    pub const ALL: [Sampling; 5] =
        [Sampling::Nearest, Sampling::Trilinear, Sampling::Occupied, Sampling::Damped, Sampling::Before];

    /// Its name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Sampling::Nearest => "nearest",
            Sampling::Trilinear => "trilinear",
            Sampling::Occupied => "occupied",
            Sampling::Damped => "damped",
            Sampling::Before => "before",
        }
    }
}

/// The light of a volume, ready to be sampled: a level of the accumulated light, or the merged light.
#[derive(Clone, Copy, Debug)]
pub struct Cells<'a, T = f32> {
    /// Each channel's light, of side n/2^i.
    pub grids: &'a [&'a Grid<T>],
    /// How colours come from the channels.
    pub channels: &'a Channels,
    /// Where the finest cells lie.
    pub placement: &'a Placement,
    /// The finest cells that a surface passes through.
    pub occupied: &'a Marks,
    /// What arrived at solids of each channel's light, where the transport tells that.
    pub arrivals: Option<&'a [Arrivals]>,
    /// Where to sample.
    pub sampling: Sampling,
}

impl<T: Real> Cells<'_, T> {
    /// The irradiance [W/m²] of a surface at `at` with unit normal `normal`; none beyond the volume.
    pub fn irradiance(&self, at: DVec3, normal: DVec3) -> Rgb {
        let scale = 1.0 / (self.placement.cell_side * self.placement.cell_side);
        let mut channels = [0.0; 3];
        for (channel, e) in (0..self.grids.len()).zip(&mut channels) {
            *e = (self.sample(channel, at, normal) * scale).max(0.0);
        }
        self.channels.rgb().map(|share| share.scale * channels[share.channel])
    }

    /// E·s² of a channel.
    fn sample(&self, channel: usize, at: DVec3, normal: DVec3) -> f64 {
        let grid = self.grids[channel];
        let coarse = grid.side() as f64 / self.placement.size as f64;
        let along = |cells: f64| self.placement.in_cells(at) * coarse + cells * normal;
        let all = |cells: f64| Between::eight(grid.side(), along(cells), |_| true);
        match self.sampling {
            Sampling::Nearest => self.received(channel, normal, &Between::nearest(grid.side(), along(0.0))),
            Sampling::Before => self.received(channel, normal, &Between::nearest(grid.side(), along(0.5))),
            Sampling::Trilinear => self.received(channel, normal, &all(0.0)),
            Sampling::Occupied => {
                let occupied = Between::eight(grid.side(), along(0.0), |cell| self.is_occupied(cell, coarse));
                self.received(channel, normal, &occupied)
            }
            Sampling::Damped => {
                let vector = |cells: &Between| cells.sum(|cell| grid.get(cell).vector());
                let here = all(0.0);
                let (way, change) = (vector(&here), vector(&all(DAMPED_AT)) - vector(&here));
                let share = match (way.try_normalize(), change.try_normalize()) {
                    (Some(way), Some(change)) => way.dot(change).max(0.0),
                    _ => 1.0,
                };
                share * self.received(channel, normal, &here)
            }
        }
    }

    /// E·s² of a channel between cells.
    fn received(&self, channel: usize, normal: DVec3, cells: &Between) -> f64 {
        let lobe = Sh::<f64>::lobe(-normal);
        let arrivals = self.arrivals.map(|arrivals| &arrivals[channel]);
        cells.sum(|cell| {
            let on_solid = arrivals.and_then(|arrivals| arrivals.on(cell, normal));
            on_solid.unwrap_or_else(|| self.grids[channel].get(cell).widen().dot(lobe) / ACROSS)
        })
    }

    /// Whether a surface passes through a cell of a level that has `coarse` times the finest one's cells along a side.
    fn is_occupied(&self, cell: Cell, coarse: f64) -> bool {
        let width = (1.0 / coarse).round() as usize;
        let first = cell.map(|c| c * width);
        let inside = |i: usize| [i % width, i / width % width, i / (width * width)];
        (0..width.pow(3)).map(inside).any(|[x, y, z]| self.occupied.get([first[0] + x, first[1] + y, first[2] + z]))
    }
}

/// The cell that holds a place in cells, borders as [`crate::mesh::cut`] has them.
pub fn cell_of(place: DVec3, side: usize) -> Option<Cell> {
    const ROUNDING: f64 = 1e-6;
    let last = side as f64;
    let inside = place.cmpge(DVec3::splat(-ROUNDING)).all() && place.cmple(DVec3::splat(last + ROUNDING)).all();
    inside.then(|| place.to_array().map(|c| ((c + ROUNDING).max(0.0) as usize).min(side - 1)))
}

/// The cells around a place, each with its weight; none beyond the volume.
struct Between {
    cells: [(Cell, f64); 8],
    count: usize,
}

impl Between {
    /// The cell that holds a place, in cells; a place on the volume's upper border is in the last one.
    fn nearest(side: usize, place: DVec3) -> Self {
        let cell = cell_of(place, side);
        Between { cells: [(cell.unwrap_or_default(), 1.0); 8], count: usize::from(cell.is_some()) }
    }

    /// Those of the eight whose middles are around it that count; beyond the outermost middles light goes on as it is.
    fn eight(side: usize, place: DVec3, counts: impl Fn(Cell) -> bool) -> Self {
        let mut between = Between { cells: [([0; 3], 0.0); 8], count: 0 };
        if cell_of(place, side).is_none() {
            return between;
        }
        let from = (place - 0.5).clamp(DVec3::ZERO, DVec3::splat(side as f64 - 1.0));
        let low = from.floor();
        let part = from - low;
        let mut weights = 0.0;
        for corner in 0..8usize {
            let upper = |axis: usize| corner >> axis & 1;
            let cell: Cell = std::array::from_fn(|axis| (low[axis] as usize + upper(axis)).min(side - 1));
            let along = |axis: usize| if upper(axis) == 1 { part[axis] } else { 1.0 - part[axis] };
            let weight = along(0) * along(1) * along(2);
            if weight > 0.0 && counts(cell) {
                between.cells[between.count] = (cell, weight);
                between.count += 1;
                weights += weight;
            }
        }
        if weights == 0.0 {
            return Between::nearest(side, place);
        }
        between.cells.iter_mut().for_each(|(_, weight)| *weight /= weights);
        between
    }

    /// The weighted sum.
    fn sum<V: Mul<f64, Output = V> + Sum>(&self, of: impl Fn(Cell) -> V) -> V {
        self.cells[..self.count].iter().map(|(cell, weight)| of(*cell) * *weight).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sh::{K0, K1, LOBE0};
    use std::f64::consts::PI;

    fn placement() -> Placement {
        Placement { origin: DVec3::new(-1.0, 2.0, 0.0), cell_side: 0.5, size: 8 }
    }

    fn irradiance(grid: &Grid<f32>, occupied: &[Cell], sampling: Sampling, at: DVec3, normal: DVec3) -> Rgb {
        let mut marks = Marks::new(8);
        occupied.iter().for_each(|cell| marks.set(*cell));
        let channels = Channels::of_colors(&[[1.0, 0.5, 0.0]]);
        let placement = placement();
        Cells { grids: &[grid], channels: &channels, placement: &placement, occupied: &marks, arrivals: None, sampling }
            .irradiance(at, normal)
    }

    fn even(light: Sh<f64>) -> Grid<f32> {
        let mut grid = Grid::new(8);
        grid.layout().cells().for_each(|cell| grid.set(cell, light.cast()));
        grid
    }

    #[test]
    fn an_even_field_gives_its_irradiance_however_it_is_sampled() {
        // Radiance 1 from everywhere is an irradiance of π; a cell then passes 1.5·s² to each direction.
        let intensity = 1.5 * 0.25;
        let grid = even(Sh([intensity / K0, 0.0, 0.0, 0.0]));
        for sampling in Sampling::ALL {
            let e = irradiance(&grid, &[], sampling, DVec3::new(0.6, 3.1, 1.2), DVec3::new(0.6, 0.0, 0.8));
            assert!((e[0] - PI).abs() < 1e-6 && (e[1] - PI / 2.0).abs() < 1e-6 && e[2] == 0.0, "{sampling:?}: {e:?}");
        }
    }

    #[test]
    fn light_from_behind_gives_nothing_and_from_before_all() {
        let grid = even(Sh::lobe(DVec3::X));
        let at = DVec3::new(0.6, 3.1, 1.2);
        assert_eq!(irradiance(&grid, &[], Sampling::Nearest, at, DVec3::X), [0.0; 3]);
        let wanted = (LOBE0 * LOBE0 + (K1 * 2.0 * PI / 3.0).powi(2)) / (1.5 * 0.25);
        assert!((irradiance(&grid, &[], Sampling::Nearest, at, DVec3::NEG_X)[0] - wanted).abs() < 1e-6);
    }

    #[test]
    fn each_sampling_looks_where_it_says() {
        // Light that grows with x; a surface at the border of cells 3 and 4, facing −x.
        let mut grid = Grid::new(8);
        for cell in grid.layout().cells() {
            grid.set(cell, (Sh([1.0, 0.0, 0.0, 0.0]) * cell[0] as f64).cast());
        }
        let at = placement().in_metres(DVec3::new(4.0, 2.5, 2.5));
        let of = |sampling, occupied: &[Cell]| {
            irradiance(&grid, occupied, sampling, at, DVec3::NEG_X)[0] / (LOBE0 / (1.5 * 0.25))
        };
        let close = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-6, "{found}, {wanted}");
        close(of(Sampling::Nearest, &[]), 4.0);
        close(of(Sampling::Before, &[]), 3.0);
        close(of(Sampling::Trilinear, &[]), 3.5);
        close(of(Sampling::Occupied, &[[3, 2, 2]]), 3.0);
        close(of(Sampling::Occupied, &[[7, 7, 7]]), 4.0);
        assert_eq!(irradiance(&grid, &[], Sampling::Nearest, DVec3::ZERO, DVec3::X), [0.0; 3], "beyond the volume");
    }

    #[test]
    fn where_a_solid_is_what_arrived_at_it_counts() {
        let (grid, marks, channels) = (Grid::<f32>::new(8), Marks::new(8), Channels::of_colors(&[[1.0; 3]]));
        let (placement, mut arrivals) = (placement(), [Arrivals::new(8)]);
        arrivals[0].set([4, 2, 2], [3.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let at = placement.in_metres(DVec3::new(4.0, 2.5, 2.5));
        let of = |sampling, normal| {
            let arrivals = Some(arrivals.as_slice());
            let cells = Cells {
                grids: &[&grid],
                channels: &channels,
                placement: &placement,
                occupied: &marks,
                arrivals,
                sampling,
            };
            cells.irradiance(at, normal)[0]
        };
        // 3 W on a cell's face of 0.25 m²; dark cells before it.
        assert_eq!([of(Sampling::Nearest, DVec3::NEG_X), of(Sampling::Nearest, DVec3::X)], [12.0, 0.0]);
        assert_eq!([of(Sampling::Before, DVec3::NEG_X), of(Sampling::Trilinear, DVec3::NEG_X)], [0.0, 6.0]);
    }

    #[test]
    fn damping_takes_away_what_grows_stronger_behind_a_surface() {
        let ramp = |slope: f64| {
            let mut grid = Grid::new(8);
            for cell in grid.layout().cells() {
                grid.set(cell, (Sh::lobe(DVec3::X) * (8.0 + slope * cell[0] as f64)).cast());
            }
            grid
        };
        let at = DVec3::new(0.6, 3.1, 1.2);
        // The surface faces −x, light travels along +x.
        let of = |slope| irradiance(&ramp(slope), &[], Sampling::Damped, at, DVec3::NEG_X)[0];
        assert!(of(-1.0) > 0.0);
        assert_eq!(of(1.0), 0.0);
    }
}
