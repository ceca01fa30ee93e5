//! Cuts triangles along the cells of a cubic lattice.
//!
//! A triangle is clipped axis by axis (Sutherland and Hodgman 1974): to slabs across x, each of them to rows across
//! y, and those to cells. The parts of a triangle sum to its area, but for what lies outside the lattice.
//!
//! A triangle in the plane between two cells belongs to the upper one, and on the lattice's upper border to the last.
//! Corners within `SNAP` of a plane between cells count as in it, so that rounding does not part such a triangle.

use glam::DVec3;

use super::Mesh;

/// In cells.
const SNAP: f64 = 1e-6;
/// Parts of less area, in squares of a cell's side, are nothing but rounding.
const LEAST_AREA: f64 = 1e-12;
/// Corners of a triangle that was clipped by two planes on each of three axes, at most.
const MOST_CORNERS: usize = 9;

/// What of a triangle lies in one cell: a convex polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// The cell, from 0 on each axis.
    pub cell: [usize; 3],
    /// The triangle's number in its mesh.
    pub triangle: usize,
    /// Its area, in squares of a cell's side.
    pub area: f64,
    polygon: Polygon,
}

impl Part {
    /// Its corners, in cells from the lattice's origin, running as the triangle's do.
    pub fn corners(&self) -> &[DVec3] {
        self.polygon.corners()
    }

    /// Its centre of mass, in cells from the lattice's origin.
    pub fn middle(&self) -> DVec3 {
        let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
        for [a, b, c] in self.triangles() {
            let area = (b - a).cross(c - a).length();
            sum += area * (a + b + c) / 3.0;
            weight += area;
        }
        sum / weight
    }

    /// The triangles that make it up, a fan.
    pub fn triangles(&self) -> impl Iterator<Item = [DVec3; 3]> {
        let corners = self.corners();
        (2..corners.len()).map(move |i| [corners[0], corners[i - 1], corners[i]])
    }
}

/// Gives every part of a mesh in a lattice of `size`³ cells of side `side`, the first one's lower corner at `origin`,
/// both in metres.
///
/// ```
/// use glam::{DVec3, Vec3};
/// use lpv_lab::mesh::{Material, Mesh, cut};
///
/// let corners = vec![Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0];
/// let mesh = Mesh::new(corners, vec![[0, 1, 2]], vec![0], vec![Material::grey("")]).unwrap();
/// let mut areas = Vec::new();
/// cut::parts(&mesh, DVec3::ZERO, 1.0, 4, |part| areas.push((part.cell, part.area)));
/// assert_eq!(areas, [([0, 0, 0], 1.0), ([0, 1, 0], 0.5), ([1, 0, 0], 0.5)]);
/// ```
pub fn parts(mesh: &Mesh, origin: DVec3, side: f64, size: usize, mut each: impl FnMut(Part)) {
    for triangle in 0..mesh.len() {
        let corners = mesh.corners(triangle).map(|corner| snapped((corner - origin) / side));
        slabs(&Polygon::new(&corners), 0, size, &mut |x, slab| {
            slabs(slab, 1, size, &mut |y, row| {
                slabs(row, 2, size, &mut |z, polygon| {
                    let area = polygon.area();
                    if area > LEAST_AREA {
                        each(Part { cell: [x, y, z], triangle, area, polygon: *polygon });
                    }
                });
            });
        });
    }
}

/// What of a polygon lies in each slab across an axis.
fn slabs(polygon: &Polygon, axis: usize, size: usize, each: &mut dyn FnMut(usize, &Polygon)) {
    let along = |corner: &DVec3| corner[axis];
    let low = polygon.corners().iter().map(along).fold(f64::INFINITY, f64::min);
    let high = polygon.corners().iter().map(along).fold(f64::NEG_INFINITY, f64::max);
    let last = size as f64;
    if polygon.corners().is_empty() || high < 0.0 || low > last {
        return;
    }
    let cell = |at: f64| (at.max(0.0) as usize).min(size - 1);
    if low == high {
        return each(cell(low), polygon);
    }
    // A polygon that ends on the plane between two cells does not reach into the upper one.
    for i in cell(low)..=cell(high.ceil() - 1.0) {
        let (from, to) = (i as f64, (i + 1) as f64);
        if low >= from && high <= to {
            each(i, polygon);
        } else {
            each(i, &polygon.clipped(axis, 1.0, from).clipped(axis, -1.0, -to));
        }
    }
}

/// A corner moved onto planes between cells that it is close to.
fn snapped(corner: DVec3) -> DVec3 {
    let near = |at: f64| if (at - at.round()).abs() < SNAP { at.round() } else { at };
    DVec3::from_array(corner.to_array().map(near))
}

/// A convex polygon of few corners.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Polygon {
    corners: [DVec3; MOST_CORNERS],
    count: usize,
}

