//! The glyphs of a slice: each lobe as large and as round as its light is, a dot in its cell's middle and a tick towards
//! where the light goes, so that a lobe is told from a ball.

use std::collections::HashMap;

use egui::{Color32, Mesh, Pos2, Rect, vec2};

use super::clip;
use super::ink::{Ink, color};
use super::placing::{Placing, Style};
use super::sprites;
use crate::app::worker::look::Shown;
use crate::field::Cell;
use crate::report::glyph::{FULL_RADIUS, Glyphs, Lobes, Outline};
use crate::report::slice::{Axis, SliceCell};

/// The numbers of points that outlines are made of.
const POINTS: [usize; 6] = [8, 12, 16, 24, 48, 96];
/// The smallest radius that is drawn, in points.
const SMALLEST: f32 = 0.25;
/// The radius up to which glyphs are drawn from pictures of their shapes, in pixels: an outline's triangles take ten
/// times the memory, and thousands of small glyphs are what makes a frame slow.
const LARGEST_SPRITE: f32 = 6.0;
/// The least side of a cell in which its middle and its flux are marked, in points.
const MARKED_FROM: f32 = 18.0;

/// Draws the glyphs that can be seen into `ink`, those too small for outlines into `small`. A coarse sample that finer
/// ones cover in part is one glyph of its own size, seen where nothing finer is: that is how it is sampled.
pub fn draw(ink: &mut Ink, small: &mut Mesh, shown: &Shown, style: &Style, placing: &Placing) {
    let axis = shown.slice.plane.axis;
    let mut pen = Pen {
        ink,
        small,
        style,
        axis,
        density: placing.density,
        negative: style.view.negative.then(|| color(style.paint.negative(style.theme))),
        glyphs: POINTS.map(|points| Glyphs::new(axis, style.scale.glyph, points)),
        outline: Outline::default(),
        corners: [Vec::new(), Vec::new()],
    };
    let mut cut_up: HashMap<(usize, Cell), Vec<Rect>> = HashMap::new();
    for cell in &shown.slice.cells {
        let square = placing.square(cell.column, cell.row, cell.span);
        if cell.span < 1 << cell.level {
            cut_up.entry((cell.level, cell.cell)).or_default().push(square);
        } else if placing.clip.intersects(square) {
            pen.glyph(cell, square, None);
        }
    }
    for cell in shown.slice.cells.iter().filter(|cell| cell.span < 1 << cell.level) {
        let Some(mut parts) = cut_up.remove(&(cell.level, cell.cell)) else { continue };
        let [column, row] = [axis.columns(), axis.rows()].map(|part| cell.cell[part] << cell.level);
        let square = placing.square(column, row, 1 << cell.level);
        if placing.clip.intersects(square) {
            join(&mut parts);
            pen.glyph(cell, square, Some(&parts));
        }
    }
}

/// Joins squares that lie side by side in a row.
fn join(parts: &mut Vec<Rect>) {
    parts.sort_by(|a, b| a.top().total_cmp(&b.top()).then(a.left().total_cmp(&b.left())));
    parts.dedup_by(|next, last| {
        let beside = next.y_range() == last.y_range() && (next.left() - last.right()).abs() < 1e-3;
        if beside {
            last.max.x = next.right();
        }
        beside
    });
}

/// What glyphs are drawn with.
struct Pen<'a> {
    ink: &'a mut Ink,
    small: &'a mut Mesh,
    style: &'a Style<'a>,
    axis: Axis,
    density: f32,
    negative: Option<Color32>,
    glyphs: [Glyphs; 6],
    outline: Outline,
    corners: [Vec<Pos2>; 2],
}

impl Pen<'_> {
    /// Draws the light of `cell` in a square on screen; only within `parts` of it where there are any.
    fn glyph(&mut self, cell: &SliceCell, square: Rect, parts: Option<&[Rect]>) {
        let Style { view, paint, scale, theme, .. } = *self.style;
        let light = view.hue.of(cell.light);
        let lobes = Lobes::of(light, self.axis);
        let peak = lobes.peak();
        let radius = FULL_RADIUS * square.width() * scale.glyph.share(peak, peak).min(1.0);
        if radius.is_nan() || radius < SMALLEST {
            return;
        }
        let share = scale.glyph.share(peak, scale.full).clamp(0.0, 1.0);
        let positive = color(paint.glyph(theme, cell.light, light, self.axis, share));
        if radius * self.density < LARGEST_SPRITE {
            sprites::glyph(self.small, &lobes, square.center(), radius, [Some(positive), self.negative]);
            return;
        }
        let pen = POINTS.iter().position(|points| *points as f32 >= 3.0 * radius).unwrap_or(POINTS.len() - 1);
        self.glyphs[pen].outline(light, &mut self.outline);
        match parts {
            None => self.ink.glyph(&self.outline, square.center(), square.width(), positive, self.negative),
            Some(parts) => self.parts(square, parts, positive),
        }
        if view.flux && square.width() >= MARKED_FROM {
            self.flux(&lobes, square, radius);
        }
    }

    /// Draws the outline as far as it lies in `parts`.
    fn parts(&mut self, square: Rect, parts: &[Rect], positive: Color32) {
        let lobes = [(&self.outline.positive, Some(positive)), (&self.outline.negative, self.negative)];
        let [corners, room] = &mut self.corners;
        for (polygon, ink) in lobes {
            let Some(ink) = ink.filter(|_| polygon.len() > 2) else { continue };
            let at = |[x, y]: [f32; 2]| square.center() + vec2(x, -y) * square.width();
            for (i, from) in polygon.iter().enumerate() {
                let slice = [square.center(), at(*from), at(polygon[(i + 1) % polygon.len()])];
                for part in parts {
                    corners.clear();
                    corners.extend(slice);
                    clip::to_rect(corners, *part, room);
                    self.ink.fan(corners, ink);
                }
            }
        }
    }

    /// A dot in the middle of the cell, and a tick from it as far as the lobe reaches.
    fn flux(&mut self, lobes: &Lobes, square: Rect, radius: f32) {
        let ink = color(self.style.theme.ink).gamma_multiply(0.75);
        let middle = square.center();
        self.ink.rect(Rect::from_center_size(middle, vec2(2.4, 2.4)), ink);
        let [right, up] = lobes.peak_direction();
        // A ball has no direction; what is left of one is told by how far its lobe is from round.
        let reach = radius * (1.0 - lobes.roundness().clamp(0.0, 1.0)).sqrt();
        if reach > 3.0 {
            let along = vec2(right, -up);
            let across = vec2(along.y, -along.x) * 0.6;
            let tip = middle + along * reach;
            self.ink.quad([middle - across, middle + across, tip + across, tip - across], ink);
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn parts_in_a_row_are_joined_and_cover_what_they_covered() {
        let square = |column: usize, row: usize| Rect::from_min_size(pos2(column as f32, row as f32), vec2(1.0, 1.0));
        let mut parts = vec![square(1, 0), square(0, 0), square(3, 0), square(0, 1)];
        join(&mut parts);
        assert_eq!(parts.len(), 3);
        assert!((parts.iter().map(|part| part.area()).sum::<f32>() - 4.0).abs() < 1e-6);
    }
}
