//! Rays through a mesh: the nearest surface, and whether two points see each other.
//!
//! A hierarchy of boxes (obvhs: eight children a node, compressed) in single precision finds the triangles
//! that a ray may meet; each is then tested in double precision by the volumes of the three tetrahedra that
//! the ray's direction spans with the triangle's sides,
//!
//! ```text
//! u = d·(c × b)    v = d·(a × c)    w = d·(b × a)        a, b, c: the corners seen from the origin
//! ```
//!
//! which all have one sign where the ray passes inside. The volume at a side that two triangles share is the
//! same number with the other sign, to the last bit, and zero counts as inside: so no ray slips between them.
//! Boxes are widened by what single precision may lose. Their unit is a thousandth of the mesh's largest
//! coordinate, because obvhs looks at no box nearer than 10⁻⁴ of a unit.

mod build;

use glam::{DVec3, Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ray::{Ray, RayHit};

use super::Mesh;

/// What a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// How far along the ray, in lengths of its direction.
    pub distance: f64,
    /// The triangle's number in its mesh.
    pub triangle: usize,
    /// Where, in metres.
    pub point: DVec3,
    /// The weights of the triangle's corners at that point; they sum to 1.
    pub weights: [f64; 3],
    /// The triangle's unit normal on the side that the ray comes from.
    pub normal: DVec3,
}

/// A mesh prepared for rays. It keeps its own copy of the triangles, in an order that suits rays.
///
/// ```
/// use glam::{DVec3, Vec3};
/// use lpv_lab::mesh::{Bvh, Material, Mesh};
///
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
/// let mesh = Mesh::new(corners, vec![[0, 1, 2]], vec![0], vec![Material::grey("")]).unwrap();
/// let bvh = Bvh::new(&mesh);
/// let hit = bvh.closest(DVec3::new(0.2, 0.2, 3.0), DVec3::NEG_Z, f64::INFINITY).unwrap();
/// assert_eq!((hit.distance, hit.normal), (3.0, DVec3::Z));
/// assert!(!bvh.visible(DVec3::new(0.2, 0.2, 1.0), DVec3::new(0.2, 0.2, -1.0)));
/// ```
pub struct Bvh {
    boxes: CwBvh,
    /// The corners of the triangles in the boxes' order.
    corners: Vec<[Vec3; 3]>,
    bounds: [DVec3; 2],
    /// The boxes' unit, in metres.
    unit: f64,
    /// The nearest that two surfaces may be to be told apart, in metres.
    resolution: f64,
}

