//! One iteration among occluders, line by line as MATH.md section 9 has it, in either precision.
//!
//! Like [`super::plain`] this is a definition: it gathers, cell by cell, what the six neighbours send.

use glam::DMat4;

use super::fuzzy::Around;
pub use super::fuzzy::Fuzzy;
#[cfg(feature = "gpu")]
pub use super::fuzzy::REFLECTION;
pub use super::gather::Which;
use super::gather::sender;
use super::settle;
use crate::field::{Cell, Grid, Layout};
use crate::sh::{Real, Sh};
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::geometry_volume::GeometryVolume;
use crate::transport::lattice::hard_solids::HardSolids;
use crate::transport::lattice::stencil::{Stencil, matrices};

/// The occluders of a scene, and what they do to light.
#[derive(Clone, Debug, PartialEq)]
pub enum OcclusionLaw<T> {
    /// Blockers weaken light, and reflect some of it.
    Fuzzy(Fuzzy<T>),
    /// Occupied cells mirror light.
    Mirrored(Mirrored<T>),
    /// Occupied cells pass nothing.
    Hard(Hard<T>),
}

/// Light that enters an occupied cell is mirrored on the axis along which it came, times opacity and albedo,
/// and goes on from there (001, 4.2).
#[derive(Clone, Debug, PartialEq)]
pub struct Mirrored<T> {
    /// The occupied cells.
    pub geometry: GeometryVolume<T>,
}

/// An occupied cell passes nothing. What would have entered it, p and all, is mirrored back to the cell it came from,
/// times albedo and bounce, and otherwise absorbed. All of that begins with the first iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Hard<T> {
    /// What passes.
    pub hard_solids: HardSolids<T>,
    /// The albedos.
    pub geometry: GeometryVolume<T>,
    /// What reflected light is multiplied by.
    pub bounce: T,
}

impl<T: Real> OcclusionLaw<T> {
    /// Sets `target` to what all cells of `source` send to their neighbours, as far as occluders let it.
    /// Outside the grid is dark.
    pub fn propagate(&self, stencil: &Stencil<T>, which: Which, source: &Grid<T>, target: &mut Grid<T>) {
        for cell in source.layout().cells() {
            target.set(cell, self.receive(stencil, which, source, cell));
        }
    }

    /// What one cell receives from its neighbours, and back from occluders.
    fn receive(&self, stencil: &Stencil<T>, which: Which, source: &Grid<T>, cell: Cell) -> Sh<T> {
        let directions = 0..Direction::ALL.len();
        settle(match self {
            OcclusionLaw::Fuzzy(fuzzy) => fuzzy.receive(stencil, which, source, cell, &fuzzy.around(which.level, cell)),
            OcclusionLaw::Mirrored(mirrored) => {
                directions.map(|d| mirrored.receive(stencil, which, source, cell, d)).sum()
            }
            OcclusionLaw::Hard(hard) => directions.map(|d| hard.receive(stencil, which, source, cell, d)).sum(),
        })
    }

    /// What number `i` of the `touched` cells receives.
    pub(super) fn receive_touched(
        &self,
        stencil: &Stencil<T>,
        which: Which,
        source: &Grid<T>,
        touched: &Touched<T>,
        i: usize,
    ) -> Sh<T> {
        let cell = touched.cells[i];
        match (self, touched.around.get(i)) {
            (OcclusionLaw::Fuzzy(fuzzy), Some(around)) => settle(fuzzy.receive(stencil, which, source, cell, around)),
            _ => self.receive(stencil, which, source, cell),
        }
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        match self {
            OcclusionLaw::Fuzzy(fuzzy) => fuzzy.geometry.bytes(),
            OcclusionLaw::Mirrored(mirrored) => mirrored.geometry.bytes(),
            OcclusionLaw::Hard(hard) => hard.geometry.bytes() + hard.hard_solids.bytes(),
        }
    }

    /// For each of the `touched` cells of an n³ level what a card keeps of its surroundings, as
    /// `kernels/solids.wgsl` takes it.
    #[cfg(feature = "gpu")]
    pub fn tables(&self, level: usize, n: usize, touched: &Touched<T>) -> Vec<(Cell, Vec<[T; 4]>)> {
        let table = |(i, &cell): (usize, &Cell)| {
            let table = match self {
                OcclusionLaw::Fuzzy(fuzzy) => {
                    let around = touched.around.get(i).copied().unwrap_or_else(|| fuzzy.around(level, cell));
                    around.iter().flat_map(Around::table).collect()
                }
                OcclusionLaw::Hard(hard) => Direction::ALL.iter().map(|d| hard.table(level, cell, *d, n)).collect(),
                OcclusionLaw::Mirrored(mirrored) => {
                    Direction::ALL.iter().map(|d| mirrored.table(level, cell, d.axis())).collect()
                }
            };
            (cell, table)
        };
        touched.cells.iter().enumerate().map(table).collect()
    }

