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

use crate::field::{Cell, Levels};
use crate::transport::lattice::face::Direction;

/// A matrix for light that travels in each of [`Direction::ALL`].
pub type Ways = [DMat4; 6];

/// What a finest step is among occluders, by level.
#[derive(Clone, Debug)]
pub struct Blockers {
    /// M_d: the share of cells that nothing touches.
    free: Ways,
    /// The touched cells of every level, in the order of memory.
    levels: Vec<Vec<(Cell, Means)>>,
}

/// The mean matrices of a cell.
#[derive(Clone, Debug)]
pub(super) struct Means {
    /// Of what goes from one finest cell in it to another.
    pub(super) inside: Ways,
    /// Of what enters it.
    pub(super) entering: Ways,
}

impl Blockers {
    /// From what the `touched` finest cells receive of each direction; all others receive what `free` says.
    pub fn new(sizes: Levels, free: Ways, touched: impl IntoIterator<Item = (Cell, Ways)>) -> Self {
        let means = |(cell, entering)| (cell, Means { inside: free, entering });
        let mut finest: Vec<(Cell, Means)> = touched.into_iter().map(means).collect();
        finest.sort_by_key(|(cell, _)| order(*cell));
        let mut levels = vec![finest];
        for i in 1..sizes.count() {
            levels.push(parents(&levels[i - 1], &free, f64::from(1u32 << (i - 1))));
        }
        Blockers { free, levels }
    }

    /// The touched cells of a level, in the order of memory.
    pub(super) fn touched(&self, level: usize) -> impl Iterator<Item = Cell> + '_ {
        self.levels[level].iter().map(|(cell, _)| *cell)
    }

    /// The means of a cell of a level, if anything touches it.
    pub(super) fn means(&self, level: usize, cell: Cell) -> Option<&Means> {
        let touched = &self.levels[level];
        let at = touched.binary_search_by_key(&order(cell), |(cell, _)| order(*cell)).ok()?;
        Some(&touched[at].1)
    }

    /// The largest that all finest cells' matrices, put together, multiply a coefficient by.
    pub fn norm(&self) -> f64 {
        let of = |ways: &Ways| ways.iter().map(norm).sum::<f64>();
        let touched = self.levels.iter().flatten().flat_map(|(_, means)| [&means.inside, &means.entering]);
        touched.chain([&self.free]).map(of).fold(0.0, f64::max)
    }

    /// Bytes of memory that they hold.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| level.capacity() * size_of::<(Cell, Means)>()).sum()
    }
}

/// The largest that a matrix multiplies a coefficient by.
pub(super) fn norm(matrix: &DMat4) -> f64 {
    (0..4).map(|row| matrix.row(row).abs().element_sum()).fold(0.0, f64::max)
}

/// The order of memory.
fn order([x, y, z]: Cell) -> Cell {
    [z, y, x]
}

/// The cells that hold any of the `touched`, which are `h` finest cells wide.
fn parents(touched: &[(Cell, Means)], free: &Ways, h: f64) -> Vec<(Cell, Means)> {
    let mut parents: BTreeMap<Cell, Means> = BTreeMap::new();
    // In units of h²: 8·(h − 1) faces inside the children and 4 between them; 4 by which light enters.
    let (inside, entering) = (1.0 / (8.0 * h - 4.0), 0.25);
    for (cell, child) in touched {
        let none = || Means { inside: *free, entering: *free };
        let parent = parents.entry(order(cell.map(|c| c / 2))).or_insert_with(none);
        for (d, direction) in Direction::ALL.into_iter().enumerate() {
            parent.inside[d] += (child.inside[d] - free[d]) * ((h - 1.0) * inside);
            let is_lower = cell[direction.axis()] % 2 == 0;
            if is_lower == direction.is_positive() {
                parent.entering[d] += (child.entering[d] - free[d]) * entering;
            } else {
                parent.inside[d] += (child.entering[d] - free[d]) * inside;
            }
        }
    }
    parents.into_iter().map(|(at, means)| (order(at), means)).collect()
}
