//! What hard occluders let through, cell by cell.
//!
//! A cell that an occluder fills passes 1 − opacity of what enters it, whatever stood before. The surface of a mesh is
//! one sheet that passes through many cells, and what it covers of one cell it leaves open of the next: along a line
//! through adjoining cells that it covers by a, b, c … of a face, light finds 1 − a, then 1 − a − b, then 1 − a − b − c …
//! of it open, until it is shut. So of what enters the second cell (1 − a − b)/(1 − a) passes, and not 1 − b: a slanted
//! wall would leak a fifth of the light. Along an axis that a surface nearly follows light comes into its cells from the
//! side, and what it covers of one tells nothing of the next.
//!
//! A sheet stands somewhere in its cell, so it is taken to stand on the cell's nearer border: light that goes towards it
//! crosses the cell first where that is the border by which it leaves. So in the corner of two walls both are lit.

use std::collections::HashMap;

use crate::field::Cell;
use crate::scene::{Problem, Solid};
use crate::sh::Real;

/// How much of the light that enters a cell of an n³ volume goes on.
#[derive(Clone, Debug, PartialEq)]
pub struct Transmittance {
    n: usize,
    /// By cell, for light that travels forwards and backwards along each axis.
    passes: Vec<Ways>,
    /// By cell, the number of a sheet's cell among those of all sheets, or [`NONE`].
    numbers: Vec<u32>,
    /// By number, whether the sheet stands nearer to the cell's lower border across each axis.
    low: Vec<[bool; 3]>,
    /// By cell of a sheet what earlier cells of it leave open of the faces that light comes in by, where that is not all.
    open: HashMap<usize, Ways>,
}

/// A number for light that travels forwards, then backwards, along x, y and z.
pub type Ways = [[f32; 3]; 2];

/// No number.
const NONE: u32 = u32::MAX;
/// The least share (squared) of what a surface covers across all axes by which it counts as crossing one: an angle of 10°.
const CROSSES: f64 = 0.03;
/// The cosine between the normals of one sheet's neighbouring cells.
const ALIKE: f64 = 0.9;
/// Less of a face than this counts as none: rounding of areas.
const SHUT: f64 = 1e-6;

impl Transmittance {
    /// What the occluders of `problem` let through; `None` where nothing stands in light's way.
    pub fn of(problem: &Problem) -> Option<Self> {
        if !problem.has_occluders() {
            return None;
        }
        let mut all = Transmittance::new(problem.size, &problem.solids)?;
        if let Some(stage) = &problem.stage {
            // Cells that an occluder fills are not the mesh's any more.
            let order = |solid: &Solid| (solid.cell[2], solid.cell[1], solid.cell[0]);
            let of_mesh = |solid: &&Solid| {
                let known = problem.solids.binary_search_by_key(&order(solid), order);
                known.is_ok_and(|i| problem.solids[i] == **solid)
            };
            let sheet: Vec<&Solid> = stage.voxels.solids.iter().filter(of_mesh).collect();
            all.adjoin(&sheet);
        }
        Some(all)
    }

    /// What `blockers` let through: 1 − opacity each, by axis; `None` if there are none.
    pub fn new(n: usize, solids: &[Solid]) -> Option<Self> {
        if solids.is_empty() {
            return None;
        }
        let mut passes = vec![[[1.0; 3]; 2]; n.pow(3)];
        for blocker in solids {
            let [x, y, z] = blocker.cell;
            passes[(z * n + y) * n + x] = [blocker.opacity.map(|opacity| 1.0 - opacity as f32); 2];
        }
        Some(Transmittance { n, passes, numbers: vec![NONE; n.pow(3)], low: Vec::new(), open: HashMap::new() })
    }

    /// What one sheet lets through that passes through these cells, z slowest and x fastest; `None` if there are none.
    pub fn of_sheet(n: usize, sheet: &[Solid]) -> Option<Self> {
        let mut all = Transmittance::new(n, sheet)?;
        all.adjoin(&sheet.iter().collect::<Vec<_>>());
        Some(all)
    }

