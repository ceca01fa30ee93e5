//! Surfaces as a volume of cells sees them, and the light that truly reaches them.
//!
//! A [`Patch`] is what of a mesh's surface lies in one cell and looks one way: the parts of its triangles there whose
//! normals are within 20° of each other, one side. A sheet gives a patch for each of its sides. A side that faces
//! another surface nearer than a cell's side has no cell before it that could hold its light (the inside of a thin
//! slab), nor has one that faces out of the volume (the outside of a room that fills it); such sides are left out, and
//! [`Patches::left_out`] tells how much that is.
//!
//! [`Lit`] is the irradiance of every patch, path traced: independent of any view, and the reference of a scene.

use std::collections::HashMap;

use glam::DVec3;

use super::bounce::{Bounces, First, indirect};
use super::estimate::{BATCHES, Estimates, Sample, Watch};
use super::rgb::{Rgb, add};
use super::sampler;
use super::sequence::Points;
use super::sparks::Sparks;
use super::world::World;
use crate::field::Cell;
use crate::mesh::{Bvh, Mesh, cut};
use crate::scene::placement::Placement;

/// The cosine of the angle up to which surfaces look the same way.
const SAME_WAY: f64 = 0.939_7;

/// What of a surface lies in one cell and looks one way.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// The cell.
    pub cell: Cell,
    /// The mean unit normal.
    pub normal: DVec3,
    /// In m².
    pub area: f64,
    /// What it is made of.
    pub facets: Vec<Facet>,
}

/// A flat piece of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// The triangle of the mesh that it is a piece of.
    pub triangle: usize,
    /// Its corners, in metres.
    pub corners: [DVec3; 3],
    /// The unit normal of its side.
    pub normal: DVec3,
    /// In m².
    pub area: f64,
}

impl Facet {
    /// Its centre of mass, in metres.
    pub fn middle(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / 3.0
    }
}

/// The patches of a mesh in a volume, z slowest and x fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Patches {
    patches: Vec<Patch>,
    left_out: f64,
}

impl Patches {
    /// The patches of a mesh.
    pub fn new(mesh: &Mesh, bvh: &Bvh, placement: &Placement) -> Self {
        let mut patches: Vec<Patch> = Vec::new();
        let mut of_cell: HashMap<Cell, Vec<usize>> = HashMap::new();
        let (mut kept, mut left_out) = (0.0, 0.0);
        let side = placement.cell_side;
        cut::parts(mesh, placement.origin, side, placement.size, |part| {
            let middle = placement.in_metres(part.middle());
            let front = mesh.normal(part.triangle);
            for normal in [front, -front] {
                let area = part.area * side * side;
                let faces_out = placement.cell_of(middle + 0.5 * side * normal).is_none();
                if faces_out || bvh.blocked(middle, normal, side) {
                    left_out += area;
                    continue;
                }
                kept += area;
                let here = of_cell.entry(part.cell).or_default();
                let known = here.iter().copied().find(|i| patches[*i].normal.dot(normal) > SAME_WAY);
                let i = known.unwrap_or_else(|| {
                    here.push(patches.len());
                    patches.push(Patch { cell: part.cell, normal, area: 0.0, facets: Vec::new() });
                    patches.len() - 1
                });
                for corners in part.triangles() {
                    let corners = corners.map(|corner| placement.in_metres(corner));
                    let area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
                    patches[i].facets.push(Facet { triangle: part.triangle, corners, normal, area });
                }
            }
        });
        for patch in &mut patches {
            patch.area = patch.facets.iter().map(|facet| facet.area).sum();
            let mean: DVec3 = patch.facets.iter().map(|facet| facet.area * facet.normal).sum();
            patch.normal = mean.try_normalize().unwrap_or(patch.normal);
        }
        // The order in which triangles come must not matter to anybody.
        patches.sort_by_key(|patch| (patch.cell[2], patch.cell[1], patch.cell[0]));
        let all = kept + left_out;
        Patches { patches, left_out: if all > 0.0 { left_out / all } else { 0.0 } }
    }

