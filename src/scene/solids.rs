//! The solid cells of a scene: what occluders fill, over what a mesh's surface passes through. Where occluders
//! overlap the later one counts, and any counts before the mesh; cells of opacity 0 are cleared, and missing normals
//! come from the gradient of the occupied cells.

use glam::DVec3;

use super::occluder::Filled;
use crate::field::Cell;
use crate::sh::Sh;

/// An occupied cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// The cell.
    pub cell: Cell,
    /// The surface's unit normal. Zero where none was given and the surroundings have none, such as inside
    /// a solid or in a wall one cell thick, and where surfaces of a mesh turn their backs to each other.
    pub normal: DVec3,
    /// How much of the cell is blocked for light along x, y and z, each 0 to 1. A cell that an occluder fills blocks
    /// alike on all axes, a mesh's floor only what falls.
    pub opacity: [f64; 3],
    /// The share of red, green and blue light that is sent back, each 0 to 1.
    pub albedo: [f64; 3],
    /// Where between the cell's borders across x, y and z a mesh's surface stands, 0 to 1, in the mean; `None` where the
    /// cell is filled.
    pub stands: Option<[f64; 3]>,
    /// What fuzzy occlusion takes it to be: a lobe about the normal, scaled by the opacity; of a mesh the sum of such
    /// lobes over its surface in the cell.
    pub blocker: Sh<f64>,
}

impl Solid {
    /// A cell that blocks alike on all axes; `opacity` is above 0 and up to 1. Where the normal is zero the blocker,
    /// [`Sh::lobe`] of it, blocks alike from all sides.
    pub fn new(cell: Cell, normal: DVec3, opacity: f64, albedo: [f64; 3]) -> Self {
        Solid { cell, normal, opacity: [opacity; 3], albedo, stands: None, blocker: Sh::lobe(normal) * opacity }
    }

    /// The most that it blocks along any axis, above 0 and up to 1.
    pub fn most_opaque(&self) -> f64 {
        self.opacity.into_iter().fold(0.0, f64::max)
    }
}

/// The cells that occluders fill, over those of a mesh; both z slowest, x fastest. An occluder of opacity 0 clears
/// the mesh's cells too.
pub(super) fn over(mesh: Vec<Solid>, filled: Vec<Filled>, size: usize) -> Vec<Solid> {
    if mesh.is_empty() || filled.is_empty() {
        return if filled.is_empty() { mesh } else { resolve(filled, size) };
    }
    let order = |cell: &Cell| (cell[2], cell[1], cell[0]);
    let touched: std::collections::HashSet<Cell> = filled.iter().map(|f| f.cell).collect();
    let mut solids: Vec<Solid> = mesh.into_iter().filter(|solid| !touched.contains(&solid.cell)).collect();
    solids.extend(resolve(filled, size));
    solids.sort_by_key(|solid| order(&solid.cell));
    solids
}

/// The solids of a volume of side `size`, z slowest, x fastest; `filled` is in the occluders' order.
fn resolve(mut filled: Vec<Filled>, size: usize) -> Vec<Solid> {
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
    let normal = |f: &Filled| f.normal.unwrap_or_else(|| occupied.normal(f.cell));
    filled.iter().map(|f| Solid::new(f.cell, normal(f), f.opacity, f.albedo)).collect()
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
        let kept: Vec<(Cell, f64)> = solids.iter().map(|b| (b.cell, b.opacity[1])).collect();
        assert_eq!(kept, [([1, 1, 1], 0.25)]);
    }

    #[test]
    fn occluders_stand_over_a_mesh_and_clear_it() {
        let mesh = [[0, 0, 0], [1, 0, 0], [0, 1, 1]].map(|cell| Solid::new(cell, DVec3::X, 0.9, [0.1; 3])).to_vec();
        let solids = over(mesh, vec![filled([1, 0, 0], 0.0), filled([0, 1, 1], 0.5), filled([1, 1, 0], 1.0)], 2);
        let kept: Vec<(Cell, f64)> = solids.iter().map(|b| (b.cell, b.most_opaque())).collect();
        assert_eq!(kept, [([0, 0, 0], 0.9), ([1, 1, 0], 1.0), ([0, 1, 1], 0.5)]);
    }
}
