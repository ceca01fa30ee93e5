//! A slice as triangles: cells, heat, the index volume, occluders, glyphs and level borders.

use std::sync::Arc;

use egui::{Color32, Mesh, Pos2, Rect, TextureId, pos2, vec2};

use crate::app::draw::ink::{Ink, color};
use crate::app::draw::sprites;
use crate::app::session::view::{Heat, View};
use crate::app::worker::look::Shown;
use crate::report::colour::Theme;
use crate::report::glyph::{FULL_RADIUS, GlyphScale, Glyphs, Lobes, Outline, fit};

/// The part of the largest glyphs that may be cut off by their cells where a linear scale follows the light.
const LINEAR_QUANTILE: f32 = 0.99;

/// The intensity that a scale starts from while all is dark.
const DARK_FULL: f32 = 1.0;

/// The numbers of points that outlines are made of.
const POINTS: [usize; 6] = [8, 12, 16, 24, 48, 96];
/// The smallest radius that is drawn, in points.
const SMALLEST: f32 = 0.25;
/// The radius up to which glyphs are drawn from pictures of their shapes, in pixels: an outline's triangles take ten
/// times the memory, and thousands of small glyphs are what makes a frame slow.
const LARGEST_SPRITE: f32 = 6.0;
/// The least distance of edges that are drawn, in points.
const CLOSEST_EDGES: f32 = 4.0;

/// What is the same for views that are to be compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Intensities to radii.
    pub glyph: GlyphScale,
    /// The intensity that fills a cell.
    pub full: f32,
    /// The largest heat.
    pub heat: f32,
}

/// The scales of all views: differences are far smaller than the light itself, so they have one of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// That of light.
    pub light: Scale,
    /// That of differences, where any are seen.
    pub difference: Option<Scale>,
}

impl Scales {
    /// The scales for everything that is seen.
    pub fn of(view: &View, shown: &[Shown]) -> Self {
        let (differences, light): (Vec<&Shown>, Vec<&Shown>) = shown.iter().partition(|s| s.pane.minus.is_some());
        let difference = (!differences.is_empty()).then(|| Scale::of(view, &differences));
        Scales { light: Scale::of(view, &light), difference }
    }

    /// That of a view.
    pub fn scale(&self, shown: &Shown) -> &Scale {
        self.difference.as_ref().filter(|_| shown.pane.minus.is_some()).unwrap_or(&self.light)
    }
}

impl Scale {
    fn of(view: &View, shown: &[&Shown]) -> Self {
        use crate::app::session::view::Scaling;
        let quantile = if view.scaling == Scaling::Linear { LINEAR_QUANTILE } else { 1.0 };
        let full = match view.fit {
            true => fit(shown.iter().map(|s| s.slice.as_ref()), view.hue, quantile).unwrap_or(DARK_FULL),
            false => view.full.max(f32::MIN_POSITIVE),
        };
        let glyph = match view.scaling {
            Scaling::Linear => GlyphScale::Linear { full },
            Scaling::Log => GlyphScale::Log { full, decades: view.decades },
            Scaling::PerGlyph => GlyphScale::PerGlyph,
        };
        let all = shown.iter().flat_map(|shown| (0..shown.slice.cells.len()).filter_map(|i| heat(view, shown, i)));
        Scale { glyph, full, heat: all.fold(0.0, f32::max) }
    }
}

/// The heat of a slice's `i`-th cell, where it has any.
fn heat(view: &View, shown: &Shown, i: usize) -> Option<f32> {
    let error = || shown.errors.get(i).copied().flatten();
    match view.heat {
        Heat::None => None,
        Heat::Mean => Some(view.hue.of(shown.slice.cells[i].light).0[0].abs()),
        Heat::Absolute => error().map(|error| error.absolute as f32),
        Heat::Relative => error().and_then(|error| error.relative).map(|relative| relative as f32),
    }
}

/// Where a slice lies on screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placing {
    /// What may be drawn on.
    pub clip: Rect,
    /// The slice's lower left corner.
    pub origin: Pos2,
    /// A finest cell's side, in points.
    pub cell: f32,
    /// Pixels in a point.
    pub density: f32,
}

impl Placing {
    /// A place in the slice, (column, row) from its lower left corner in finest cells, on screen.
    pub fn at(&self, column: f32, row: f32) -> Pos2 {
        self.origin + vec2(column, -row) * self.cell
    }

    /// A square of finest cells on screen.
    pub fn square(&self, column: usize, row: usize, span: usize) -> Rect {
        let side = span as f32;
        Rect::from_two_pos(self.at(column as f32, row as f32), self.at(column as f32 + side, row as f32 + side))
    }

    /// The finest cell, (column, row), under a place on screen.
    pub fn cell_at(&self, pos: Pos2, side: usize) -> Option<[usize; 2]> {
        let (column, row) = ((pos.x - self.origin.x) / self.cell, (self.origin.y - pos.y) / self.cell);
        let inside = |c: f32| (0.0..side as f32).contains(&c);
        (inside(column) && inside(row) && self.clip.contains(pos)).then_some([column as usize, row as usize])
    }
}

/// Draws a slice: all but its smallest glyphs, and over it those, as squares of the texture `sprites`.
pub fn meshes(
    shown: &Shown,
    view: &View,
    scale: &Scale,
    theme: &Theme,
    placing: &Placing,
    sprites: TextureId,
) -> [Arc<Mesh>; 2] {
    let mut ink = Ink::default();
    let mut small = Mesh::with_texture(sprites);
    grounds(&mut ink, shown, view, scale, theme, placing);
    if view.cells {
        edges(&mut ink, shown, theme, placing);
    }
    if view.glyphs {
        glyphs(&mut ink, &mut small, shown, view, scale, theme, placing);
    }
    for border in &shown.slice.borders {
        let at = |[column, row]: [usize; 2]| placing.at(column as f32, row as f32);
        ink.line(at(border.from), at(border.to), 1.6, color(theme.ink));
    }
    [ink.mesh, small].map(Arc::new)
}