    /// Takes the cells of a sheet, z slowest and x fastest, for what they are.
    fn adjoin<'a>(&mut self, sheet: &[&'a Solid]) {
        for solid in sheet {
            let [x, y, z] = solid.cell;
            self.numbers[(z * self.n + y) * self.n + x] = self.low.len() as u32;
            self.low.push(solid.stands.unwrap_or([0.5; 3]).map(|stands| stands <= 0.5));
        }
        let crosses = |solid: &Solid, axis: usize| {
            let squares = solid.opacity.map(|opacity| opacity * opacity);
            squares[axis] > CROSSES * squares.iter().sum::<f64>()
        };
        for axis in 0..3 {
            for (way, step) in [-1, 1].into_iter().enumerate() {
                // By column of cells along the axis, how much of its face the sheet has left open so far.
                let mut left: Vec<(f64, Option<&Solid>)> = vec![(1.0, None); self.n * self.n];
                let mut pass = |solid: &'a Solid| {
                    let cell = solid.cell;
                    let column = &mut left[cell[(axis + 1) % 3] * self.n + cell[(axis + 2) % 3]];
                    let goes_on = column.1.is_some_and(|last| {
                        last.cell[axis].abs_diff(cell[axis]) == 1 && last.normal.dot(solid.normal) > ALIKE
                    });
                    let open = if goes_on { column.0 } else { 1.0 };
                    let closed = (open - solid.opacity[axis]).max(0.0);
                    *column = (closed, Some(solid));
                    let passed = if open > SHUT && closed > SHUT { closed / open } else { 0.0 };
                    let at = (cell[2] * self.n + cell[1]) * self.n + cell[0];
                    self.passes[at][way][axis] = passed as f32;
                    if open < 1.0 {
                        self.open.entry(at).or_insert([[1.0; 3]; 2])[way][axis] = open as f32;
                    }
                };
                // Every column is met in the order in which light goes along it.
                let crossing = sheet.iter().filter(|solid| crosses(solid, axis));
                if step < 0 { crossing.for_each(|s| pass(s)) } else { crossing.rev().for_each(|s| pass(s)) }
            }
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.passes.as_slice())
            + size_of_val(self.numbers.as_slice())
            + size_of_val(self.low.as_slice())
            + self.open.len() * size_of::<(usize, Ways)>()
    }

    /// The shares that pass a cell of what enters it by its faces across x, y and z, each 0 to 1; `backwards` tells for
    /// each axis whether the light travels towards smaller indices.
    #[inline]
    pub fn along(&self, [x, y, z]: Cell, backwards: [bool; 3]) -> [f32; 3] {
        let ways = &self.passes[(z * self.n + y) * self.n + x];
        [0, 1, 2].map(|axis| ways[usize::from(backwards[axis])][axis])
    }

    /// How many cells sheets have.
    pub fn sheets(&self) -> usize {
        self.low.len()
    }

    /// The number of a cell among those of sheets.
    #[inline]
    pub fn sheet(&self, [x, y, z]: Cell) -> Option<usize> {
        let number = self.numbers[(z * self.n + y) * self.n + x];
        (number != NONE).then_some(number as usize)
    }

    /// By axis, whether light that goes `backwards` meets what stands in a cell where it leaves the cell, and not where
    /// it comes in: a sheet that stands nearer to the border by which light leaves.
    #[inline]
    pub fn at_exit(&self, cell: Cell, backwards: [bool; 3]) -> [bool; 3] {
        self.sheet(cell).map_or([false; 3], |i| [0, 1, 2].map(|axis| self.low[i][axis] == backwards[axis]))
    }

    /// The shares that pass where light comes into a cell, and where it leaves it.
    #[inline]
    pub fn ends<T: Real>(&self, cell: Cell, backwards: [bool; 3]) -> [[T; 3]; 2] {
        let shares = self.along(cell, backwards).map(|share| T::of(f64::from(share)));
        let at_exit = self.at_exit(cell, backwards);
        let where_not = |exit: bool| [0, 1, 2].map(|k| if at_exit[k] == exit { shares[k] } else { T::of(1.0) });
        [where_not(false), where_not(true)]
    }

    /// The least of all shares: for light whose way through the cell nobody follows.
    #[inline]
    pub fn least(&self, [x, y, z]: Cell) -> f32 {
        self.passes[(z * self.n + y) * self.n + x].into_iter().flatten().fold(1.0, f32::min)
    }

    /// What earlier cells of the sheet that passes through a cell leave open of the faces by which light comes in.
    pub fn open(&self, [x, y, z]: Cell) -> Ways {
        self.open.get(&((z * self.n + y) * self.n + x)).copied().unwrap_or([[1.0; 3]; 2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// A sheet that covers so much of each cell along x.
    fn along_x(covers: &[f64]) -> Transmittance {
        let solid = |(x, cover): (usize, &f64)| Solid {
            opacity: [*cover, 0.0, 0.0],
            ..Solid::new([x + 2, 3, 4], DVec3::X, 1.0, [0.0; 3])
        };
        let sheet: Vec<Solid> = covers.iter().enumerate().map(solid).collect();
        Transmittance::of_sheet(8, &sheet).unwrap()
    }

    #[test]
    fn a_slanted_sheet_that_covers_a_face_in_pieces_is_shut_from_both_sides() {
        let all = along_x(&[0.3, 0.5, 0.2]);
        let along = |x: usize, backwards: bool| all.along([x, 3, 4], [backwards; 3])[0];
        for (found, wanted) in [
            (along(2, false), 0.7),
            (along(3, false), 0.2 / 0.7),
            (along(4, false), 0.0),
            (along(4, true), 0.8),
            (along(3, true), 0.3 / 0.8),
            (along(2, true), 0.0),
        ] {
            assert!((found - wanted).abs() < 1e-6, "{found}, {wanted}");
        }
        let open = all.open([4, 3, 4]);
        assert!((open[0][0] - 0.2).abs() < 1e-6 && open[1][0] == 1.0 && open[0][1] == 1.0, "{open:?}");
        assert_eq!(all.along([3, 3, 4], [false; 3])[1..], [1.0, 1.0]);
    }

    #[test]
    fn along_an_axis_that_it_nearly_follows_a_sheet_takes_its_share_in_each_cell() {
        let leaning = |x| Solid { opacity: [0.02, 1.0, 0.0], ..Solid::new([x, 3, 4], DVec3::Y, 1.0, [0.0; 3]) };
        let sheet: Vec<Solid> = (0..8).map(leaning).collect();
        let all = Transmittance::of_sheet(8, &sheet).unwrap();
        assert_eq!(all.along([7, 3, 4], [false; 3])[..2], [0.98, 0.0]);
        assert_eq!(all.open([7, 3, 4]), [[1.0; 3]; 2]);
    }

    #[test]
    fn what_is_not_a_sheet_takes_its_share_of_what_is_left() {
        let fog = |x| Solid::new([x, 3, 4], DVec3::X, 0.5, [0.0; 3]);
        let all = Transmittance::new(8, &[fog(2), fog(3)]).unwrap();
        assert_eq!(all.along([3, 3, 4], [false, true, false]), [0.5; 3]);
        assert_eq!(all.least([3, 3, 4]), 0.5);
    }
}