impl Bvh {
    /// Prepares a mesh: about a microsecond a triangle.
    pub fn new(mesh: &Mesh) -> Self {
        let bounds = mesh.bounds();
        let largest = bounds[0].abs().max(bounds[1].abs()).max_element();
        let unit = (largest / 1000.0).max(f64::MIN_POSITIVE);
        let wider = Vec3A::splat(4e-4);
        let around = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| (mesh.vertices()[v as usize].as_dvec3() / unit).as_vec3a());
            Aabb { min: a.min(b).min(c) - wider, max: a.max(b).max(c) + wider }
        };
        let around: Vec<Aabb> = mesh.triangles().iter().map(around).collect();
        let boxes = bvh2_to_cwbvh(&build::tree(&around), 3, true, false);
        let corners = boxes
            .primitive_indices
            .iter()
            .map(|t| mesh.triangles()[*t as usize].map(|v| mesh.vertices()[v as usize]))
            .collect();
        Bvh { boxes, corners, bounds, unit, resolution: 1e-4 * unit }
    }

    /// The nearest that a ray's origin may be to a surface that it shall meet, in metres: 10⁻⁷ of the mesh's
    /// largest coordinate, as much as its corners are rounded by.
    pub fn resolution(&self) -> f64 {
        self.resolution
    }

    /// The first surface that the ray from `origin` along `direction` (any length but zero) meets, farther than
    /// [`Bvh::resolution`] and at most `most` away, in metres.
    pub fn closest(&self, origin: DVec3, direction: DVec3, most: f64) -> Option<Hit> {
        let length = direction.length();
        let d = direction / length;
        let mut best: Option<(f64, usize, [f64; 3])> = None;
        let (ray, start) = self.ray(origin, d, most)?;
        let (least, slack) = (self.resolution, 4.0 * self.resolution);
        let mut farthest = most;
        self.boxes.ray_traverse(ray, &mut RayHit::none(), |_, i| match self.meets(i, origin, d) {
            Some((t, weights)) if t > least && t < farthest => {
                farthest = t;
                best = Some((t, i, weights));
                ((t - start + slack) / self.unit) as f32
            }
            _ => f32::INFINITY,
        });
        let (t, i, weights) = best?;
        let [a, b, c] = self.corners[i].map(|v| v.as_dvec3());
        let normal = (b - a).cross(c - a).normalize();
        Some(Hit {
            distance: t / length,
            triangle: self.boxes.primitive_indices[i] as usize,
            point: a * weights[0] + b * weights[1] + c * weights[2],
            weights,
            normal: if normal.dot(d) > 0.0 { -normal } else { normal },
        })
    }

    /// Whether no surface stands between two points. What lies within [`Bvh::resolution`] of either is not seen,
    /// so the points may lie on surfaces.
    pub fn visible(&self, a: DVec3, b: DVec3) -> bool {
        let length = a.distance(b);
        let most = length - self.resolution;
        if most <= self.resolution {
            return true;
        }
        !self.blocked(a, (b - a) / length, most)
    }

    /// Whether the ray from `origin` along the unit vector `d` meets a surface farther than [`Bvh::resolution`]
    /// and nearer than `most`, in metres.
    pub fn blocked(&self, origin: DVec3, d: DVec3, most: f64) -> bool {
        let Some((ray, _)) = self.ray(origin, d, most) else { return false };
        let meets = |i| self.meets(i, origin, d).is_some_and(|(t, _)| t > self.resolution && t < most);
        !self.boxes.ray_traverse_miss(ray, |_, i| if meets(i) { 0.0 } else { f32::INFINITY })
    }

    /// The bytes that it takes.
    pub fn bytes(&self) -> u64 {
        (self.boxes.nodes.len() * 80 + self.corners.len() * (size_of::<[Vec3; 3]>() + size_of::<u32>())) as u64
    }

    /// The ray in single precision, from where it enters the mesh's box, and how far that is; `None` if it
    /// does not.
    fn ray(&self, origin: DVec3, d: DVec3, most: f64) -> Option<(Ray, f64)> {
        let wider = DVec3::splat(16.0 * self.resolution);
        let [low, high] = [self.bounds[0] - wider, self.bounds[1] + wider];
        let (mut enter, mut leave) = (0.0f64, most);
        for axis in 0..3 {
            if d[axis] == 0.0 {
                if origin[axis] < low[axis] || origin[axis] > high[axis] {
                    return None;
                }
                continue;
            }
            let (p, q) = ((low[axis] - origin[axis]) / d[axis], (high[axis] - origin[axis]) / d[axis]);
            enter = enter.max(p.min(q));
            leave = leave.min(p.max(q));
        }
        // A NaN or infinite origin or direction meets nothing.
        if !(enter <= leave && origin.is_finite() && d.is_finite()) {
            return None;
        }
        let most = (leave - enter + 8.0 * self.resolution) / self.unit;
        let start = (origin + d * enter) / self.unit;
        // Rays of minus zero on some axis miss the boxes; the sum makes it zero.
        let way = d.as_vec3a() + Vec3A::ZERO;
        Some((Ray::new(start.as_vec3a(), way, 0.0, most as f32), enter))
    }

    /// Where the ray meets triangle `i` of the boxes' order: the distance and the corners' weights.
    fn meets(&self, i: usize, origin: DVec3, d: DVec3) -> Option<(f64, [f64; 3])> {
        let [a, b, c] = self.corners[i].map(|v| v.as_dvec3() - origin);
        let u = d.dot(c.cross(b));
        let v = d.dot(a.cross(c));
        let w = d.dot(b.cross(a));
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        if sum == 0.0 {
            return None;
        }
        let weights = [u / sum, v / sum, w / sum];
        let t = d.dot(a * weights[0] + b * weights[1] + c * weights[2]);
        Some((t, weights))
    }
}

