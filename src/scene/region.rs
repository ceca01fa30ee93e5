//! Blocks of cells, both ends in: walls, rectangles and boxes.

use super::error::Fault;
use crate::field::Cell;

/// The cells from one corner to the other, both in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Region {
    pub(super) from: Cell,
    pub(super) to: Cell,
}

impl Region {
    /// The block between two corners, which must lie in a volume of side `size` in their order.
    pub(super) fn checked(from: Cell, to: Cell, size: usize) -> Result<Self, Fault> {
        check_cell(from, size).map_err(|p| p.field("from"))?;
        check_cell(to, size).map_err(|p| p.field("to"))?;
        if let Some(axis) = (0..3).find(|&axis| from[axis] > to[axis]) {
            let name = ["x", "y", "z"][axis];
            let what = format!("the block ends at {name} = {} before it begins at {}", to[axis], from[axis]);
            return Err(Fault::new(what, "`from` holds the smaller x, y and z, `to` the larger").field("to"));
        }
        Ok(Region { from, to })
    }

    /// All cells whose coordinate along `axis` is `at`, in a volume of side `size`.
    pub(super) fn slab(axis: usize, at: usize, size: usize) -> Self {
        let (mut from, mut to) = ([0; 3], [size - 1; 3]);
        (from[axis], to[axis]) = (at, at);
        Region { from, to }
    }

    /// Cells along each axis.
    fn sides(self) -> [usize; 3] {
        std::array::from_fn(|axis| self.to[axis] - self.from[axis] + 1)
    }

    /// Cells along the shortest side.
    pub(super) fn thinnest(self) -> usize {
        let [x, y, z] = self.sides();
        x.min(y).min(z)
    }

    /// How many cells it holds.
    pub(super) fn len(self) -> usize {
        self.sides().iter().product()
    }

    /// Every cell, x fastest, z slowest.
    pub(super) fn cells(self) -> impl Iterator<Item = Cell> {
        let Region { from, to } = self;
        (from[2]..=to[2])
            .flat_map(move |z| (from[1]..=to[1]).flat_map(move |y| (from[0]..=to[0]).map(move |x| [x, y, z])))
    }
}

/// Checks that a cell lies in a volume of side `size`.
pub(super) fn check_cell(cell: Cell, size: usize) -> Result<(), Fault> {
    if cell.iter().all(|c| *c < size) {
        return Ok(());
    }
    let [x, y, z] = cell;
    let what = format!("the cell ({x}, {y}, {z}) lies outside the volume");
    Err(Fault::new(what, format!("x, y and z go from 0 to {}", size - 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_holds_both_its_ends() {
        let region = Region { from: [1, 2, 3], to: [2, 2, 5] };
        let cells: Vec<Cell> = region.cells().collect();
        assert_eq!(cells, [[1, 2, 3], [2, 2, 3], [1, 2, 4], [2, 2, 4], [1, 2, 5], [2, 2, 5]]);
        assert_eq!((region.len(), region.thinnest()), (6, 1));
        assert_eq!(Region::slab(1, 3, 4), Region { from: [0, 3, 0], to: [3, 3, 3] });
    }

    #[test]
    fn blocks_outside_or_the_wrong_way_round_are_refused() {
        assert!(Region::checked([0; 3], [3; 3], 4).is_ok());
        for (from, to) in [([0; 3], [4, 0, 0]), ([0, 4, 0], [3; 3]), ([0, 2, 0], [3, 1, 3])] {
            assert!(Region::checked(from, to, 4).is_err(), "{from:?} {to:?}");
        }
    }
}
