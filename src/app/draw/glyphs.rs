//! A slice as triangles: cells, heat, the index volume, occluders, glyphs and level borders.

use std::sync::Arc;

use egui::{Color32, Mesh, Rect, pos2};

use super::ink::{Ink, color};
use super::lobes;
use super::placing::{Placing, Style};
use super::scales::{Scale, heat};
use crate::app::session::view::{Heat, View};
use crate::app::worker::look::Shown;
use crate::report::colour::Theme;
use crate::report::glyph::GlyphScale;

/// The least distance of edges that are drawn, in points.
const CLOSEST_EDGES: f32 = 4.0;

/// Draws a slice: all but its smallest glyphs, and over it those, as squares of a texture.
pub fn meshes(shown: &Shown, style: &Style, placing: &Placing) -> [Arc<Mesh>; 2] {
    let Style { view, scale, theme, .. } = *style;
    let mut ink = Ink::default();
    let mut small = Mesh::with_texture(style.sprites);
    grounds(&mut ink, shown, view, &scale, theme, placing);
    if view.cells {
        edges(&mut ink, shown, theme, placing);
    }
    if view.glyphs {
        lobes::draw(&mut ink, &mut small, shown, style, placing);
    }
    for border in &shown.slice.borders {
        let at = |[column, row]: [usize; 2]| placing.at(column as f32, row as f32);
        ink.line(at(border.from), at(border.to), 1.6, color(theme.ink));
    }
    [ink.mesh, small].map(Arc::new)
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
        for (row, levels) in shown.index.chunks(slice.side.max(1)).enumerate() {
            let mut column = 0;
            for alike in levels.chunk_by(|a, b| a == b) {
                let (low, high) = (column as f32, (column + alike.len()) as f32);
                let strip = Rect::from_two_pos(placing.at(low, row as f32), placing.at(high, row as f32 + 1.0));
                ink.rect(strip, level_tint(theme, usize::from(alike[0])));
                column += alike.len();
            }
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
}
