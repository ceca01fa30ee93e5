//! Reflective shadow maps: what a light sees, texel by texel, and the virtual point light that each texel is
//! (000, 3.2.1 and 3.3; 002, N.5.2).
//!
//! A map is a grid of rays from the light; the first surface that a ray meets is a virtual point light of flux
//!
//! ```text
//! point  Φ = ρ·I·Ω        six faces of a cube, each from −1 to 1 on the plane at distance 1
//! spot   Φ = ρ·I(ω)·Ω     one face, from −tan θ to tan θ; I(ω) the mean over the texel
//! sun    Φ = ρ·E⊥·a       one face across the light, a the area of a texel
//! ```
//!
//! with Ω the exact solid angle of the texel,
//!
//! ```text
//! Ω = g(x1, y1) − g(x0, y1) − g(x1, y0) + g(x0, y0),    g(x, y) = atan(x·y/√(1 + x² + y²))
//! ```
//!
//! which sums to 2π/3 over a face of the cube. (000, 3.3) prints 4cos³θ·tan²(FOV/2)/N², which is that to 4 % at N = 4
//! and to 2·10⁻⁵ at 256. There is no cosine of the surface: what a slanted surface loses in irradiance it has more
//! of in area under the texel. Many published programs multiply by it once more.

use glam::DVec3;
use rayon::prelude::*;

use super::mesh_scene::{Light, LightKind};
use crate::mesh::{Bvh, Mesh};

/// What a light sees.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadowMap {
    /// Its faces: six for a point light, in the order +x −x +y −y +z −z, one for the others.
    pub faces: Vec<Face>,
    /// What the light gives into the map by colour, in W: 4πI for a point light.
    pub given: [f64; 3],
    /// What of it meets a surface, in W.
    pub met: [f64; 3],
}

/// A square of texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// Texels along a side.
    pub side: usize,
    /// The texels, row by row; `None` where the ray meets nothing or the light sends nothing.
    pub texels: Vec<Option<Texel>>,
}

/// A virtual point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texel {
    /// How far it is from the light along the ray, in metres; for the sun from where its rays start.
    pub distance: f64,
    /// Where it is, in metres.
    pub position: DVec3,
    /// The surface's unit normal on the side that the light is on.
    pub normal: DVec3,
    /// What it sends back in red, green and blue, in W.
    pub flux: [f64; 3],
}

/// A square on which rays are laid out, and what each texel carries.
struct Frame {
    /// From the light to the face's middle.
    ahead: DVec3,
    /// Across and down the face, to its edge.
    across: DVec3,
    down: DVec3,
}

impl ShadowMap {
    /// The map of a light with `side` texels along a side of each face. The sun lights the box `lit` (smallest and
    /// largest coordinates, in metres).
    pub fn new(light: &Light, side: usize, mesh: &Mesh, bvh: &Bvh, lit: [DVec3; 2]) -> Self {
        match light.kind {
            LightKind::Point { position } => {
                let frames = [0, 1, 2, 3, 4, 5].map(|face| {
                    let ahead = DVec3::AXES[face / 2] * [1.0, -1.0][face % 2];
                    // Down is −y where that can be, as in a picture.
                    let up = if face / 2 == 1 { DVec3::Z } else { DVec3::Y };
                    Frame { ahead, across: ahead.cross(up), down: -up }
                });
                Self::central(light, DVec3::from_array(position), &frames, 1.0, side, mesh, bvh)
            }
            LightKind::Spot { position, angle, .. } => {
                let ahead = light.direction().unwrap_or(DVec3::NEG_Y);
                let (across, down) = beside(ahead);
                let frames = [Frame { ahead, across, down }];
                let reach = angle.to_radians().tan();
                Self::central(light, DVec3::from_array(position), &frames, reach, side, mesh, bvh)
            }
            LightKind::Sun { .. } => Self::parallel(light, side, mesh, bvh, lit),
        }
    }