/// The glyphs that can be seen, each with as many points as its size can show.
fn glyphs(
    ink: &mut Ink,
    small: &mut Mesh,
    shown: &Shown,
    view: &View,
    scale: &Scale,
    theme: &Theme,
    placing: &Placing,
) {
    let axis = shown.slice.plane.axis;
    let pens = POINTS.map(|points| Glyphs::new(axis, scale.glyph, points));
    let negative = view.negative.then_some(color(theme.negative));
    let mut outline = Outline::default();
    for cell in &shown.slice.cells {
        let square = placing.square(cell.column, cell.row, cell.span);
        if !placing.clip.intersects(square) {
            continue;
        }
        let light = view.hue.of(cell.light);
        let lobes = Lobes::of(light, axis);
        let peak = lobes.peak();
        let radius = FULL_RADIUS * square.width() * scale.glyph.share(peak, peak).min(1.0);
        if radius.is_nan() || radius < SMALLEST {
            continue;
        }
        let share = scale.glyph.share(peak, scale.full).clamp(0.0, 1.0);
        let positive = color(view.paint.glyph(theme, cell.light, light, axis, share));
        if radius * placing.density < LARGEST_SPRITE {
            sprites::glyph(small, &lobes, square.center(), radius, [Some(positive), negative]);
            continue;
        }
        let pen = POINTS.iter().position(|points| *points as f32 >= 3.0 * radius).unwrap_or(POINTS.len() - 1);
        pens[pen].outline(light, &mut outline);
        ink.glyph(&outline, square.center(), square.width(), positive, negative);
    }
}

/// What lies under everything: heat, the index volume, occluders.
fn grounds(ink: &mut Ink, shown: &Shown, view: &View, scale: &Scale, theme: &Theme, placing: &Placing) {
    let slice = &shown.slice;
    if view.heat != Heat::None && scale.heat > 0.0 {
        for (i, cell) in slice.cells.iter().enumerate() {
            let Some(heat) = heat(view, shown, i).filter(|heat| *heat > 0.0) else { continue };
            let share = match scale.glyph {
                GlyphScale::Log { decades, .. } => 1.0 + (heat / scale.heat).log10() / decades,
                _ => heat / scale.heat,
            };
            ink.rect(placing.square(cell.column, cell.row, cell.span), color(theme.heat(share.clamp(0.0, 1.0))));
        }
    }
    if view.levels {
        for (i, level) in shown.index.iter().enumerate() {
            let square = placing.square(i % slice.side, i / slice.side, 1);
            ink.rect(square, level_tint(theme, usize::from(*level)));
        }
    }
    if view.occluders {
        for [column, row] in &shown.occupied {
            ink.rect(placing.square(*column, *row, 1), color(theme.muted).gamma_multiply(0.55));
        }
    }
}

/// The tint of cells that are sampled from `level`.
pub fn level_tint(theme: &Theme, level: usize) -> Color32 {
    color(theme.curve(level)).gamma_multiply(0.28)
}

/// The cells' edges, where they are far enough apart to tell, joined to lines as long as can be.
fn edges(ink: &mut Ink, shown: &Shown, theme: &Theme, placing: &Placing) {
    let side = shown.slice.side;
    // Whether there is an edge below, or to the left of, each finest cell.
    let (mut below, mut left) = (vec![false; side * side], vec![false; side * side]);
    for cell in shown.slice.cells.iter().filter(|cell| cell.span as f32 * placing.cell >= CLOSEST_EDGES) {
        for i in 0..cell.span {
            below[cell.row * side + cell.column + i] = true;
            left[cell.column * side + cell.row + i] = true;
        }
    }
    let grid = color(theme.grid);
    for line in 0..side {
        let at = line as f32;
        for (from, to) in runs(&below[line * side..(line + 1) * side]) {
            ink.line(placing.at(from as f32, at), placing.at(to as f32, at), 1.0, grid);
        }
        for (from, to) in runs(&left[line * side..(line + 1) * side]) {
            ink.line(placing.at(at, from as f32), placing.at(at, to as f32), 1.0, grid);
        }
    }
    let Rect { min, max } = placing.square(0, 0, side);
    ink.frame(
        Rect::from_min_max(pos2(min.x - 0.5, min.y - 0.5), pos2(max.x + 0.5, max.y + 0.5)),
        1.0,
        color(theme.muted),
    );
}

/// Where `true` stands without a gap: the first place of each run, and the one after its last.
fn runs(marks: &[bool]) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for (i, _) in marks.iter().enumerate().filter(|(_, mark)| **mark) {
        match runs.last_mut() {
            Some((_, end)) if *end == i => *end += 1,
            _ => runs.push((i, i + 1)),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_joined_to_runs() {
        assert_eq!(runs(&[true, true, false, true]), [(0, 2), (3, 4)]);
        assert_eq!(runs(&[false; 3]), []);
    }

    #[test]
    fn a_place_on_screen_is_in_the_cell_that_is_drawn_there() {
        let clip = Rect::from_min_size(pos2(10.0, 20.0), vec2(80.0, 80.0));
        let placing = Placing { clip, origin: clip.left_bottom(), cell: 10.0, density: 1.0 };
        for at in [[0, 0], [7, 0], [3, 5]] {
            let middle = placing.square(at[0], at[1], 1).center();
            assert_eq!(placing.cell_at(middle, 8), Some(at));
        }
        assert_eq!(placing.cell_at(pos2(9.0, 50.0), 8), None);
    }
}