    /// The cells of an n³ level whose light depends on an occluder; the others receive what they would
    /// without any.
    pub fn touched(&self, level: usize, n: usize) -> Touched<T> {
        let is_touched = |cell: &Cell| match self {
            OcclusionLaw::Fuzzy(fuzzy) => fuzzy.touches(level, *cell),
            OcclusionLaw::Mirrored(mirrored) => mirrored.geometry.is_occupied(level, *cell),
            OcclusionLaw::Hard(hard) => hard.touches(level, *cell, n),
        };
        let cells: Vec<Cell> = Layout::new(n).cells().filter(is_touched).collect();
        let around = match self {
            OcclusionLaw::Fuzzy(fuzzy) => cells.iter().map(|cell| fuzzy.around(level, *cell)).collect(),
            _ => Vec::new(),
        };
        Touched { cells, around }
    }
}

impl OcclusionLaw<f64> {
    /// What a cell receives of the light that its neighbours send in each of [`Direction::ALL`], as matrices on that
    /// light: all there is to say where what a cell receives depends on its neighbours alone and no flux is clamped.
    /// `None` for hard occluders, which send some of a cell's own light back.
    pub fn matrices(&self, stencil: &Stencil<f64>, which: Which, cell: Cell) -> Option<[DMat4; 6]> {
        match self {
            OcclusionLaw::Fuzzy(fuzzy) => {
                let around = fuzzy.around(which.level, cell);
                Some(matrices(|d, light| fuzzy.admit(stencil, which, d, &around[d.index()], light)))
            }
            OcclusionLaw::Mirrored(mirrored) => {
                Some(matrices(|d, light| mirrored.admit(stencil, which, cell, d, light)))
            }
            OcclusionLaw::Hard(_) => None,
        }
    }
}

impl<T> Touched<T> {
    /// Bytes that a cell takes.
    pub const CELL: usize = size_of::<Cell>();
    /// Bytes that what lies around it takes, for fuzzy occluders.
    pub const AROUND: usize = size_of::<[Around<T>; 6]>();

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        size_of_val(self.cells.as_slice()) + size_of_val(self.around.as_slice())
    }
}

/// The cells of a level whose light depends on an occluder.
#[derive(Clone, Debug, PartialEq)]
pub struct Touched<T> {
    pub(in crate::transport::lattice) cells: Vec<Cell>,
    /// For fuzzy occluders, what lies around each of the cells.
    around: Vec<[Around<T>; 6]>,
}

impl<T: Real> Mirrored<T> {
    /// The share of light along `axis` that passes a cell, and what it mirrors of red, green and blue.
    #[cfg(feature = "gpu")]
    fn table(&self, level: usize, cell: Cell, axis: usize) -> [T; 4] {
        let occupied = self.geometry.opacity(level, cell, axis);
        let [red, green, blue] = [0, 1, 2].map(|colour| occupied * self.geometry.albedo(level, cell, colour));
        [T::of(1.0) - occupied, red, green, blue]
    }

    fn receive(&self, stencil: &Stencil<T>, which: Which, source: &Grid<T>, cell: Cell, d: usize) -> Sh<T> {
        self.admit(stencil, which, cell, Direction::ALL[d], sender(source, cell, Direction::ALL[d]))
    }

    /// What a cell receives of the `light` of the neighbour that sends it in a direction.
    fn admit(&self, stencil: &Stencil<T>, which: Which, cell: Cell, direction: Direction, light: Sh<T>) -> Sh<T> {
        let sent = stencil.send(direction.index(), light);
        let occupied = self.geometry.opacity(which.level, cell, direction.axis());
        let reflected = occupied * self.geometry.albedo(which.level, cell, which.colour);
        sent * (T::of(1.0) - occupied) + sent.mirrored(direction.axis()) * reflected
    }
}

impl<T: Real> Hard<T> {
    /// The share of light along `direction` that passes a cell, and what the next cell sends back of red, green and
    /// blue.
    #[cfg(feature = "gpu")]
    fn table(&self, level: usize, cell: Cell, direction: Direction, n: usize) -> [T; 4] {
        let passes = |cell| self.hard_solids.passes(level, cell, direction.axis());
        let reflected = |colour| {
            direction.neighbour(cell, n).map_or(T::ZERO, |next| {
                (T::of(1.0) - passes(next)) * self.geometry.albedo(level, next, colour) * self.bounce
            })
        };
        [passes(cell), reflected(0), reflected(1), reflected(2)]
    }