    /// The map of a light at a point; faces reach from −`reach` to `reach` on the plane at distance 1.
    fn central(
        light: &Light,
        position: DVec3,
        frames: &[Frame],
        reach: f64,
        side: usize,
        mesh: &Mesh,
        bvh: &Bvh,
    ) -> Self {
        let power = light.power();
        let edge = |i: usize| reach * (2.0 * i as f64 / side as f64 - 1.0);
        // Texels share their corners, and faces all of them.
        let corners: Vec<Vec<f64>> =
            (0..=side).map(|j| (0..=side).map(|i| corner(edge(i), edge(j))).collect()).collect();
        let row = |face: &Frame, j: usize, texels: &mut [Option<Texel>]| -> Vec<f64> {
            let mut texel = |i: usize| {
                let (x, y) = ([edge(i), edge(i + 1)], [edge(j), edge(j + 1)]);
                let weight = between([&corners[j][i..=i + 1], &corners[j + 1][i..=i + 1]]) * mean_share(light, x, y);
                let (u, v) = ((x[0] + x[1]) / 2.0, (y[0] + y[1]) / 2.0);
                let d = (face.ahead + face.across * u + face.down * v).normalize();
                let hit = (weight > 0.0).then(|| bvh.closest(position, d, f64::INFINITY)).flatten();
                texels[i] = hit.map(|hit| Texel::new(&hit, mesh, power.map(|p| p * weight)));
                weight
            };
            (0..side).map(&mut texel).collect()
        };
        Self::gather(frames, side, power, row)
    }

    /// The map of the sun over a box: a rectangle across its light, seen from before the mesh and the box.
    fn parallel(light: &Light, side: usize, mesh: &Mesh, bvh: &Bvh, lit: [DVec3; 2]) -> Self {
        let ahead = light.direction().unwrap_or(DVec3::NEG_Y);
        let (across, down) = beside(ahead);
        let corners = |of: [DVec3; 2]| (0..8).map(move |i| DVec3::new(of[i & 1].x, of[i >> 1 & 1].y, of[i >> 2].z));
        let span = |axis: DVec3| {
            let along = corners(lit).map(|corner| corner.dot(axis));
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)))
        };
        let ((x0, x1), (y0, y1)) = (span(across), span(down));
        let all = corners(lit).chain(corners(mesh.bounds()));
        let start = all.map(|corner| corner.dot(ahead)).fold(f64::INFINITY, f64::min) - 16.0 * bvh.resolution();
        let (w, h) = ((x1 - x0) / side as f64, (y1 - y0) / side as f64);
        let (power, area) = (light.power(), w * h);
        let row = |_: &Frame, j: usize, texels: &mut [Option<Texel>]| -> Vec<f64> {
            for (i, texel) in texels.iter_mut().enumerate() {
                let (x, y) = (x0 + (i as f64 + 0.5) * w, y0 + (j as f64 + 0.5) * h);
                let hit = bvh.closest(ahead * start + across * x + down * y, ahead, f64::INFINITY);
                *texel = hit.map(|hit| Texel::new(&hit, mesh, power.map(|p| p * area)));
            }
            vec![area; side]
        };
        Self::gather(&[Frame { ahead, across, down }], side, power, row)
    }

    /// Makes all rows, in parallel, and sums them in order. `row` fills one with its texels and returns how each of them
    /// counts.
    fn gather(
        frames: &[Frame],
        side: usize,
        power: [f64; 3],
        row: impl Fn(&Frame, usize, &mut [Option<Texel>]) -> Vec<f64> + Sync,
    ) -> Self {
        let (mut given, mut met) = (0.0, 0.0);
        let mut faces: Vec<Face> = Vec::with_capacity(frames.len());
        for frame in frames {
            let mut texels = vec![None; side * side];
            let rows = texels.par_chunks_mut(side).enumerate().map(|(j, texels)| row(frame, j, texels));
            let weights: Vec<Vec<f64>> = rows.collect();
            for (weight, texel) in weights.iter().flatten().zip(&texels) {
                given += weight;
                met += if texel.is_some() { *weight } else { 0.0 };
            }
            faces.push(Face { side, texels });
        }
        ShadowMap { faces, given: power.map(|p| p * given), met: power.map(|p| p * met) }
    }

    /// The virtual point lights, face by face and row by row.
    pub fn texels(&self) -> impl Iterator<Item = &Texel> {
        self.faces.iter().flat_map(|face| face.texels.iter().flatten())
    }

    /// What all virtual point lights send back, in W.
    pub fn flux(&self) -> [f64; 3] {
        self.texels().fold([0.0; 3], |sum, texel| [0, 1, 2].map(|c| sum[c] + texel.flux[c]))
    }
}

