//! Where a volume of cells lies among metres.

use glam::DVec3;

use super::mesh_scene::Volume;
use crate::field::Cell;

/// A volume of n³ cells in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The corner of cell (0, 0, 0) that all others lie behind, in metres.
    pub origin: DVec3,
    /// The side of a cell, s, in metres.
    pub cell_side: f64,
    /// Cells along a side, n.
    pub size: usize,
}

impl Placement {
    /// The volume that a document asks for around a mesh of these bounds.
    pub fn new(volume: Volume, [low, high]: [DVec3; 2], size: usize) -> Self {
        let n = size as f64;
        let (center, side) = match volume {
            Volume::Fit { margin } => {
                let longest = (high - low).max_element();
                ((low + high) / 2.0, longest * n / (n - 2.0 * margin))
            }
            Volume::Cube { center, side } => (DVec3::from_array(center), side),
        };
        Placement { origin: center - DVec3::splat(side / 2.0), cell_side: side / n, size }
    }

    /// A point in cells from the origin: cell (x, y, z) spans x to x + 1 and so on.
    pub fn in_cells(&self, point: DVec3) -> DVec3 {
        (point - self.origin) / self.cell_side
    }

    /// The point in metres at a place in cells.
    pub fn in_metres(&self, place: DVec3) -> DVec3 {
        self.origin + place * self.cell_side
    }

    /// The middle of a cell, in metres.
    pub fn middle(&self, cell: Cell) -> DVec3 {
        self.in_metres(DVec3::from_array(cell.map(|c| c as f64 + 0.5)))
    }

    /// The cell that a point lies in, if any. What lies on a border between two belongs to the upper one, on the
    /// volume's upper border to the last; what rounding moved out of the volume, by less than 10⁻⁶ of a cell, is on its
    /// border.
    pub fn cell_of(&self, point: DVec3) -> Option<Cell> {
        const SLACK: f64 = 1e-6;
        let (at, n) = (self.in_cells(point), self.size as f64);
        let inside = at.cmpge(DVec3::splat(-SLACK)).all() && at.cmple(DVec3::splat(n + SLACK)).all();
        inside.then(|| at.to_array().map(|c| c.floor().clamp(0.0, n - 1.0) as usize))
    }

    /// The volume's corners with the smallest and the largest coordinates, in metres.
    pub fn bounds(&self) -> [DVec3; 2] {
        [self.origin, self.in_metres(DVec3::splat(self.size as f64))]
    }

    /// The same cells, moved by a part of a cell's side along every axis.
    pub fn moved(&self, cells: f64) -> Self {
        Placement { origin: self.origin + DVec3::splat(cells * self.cell_side), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_volume_fits_its_mesh_with_its_margin() {
        let bounds = [DVec3::new(-1.0, 0.0, 2.0), DVec3::new(3.0, 2.0, 3.0)];
        let volume = Placement::new(Volume::Fit { margin: 0.0 }, bounds, 8);
        assert_eq!((volume.cell_side, volume.origin), (0.5, DVec3::new(-1.0, -1.0, 0.5)));
        let volume = Placement::new(Volume::Fit { margin: 2.0 }, bounds, 8);
        assert_eq!((volume.cell_side, volume.in_cells(bounds[0]).x), (1.0, 2.0));
        assert_eq!(volume.in_cells(bounds[1]).x, 6.0);
        assert_eq!(volume.cell_of(DVec3::new(1.0, 1.0, 2.5)), Some([4, 4, 4]));
        assert_eq!(volume.cell_of(volume.bounds()[1]), Some([7; 3]));
        assert_eq!(volume.cell_of(volume.bounds()[1] + DVec3::X * 1e-3), None);
        assert_eq!(volume.middle([4, 4, 4]), DVec3::new(1.5, 1.5, 3.0));
    }
}
