//! A mesh in its volume, shaded, with its virtual point lights, occupied cells and the light in cells: pixels of their
//! own depth, so that what is nearer hides what is behind it however large triangles are.
//!
//! Sides that face away are left out on request: of a room whose walls face inwards one sees the inside from without.

use egui::{Color32, ColorImage, Pos2, Rect, pos2, vec2};
use glam::Vec3;

use super::ink::color;
use super::space::{Dress, Eye, Projection};
use crate::app::session::view::View;
use crate::app::worker::look::{Cloud, CloudCell};
use crate::report::colour::Theme;
use crate::report::glyph::{Glyphs, Outline};
use crate::scene::Stage;
use crate::sh::Sh;

/// What is drawn of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// The mesh.
    pub mesh: bool,
    /// Triangles whose back is towards the eye too.
    pub backs: bool,
    /// The virtual point lights.
    pub emitters: bool,
    /// The occupied cells.
    pub cells: bool,
}

impl Default for Shown {
    fn default() -> Self {
        Shown { mesh: true, backs: false, emitters: false, cells: false }
    }
}

/// A canvas of pixels that knows how near each is.
struct Canvas {
    image: ColorImage,
    nearest: Vec<f32>,
    size: [usize; 2],
}

/// The light in cells, and how it is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Light<'a> {
    /// The lit cells.
    pub cloud: &'a Cloud,
    /// How light is looked at.
    pub view: &'a View,
    /// Lobes in place of cubes.
    pub lobes: bool,
}

/// The scene as the eye sees it, `size` pixels wide and high.
pub fn picture(
    stage: &Stage,
    light: Option<Light>,
    eye: &Eye,
    size: [usize; 2],
    shown: Shown,
    theme: &Theme,
) -> ColorImage {
    let rect = Rect::from_min_size(Pos2::ZERO, vec2(size[0] as f32, size[1] as f32));
    let projection = Projection::new(eye, rect, stage.placement.size);
    let mut canvas = Canvas {
        image: ColorImage::filled(size, color(theme.ground)),
        nearest: vec![f32::NEG_INFINITY; size[0] * size[1]],
        size,
    };
    let seen = |place: Vec3| {
        let seen = projection.seen(place);
        (projection.screen(seen).0, seen.z)
    };
    if shown.mesh {
        let mesh = &stage.model.mesh;
        for triangle in 0..mesh.len() {
            let corners = mesh.corners(triangle).map(|corner| stage.placement.in_cells(corner).as_vec3());
            let facing = projection.facing(corners[0], mesh.normal(triangle).as_vec3());
            if facing < 0.0 && !shown.backs {
                continue;
            }
            let light = 0.35 + 0.65 * facing.abs();
            canvas.triangle(corners.map(seen), shade(mesh.albedo(triangle), f64::from(light)));
        }
    }
    if shown.cells {
        for solid in &stage.voxels.solids {
            let middle = Vec3::from_array(solid.cell.map(|c| c as f32 + 0.5));
            canvas.cube(middle, 0.42, &projection, &seen, |facing| shade(solid.albedo, facing));
        }
    }
    if let Some(light) = light {
        canvas.light(&light, &projection, &seen, theme);
    }
    if shown.emitters {
        let brightest = stage.emitters().flat_map(|e| e.flux).fold(f64::MIN_POSITIVE, f64::max);
        for emitter in stage.emitters() {
            let (at, depth) = seen(stage.placement.in_cells(emitter.position).as_vec3());
            let light = emitter.flux.map(|flux| (flux / brightest).sqrt());
            // A little nearer than the surface that they lie on.
            canvas.dot(at, depth + 0.004, shade(light, 1.0));
        }
    }
    canvas.image
}

impl Canvas {
    fn put(&mut self, x: usize, y: usize, depth: f32, color: Color32) {
        let i = y * self.size[0] + x;
        if depth > self.nearest[i] {
            self.nearest[i] = depth;
            self.image.pixels[i] = color;
        }
    }

    /// A filled triangle of corners on screen, each with its depth.
    fn triangle(&mut self, [(a, da), (b, db), (c, dc)]: [(Pos2, f32); 3], color: Color32) {
        let cross = |p: Pos2, q: Pos2, r: Pos2| (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
        let whole = cross(a, b, c);
        if whole == 0.0 || !whole.is_finite() {
            return;
        }
        let span = |p: f32, q: f32, r: f32, n: usize| {
            let (low, high) = (p.min(q).min(r).floor().max(0.0), p.max(q).max(r).ceil().min(n as f32));
            low as usize..high as usize
        };
        let across = span(a.x, b.x, c.x, self.size[0]);
        for y in span(a.y, b.y, c.y, self.size[1]) {
            for x in across.clone() {
                let p = pos2(x as f32 + 0.5, y as f32 + 0.5);
                let (u, v) = (cross(b, c, p) / whole, cross(c, a, p) / whole);
                let w = 1.0 - u - v;
                if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                    self.put(x, y, u * da + v * db + w * dc, color);
                }
            }
        }
    }

