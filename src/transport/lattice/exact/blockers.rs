//! What occluders that only weaken light, or turn it, make of a finest step, on every level.
//!
//! Fuzzy blockers act on every flux that enters a finest cell, and so do the mirrors of the reflective scheme; both are
//! linear once no clamp acts. So what a finest cell receives of the light that comes in a direction d is a 4×4 matrix
//! G_d in place of the scheme's share M_d, and only in cells that an occluder *touches* are the two different.
//!
//! In one finest step light crosses h²·(h − 1) faces inside a cell of h finest cells a side in every direction, and h²
//! on its way in. With the mean of G_d over either, the step of [`super::leaves`] is
//!
//! ```text
//! V·a' = Σ_d [ inside_d·(V·a − A·own_d) + A·entering_d·beyond_d ]
//! ```
//!
//! own_d the plane of the cell's light next to the face that it leaves through, beyond_d the one beyond the face that it
//! comes in by. Without occluders that is V·T·a + Σ A·(M_in·beyond − M_out·own); with planes that hold the cell's mean it
//! is what a finest step makes of evenly spread light; and at level 0 it is the step itself.
//!
//! So coarse levels are occluded by what stands at the finest, not by means of blockers as with
//! [`crate::transport::lattice::geometry_volume`]: the amplified, limited blocking of a mean is not the mean blocking.

use std::collections::BTreeMap;

use glam::DMat4;

use crate::field::{Cell, Levels, memory_order};
use crate::transport::lattice::face::Direction;

/// A matrix for light that travels in each of [`Direction::ALL`].
pub type Ways = [DMat4; 6];

/// What a finest step is among occluders, by level.
#[derive(Clone, Debug)]
pub struct Blockers {
    /// M_d: the share of cells that nothing touches.
    free: Ways,
    levels: Vec<Level>,
}

/// The touched cells of a level, in the order of memory.
#[derive(Clone, Debug, Default)]
struct Level {
    cells: Vec<Cell>,
    entering: Vec<Ways>,
    /// Nothing crosses inside of finest cells: there are none at level 0.
    inside: Vec<Ways>,
}

/// The mean matrices of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Means<'a> {
    /// Of what goes from one finest cell in it to another.
    pub(super) inside: &'a Ways,
    /// Of what enters it.
    pub(super) entering: &'a Ways,
}

impl Blockers {
    /// From what the `touched` finest cells, in the order of memory, receive of each direction; all others receive what
    /// `free` says.
    pub fn new(sizes: Levels, free: Ways, touched: impl IntoIterator<Item = (Cell, Ways)>) -> Self {
        let (cells, entering) = touched.into_iter().unzip();
        let mut levels = vec![Level { cells, entering, inside: Vec::new() }];
        for i in 1..sizes.count() {
            levels.push(levels[i - 1].parents(&free, f64::from(1u32 << (i - 1))));
        }
        Blockers { free, levels }
    }

    /// The touched cells of a level, in the order of memory.
    pub(super) fn touched(&self, level: usize) -> &[Cell] {
        &self.levels[level].cells
    }

    /// The means of a cell of a level, if anything touches it.
    pub(super) fn means(&self, level: usize, cell: Cell) -> Option<Means<'_>> {
        let touched = &self.levels[level];
        let at = touched.cells.binary_search_by_key(&memory_order(cell), |cell| memory_order(*cell)).ok()?;
        Some(Means { inside: touched.inside.get(at).unwrap_or(&self.free), entering: &touched.entering[at] })
    }

    /// The largest that all finest cells' matrices, put together, multiply a coefficient by.
    pub fn norm(&self) -> f64 {
        let of = |ways: &Ways| ways.iter().map(norm).sum::<f64>();
        let touched = self.levels.iter().flat_map(|level| level.inside.iter().chain(&level.entering));
        touched.chain([&self.free]).map(of).fold(0.0, f64::max)
    }

    /// Bytes of memory that they hold.
    pub fn bytes(&self) -> usize {
        let of = |level: &Level| {
            size_of_val(level.cells.as_slice()) + size_of_val(&level.entering[..]) + size_of_val(&level.inside[..])
        };
        self.levels.iter().map(of).sum()
    }

    /// Bytes that so many touched cells of a level take.
    pub fn bytes_of(level: usize, cells: usize) -> usize {
        cells * (size_of::<Cell>() + size_of::<Ways>() * if level == 0 { 1 } else { 2 })
    }
}

/// The largest that a matrix multiplies a coefficient by.
pub(super) fn norm(matrix: &DMat4) -> f64 {
    (0..4).map(|row| matrix.row(row).abs().element_sum()).fold(0.0, f64::max)
}

impl Level {
    /// The cells that hold any of these, which are `h` finest cells wide.
    fn parents(&self, free: &Ways, h: f64) -> Self {
        let mut parents: BTreeMap<[usize; 3], [Ways; 2]> = BTreeMap::new();
        // In units of h²: 8·(h − 1) faces inside the children and 4 between them; 4 by which light enters.
        let (of_inside, of_entering) = (1.0 / (8.0 * h - 4.0), 0.25);
        for (i, cell) in self.cells.iter().enumerate() {
            let (child_inside, child_entering) = (self.inside.get(i).unwrap_or(free), &self.entering[i]);
            let [inside, entering] = parents.entry(memory_order(cell.map(|c| c / 2))).or_insert([*free, *free]);
            for (d, direction) in Direction::ALL.into_iter().enumerate() {
                inside[d] += (child_inside[d] - free[d]) * ((h - 1.0) * of_inside);
                let is_lower = cell[direction.axis()] % 2 == 0;
                let change = child_entering[d] - free[d];
                if is_lower == direction.is_positive() {
                    entering[d] += change * of_entering;
                } else {
                    inside[d] += change * of_inside;
                }
            }
        }
        let mut level = Level::default();
        for ([z, y, x], [inside, entering]) in parents {
            level.cells.push([x, y, z]);
            level.inside.push(inside);
            level.entering.push(entering);
        }
        level
    }
}
