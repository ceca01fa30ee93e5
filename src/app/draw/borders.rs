//! The numbers of the levels on both sides of their borders, where there is room for them.

use egui::{Align2, FontId, Painter, Pos2, vec2};

use super::ink::color;
use super::placing::Placing;
use crate::app::worker::look::Shown;
use crate::report::colour::Theme;
use crate::report::slice::Border;

/// The least length of a border that is numbered, and the least way between two numbers, in points.
const LEAST: f32 = 28.0;
const APART: f32 = 90.0;

/// Writes them.
pub fn number(painter: &Painter, shown: &Shown, placing: &Placing, theme: &Theme) {
    let mut written: Vec<Pos2> = Vec::new();
    let font = FontId::proportional(10.0);
    for Border { from, to } in &shown.slice.borders {
        let at = |[column, row]: [usize; 2]| placing.at(column as f32, row as f32);
        let (start, end) = (at(*from), at(*to));
        let middle = start.lerp(end, 0.5);
        let far = written.iter().all(|other| other.distance(middle) > APART);
        if start.distance(end) < LEAST || !placing.clip.contains(middle) || !far {
            continue;
        }
        written.push(middle);
        let half = [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2];
        let upright = from[0] == to[0];
        let [column, row] = half;
        let (before, after) = match upright {
            true => ([column.wrapping_sub(1), row], [column, row]),
            false => ([column, row.wrapping_sub(1)], [column, row]),
        };
        let out = if upright { vec2(7.0, 0.0) } else { vec2(0.0, -7.0) };
        for (cell, place) in [(before, middle - out), (after, middle + out)] {
            let Some(level) = level_at(shown, cell) else { continue };
            let galley = painter.layout_no_wrap(level.to_string(), font.clone(), color(theme.ink));
            let rect = Align2::CENTER_CENTER.anchor_size(place, galley.size());
            painter.rect_filled(rect.expand2(vec2(1.5, -1.0)), 2.0, color(theme.ground).gamma_multiply(0.75));
            painter.galley(rect.min, galley, color(theme.ink));
        }
    }
}

/// The level that a finest cell is sampled from.
fn level_at(shown: &Shown, [column, row]: [usize; 2]) -> Option<u8> {
    let side = shown.slice.side;
    (column < side && row < side).then(|| shown.index.get(row * side + column).copied()).flatten()
}