    /// Whether the cell holds light up, or a neighbour that may send some back.
    fn touches(&self, level: usize, cell: Cell, n: usize) -> bool {
        let is_open = |cell| (0..3).all(|axis| self.hard_solids.passes(level, cell, axis) == T::of(1.0));
        let sends_back = |d: &Direction| d.neighbour(cell, n).is_some_and(|next| !is_open(next));
        !is_open(cell) || (self.bounce > T::ZERO && Direction::ALL.iter().any(sends_back))
    }

    /// Besides what `cell` receives in direction `d`, what the neighbour in that direction sends back to it.
    fn receive(&self, stencil: &Stencil<T>, which: Which, source: &Grid<T>, cell: Cell, d: usize) -> Sh<T> {
        let direction = Direction::ALL[d];
        let passes = |cell| self.hard_solids.passes(which.level, cell, direction.axis());
        if passes(cell) == T::ZERO {
            return Sh::ZERO;
        }
        let mut received = stencil.send(d, sender(source, cell, direction));
        // Most scenes reflect nothing, and then nobody asks for albedos.
        if self.bounce > T::ZERO
            && let Some(next) = direction.neighbour(cell, source.side())
        {
            let albedo = self.geometry.albedo(which.level, next, which.colour);
            let reflected = (T::of(1.0) - passes(next)) * albedo * self.bounce;
            if reflected > T::ZERO {
                received += stencil.send(d, source.get(cell)).mirrored(direction.axis()) * reflected;
            }
        }
        received * passes(cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Levels;
    use crate::scene::Solid;
    use crate::sh::SPHERE;
    use crate::transport::lattice::face::{far_solid_angle, side_solid_angle};
    use crate::transport::lattice::kernel::plain;
    use crate::transport::lattice::schemes::{cascaded, reflective};
    use glam::DVec3;

    const RED: Which = Which { level: 0, colour: 0, blocks: true };
    const N: usize = 8;

    /// A wall at x = 4 that faces −X, for red light of albedo 0.5.
    fn wall(opacity: f64) -> Vec<Solid> {
        let cells = Grid::<f64>::new(N).layout().cells().filter(|cell| cell[0] == 4);
        let block = |cell| Solid::new(cell, DVec3::NEG_X, opacity, [0.5, 0.0, 1.0]);
        cells.map(block).collect()
    }

    fn geometry(solids: &[Solid]) -> GeometryVolume<f64> {
        GeometryVolume::new(Levels::new(N, 1).unwrap(), solids)
    }

    /// What one iteration makes of a unit lobe towards +X in cell (3, 4, 4).
    fn step(occluders: &OcclusionLaw<f64>, stencil: &Stencil<f64>) -> Grid<f64> {
        let (mut source, mut target) = (Grid::new(N), Grid::new(N));
        source.set([3, 4, 4], Sh::lobe(DVec3::X));
        occluders.propagate(stencil, RED, &source, &mut target);
        target
    }

    /// The flux of a unit lobe straight ahead and through the four sides, by the formulas of MATH.md section 2.
    fn flux_ahead() -> (f64, f64) {
        let value = |cosine: f64| 0.25 + 0.5 * cosine;
        (value(1.0) * far_solid_angle() / SPHERE, 4.0 * value(2.0 / 5f64.sqrt()) * side_solid_angle() / SPHERE)
    }

    #[test]
    fn cells_that_no_occluder_touches_receive_what_they_would_without() {
        let stencil = Stencil::new(&cascaded::scheme(), 3.0, true);
        let mut source = Grid::new(N);
        for (i, cell) in source.layout().cells().enumerate() {
            let (s, c) = (i as f64).sin_cos();
            source.set(cell, Sh::lobe(DVec3::new(s, c, 0.0)));
        }
        let mut free = Grid::new(N);
        plain::propagate(&stencil, &source, &mut free);
        let corner: Vec<Solid> = wall(0.7).into_iter().filter(|b| b.cell[1] > 2 && b.cell[2] < 5).collect();
        let hard_solids = HardSolids::new(Levels::new(N, 1).unwrap(), &corner, [[0, 0, 0]]);
        for (occluders, most) in [
            (
                OcclusionLaw::Fuzzy(Fuzzy {
                    geometry: geometry(&corner),
                    amplifier: 0.8,
                    along_travel: false,
                    bounce: 0.5,
                }),
                2 * 6 * 6,
            ),
            (OcclusionLaw::Mirrored(Mirrored { geometry: geometry(&corner) }), 5 * 5),
            (OcclusionLaw::Hard(Hard { hard_solids, geometry: geometry(&corner), bounce: 0.5 }), 3 * 5 * 5 + 2 * 5),
        ] {
            let mut found = Grid::new(N);
            occluders.propagate(&stencil, RED, &source, &mut found);
            let touched = occluders.touched(0, N).cells;
            assert!(!touched.is_empty() && touched.len() <= most, "{}", touched.len());
            for (cell, light) in found.iter() {
                assert!(light == free.get(cell) || touched.contains(&cell), "{cell:?}");
            }
        }
    }

    #[test]
    fn the_bounce_is_the_documented_multiple_of_the_flux_about_the_walls_normal() {
        let stencil = Stencil::new(&cascaded::scheme(), 3.0, true);
        let fuzzy = |bounce| {
            OcclusionLaw::Fuzzy(Fuzzy { geometry: geometry(&wall(1.0)), amplifier: 0.8, along_travel: false, bounce })
        };
        // The far corners of cell (4, 4, 4) hold the wall: G = L(−X), facing the light with G · Y(−X) = 3/4.
        // Nothing lies on the near side, so nothing is occluded. The factor 3 has no part in it.
        let reflected = step(&fuzzy(0.6), &stencil).get([4, 4, 4]) - step(&fuzzy(0.0), &stencil).get([4, 4, 4]);
        let (far, sides) = flux_ahead();
        let expected = Sh::lobe(DVec3::NEG_X) * (0.75 * (far + sides) * 4.8 * 0.5 * 0.6);
        assert!((reflected - expected).max_norm() < 1e-14, "{reflected:?}, {expected:?}");
        assert_eq!(step(&fuzzy(0.6), &stencil).get([3, 5, 4]), step(&fuzzy(0.0), &stencil).get([3, 5, 4]));
    }

    #[test]
    fn a_walls_front_blocks_against_travel_and_not_along_it() {
        let stencil = Stencil::new(&cascaded::scheme(), 1.0, true);
        // Light that enters cell (5, 4, 4) from (4, 4, 4) passes between them, where the wall is.
        let passed = |along_travel| {
            let fuzzy = OcclusionLaw::Fuzzy(Fuzzy {
                geometry: geometry(&wall(1.0)),
                amplifier: 0.8,
                along_travel,
                bounce: 0.0,
            });
            let (mut source, mut target) = (Grid::new(N), Grid::new(N));
            source.set([4, 4, 4], Sh::lobe(DVec3::X));
            fuzzy.propagate(&stencil, RED, &source, &mut target);
            target.get([5, 4, 4]).0[0] / Sh::<f64>::lobe(DVec3::X).0[0]
        };
        let (far, sides) = flux_ahead();
        let blocked = |cosine: f64| 1.0 - (0.8 * (0.25 + 0.5 * cosine)).max(0.0);
        let expected = far * blocked(1.0) + sides * blocked(2.0 / 5f64.sqrt());
        assert!((passed(false) - expected).abs() < 1e-14);
        // Evaluated along travel, a lobe that faces the light is below zero in each of the five directions.
        assert!((passed(true) - (far + sides)).abs() < 1e-14);
    }

    #[test]
    fn a_mirror_turns_the_axis_of_travel_and_keeps_opacity_times_albedo() {
        let stencil = Stencil::new(&reflective::scheme(), 1.0, true);
        let mirrored = step(&OcclusionLaw::Mirrored(Mirrored { geometry: geometry(&wall(0.8)) }), &stencil);
        let free = step(&OcclusionLaw::Mirrored(Mirrored { geometry: geometry(&[]) }), &stencil);
        let Sh([c00, x, ..]) = free.get([4, 4, 4]);
        let expected = Sh([c00 * (0.2 + 0.4), x * (0.2 - 0.4), 0.0, 0.0]);
        assert!((mirrored.get([4, 4, 4]) - expected).max_norm() < 1e-15);
        assert_eq!(mirrored.get([3, 5, 4]), free.get([3, 5, 4]));
    }

    #[test]
    fn a_hard_wall_sends_back_what_would_have_entered_and_passes_nothing() {
        let stencil = Stencil::new(&reflective::scheme(), 1.0, true);
        let sizes = Levels::new(N, 1).unwrap();
        let hard = |bounce| {
            let hard_solids = HardSolids::new(sizes, &wall(1.0), [[3, 4, 4]]);
            step(&OcclusionLaw::Hard(Hard { hard_solids, geometry: geometry(&wall(1.0)), bounce }), &stencil)
        };
        let free = step(&OcclusionLaw::Mirrored(Mirrored { geometry: geometry(&[]) }), &stencil);
        assert!(hard(1.0).get([4, 4, 4]).is_zero());
        let Sh([c00, x, ..]) = free.get([4, 4, 4]);
        assert!((hard(0.6).get([3, 4, 4]) - Sh([0.3 * c00, -0.3 * x, 0.0, 0.0])).max_norm() < 1e-15);
        assert!(hard(0.0).get([3, 4, 4]).is_zero());
    }
}
