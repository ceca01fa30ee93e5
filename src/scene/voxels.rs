//! Triangles into cells (001, 4.1; the geometry volume of 000, 5.2).
//!
//! Each triangle is clipped to every cell that it touches, axis by axis. Per cell add up the area a (in units of a
//! cell's side squared), a·n, a·|n_k| for each axis k, and a·ρ. Then
//!
//! ```text
//! opacity on axis k   min(1, Σ a·|n_k|)       what the surface covers seen along k
//! albedo              Σ a·ρ / Σ a
//! blocker             Σ a·(L(n) + L(−n))      both sides of a sheet, for fuzzy occlusion
//! normal              along Σ a·n
//! ```
//!
//! One opacity for all axes would be wrong: a floor stops what falls and not what passes along it. A blocker about
//! the mean normal would be wrong too: it cancels in a cell with two faces.
//!
//! Corners within rounding of a border between cells count as on it, and what lies on a border belongs to the upper
//! cell, at the volume's upper border to the last: so a wall is in one layer of cells, whole.

use glam::DVec3;

use super::placement::Placement;
use super::solids::Solid;
use crate::field::Cell;
use crate::mesh::Mesh;
use crate::sh::Sh;

/// What a mesh is to the cells of a volume.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Voxels {
    /// The occupied cells, z slowest and x fastest.
    pub solids: Vec<Solid>,
    /// By occupied cell, the surface in it in m², one side.
    pub areas: Vec<f64>,
}

impl Voxels {
    /// The cells of a volume that a mesh's surface passes through. `None` if there are more than `most`.
    pub fn new(mesh: &Mesh, placement: &Placement, most: usize) -> Option<Self> {
        let n = placement.size;
        let mut places = vec![NONE; n.pow(3)];
        let mut parts: Vec<(u32, Part)> = Vec::new();
        let mut clip = Clip::default();
        for triangle in 0..mesh.len() {
            let corners = mesh.corners(triangle).map(|corner| on_border(placement.in_cells(corner), n));
            let (normal, albedo) = (mesh.normal(triangle), mesh.albedo(triangle));
            clip.cells(corners, n, |cell, area, middle| {
                let i = (cell[2] * n + cell[1]) * n + cell[0];
                let place = &mut places[i];
                if *place == NONE {
                    *place = parts.len() as u32;
                    parts.push((i as u32, Part::default()));
                }
                parts[*place as usize].1.add(area, middle, normal, albedo);
            });
            if parts.len() > most {
                return None;
            }
        }
        parts.sort_unstable_by_key(|(i, _)| *i);
        let s2 = placement.cell_side * placement.cell_side;
        let cell = |i: u32| [i as usize % n, i as usize / n % n, i as usize / (n * n)];
        Some(Voxels {
            solids: parts.iter().map(|(i, part)| part.solid(cell(*i))).collect(),
            areas: parts.iter().map(|(_, part)| part.area * s2).collect(),
        })
    }
}

const NONE: u32 = u32::MAX;

/// What is known of the surface in a cell; areas in units of a cell's side squared.
#[derive(Clone, Copy, Default)]
struct Part {
    area: f64,
    /// Σ a·n.
    normal: DVec3,
    /// Σ a·|n_k|.
    covers: DVec3,
    /// Σ a·|n_k|·x_k, x the place in the cell.
    stands: DVec3,
    /// Σ a·ρ.
    albedo: [f64; 3],
}

impl Part {
    fn add(&mut self, area: f64, middle: DVec3, normal: DVec3, albedo: [f64; 3]) {
        self.area += area;
        self.normal += normal * area;
        self.covers += normal.abs() * area;
        self.stands += normal.abs() * area * middle;
        (0..3).for_each(|c| self.albedo[c] += albedo[c] * area);
    }

    fn solid(&self, cell: Cell) -> Solid {
        // L(n) + L(−n) is the same for every n: the parts along n cancel.
        let both_sides = Sh::<f64>::lobe(DVec3::X) + Sh::lobe(DVec3::NEG_X);
        Solid {
            cell,
            // Two faces of a thin wall cancel but for rounding.
            normal: if self.normal.length() > 1e-9 * self.area { self.normal.normalize() } else { DVec3::ZERO },
            opacity: self.covers.to_array().map(|covered| covered.min(1.0)),
            albedo: self.albedo.map(|albedo| (albedo / self.area).min(1.0)),
            stands: Some([0, 1, 2].map(|k| if self.covers[k] > 0.0 { self.stands[k] / self.covers[k] } else { 0.5 })),
            blocker: both_sides * self.area,
        }
    }
}

