//! A light as Monte Carlo integrals want it: what it sends to a point, rays from it, and their density.
//!
//! Rays from a light end where its light falls, so they find the bright parts of a scene. By area they are as dense
//! as, on a surface at distance d whose normal is at angle θ to the light,
//!
//! ```text
//! point  cosθ/(4π·d²)          every direction alike
//! spot   cosθ/(Ω·d²)           every direction of its cone alike, Ω = 2π(1 − cos of its half angle)
//! sun    cosθ/(π·R²)           every point alike of a disk of radius R that covers the scene
//! ```

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::rgb::Rgb;
use super::sampler;
use crate::scene::mesh_scene::fade;

/// A light, ready for a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lamp {
    /// Alike to all sides.
    Point {
        /// Where it is, in metres.
        position: DVec3,
        /// What it sends [W/sr].
        intensity: Rgb,
    },
    /// Into a cone.
    Spot {
        /// Where it is, in metres.
        position: DVec3,
        /// The unit vector along the cone.
        direction: DVec3,
        /// The cosine of the cone's half angle.
        edge: f64,
        /// The cosine of the angle up to which it sends all its intensity; towards `edge` it fades.
        full: f64,
        /// What it sends [W/sr] within `full`.
        intensity: Rgb,
    },
    /// Parallel light from without.
    Sun {
        /// The unit vector in which its light goes.
        direction: DVec3,
        /// What a surface gets that faces it [W/m²].
        irradiance: Rgb,
        /// The middle of the scene, in metres.
        middle: DVec3,
        /// The radius of a ball about it that holds the scene, in metres.
        radius: f64,
    },
}

/// Light that comes to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The unit vector from the point to the light.
    pub to_light: DVec3,
    /// How far off the light is, in metres; the sun is infinitely far.
    pub distance: f64,
    /// What a surface gets that faces the light [W/m²].
    pub across: Rgb,
}

impl Lamp {
    /// The light that comes to a point if nothing stands between.
    pub fn light(&self, at: DVec3) -> Ray {
        match *self {
            Lamp::Point { position, intensity } => towards(at, position, |_| intensity),
            Lamp::Spot { position, direction, edge, full, intensity } => {
                let share = |way: DVec3| fade(way.dot(direction), edge, full);
                towards(at, position, |way| intensity.map(|i| i * share(way)))
            }
            Lamp::Sun { direction, irradiance, .. } => {
                Ray { to_light: -direction, distance: f64::INFINITY, across: irradiance }
            }
        }
    }

    /// A ray from the light, as its origin and direction.
    pub fn ray(&self, uv: [f64; 2]) -> (DVec3, DVec3) {
        match *self {
            Lamp::Point { position, .. } => (position, sampler::cone(DVec3::Z, -1.0, uv)),
            Lamp::Spot { position, direction, edge, .. } => (position, sampler::cone(direction, edge, uv)),
            Lamp::Sun { direction, middle, radius, .. } => {
                let place = radius * sampler::disk(uv);
                let start = middle + sampler::frame(direction) * DVec3::new(place.x, place.y, -1.001 * radius);
                (start, direction)
            }
        }
    }

    /// By which density per area [1/m²] the first hits of such rays lie about a lit point of a surface with unit
    /// normal `normal`.
    pub fn density(&self, at: DVec3, normal: DVec3) -> f64 {
        let (position, solid_angle) = match *self {
            Lamp::Point { position, .. } => (position, 2.0 * TAU),
            Lamp::Spot { position, direction, edge, .. } => {
                let inside = (at - position).normalize_or_zero().dot(direction) >= edge;
                (position, if inside { TAU * (1.0 - edge) } else { f64::INFINITY })
            }
            Lamp::Sun { direction, radius, .. } => {
                return normal.dot(direction).abs() / (PI * radius * radius);
            }
        };
        let offset = at - position;
        let squared = offset.length_squared();
        (normal.dot(offset).abs() / squared.sqrt()) / (solid_angle * squared)
    }
}

/// Light from a position, its intensity by the direction in which it leaves.
fn towards(at: DVec3, position: DVec3, intensity: impl Fn(DVec3) -> Rgb) -> Ray {
    let offset = position - at;
    let squared = offset.length_squared();
    let distance = squared.sqrt();
    if distance == 0.0 {
        return Ray { to_light: DVec3::Z, distance, across: [0.0; 3] };
    }
    let to_light = offset / distance;
    Ray { to_light, distance, across: intensity(-to_light).map(|i| i / squared) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::sequence::Points;

    #[test]
    fn a_point_light_follows_the_inverse_square() {
        let lamp = Lamp::Point { position: DVec3::new(0.0, 2.0, 0.0), intensity: [3.0, 2.0, 1.0] };
        let ray = lamp.light(DVec3::ZERO);
        assert_eq!((ray.to_light, ray.distance, ray.across), (DVec3::Y, 2.0, [0.75, 0.5, 0.25]));
        assert_eq!(lamp.light(DVec3::new(0.0, 2.0, 0.0)).across, [0.0; 3], "no light of infinite strength");
    }

    #[test]
    fn a_spot_is_full_inside_fades_and_ends() {
        let (edge, full) = (0.5, 0.7);
        let lamp = Lamp::Spot { position: DVec3::ZERO, direction: DVec3::X, edge, full, intensity: [1.0; 3] };
        let at = |cosine: f64| lamp.light(DVec3::new(cosine, (1.0 - cosine * cosine).sqrt(), 0.0)).across[0];
        assert!((at(0.8) - 1.0).abs() < 1e-12 && (at(0.6) - 0.5).abs() < 1e-12 && at(0.4) == 0.0);
    }

    #[test]
    fn rays_are_as_dense_as_they_say() {
        // The share of rays that meet a square of a plane, against the integral of the density over it.
        let lamps = [
            Lamp::Point { position: DVec3::new(0.2, 0.1, 0.9), intensity: [1.0; 3] },
            Lamp::Spot {
                position: DVec3::new(0.2, 0.1, 0.9),
                direction: DVec3::new(0.1, 0.2, -1.0).normalize(),
                edge: 0.6,
                full: 0.7,
                intensity: [1.0; 3],
            },
            Lamp::Sun {
                direction: DVec3::new(0.3, -0.2, -0.6).normalize(),
                irradiance: [1.0; 3],
                middle: DVec3::new(0.1, 0.0, 0.3),
                radius: 2.0,
            },
        ];
        let inside = |p: DVec3| p.x.abs() < 0.6 && p.y.abs() < 0.5;
        for lamp in lamps {
            let points = Points::<2>::new();
            let count = 200_000;
            let met = (0..count).filter(|i| {
                let (from, way) = lamp.ray(points.at(&[0, 0], *i));
                way.z < 0.0 && inside(from - way * (from.z / way.z))
            });
            let share = met.count() as f64 / count as f64;
            let cells = 400;
            let area = 1.2 * 1.0 / (cells * cells) as f64;
            let density = |i: usize| {
                let [x, y] = [i % cells, i / cells].map(|j| (j as f64 + 0.5) / cells as f64 - 0.5);
                lamp.density(DVec3::new(1.2 * x, y, 0.0), DVec3::Z) * area
            };
            let wanted: f64 = (0..cells * cells).map(density).sum();
            assert!((share - wanted).abs() < 2e-3 * wanted, "{lamp:?}: {share}, {wanted}");
        }
    }
}
