//! One lobe in space, large, to be turned: its surface at radius |f| in every direction, what is negative in a colour
//! of its own.

use egui::{Color32, Mesh, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};
use glam::{Mat3, Vec3, vec3};

use super::ink::{Ink, color};
use crate::report::colour::{Paint, Theme};
use crate::report::slice::Axis;
use crate::sh::Sh;

/// Steps around and from pole to pole.
const AROUND: usize = 32;
const DOWN: usize = 16;

/// From where the lobe is seen, in radians about the upright axis and above the horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// About the upright axis.
    pub yaw: f32,
    /// Above the horizon.
    pub pitch: f32,
}

impl Default for Turn {
    fn default() -> Self {
        Turn { yaw: -0.45, pitch: 0.35 }
    }
}

impl Turn {
    /// Turned by a drag over this many points.
    pub fn dragged(self, drag: Vec2) -> Self {
        Turn { yaw: self.yaw + 0.01 * drag.x, pitch: (self.pitch + 0.01 * drag.y).clamp(-1.55, 1.55) }
    }

    fn matrix(self) -> Mat3 {
        Mat3::from_rotation_x(self.pitch) * Mat3::from_rotation_y(self.yaw)
    }
}

/// Draws a lobe so that it fills `rect`, within the edges of its cell.
pub fn draw(painter: &Painter, rect: Rect, light: Sh<f32>, turn: Turn, theme: &Theme) {
    let turn = turn.matrix();
    let scale = rect.width().min(rect.height()) * 0.5 / 1.85;
    let at = |p: Vec3| -> Pos2 {
        let seen = turn * p;
        rect.center() + vec2(seen.x, -seen.y) * scale
    };
    edges(painter, &at, &turn, theme, false);
    painter.add(Shape::mesh(surface(light, &turn, &at, theme)));
    edges(painter, &at, &turn, theme, true);
    painter.circle_filled(rect.center(), 1.8, color(theme.ink));
    let Sh([_, x, y, z]) = light;
    if let Some(flux) = vec3(x, y, z).try_normalize() {
        painter.line_segment([rect.center(), at(flux * 1.25)], Stroke::new(1.4, color(theme.ink)));
    }
}

/// The lobe's surface, the farthest parts first.
fn surface(light: Sh<f32>, turn: &Mat3, at: &impl Fn(Vec3) -> Pos2, theme: &Theme) -> Mesh {
    let direction = |i: usize, j: usize| {
        let (up, out) = (std::f32::consts::PI * (j as f32 / DOWN as f32 - 0.5)).sin_cos();
        let (s, c) = (std::f32::consts::TAU * i as f32 / AROUND as f32).sin_cos();
        vec3(out * c, up, out * s)
    };
    let value = |d: Vec3| light.eval(d.as_dvec3());
    let all = || (0..AROUND).flat_map(|i| (0..=DOWN).map(move |j| (i, j)));
    let largest = all().map(|(i, j)| value(direction(i, j)).abs()).fold(f32::MIN_POSITIVE, f32::max);
    let mut quads: Vec<(f32, [Pos2; 4], Color32)> = Vec::with_capacity(AROUND * DOWN);
    for (i, j) in all().filter(|(_, j)| *j < DOWN) {
        let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| direction(i, j));
        let middle = (corners[0] + corners[2]).normalize_or_zero();
        let f = value(middle);
        let spots = corners.map(|d| d * (value(d).abs() / largest));
        let normal = (spots[2] - spots[0]).cross(spots[3] - spots[1]).normalize_or_zero();
        let facing = (*turn * normal).z.abs();
        let paint = match f >= 0.0 {
            true => {
                let towards = Sh([1.0, middle.x, middle.y, middle.z]);
                Paint::Direction.glyph(theme, [towards; 3], towards, Axis::Z, 1.0)
            }
            false => theme.negative,
        };
        let shaded = color(paint.towards(theme.ground, 0.5 * (1.0 - facing)));
        let depth = spots.iter().map(|p| (*turn * *p).z).sum::<f32>();
        quads.push((depth, spots.map(at), shaded));
    }
    quads.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut ink = Ink::default();
    quads.into_iter().for_each(|(_, corners, shaded)| ink.quad(corners, shaded));
    ink.mesh
}

/// The edges of the cell and the names of its axes, those behind the lobe or those before it.
fn edges(painter: &Painter, at: &impl Fn(Vec3) -> Pos2, turn: &Mat3, theme: &Theme, front: bool) {
    let corner = |i: usize| vec3((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32) * 2.0 - Vec3::ONE;
    let depth = |i: usize| (*turn * corner(i)).z;
    let nearest = (0..8).max_by(|a, b| depth(*a).total_cmp(&depth(*b))).unwrap_or(0);
    for from in 0..8usize {
        for bit in [1, 2, 4] {
            let to = from ^ bit;
            if from < to && (from == nearest || to == nearest) == front {
                let ink = color(theme.muted).gamma_multiply(if front { 0.3 } else { 0.7 });
                painter.line_segment([at(corner(from)), at(corner(to))], (1.0, ink));
            }
        }
    }
    if front {
        for (axis, name) in Vec3::AXES.into_iter().zip(["x", "y", "z"]) {
            let spot = at(vec3(-1.0, -1.0, -1.0) + axis * 2.2);
            painter.text(spot, egui::Align2::CENTER_CENTER, name, egui::FontId::proportional(11.0), color(theme.ink));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lobe_to_the_right_is_drawn_to_the_right_of_its_middle() {
        let light = Sh::<f32>::lobe(glam::DVec3::X);
        let straight = Turn { yaw: 0.0, pitch: 0.0 }.matrix();
        let at = |p: Vec3| {
            let seen = straight * p;
            egui::pos2(seen.x, -seen.y)
        };
        let mesh = surface(light, &straight, &at, &Theme::DARK);
        let most = mesh.vertices.iter().map(|v| v.pos.x).fold(0.0, f32::max);
        let least = mesh.vertices.iter().map(|v| v.pos.x).fold(0.0, f32::min);
        // A clamped cosine in two bands is 1/4 + cos/2, at most three quarters: a third of that behind.
        assert!((most - 1.0).abs() < 1e-3 && (least + 1.0 / 3.0).abs() < 0.02, "{least} {most}");
    }
}