/// A place in cells, with coordinates that rounding moved off a border between cells put back onto it.
fn on_border(place: DVec3, n: usize) -> DVec3 {
    // Corners are held in single precision, 6·10⁻⁸ of their coordinate; a volume is that many cells wide.
    let slack = 4e-7 * n as f64;
    let nearest = place.round();
    let off = (place - nearest).abs();
    DVec3::select(off.cmple(DVec3::splat(slack)), nearest, place)
}

/// Polygons in clipping, kept for the next triangle.
#[derive(Default)]
struct Clip {
    slab: Vec<DVec3>,
    row: Vec<DVec3>,
    piece: Vec<DVec3>,
}

impl Clip {
    /// Calls `each` with every cell of an n³ volume that a triangle (in cells) touches, its area there, and the middle
    /// of that, from the cell's corner.
    fn cells(&mut self, corners: [DVec3; 3], n: usize, mut each: impl FnMut(Cell, f64, DVec3)) {
        let Clip { slab, row, piece } = self;
        for z in layers(&corners, 2, n) {
            clip(&corners, 2, z, slab);
            for y in layers(slab, 1, n) {
                clip(slab, 1, y, row);
                for x in layers(row, 0, n) {
                    clip(row, 0, x, piece);
                    let (area, middle) = area(piece);
                    if area > 0.0 {
                        let corner = DVec3::new(x as f64, y as f64, z as f64);
                        each([x, y, z], area, (middle - corner).clamp(DVec3::ZERO, DVec3::ONE));
                    }
                }
            }
        }
    }
}

/// The layers of cells across an axis that a polygon touches inside an n³ volume.
fn layers(polygon: &[DVec3], axis: usize, n: usize) -> std::ops::Range<usize> {
    let along = polygon.iter().map(|p| p[axis]);
    let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)));
    let n = n as f64;
    if !(low <= n && high >= 0.0) {
        return 0..0;
    }
    // A polygon that lies in a border belongs to the layer above it, at the upper border to the last.
    let first = low.floor().clamp(0.0, n - 1.0);
    let end = if low == high { first + 1.0 } else { high.ceil().clamp(first + 1.0, n) };
    first as usize..end as usize
}

/// What of a convex polygon lies in a layer of cells, from `layer` to `layer` + 1 along an axis.
fn clip(polygon: &[DVec3], axis: usize, layer: usize, into: &mut Vec<DVec3>) {
    into.clear();
    let (low, high) = (layer as f64, layer as f64 + 1.0);
    let Some(mut before) = polygon.last().copied() else { return };
    for &p in polygon {
        let (from, to) = (before[axis], p[axis]);
        // The borders that the side crosses, in the order in which it does.
        let borders = if from < to { [low, high] } else { [high, low] };
        for border in borders {
            if (from < border && to > border) || (from > border && to < border) {
                let mut at = before + (p - before) * ((border - from) / (to - from));
                at[axis] = border;
                into.push(at);
            }
        }
        if to >= low && to <= high {
            into.push(p);
        }
        before = p;
    }
}