impl std::fmt::Debug for Bvh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bvh").field("triangles", &self.corners.len()).field("bounds", &self.bounds).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Material;

    /// Numbers from 0 to 1 that are the same in every run.
    fn dice(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    fn mesh(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
        let made_of = vec![0; triangles.len()];
        Mesh::new(vertices, triangles, made_of, vec![Material::grey("")]).unwrap()
    }

    /// The cube from 0 to 1, two triangles a side.
    fn cube() -> Mesh {
        let vertices = (0..8u32).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32)).collect();
        let sides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        let triangles = sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        mesh(vertices, triangles)
    }

    #[test]
    fn no_ray_leaves_a_closed_cube_not_even_along_edges_and_through_corners() {
        let bvh = Bvh::new(&cube());
        let mut dice = dice(1);
        for origin in [DVec3::splat(0.5), DVec3::new(0.3, 0.6, 0.8)] {
            // Towards a fine lattice on the cube's surface, its edges, diagonals and corners among it.
            for [i, j, k] in (0..17usize.pow(3)).map(|n| [n % 17, n / 17 % 17, n / 289]) {
                if [i, j, k].iter().all(|c| (1..16).contains(c)) {
                    continue;
                }
                let target = DVec3::new(i as f64, j as f64, k as f64) / 16.0;
                let hit = bvh.closest(origin, target - origin, f64::INFINITY).unwrap();
                assert!((hit.distance - 1.0).abs() < 1e-12 && hit.point.distance(target) < 1e-12, "{target}");
                assert!(hit.normal.dot(target - origin) < 0.0);
                assert!(bvh.visible(origin, target) && !bvh.visible(origin, target * 1.5 - origin * 0.5));
            }
            for _ in 0..2000 {
                let d = DVec3::new(dice() - 0.5, dice() - 0.5, dice() - 0.5);
                assert!(bvh.closest(origin, d, f64::INFINITY).is_some(), "{d}");
            }
        }
    }

    #[test]
    fn the_nearest_hit_is_the_one_that_a_test_of_every_triangle_finds() {
        let mut dice = dice(7);
        let mut point = |scale: f64| (DVec3::new(dice(), dice(), dice()) * scale).as_vec3();
        let vertices: Vec<Vec3> = (0..300)
            .flat_map(|_| {
                let corner = point(10.0);
                [corner, corner + point(1.0), corner + point(1.0)]
            })
            .collect();
        let mesh = mesh(vertices, (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect());
        let bvh = Bvh::new(&mesh);
        let mut met = 0;
        for _ in 0..2000 {
            // Origins inside the mesh and far outside it.
            let origin = (point(40.0) - Vec3::splat(15.0)).as_dvec3();
            let d = (point(10.0).as_dvec3() - origin).normalize();
            // Cramer's rule for origin + t d = a + v (b − a) + w (c − a).
            let each = (0..mesh.len()).filter_map(|i| {
                let [a, b, c] = mesh.corners(i);
                let matrix = glam::DMat3::from_cols(-d, b - a, c - a);
                let DVec3 { x: t, y: v, z: w } = matrix.inverse() * (origin - a);
                (t > 0.0 && v >= 0.0 && w >= 0.0 && v + w <= 1.0).then_some((t, i))
            });
            let nearest = each.min_by(|p, q| p.0.total_cmp(&q.0));
            let hit = bvh.closest(origin, d, f64::INFINITY);
            assert_eq!(hit.map(|h| h.triangle), nearest.map(|n| n.1));
            if let (Some(hit), Some((t, _))) = (hit, nearest) {
                assert!((hit.distance - t).abs() < 1e-9, "{} {t}", hit.distance);
                assert!(bvh.blocked(origin, d, t + 1e-3) && bvh.closest(origin, d, t - 1e-3).is_none());
                met += 1;
            }
        }
        assert!(met > 200, "{met} rays met something");
    }

    #[test]
    fn the_sign_of_zero_makes_no_difference() {
        let floor = [[-5.0, -5.0], [5.0, -5.0], [5.0, 5.0], [-5.0, 5.0]].map(|[x, z]| Vec3::new(x, 0.0, z));
        let roof = floor.map(|corner| 0.1 * corner + Vec3::Y);
        let bvh = Bvh::new(&mesh([floor, roof].concat(), vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]));
        let from = DVec3::new(0.3, 0.0, 0.1);
        for way in [DVec3::Y, -DVec3::NEG_Y, DVec3::new(-1e-60, 1.0, 0.0), DVec3::new(0.0, 1.0, -0.0)] {
            assert!(bvh.blocked(from, way, f64::INFINITY), "{way}");
            assert!(
                bvh.closest(from, way, f64::INFINITY).is_some_and(|hit| (hit.distance - 1.0).abs() < 1e-6),
                "{way}"
            );
        }
    }

    #[test]
    fn what_touches_a_surface_does_not_see_that_surface() {
        let bvh = Bvh::new(&cube());
        let on = DVec3::new(0.25, 0.5, 0.0);
        assert!(bvh.visible(on, DVec3::new(0.5, 1.0, 0.75)));
        // Its own plane is behind it, not before it: from the outside it sees the outside.
        assert!(bvh.visible(on, DVec3::new(0.5, 0.5, -0.1)));
        assert_eq!(bvh.closest(on, DVec3::Z, 5.0).unwrap().distance, 1.0);
        assert!(bvh.visible(on, on));
    }

    #[test]
    fn rays_that_are_none_meet_nothing_and_thousands_of_equal_triangles_are_no_harder_than_one() {
        let bvh = Bvh::new(&cube());
        for odd in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
            assert_eq!(bvh.closest(DVec3::splat(0.5), odd, 9.0), None);
            assert!(bvh.closest(odd, DVec3::X, 9.0).is_none_or(|hit| odd == DVec3::ZERO && hit.distance == 1.0));
        }
        for number in [1, 3, 4, 20_000] {
            let many = mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]; number]);
            let bvh = Bvh::new(&many);
            assert!(bvh.closest(DVec3::new(0.2, 0.2, 1.0), DVec3::NEG_Z, 9.0).is_some(), "{number}");
            assert!(bvh.visible(DVec3::new(0.9, 0.9, 1.0), DVec3::new(0.9, 0.9, -1.0)));
        }
    }

    #[test]
    fn a_mesh_of_any_size_is_met_alike() {
        for size in [1e-12, 1e-3, 1.0, 1e3, 1e8f32] {
            let bvh = Bvh::new(&mesh(vec![Vec3::ZERO, Vec3::X * size, Vec3::Y * size], vec![[0, 1, 2]]));
            let size = f64::from(size);
            for height in [1e-6, 1e-3, 1.0, 100.0] {
                let origin = DVec3::new(0.2, 0.3, height) * size;
                let hit = bvh.closest(origin, DVec3::NEG_Z, f64::INFINITY).unwrap();
                assert!((hit.distance / (height * size) - 1.0).abs() < 1e-9, "{size} {height}");
                assert!(!bvh.visible(origin, DVec3::new(0.2, 0.3, -0.5) * size));
            }
        }
    }
}
