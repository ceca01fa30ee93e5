//! From the cells that occluders fill to a scene's blockers: where occluders overlap the later one counts,
//! cells of opacity 0 are cleared, and missing normals come from the gradient of the occupied cells.

use glam::DVec3;

use super::occluder::Filled;
use crate::field::Cell;

/// An occupied cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// The cell.
    pub cell: Cell,
    /// The surface's unit normal. Zero where none was given and the surroundings have none, such as inside
    /// a solid or in a wall one cell thick: [`Sh::lobe`] of it then blocks alike from all sides.
    pub normal: DVec3,
    /// How much of the cell is blocked, above 0 and up to 1.
    pub opacity: f64,
    /// The share of red, green and blue light that is sent back, each 0 to 1.
    pub albedo: [f64; 3],
}

/// The blockers of a volume of side `size`, z slowest, x fastest; `filled` is in the occluders' order.
pub(super) fn resolve(mut filled: Vec<Filled>, size: usize) -> Vec<Solid> {
    // The sort is stable: one cell's entries stay in the occluders' order.
    filled.sort_by_key(|f| (f.cell[2], f.cell[1], f.cell[0]));
    filled.dedup_by(|later, kept| {
        let same = later.cell == kept.cell;
        if same {
            *kept = *later;
        }
        same
    });
    filled.retain(|f| f.opacity > 0.0);
    let occupied = Occupied::new(&filled, size);
    let block = |f: &Filled| Solid {
        cell: f.cell,
        normal: f.normal.unwrap_or_else(|| occupied.normal(f.cell)),
        opacity: f.opacity,
        albedo: f.albedo,
    };
    filled.iter().map(block).collect()
}

/// Which cells are occupied, a bit each.
struct Occupied {
    size: usize,
    bits: Vec<u64>,
}

impl Occupied {
    fn new(filled: &[Filled], size: usize) -> Self {
        let words = if filled.is_empty() { 0 } else { size.pow(3).div_ceil(64) };
        let mut occupied = Occupied { size, bits: vec![0; words] };
        for f in filled {
            let i = occupied.index(f.cell);
            occupied.bits[i / 64] |= 1 << (i % 64);
        }
        occupied
    }

    fn index(&self, [x, y, z]: Cell) -> usize {
        (z * self.size + y) * self.size + x
    }

    /// The unit vector from the occupied towards the empty cells around `cell`, by Sobel's weights on
    /// 3³ cells; zero where they balance. Beyond the volume the outermost cells go on, so that walls
    /// at its border face inwards.
    fn normal(&self, cell: Cell) -> DVec3 {
        let mut out = DVec3::ZERO;
        for [x, y, z] in (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]) {
            let beside = |axis: usize, offset: usize| (cell[axis] + offset).clamp(1, self.size) - 1;
            let i = self.index([beside(0, x), beside(1, y), beside(2, z)]);
            if self.bits[i / 64] >> (i % 64) & 1 == 1 {
                let weight = |offset: usize| if offset == 1 { 2.0 } else { 1.0 };
                let slope = |offset: usize| offset as f64 - 1.0;
                out -= DVec3::new(
                    slope(x) * weight(y) * weight(z),
                    weight(x) * slope(y) * weight(z),
                    weight(x) * weight(y) * slope(z),
                );
            }
        }
        // The sums are whole numbers: a balance is exactly zero.
        out.normalize_or_zero()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(cell: Cell, opacity: f64) -> Filled {
        Filled { cell, normal: None, opacity, albedo: [0.0; 3] }
    }

    fn block(from: Cell, to: Cell) -> Vec<Filled> {
        let region = super::super::region::Region { from, to };
        region.cells().map(|cell| filled(cell, 1.0)).collect()
    }

    fn normal_at(solids: &[Solid], cell: Cell) -> DVec3 {
        solids.iter().find(|b| b.cell == cell).unwrap().normal
    }

    #[test]
    fn a_solids_faces_and_corners_face_outwards_and_its_inside_has_no_normal() {
        let solids = resolve(block([2, 2, 2], [5, 5, 5]), 8);
        assert_eq!(normal_at(&solids, [2, 3, 4]), DVec3::NEG_X);
        assert_eq!(normal_at(&solids, [3, 5, 4]), DVec3::Y);
        assert_eq!(normal_at(&solids, [3, 4, 3]), DVec3::ZERO);
        assert!((normal_at(&solids, [5, 5, 2]) - DVec3::new(1.0, 1.0, -1.0).normalize()).length() < 1e-12);
    }

    #[test]
    fn walls_at_the_border_face_inwards_and_thin_ones_inside_have_no_normal() {
        let floor = resolve(block([0, 0, 0], [7, 0, 7]), 8);
        assert!(floor.iter().all(|b| b.normal == DVec3::Y));
        let ceiling = resolve(block([0, 7, 0], [7, 7, 7]), 8);
        assert!(ceiling.iter().all(|b| b.normal == DVec3::NEG_Y));
        let thin = resolve(block([0, 4, 0], [7, 4, 7]), 8);
        assert!(thin.iter().all(|b| b.normal == DVec3::ZERO));
        assert_eq!(resolve(block([0; 3], [0; 3]), 1)[0].normal, DVec3::ZERO);
    }

    #[test]
    fn the_later_occluder_counts_and_opacity_zero_clears() {
        let solids = resolve(
            vec![filled([1, 1, 1], 1.0), filled([0, 0, 0], 0.5), filled([1, 1, 1], 0.25), filled([0, 0, 0], 0.0)],
            2,
        );
        let kept: Vec<(Cell, f64)> = solids.iter().map(|b| (b.cell, b.opacity)).collect();
        assert_eq!(kept, [([1, 1, 1], 0.25)]);
    }
}
