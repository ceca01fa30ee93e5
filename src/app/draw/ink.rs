//! Triangles: squares, lines and glyphs, all of one layer in one mesh.

use egui::epaint::{Vertex, WHITE_UV};
use egui::{Color32, Mesh, Pos2, Rect, pos2};

use crate::report::colour::Rgb;
use crate::report::glyph::Outline;

/// Half the width of the transparent skirt that makes edges smooth, in points.
const FEATHER: f32 = 0.6;

/// A colour of the report's as egui has it.
pub fn color(Rgb([r, g, b]): Rgb) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// A mesh that is being filled.
#[derive(Debug, Default)]
pub struct Ink {
    /// What has been drawn so far.
    pub mesh: Mesh,
}

impl Ink {
    fn vertex(&mut self, pos: Pos2, color: Color32) -> u32 {
        let index = self.mesh.vertices.len() as u32;
        self.mesh.vertices.push(Vertex { pos, uv: WHITE_UV, color });
        index
    }

    /// A filled rectangle.
    pub fn rect(&mut self, rect: Rect, color: Color32) {
        self.quad([rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom()], color);
    }

    /// A filled convex four-sided figure.
    pub fn quad(&mut self, corners: [Pos2; 4], color: Color32) {
        let [a, b, c, d] = corners.map(|corner| self.vertex(corner, color));
        self.mesh.indices.extend([a, b, c, a, c, d]);
    }

    /// A filled convex polygon; nothing where it has no area.
    pub fn fan(&mut self, corners: &[Pos2], color: Color32) {
        let [first, .., _] = corners else { return };
        let first = self.vertex(*first, color);
        let rest: Vec<u32> = corners[1..].iter().map(|corner| self.vertex(*corner, color)).collect();
        self.mesh.indices.extend(rest.windows(2).flat_map(|pair| [first, pair[0], pair[1]]));
    }

    /// The frame of a rectangle, `width` points thick, inside it.
    pub fn frame(&mut self, rect: Rect, width: f32, color: Color32) {
        let Rect { min, max } = rect;
        self.rect(Rect::from_min_max(min, pos2(max.x, min.y + width)), color);
        self.rect(Rect::from_min_max(pos2(min.x, max.y - width), max), color);
        self.rect(Rect::from_min_max(min, pos2(min.x + width, max.y)), color);
        self.rect(Rect::from_min_max(pos2(max.x - width, min.y), max), color);
    }

    /// A level or upright line `width` points thick, its ends lengthened to close corners.
    pub fn line(&mut self, from: Pos2, to: Pos2, width: f32, color: Color32) {
        self.rect(Rect::from_two_pos(from, to).expand(width / 2.0), color);
    }

    /// Both lobes of a glyph, around `centre`, in a cell `side` points wide.
    pub fn glyph(&mut self, outline: &Outline, centre: Pos2, side: f32, positive: Color32, negative: Option<Color32>) {
        self.lobe(&outline.positive, centre, side, positive);
        if let Some(negative) = negative {
            self.lobe(&outline.negative, centre, side, negative);
        }
    }

    /// A polygon that can be seen whole from `centre`, with a smooth edge. Its y points upwards.
    fn lobe(&mut self, polygon: &[[f32; 2]], centre: Pos2, side: f32, color: Color32) {
        let count = polygon.len() as u32;
        if count < 3 {
            return;
        }
        let middle = self.vertex(centre, color);
        let first = middle + 1;
        self.mesh.vertices.reserve(2 * polygon.len());
        for [x, y] in polygon {
            let (x, y) = (x * side, -y * side);
            // Outwards is away from the middle, which is near enough for an edge thinner than a point.
            let out = FEATHER / x.hypot(y).max(FEATHER);
            self.vertex(centre + egui::vec2(x, y), color);
            self.vertex(centre + egui::vec2(x * (1.0 + out), y * (1.0 + out)), Color32::TRANSPARENT);
        }
        self.mesh.indices.reserve(9 * polygon.len());
        for k in 0..count {
            let (inner, next) = (first + 2 * k, first + 2 * ((k + 1) % count));
            self.mesh.indices.extend([middle, inner, next, inner, inner + 1, next, next, inner + 1, next + 1]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_glyph_is_a_fan_with_a_skirt_that_fades_out() {
        let outline = Outline {
            positive: vec![[0.4, 0.0], [0.0, 0.4], [-0.4, 0.0], [0.0, -0.4]],
            negative: vec![[0.1, 0.0], [0.0, 0.1], [0.0, 0.0]],
            clipped: false,
        };
        let mut ink = Ink::default();
        ink.glyph(&outline, pos2(50.0, 50.0), 100.0, Color32::RED, None);
        assert!(ink.mesh.is_valid());
        assert_eq!((ink.mesh.vertices.len(), ink.mesh.indices.len()), (9, 36));
        let solid: Vec<Pos2> = ink.mesh.vertices.iter().filter(|v| v.color == Color32::RED).map(|v| v.pos).collect();
        // y grows upwards in outlines and downwards on screen.
        assert_eq!(solid, [pos2(50.0, 50.0), pos2(90.0, 50.0), pos2(50.0, 10.0), pos2(10.0, 50.0), pos2(50.0, 90.0)]);
        ink.glyph(&outline, pos2(50.0, 50.0), 100.0, Color32::RED, Some(Color32::BLUE));
        assert!(ink.mesh.vertices.iter().any(|v| v.color == Color32::BLUE));
    }
}