    /// All patches.
    pub fn all(&self) -> &[Patch] {
        &self.patches
    }

    /// The share of the area of all sides that faces another surface too closely, or out of the volume, 0 to 1.
    pub fn left_out(&self) -> f64 {
        self.left_out
    }

    /// For each patch the mean over its facets of what `of` makes of a place and its normal.
    pub fn mean(&self, of: impl Fn(&Patch, DVec3, DVec3) -> Rgb) -> Vec<Rgb> {
        let mean = |patch: &Patch| {
            let weighted = |facet: &Facet| of(patch, facet.middle(), facet.normal).map(|e| e * facet.area / patch.area);
            patch.facets.iter().map(weighted).fold([0.0; 3], add)
        };
        self.patches.iter().map(mean).collect()
    }
}

/// The irradiance [W/m²] of every patch, path traced.
#[derive(Clone, Debug)]
pub struct Lit {
    /// Direct light, then indirect.
    estimates: Estimates<6>,
}

impl Lit {
    /// Traces `samples` paths a patch, from places even over its area; `None` where `watch` ended it.
    pub fn traced(world: &World, patches: &Patches, bounces: Bounces, samples: u64, watch: Watch) -> Option<Self> {
        let sums = |patch: &Patch| {
            let mut sum = 0.0;
            let running = patch.facets.iter().map(|facet| {
                sum += facet.area;
                sum
            });
            running.collect()
        };
        let sums: Vec<Vec<f64>> = patches.all().iter().map(sums).collect();
        let (places, first) = (Points::<6>::new(), First::default());
        let mut estimates = Estimates::new(patches.all().len(), 1);
        let each = samples.div_ceil(u64::from(BATCHES)).max(1);
        let of = |sparks: &Sparks, item: usize, mut sample: Sample| {
            let [.., u, v] = places.at(&sample.shift, sample.number);
            let [a, b, c, d, ..] = sample.shift;
            let numbers = first.at([a, b, c, d], sample.number);
            let (i, u) = sampler::choose(&sums[item], u);
            let facet = &patches.all()[item].facets[i];
            let weights = sampler::triangle([u, v]);
            let at = facet.corners.iter().zip(weights).map(|(corner, weight)| weight * *corner).sum();
            let surface = world.surface(facet.triangle, at, facet.normal);
            let [r, g, b_] = world.direct(&surface);
            let [x, y, z] = indirect(world, sparks, &surface, bounces, numbers, &mut sample.more);
            [r, g, b_, x, y, z]
        };
        for batch in 0..BATCHES {
            let share = |share: f64| watch((f64::from(batch) + share) / f64::from(BATCHES));
            let sparks = Sparks::new(world, u64::from(batch));
            if !estimates.add_batch(each, &share, |item, sample| of(&sparks, item, sample)) {
                return None;
            }
        }
        Some(Lit { estimates })
    }

    /// The irradiance of a patch by light that comes straight from the lamps.
    pub fn direct(&self, patch: usize) -> Rgb {
        let [r, g, b, ..] = self.estimates.mean(patch);
        [r, g, b]
    }

    /// Its irradiance by light that was reflected before: what a volume should give it.
    pub fn indirect(&self, patch: usize) -> Rgb {
        let [.., r, g, b] = self.estimates.mean(patch);
        [r, g, b]
    }

    /// One standard deviation of that.
    pub fn deviation(&self, patch: usize) -> Rgb {
        let [.., r, g, b] = self.estimates.deviation(patch);
        [r, g, b]
    }

