//! Glyphs too small for their outlines to be told from pictures: each lobe is one square of a texture.
//!
//! Within a slice a two-band function is f(θ) = m + s·cos(θ − φ), so but for size and direction a lobe's shape is told
//! by one number, the roundness m/(|m| + s): −1 nothing, 0 a circle through the middle, 1 a circle about it. The
//! negative lobe is the positive one of −f, which points the other way.

use egui::epaint::Vertex;
use egui::{Color32, ColorImage, Context, Mesh, Pos2, TextureHandle, TextureOptions, pos2, vec2};

use crate::report::glyph::Lobes;

/// Shapes that are told apart, evenly from roundness −1 to 1.
const SHAPES: usize = 64;
/// A shape's square in the texture, in texels, and the radius of a full glyph in it: the rest keeps neighbours apart.
const SQUARE: usize = 16;
const RADIUS: f32 = 6.5;
/// Samples along a side of a texel.
const FINE: usize = 4;

/// The texture of all shapes, side by side, for a peak to the right.
pub fn texture(ctx: &Context) -> TextureHandle {
    let mut image = ColorImage::filled([SHAPES * SQUARE, SQUARE], Color32::TRANSPARENT);
    for shape in 0..SHAPES {
        for (y, x) in (0..SQUARE).flat_map(|y| (0..SQUARE).map(move |x| (y, x))) {
            image[(shape * SQUARE + x, y)] = Color32::from_white_alpha((255.0 * covered(shape, x, y)).round() as u8);
        }
    }
    ctx.load_texture("small glyphs", image, TextureOptions::LINEAR)
}

fn roundness(shape: usize) -> f32 {
    2.0 * shape as f32 / (SHAPES - 1) as f32 - 1.0
}

/// The share of a texel that lies within a shape.
fn covered(shape: usize, x: usize, y: usize) -> f32 {
    let roundness = roundness(shape);
    let at = |texel: usize, i: usize| texel as f32 + (i as f32 + 0.5) / FINE as f32 - SQUARE as f32 / 2.0;
    let inside = |x: f32, y: f32| {
        let distance = x.hypot(y);
        distance <= RADIUS * (roundness + (1.0 - roundness.abs()) * x / distance)
    };
    let samples = (0..FINE * FINE).filter(|i| inside(at(x, i % FINE), at(y, i / FINE)));
    samples.count() as f32 / (FINE * FINE) as f32
}

/// Draws lobes whose largest radius is `radius` points around `centre`; a lobe without a colour is left out.
pub fn glyph(mesh: &mut Mesh, lobes: &Lobes, centre: Pos2, radius: f32, [positive, negative]: [Option<Color32>; 2]) {
    let roundness = lobes.roundness();
    let [right, up] = lobes.peak_direction();
    for (color, sign) in [(positive, 1.0), (negative, -1.0)] {
        let shape = ((sign * roundness + 1.0) / 2.0 * (SHAPES - 1) as f32).round() as usize;
        let (Some(color), true) = (color, shape > 0) else { continue };
        // The screen's y points down.
        let half = 0.5 * SQUARE as f32 / RADIUS * radius;
        let (along, across) = (vec2(right, -up) * (sign * half), vec2(up, right) * (sign * half));
        let first = mesh.vertices.len() as u32;
        let (left, width) = (shape as f32 / SHAPES as f32, 1.0 / SHAPES as f32);
        let corners = [
            (centre - along - across, pos2(left, 0.0)),
            (centre + along - across, pos2(left + width, 0.0)),
            (centre + along + across, pos2(left + width, 1.0)),
            (centre - along + across, pos2(left, 1.0)),
        ];
        mesh.vertices.extend(corners.map(|(pos, uv)| Vertex { pos, uv, color }));
        mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::slice::Axis;
    use crate::sh::Sh;

    #[test]
    fn the_shapes_are_nothing_a_disc_to_the_right_and_a_disc_about_the_middle() {
        let row = |shape: usize| (0..SQUARE).map(|x| covered(shape, x, SQUARE / 2)).collect::<Vec<_>>();
        assert!(row(0).iter().all(|share| *share == 0.0));
        let round = row(SHAPES - 1);
        let filled: Vec<usize> = (0..SQUARE).filter(|x| round[*x] > 0.9).collect();
        assert_eq!((filled[0], filled[filled.len() - 1]), (2, 13));
        // A dipole's lobe lies to the right of the middle only.
        let dipole = row(SHAPES / 2);
        assert!(dipole[..8].iter().all(|share| *share < 0.05) && dipole[9..14].iter().all(|share| *share > 0.9));
    }

    #[test]
    fn a_lobe_points_where_its_light_goes_and_its_negative_the_other_way() {
        // Light to +X: cells are cut across Z, so the peak is to the right.
        let lobes = Lobes::of(Sh::<f32>::lobe(glam::DVec3::X), Axis::Z);
        let mut mesh = Mesh::default();
        glyph(&mut mesh, &lobes, pos2(50.0, 50.0), RADIUS, [Some(Color32::RED), Some(Color32::BLUE)]);
        assert!(mesh.is_valid());
        assert_eq!(mesh.vertices.len(), 8);
        // The texture's right edge is where the light goes.
        let ahead = |vertices: &[Vertex]| vertices[1].pos.x - vertices[0].pos.x;
        assert!((ahead(&mesh.vertices[..4]) - SQUARE as f32).abs() < 1e-3);
        assert!((ahead(&mesh.vertices[4..]) + SQUARE as f32).abs() < 1e-3);
        assert!(mesh.vertices[..4].iter().all(|v| v.color == Color32::RED));
    }
}
