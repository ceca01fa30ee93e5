//! What rays travel through: a mesh and the lights in it.
//!
//! Quantities are radiometric. A point or spot light sends an intensity [W/sr], so a surface at distance d whose
//! normal is at angle θ gets the irradiance I·cosθ/d² [W/m²]; the sun gives E⊥·cosθ. Every surface is two-sided
//! and diffuse: of the irradiance E it sends the radiance ρE/π back to the side that it came from, and to both
//! sides the radiance that it emits itself.
//!
//! *Direct* light is what lights send to a surface without a bounce. Light that surfaces emit counts as if they
//! reflected it: that is how it enters a volume, as a virtual point light.

use std::f64::consts::PI;

use glam::DVec3;

use super::lamp::Lamp;
use super::rgb::{Rgb, add, times};
use super::sampler;
use crate::mesh::{Bvh, Mesh};

/// The least cosine by which a place lies before another.
const GRAZING: f64 = 1e-9;

/// A mesh and its lights, made ready for rays.
#[derive(Clone, Debug)]
pub struct World<'a> {
    bvh: &'a Bvh,
    mesh: &'a Mesh,
    lamps: Vec<Lamp>,
    emitters: Emitters,
}

/// A place on one side of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Where it is, in metres.
    pub at: DVec3,
    /// The unit normal of the side.
    pub normal: DVec3,
    /// What share of the light it reflects.
    pub albedo: Rgb,
    /// The radiance that it emits [W/(m²·sr)].
    pub emission: Rgb,
}

/// Surfaces that emit light, to be chosen by their area.
#[derive(Clone, Debug, Default)]
struct Emitters {
    triangles: Vec<usize>,
    /// Running sums of their areas [m²].
    areas: Vec<f64>,
}

impl<'a> World<'a> {
    /// The world of a mesh and the lights in it.
    pub fn new(mesh: &'a Mesh, bvh: &'a Bvh, lamps: Vec<Lamp>) -> Self {
        let mut emitters = Emitters::default();
        let mut area = 0.0;
        for triangle in (0..mesh.len()).filter(|t| mesh.emission(*t) != [0.0; 3]) {
            area += mesh.area(triangle);
            emitters.triangles.push(triangle);
            emitters.areas.push(area);
        }
        World { mesh, bvh, lamps, emitters }
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// The lights.
    pub fn lamps(&self) -> &[Lamp] {
        &self.lamps
    }

    /// The first surface that a ray meets, farther off than the mesh's [resolution](Bvh::resolution): it may begin on
    /// a surface.
    pub fn meet(&self, from: DVec3, way: DVec3) -> Option<Surface> {
        let hit = self.bvh.closest(from, way, f64::INFINITY)?;
        Some(self.surface(hit.triangle, hit.point, hit.normal))
    }

    /// A place on a triangle, `normal` telling the side.
    pub fn surface(&self, triangle: usize, at: DVec3, normal: DVec3) -> Surface {
        Surface { at, normal, albedo: self.mesh.albedo(triangle), emission: self.mesh.emission(triangle) }
    }

    /// Whether two places on surfaces see each other, on the sides that they name. Places in one plane do not, whatever
    /// their last bits say.
    pub fn see_each_other(&self, a: &Surface, b: &Surface) -> bool {
        let way = b.at - a.at;
        let least = GRAZING * way.length();
        way.dot(a.normal) > least && way.dot(b.normal) < -least && self.bvh.visible(a.at, b.at)
    }

    /// The irradiance [W/m²] that a lamp gives a surface, its shadow counted.
    pub fn lit(&self, lamp: &Lamp, surface: &Surface) -> Rgb {
        let ray = lamp.light(surface.at);
        let cosine = ray.to_light.dot(surface.normal);
        if cosine <= 0.0 || ray.across == [0.0; 3] {
            return [0.0; 3];
        }
        let most = ray.distance - self.bvh.resolution();
        if self.bvh.blocked(surface.at, ray.to_light, most) { [0.0; 3] } else { ray.across.map(|e| e * cosine) }
    }

    /// The irradiance [W/m²] that all lights give a surface.
    pub fn direct(&self, surface: &Surface) -> Rgb {
        self.lamps.iter().map(|lamp| self.lit(lamp, surface)).fold([0.0; 3], add)
    }

    /// An even place on the emitting surfaces, on the side that faces `seen_from`; `None` where there are none.
    pub(super) fn emitting(&self, seen_from: DVec3, [u, v]: [f64; 2]) -> Option<Surface> {
        if self.emitters.triangles.is_empty() {
            return None;
        }
        let (i, u) = sampler::choose(&self.emitters.areas, u);
        let triangle = self.emitters.triangles[i];
        let corners = self.mesh.corners(triangle);
        let at = corners.iter().zip(sampler::triangle([u, v])).map(|(corner, weight)| weight * *corner).sum();
        let normal = self.mesh.normal(triangle);
        let normal = if normal.dot(seen_from - at) < 0.0 { -normal } else { normal };
        Some(self.surface(triangle, at, normal))
    }

    /// The density of [`Self::emitting`] by area [1/m²].
    pub(super) fn emitting_density(&self) -> f64 {
        self.emitters.areas.last().map_or(0.0, |area| 1.0 / area)
    }
}

impl Surface {
    /// The radiance [W/(m²·sr)] of irradiance that it reflects.
    pub fn reflects(&self, irradiance: Rgb) -> Rgb {
        times(self.albedo, irradiance).map(|b| b / PI)
    }
}
