//! Where a slice lies on screen, and how it is drawn.

use egui::{Pos2, Rect, TextureId, vec2};

use super::scales::Scale;
use crate::app::session::view::View;
use crate::report::colour::{Paint, Theme};

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

    /// The finest cell, (column, row), nearest to a place on screen.
    pub fn nearest(&self, pos: Pos2, side: usize) -> [usize; 2] {
        let cell = |offset: f32| ((offset / self.cell).floor().max(0.0) as usize).min(side.saturating_sub(1));
        [cell(pos.x - self.origin.x), cell(self.origin.y - pos.y)]
    }

    /// The finest cell, (column, row), under a place on screen.
    pub fn cell_at(&self, pos: Pos2, side: usize) -> Option<[usize; 2]> {
        let (column, row) = ((pos.x - self.origin.x) / self.cell, (self.origin.y - pos.y) / self.cell);
        let inside = |c: f32| (0.0..side as f32).contains(&c);
        (inside(column) && inside(row) && self.clip.contains(pos)).then_some([column as usize, row as usize])
    }
}

/// How a slice is drawn.
#[derive(Clone, Copy)]
pub struct Style<'a> {
    /// How light is looked at.
    pub view: &'a View,
    /// What glyphs' colours tell.
    pub paint: Paint,
    /// What makes a glyph fill its cell.
    pub scale: Scale,
    /// The colours.
    pub theme: &'a Theme,
    /// The texture of small glyphs.
    pub sprites: TextureId,
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn a_place_on_screen_is_in_the_cell_that_is_drawn_there() {
        let clip = Rect::from_min_size(pos2(10.0, 20.0), vec2(80.0, 80.0));
        let placing = Placing { clip, origin: clip.left_bottom(), cell: 10.0, density: 1.0 };
        for at in [[0, 0], [7, 0], [3, 5]] {
            let middle = placing.square(at[0], at[1], 1).center();
            assert_eq!(placing.cell_at(middle, 8), Some(at));
            assert_eq!(placing.nearest(middle, 8), at);
        }
        assert_eq!(placing.cell_at(pos2(9.0, 50.0), 8), None);
        assert_eq!(placing.nearest(pos2(-90.0, 5000.0), 8), [0, 0]);
    }
}