/// The area of a flat convex polygon, and its centre of mass.
fn area(polygon: &[DVec3]) -> (f64, DVec3) {
    let Some(first) = polygon.first() else { return (0.0, DVec3::ZERO) };
    let (mut area, mut sum) = (0.0, DVec3::ZERO);
    for pair in polygon.windows(2) {
        let triangle = (pair[0] - first).cross(pair[1] - first).length() / 2.0;
        area += triangle;
        sum += triangle * (first + pair[0] + pair[1]) / 3.0;
    }
    (area, if area > 0.0 { sum / area } else { *first })
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::mesh::Material;
    use crate::scene::mesh_scene::Volume;

    fn mesh(corners: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
        let corners = corners.iter().map(|c| Vec3::from_array(*c)).collect();
        let paint = Material { albedo: [0.2, 0.4, 0.6], ..Material::grey("") };
        Mesh::new(corners, triangles.to_vec(), vec![0; triangles.len()], vec![paint]).unwrap()
    }

    fn cube(n: usize) -> Placement {
        Placement::new(Volume::Cube { center: [0.5; 3], side: 1.0 }, [DVec3::ZERO; 2], n)
    }

    #[test]
    fn an_axis_aligned_wall_is_one_layer_thick_shut_across_and_open_along() {
        for (height, layer) in [(0.0, 0), (0.3, 2), (0.5, 4), (1.0, 7)] {
            let corners = [[0.0, height, 0.0], [1.0, height, 0.0], [1.0, height, 1.0], [0.0, height, 1.0]];
            let voxels = Voxels::new(&mesh(&corners, &[[0, 1, 2], [0, 2, 3]]), &cube(8), 1 << 20).unwrap();
            assert_eq!(voxels.solids.len(), 64, "{height}");
            for (solid, area) in voxels.solids.iter().zip(&voxels.areas) {
                assert_eq!(solid.cell[1], layer);
                assert!((solid.opacity[1] - 1.0).abs() < 1e-12 && solid.opacity[0] + solid.opacity[2] == 0.0);
                assert!((area - 1.0 / 64.0).abs() < 1e-12);
                assert!((solid.normal - DVec3::NEG_Y).length() < 1e-12);
                assert!((0..3).all(|c| (solid.albedo[c] - [0.2, 0.4, 0.6][c]).abs() < 1e-6));
                assert!((solid.blocker.0[0] - std::f64::consts::PI.sqrt()).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_slanted_wall_covers_what_its_projection_covers() {
        // The plane x = y, from z = 0 to 1: through the cells of the diagonal, corner to corner.
        let corners = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [0.0, 0.0, 1.0]];
        let voxels = Voxels::new(&mesh(&corners, &[[0, 1, 2], [0, 2, 3]]), &cube(8), 1 << 20).unwrap();
        assert_eq!(voxels.solids.len(), 64);
        for solid in &voxels.solids {
            assert_eq!(solid.cell[0], solid.cell[1]);
            assert!((solid.opacity[0] - 1.0).abs() < 1e-6 && (solid.opacity[1] - 1.0).abs() < 1e-6);
            assert_eq!(solid.opacity[2], 0.0);
        }
    }

    #[test]
    fn the_areas_of_all_cells_are_the_meshs_wherever_it_lies() {
        let corners = [[0.11, 0.23, 0.37], [0.93, 0.31, 0.71], [0.42, 0.88, 0.15], [0.6, 0.1, 0.9]];
        let mesh = mesh(&corners, &[[0, 1, 2], [1, 2, 3], [0, 3, 2]]);
        for n in [1, 2, 8, 32] {
            let voxels = Voxels::new(&mesh, &cube(n), 1 << 20).unwrap();
            let sum: f64 = voxels.areas.iter().sum();
            assert!((sum / mesh.total_area() - 1.0).abs() < 1e-9, "{n}: {sum}");
        }
        // What stands out of the volume is left out: the half of a square.
        let square = [[0.0, 0.5, 0.5], [2.0, 0.5, 0.5], [2.0, 0.5, 1.0], [0.0, 0.5, 1.0]];
        let half = Voxels::new(&self::mesh(&square, &[[0, 1, 2], [0, 2, 3]]), &cube(4), 1 << 20).unwrap();
        assert!((half.areas.iter().sum::<f64>() - 0.5).abs() < 1e-9);
        assert_eq!(Voxels::new(&mesh, &cube(32), 3), None);
    }

    #[test]
    fn two_faces_in_a_cell_add_up_and_have_no_normal() {
        let corners = [
            [0.0, 0.55, 0.0],
            [1.0, 0.55, 0.0],
            [1.0, 0.55, 1.0],
            [0.0, 0.55, 1.0],
            [0.0, 0.6, 0.0],
            [1.0, 0.6, 0.0],
            [1.0, 0.6, 1.0],
            [0.0, 0.6, 1.0],
        ];
        let voxels =
            Voxels::new(&mesh(&corners, &[[0, 1, 2], [0, 2, 3], [5, 4, 6], [6, 4, 7]]), &cube(4), 1 << 20).unwrap();
        assert_eq!(voxels.solids.len(), 16);
        for solid in &voxels.solids {
            assert_eq!((solid.normal, solid.opacity[1]), (DVec3::ZERO, 1.0));
            assert!((solid.blocker.0[0] - 2.0 * std::f64::consts::PI.sqrt()).abs() < 1e-9);
        }
    }
}