    /// The faces of a cube that face the eye.
    fn cube(
        &mut self,
        middle: Vec3,
        half: f32,
        projection: &Projection,
        seen: &impl Fn(Vec3) -> (Pos2, f32),
        paint: impl Fn(f64) -> Color32,
    ) {
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let normal = Vec3::AXES[axis] * sign;
                let face = middle + normal * half;
                let facing = projection.facing(face, normal);
                if facing <= 0.0 {
                    continue;
                }
                let (u, v) = (Vec3::AXES[(axis + 1) % 3] * half, Vec3::AXES[(axis + 2) % 3] * half);
                let [a, b, c, d] = [face - u - v, face + u - v, face + u + v, face - u + v].map(seen);
                let color = paint(f64::from(0.35 + 0.65 * facing));
                self.triangle([a, b, c], color);
                self.triangle([a, c, d], color);
            }
        }
    }

    /// Every lit cell, as a cube or as a lobe in the plane across the line of sight.
    fn light(&mut self, light: &Light, projection: &Projection, seen: &impl Fn(Vec3) -> (Pos2, f32), theme: &Theme) {
        let dress = Dress::of(light.cloud, light.view);
        let (glyphs, mut outline) = (dress.glyphs(), Outline::default());
        for cell in &light.cloud.cells {
            let (share, paint) = dress.worn(cell, light.view, light.lobes, theme);
            let centre = Vec3::from_array(cell.centre);
            if light.lobes {
                self.lobe(
                    cell,
                    light.view,
                    &glyphs,
                    &mut outline,
                    projection,
                    seen,
                    [color(paint), color(theme.negative)],
                );
            } else {
                // Small enough that the mesh is seen between them.
                let half = cell.span * (0.05 + 0.2 * share);
                let lit = |facing: f64| color(paint.towards(theme.ground, 0.55 * (1.0 - facing as f32)));
                self.cube(centre, half, projection, seen, lit);
            }
        }
    }

    #[expect(clippy::too_many_arguments, reason = "a lobe needs its cell, its shape, its place and its colours")]
    fn lobe(
        &mut self,
        cell: &CloudCell,
        view: &View,
        glyphs: &Glyphs,
        outline: &mut Outline,
        projection: &Projection,
        seen: &impl Fn(Vec3) -> (Pos2, f32),
        colors: [Color32; 2],
    ) {
        let Sh([c00, x, y, z]) = view.hue.of(cell.light);
        let turned = projection.turn * Vec3::new(x, y, z);
        glyphs.outline(Sh([c00, turned.x, turned.y, turned.z]), outline);
        let centre = Vec3::from_array(cell.centre);
        let (at, depth) = seen(centre);
        let side = cell.span * projection.points(centre);
        for (polygon, color) in [&outline.positive, &outline.negative].into_iter().zip(colors) {
            let corner = |[x, y]: [f32; 2]| (at + vec2(x, -y) * side, depth);
            for (i, from) in polygon.iter().enumerate() {
                let to = polygon[(i + 1) % polygon.len()];
                self.triangle([(at, depth), corner(*from), corner(to)], color);
            }
        }
    }

    /// Two pixels by two.
    fn dot(&mut self, at: Pos2, depth: f32, color: Color32) {
        if !(at.x >= 0.0 && at.y >= 0.0) {
            return;
        }
        let (x, y) = (at.x as usize, at.y as usize);
        for (x, y) in [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)] {
            if x < self.size[0] && y < self.size[1] {
                self.put(x, y, depth, color);
            }
        }
    }
}

/// A linear colour, weakened, on screen.
fn shade(linear: [f64; 3], light: f64) -> Color32 {
    // The screen's curve, near enough for shading.
    let [r, g, b] = linear.map(|part| (255.0 * (part * light).clamp(0.0, 1.0).powf(1.0 / 2.2)) as u8);
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_nearer_hides_what_is_behind_whatever_comes_first() {
        let size = [8, 8];
        let blank =
            || Canvas { image: ColorImage::filled(size, Color32::BLACK), nearest: vec![f32::NEG_INFINITY; 64], size };
        let triangle = |depth: f32| [(pos2(-1.0, -1.0), depth), (pos2(20.0, -1.0), depth), (pos2(-1.0, 20.0), depth)];
        for order in [[0, 1], [1, 0]] {
            let mut canvas = blank();
            for i in order {
                let (depth, color) = [(0.2, Color32::RED), (0.8, Color32::GREEN)][i];
                canvas.triangle(triangle(depth), color);
            }
            assert!(canvas.image.pixels.iter().all(|pixel| *pixel == Color32::GREEN));
        }
        let mut canvas = blank();
        canvas.dot(pos2(7.5, 7.5), 0.0, Color32::RED);
        canvas.dot(pos2(-3.0, 2.0), 0.0, Color32::RED);
        canvas.triangle([(pos2(f32::NAN, 0.0), 0.0), (pos2(4.0, 0.0), 0.0), (pos2(0.0, 4.0), 0.0)], Color32::RED);
        assert_eq!(canvas.image.pixels.iter().filter(|pixel| **pixel == Color32::RED).count(), 1);
    }
}