impl Polygon {
    fn new(corners: &[DVec3]) -> Self {
        let mut polygon = Polygon { corners: [DVec3::ZERO; MOST_CORNERS], count: 0 };
        corners.iter().for_each(|corner| polygon.push(*corner));
        polygon
    }

    fn push(&mut self, corner: DVec3) {
        if self.count < MOST_CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    fn area(&self) -> f64 {
        let corners = self.corners();
        let across = |i: usize| (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]);
        0.5 * (2..corners.len()).map(across).sum::<DVec3>().length()
    }

    /// The part where `sign` times the coordinate is at least `least`.
    fn clipped(&self, axis: usize, sign: f64, least: f64) -> Polygon {
        let mut kept = Polygon::new(&[]);
        let corners = self.corners();
        for (i, corner) in corners.iter().enumerate() {
            let next = corners[(i + 1) % corners.len()];
            let (here, there) = (sign * corner[axis] - least, sign * next[axis] - least);
            if here >= 0.0 {
                kept.push(*corner);
            }
            if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
                let mut crossing = corner.lerp(next, here / (here - there));
                crossing[axis] = sign * least;
                kept.push(crossing);
            }
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Material;
    use glam::Vec3;

    fn mesh(triangles: &[[Vec3; 3]]) -> Mesh {
        let count = triangles.len() as u32;
        let vertices = triangles.iter().flatten().copied().collect();
        let numbers = (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        Mesh::new(vertices, numbers, vec![0; count as usize], vec![Material::grey("")]).unwrap()
    }

    fn all(mesh: &Mesh, origin: DVec3, side: f64, size: usize) -> Vec<Part> {
        let mut all = Vec::new();
        parts(mesh, origin, side, size, |part| all.push(part));
        all
    }

    /// Triangles here and there, the same in every run.
    fn scattered() -> Mesh {
        let mut state = 3u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 24) as f32 * 8.0
        };
        let triangles: Vec<[Vec3; 3]> =
            (0..60).map(|_| [(); 3].map(|()| Vec3::new(number(), number(), number()))).collect();
        mesh(&triangles)
    }

    #[test]
    fn the_parts_of_triangles_sum_to_their_areas_and_lie_in_their_cells() {
        let mesh = scattered();
        for (side, size) in [(1.0, 8), (0.25, 32), (8.0, 1), (0.37, 22)] {
            let mut areas = vec![0.0; mesh.len()];
            for part in all(&mesh, DVec3::ZERO, side, size) {
                areas[part.triangle] += part.area * side * side;
                for corner in part.corners() {
                    let inside = |a: usize| (corner[a] - part.cell[a] as f64 - 0.5).abs() <= 0.5 + 1e-9;
                    assert!((0..3).all(inside), "{part:?}");
                }
                let middle = part.middle();
                assert!((0..3).all(|a| middle[a].floor() as usize == part.cell[a] || part.area < 1e-9));
            }
            for (triangle, area) in areas.iter().enumerate() {
                assert!((area / mesh.area(triangle) - 1.0).abs() < 1e-5, "{side} {triangle}: {area}");
            }
        }
    }

    #[test]
    fn what_lies_between_cells_belongs_to_the_upper_one_and_on_the_border_to_the_last() {
        let across = |x: f32| [Vec3::new(x, 0.2, 0.2), Vec3::new(x, 0.8, 0.2), Vec3::new(x, 0.2, 0.8)];
        for (x, cell) in [(0.0, 0), (0.5, 0), (1.0, 1), (1.0 + 1e-7, 1), (1.0 - 1e-7, 1), (3.0, 3), (4.0, 3)] {
            let parts = all(&mesh(&[across(x)]), DVec3::ZERO, 1.0, 4);
            assert_eq!(parts.len(), 1, "{x}");
            assert_eq!(parts[0].cell, [cell, 0, 0], "{x}");
        }
        // One that slants ends at the plane.
        let slanting = [Vec3::new(0.5, 0.2, 0.2), Vec3::new(1.0, 0.8, 0.2), Vec3::new(0.5, 0.2, 0.8)];
        assert_eq!(all(&mesh(&[slanting]), DVec3::ZERO, 1.0, 4).len(), 1);
    }

    #[test]
    fn what_lies_outside_is_left_out() {
        let outside = [Vec3::splat(-3.0), Vec3::new(-1.0, -3.0, -3.0), Vec3::new(-1.0, -1.0, -3.0)];
        assert!(all(&mesh(&[outside]), DVec3::ZERO, 1.0, 4).is_empty());
        let through = [Vec3::new(-10.0, 1.5, 1.5), Vec3::new(20.0, 1.5, 1.5), Vec3::new(20.0, 1.6, 1.5)];
        let cells: Vec<usize> = all(&mesh(&[through]), DVec3::ZERO, 1.0, 4).iter().map(|part| part.cell[0]).collect();
        assert_eq!(cells, [0, 1, 2, 3]);
    }
}