    /// How many patches there are.
    pub fn len(&self) -> usize {
        self.estimates.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.estimates.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Material;
    use glam::Vec3;

    /// Squares across y at these heights, from 0.1 to 3.9 along x and z.
    fn floors(heights: &[f32]) -> Mesh {
        let corner = |x: f32, z: f32, y: f32| Vec3::new(x, y, z);
        let vertices = heights
            .iter()
            .flat_map(|y| [[0.1, 0.1], [3.9, 0.1], [3.9, 3.9], [0.1, 3.9]].map(|[x, z]| corner(x, z, *y)));
        let quads = 0..heights.len() as u32;
        let triangles = quads.flat_map(|q| [[4 * q, 4 * q + 1, 4 * q + 2], [4 * q, 4 * q + 2, 4 * q + 3]]).collect();
        Mesh::new(vertices.collect(), triangles, vec![0; 2 * heights.len()], vec![Material::grey("")]).unwrap()
    }

    fn patches(mesh: &Mesh) -> Patches {
        let placement = Placement { origin: DVec3::ZERO, cell_side: 1.0, size: 4 };
        Patches::new(mesh, &Bvh::new(mesh), &placement)
    }

    #[test]
    fn a_sheet_has_a_patch_for_each_side_in_every_cell() {
        let mesh = floors(&[1.5]);
        let patches = patches(&mesh);
        assert_eq!((patches.all().len(), patches.left_out()), (2 * 16, 0.0));
        let area: f64 = patches.all().iter().map(|patch| patch.area).sum();
        assert!((area - 2.0 * 3.8 * 3.8).abs() < 1e-5);
        assert!(patches.all().iter().all(|patch| patch.cell[1] == 1 && patch.normal.y.abs() == 1.0));
    }

    #[test]
    fn what_faces_another_surface_within_a_cell_is_left_out() {
        let mesh = floors(&[1.2, 1.6]);
        let patches = patches(&mesh);
        assert_eq!(patches.all().len(), 2 * 16);
        assert!((patches.left_out() - 0.5).abs() < 1e-12);
        // The outer sides remain: the upper one's above, the lower one's below.
        let outer = |patch: &Patch| patch.facets.iter().all(|facet| (facet.middle().y > 1.4) == (facet.normal.y > 0.0));
        assert!(patches.all().iter().all(outer));
    }

    #[test]
    fn a_side_that_faces_out_of_the_volume_is_left_out() {
        for (height, inwards) in [(0.1, DVec3::Y), (3.9, DVec3::NEG_Y)] {
            let patches = patches(&floors(&[height]));
            assert!(patches.all().len() == 16 && patches.all().iter().all(|patch| patch.normal == inwards), "{height}");
            assert!((patches.left_out() - 0.5).abs() < 1e-12);
        }
    }

    #[test]
    fn a_floor_gets_what_the_ceilings_spot_sends_back() {
        // A lamp close under a ceiling makes a small bright spot: E = Φ·cosθ·cosθ'/(π·r²), Φ the flux sent back.
        let mesh = floors(&[0.5, 3.5]);
        let bvh = Bvh::new(&mesh);
        let lamp = super::super::lamp::Lamp::Spot {
            position: DVec3::new(2.0, 3.0, 2.0),
            direction: DVec3::Y,
            edge: 0.999,
            full: 0.999,
            intensity: [1.0; 3],
        };
        let world = World::new(&mesh, &bvh, vec![lamp]);
        let patches = patches(&mesh);
        let lit = Lit::traced(&world, &patches, Bounces::UpTo(1), 1024, &|_| true).unwrap();
        let flux = 0.5 * std::f64::consts::TAU * (1.0 - 0.999);
        for (i, patch) in
            patches.all().iter().enumerate().filter(|(_, patch)| patch.cell[1] == 0 && patch.normal.y > 0.0)
        {
            let middle: DVec3 =
                patch.facets.iter().map(|facet| facet.area * facet.middle()).sum::<DVec3>() / patch.area;
            let to = DVec3::new(2.0, 3.5, 2.0) - middle;
            let wanted = flux * (3.0 / to.length()).powi(2) / (std::f64::consts::PI * to.length_squared());
            let found = lit.indirect(i)[0];
            assert!(
                (found / wanted - 1.0).abs() < 0.1 && lit.deviation(i)[0] < 0.02 * wanted,
                "{patch:?} {found} {wanted}"
            );
            assert_eq!(lit.direct(i), [0.0; 3]);
        }
    }
}
