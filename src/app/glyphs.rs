//! A slice as triangles: cells, heat, the index volume, occluders, glyphs and level borders.

use std::sync::Arc;

use egui::{Color32, Mesh, Pos2, Rect, pos2, vec2};

use super::look::Shown;
use super::mesh::{Ink, color};
use super::view::{Heat, View};
use crate::report::colour::Theme;
use crate::report::glyph::{GlyphScale, Glyphs, Outline, fit, peak};
use crate::report::slice::SliceCell;

/// The part of the largest glyphs that may be cut off by their cells where a linear scale follows the light.
const LINEAR_QUANTILE: f32 = 0.99;

/// The intensity that a scale starts from while all is dark.
const DARK_FULL: f32 = 1.0;

/// What is the same for every view, so that they can be compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Intensities to radii.
    pub glyph: GlyphScale,
    /// The intensity that fills a cell.
    pub full: f32,
    /// The largest heat.
    pub heat: f32,
}

impl Scales {
    /// The scales for everything that is seen.
    pub fn of(view: &View, shown: &[Shown]) -> Self {
        use super::view::Scaling;
        let quantile = if view.scaling == Scaling::Linear { LINEAR_QUANTILE } else { 1.0 };
        let full = match view.fit {
            true => fit(shown.iter().map(|s| s.slice.as_ref()), view.hue(), quantile).unwrap_or(DARK_FULL),
            false => view.full.max(f32::MIN_POSITIVE),
        };
        let glyph = match view.scaling {
            Scaling::Linear => GlyphScale::Linear { full },
            Scaling::Log => GlyphScale::Log { full, decades: view.decades },
            Scaling::PerGlyph => GlyphScale::PerGlyph,
        };
        let all = shown.iter().flat_map(|shown| (0..shown.slice.cells.len()).filter_map(|i| heat(view, shown, i)));
        Scales { glyph, full, heat: all.fold(0.0, f32::max) }
    }

    /// How far along a ramp an intensity is, 0 to 1.
    fn share(&self, intensity: f32) -> f32 {
        match self.glyph {
            GlyphScale::Log { full, decades } => 1.0 + (intensity / full).log10() / decades,
            GlyphScale::Linear { .. } | GlyphScale::PerGlyph => intensity / self.full,
        }
        .clamp(0.0, 1.0)
    }
}

/// The heat of a slice's `i`-th cell, where it has any.
fn heat(view: &View, shown: &Shown, i: usize) -> Option<f32> {
    let error = || shown.errors.get(i).copied().flatten();
    match view.heat {
        Heat::None => None,
        Heat::Mean => Some(view.hue().of(shown.slice.cells[i].light).0[0].abs()),
        Heat::Absolute => error().map(|error| error.absolute),
        Heat::Relative => error().and_then(|error| error.relative),
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

/// Draws a slice into one mesh.
pub fn mesh(shown: &Shown, view: &View, scales: &Scales, theme: &Theme, placing: &Placing) -> Arc<Mesh> {
    let mut ink = Ink::default();
    let slice = &shown.slice;
    let visible = |cell: &SliceCell| {
        let square = placing.square(cell.column, cell.row, cell.span);
        placing.clip.intersects(square).then_some(square)
    };
    grounds(&mut ink, shown, view, scales, theme, placing);
    if view.cells {
        lines(&mut ink, shown, theme, placing, &visible);
    }
    if view.glyphs {
        let largest = slice.cells.iter().map(|cell| cell.span).max().unwrap_or(1) as f32 * placing.cell;
        let glyphs = Glyphs::new(slice.plane.axis, scales.glyph, ((largest * 1.5) as usize).clamp(12, 96));
        let small = Glyphs::new(slice.plane.axis, scales.glyph, ((placing.cell * 1.5) as usize).clamp(12, 96));
        let negative = view.negative.then_some(color(theme.negative));
        let mut outline = Outline::default();
        for cell in &slice.cells {
            let Some(square) = visible(cell) else { continue };
            let light = view.hue().of(cell.light);
            let pen = if cell.span > 1 { &glyphs } else { &small };
            pen.outline(light, &mut outline);
            if outline.positive.is_empty() && outline.negative.is_empty() {
                continue;
            }
            let share = scales.share(peak(light, slice.plane.axis));
            let positive = view.paint().glyph(theme, cell.light, light, slice.plane.axis, share);
            ink.glyph(&outline, square.center(), square.width(), color(positive), negative);
        }
    }
    for border in &slice.borders {
        let at = |[column, row]: [usize; 2]| placing.at(column as f32, row as f32);
        ink.line(at(border.from), at(border.to), 1.6, color(theme.ink));
    }
    Arc::new(ink.mesh)
}

/// What lies under everything: heat, the index volume, occluders.
fn grounds(ink: &mut Ink, shown: &Shown, view: &View, scales: &Scales, theme: &Theme, placing: &Placing) {
    let slice = &shown.slice;
    if view.heat != Heat::None && scales.heat > 0.0 {
        for (i, cell) in slice.cells.iter().enumerate() {
            let Some(heat) = heat(view, shown, i).filter(|heat| *heat > 0.0) else { continue };
            let share = match scales.glyph {
                GlyphScale::Log { decades, .. } => 1.0 + (heat / scales.heat).log10() / decades,
                _ => heat / scales.heat,
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

/// The cells' edges, where they are far enough apart to tell.
fn lines(
    ink: &mut Ink,
    shown: &Shown,
    theme: &Theme,
    placing: &Placing,
    visible: &impl Fn(&SliceCell) -> Option<Rect>,
) {
    let grid = color(theme.grid);
    for cell in &shown.slice.cells {
        if cell.span as f32 * placing.cell < 4.0 {
            continue;
        }
        let Some(square) = visible(cell) else { continue };
        // A line a side: the left and the lower one; the slice's own frame closes the rest.
        ink.line(square.left_bottom(), square.left_top(), 1.0, grid);
        ink.line(square.left_bottom(), square.right_bottom(), 1.0, grid);
    }
    let Rect { min, max } = placing.square(0, 0, shown.slice.side);
    ink.frame(
        Rect::from_min_max(pos2(min.x - 0.5, min.y - 0.5), pos2(max.x + 0.5, max.y + 0.5)),
        1.0,
        color(theme.muted),
    );
}