impl Texel {
    fn new(hit: &crate::mesh::Hit, mesh: &Mesh, given: [f64; 3]) -> Self {
        let albedo = mesh.albedo(hit.triangle);
        let flux = [0, 1, 2].map(|c| albedo[c] * given[c]);
        Texel { distance: hit.distance, position: hit.point, normal: hit.normal, flux }
    }
}

/// The part of a rectangle's solid angle that comes from its corner at (x, y).
fn corner(x: f64, y: f64) -> f64 {
    (x * y / (1.0 + x * x + y * y).sqrt()).atan()
}

/// The solid angle between the parts of its corners, those of lower y first, of lower x first.
fn between<R: AsRef<[f64]>>([low, high]: [R; 2]) -> f64 {
    let (low, high) = (low.as_ref(), high.as_ref());
    high[1] - high[0] - low[1] + low[0]
}

/// The mean share of its intensity that a light sends into a texel on the plane at distance 1: where it is not the
/// same at the texel's corners and middle, over 16² places.
fn mean_share(light: &Light, x: [f64; 2], y: [f64; 2]) -> f64 {
    if !matches!(light.kind, LightKind::Spot { .. }) {
        return 1.0;
    }
    let at = |x: f64, y: f64| light.share(1.0 / (1.0 + x * x + y * y).sqrt());
    let corners = [at(x[0], y[0]), at(x[1], y[0]), at(x[0], y[1]), at(x[1], y[1])];
    // The point of the texel that is nearest to the axis decides whether light falls into it at all.
    let nearest = at(0f64.clamp(x[0], x[1]), 0f64.clamp(y[0], y[1]));
    if corners.iter().all(|corner| *corner == nearest) {
        return nearest;
    }
    const PLACES: usize = 16;
    let along = |[a, b]: [f64; 2], i: usize| a + (b - a) * (i as f64 + 0.5) / PLACES as f64;
    let places = (0..PLACES * PLACES).map(|i| at(along(x, i % PLACES), along(y, i / PLACES)));
    places.sum::<f64>() / (PLACES * PLACES) as f64
}

/// Two unit vectors across `ahead`: to the right and down, with y up where that can be.
fn beside(ahead: DVec3) -> (DVec3, DVec3) {
    let up = if ahead.y.abs() > 0.999 { DVec3::Z } else { DVec3::Y };
    let across = ahead.cross(up).normalize();
    (across, ahead.cross(across))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// The exact solid angle of a rectangle on the plane at distance 1, in sr.
    fn solid_angle(x: [f64; 2], y: [f64; 2]) -> f64 {
        between(y.map(|y| x.map(|x| corner(x, y))))
    }

    #[test]
    fn a_face_of_texels_has_the_solid_angle_of_a_cubes_side() {
        for n in [1, 3, 16] {
            let edge = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
            let texels = (0..n * n).map(|t| [t % n, t / n]);
            let sum: f64 = texels.map(|[i, j]| solid_angle([edge(i), edge(i + 1)], [edge(j), edge(j + 1)])).sum();
            assert!((sum - 2.0 * PI / 3.0).abs() < 1e-12, "{n}: {sum}");
        }
        // The thesis's weight, 4cos³θ·tan²(FOV/2)/N², at N = 256 in the worst texel.
        let n = 256.0;
        let corner = solid_angle([1.0 - 2.0 / n, 1.0], [1.0 - 2.0 / n, 1.0]);
        let middle: f64 = 1.0 - 1.0 / n;
        let thesis = 4.0 * (1.0 + 2.0 * middle * middle).powf(-1.5) / (n * n);
        assert!((thesis / corner - 1.0).abs() < 3e-5, "{}", thesis / corner);
    }

    #[test]
    fn what_is_beside_is_at_right_angles() {
        for d in [DVec3::X, DVec3::NEG_Y, DVec3::new(1.0, -2.0, 0.5).normalize()] {
            let (across, down) = beside(d);
            assert!(across.dot(d).abs() + down.dot(d).abs() + across.dot(down).abs() < 1e-12);
            assert!(down.y <= 1e-12 && (down.length() - 1.0).abs() < 1e-12, "{down}");
        }
    }
}
