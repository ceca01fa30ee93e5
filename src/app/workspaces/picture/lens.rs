//! One zoom and one place for all pictures, and what is under the pointer in them.

use egui::{Pos2, Rect, Vec2, pos2, vec2};

/// The most that a picture is magnified.
const MOST: f32 = 64.0;

/// Which part of every picture is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// How much larger than fitting.
    zoom: f32,
    /// The part's middle, in shares of the picture from its top left.
    middle: Vec2,
}

impl Default for Lens {
    fn default() -> Self {
        Lens { zoom: 1.0, middle: Vec2::splat(0.5) }
    }
}

impl Lens {
    /// The part that is seen, in shares of the picture.
    pub fn part(&self) -> Rect {
        Rect::from_center_size(self.middle.to_pos2(), Vec2::splat(1.0 / self.zoom))
    }

    /// The place in the picture, in shares of it, that a point on screen shows; `tile` is where the picture is.
    pub fn place(&self, tile: Rect, at: Pos2) -> Pos2 {
        let part = self.part();
        part.min + (at - tile.min) / tile.size() * part.size()
    }

    /// The point on screen that shows a place in the picture, in shares of it.
    pub fn screen(&self, tile: Rect, place: Pos2) -> Pos2 {
        let part = self.part();
        tile.min + (place - part.min) / part.size() * tile.size()
    }

    /// Magnifies by `by` so that what is under the pointer stays there.
    pub fn zoom(&mut self, tile: Rect, pointer: Pos2, by: f32) {
        let before = self.place(tile, pointer);
        self.zoom = (self.zoom * by).clamp(1.0, MOST);
        let after = self.place(tile, pointer);
        self.middle += before - after;
        self.keep_inside();
    }

    /// Moves the picture with the pointer.
    pub fn pan(&mut self, tile: Rect, by: Vec2) {
        self.middle -= by / tile.size() / self.zoom;
        self.keep_inside();
    }

    /// What is beyond a picture's edges is never seen.
    fn keep_inside(&mut self) {
        let half = 0.5 / self.zoom;
        self.middle = self.middle.clamp(Vec2::splat(half), Vec2::splat(1.0 - half));
    }
}

/// How much smaller tiles may be that fill all their rows than those that are as large as can be: pictures that belong
/// together are then in line.
const IN_LINE: f32 = 0.85;

/// Where `count` square tiles with a title above each are as large as can be in a room, or nearly so and in full rows:
/// their squares, row by row.
pub fn tiles(room: Rect, count: usize, title: f32, gap: f32) -> Vec<Rect> {
    let side = |columns: usize| {
        let rows = count.div_ceil(columns) as f32;
        let wide = (room.width() - gap * (columns - 1) as f32) / columns as f32;
        wide.min((room.height() - gap * (rows - 1.0)) / rows - title)
    };
    let largest = |columns: &mut dyn Iterator<Item = usize>| columns.max_by(|a, b| side(*a).total_cmp(&side(*b)));
    let best = largest(&mut (1..=count.max(1))).unwrap_or(1);
    let full = largest(&mut (1..=count).filter(|columns| count.is_multiple_of(*columns)));
    let best = full.filter(|full| side(*full) >= IN_LINE * side(best)).unwrap_or(best);
    let side = side(best).max(8.0);
    let tile = |i: usize| {
        let (column, row) = ((i % best) as f32, (i / best) as f32);
        let corner = vec2(column * (side + gap), row * (side + title + gap) + title);
        Rect::from_min_size(room.min + corner, Vec2::splat(side))
    };
    (0..count).map(tile).collect()
}

/// The pixel at a place, in shares of a picture of so many pixels along a side.
pub fn pixel(place: Pos2, side: usize) -> Option<[usize; 2]> {
    let inside = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)).contains(place);
    let of = |share: f32| ((share * side as f32) as usize).min(side.saturating_sub(1));
    (inside && side > 0).then(|| [of(place.x), of(place.y)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_under_the_pointer_stays_there_and_comes_back() {
        let tile = Rect::from_min_size(pos2(100.0, 50.0), Vec2::splat(200.0));
        let (mut lens, pointer) = (Lens::default(), pos2(150.0, 200.0));
        let place = lens.place(tile, pointer);
        assert!((place - pos2(0.25, 0.75)).length() < 1e-6);
        lens.zoom(tile, pointer, 4.0);
        assert!((lens.place(tile, pointer) - place).length() < 1e-6);
        assert!((lens.screen(tile, place) - pointer).length() < 1e-3);
        lens.pan(tile, vec2(-1e6, 0.0));
        assert!((lens.part().max.x - 1.0).abs() < 1e-6, "a picture is not panned off its tile");
        lens.zoom(tile, pointer, 0.0);
        assert_eq!(lens, Lens::default());
    }

    #[test]
    fn tiles_are_as_large_as_can_be_and_do_not_overlap() {
        let room = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 220.0));
        // Two in a row: 195 wide and 200 high; one above the other they would be 85 high.
        let two = tiles(room, 2, 20.0, 10.0);
        assert_eq!([two[0].width(), two[1].left(), two[1].top()], [195.0, 205.0, 20.0]);
        // Two and two are as large as three and one: (580 − 10)/2 − 20.
        let four = tiles(Rect::from_min_size(Pos2::ZERO, vec2(1000.0, 580.0)), 4, 20.0, 10.0);
        assert_eq!(four.iter().map(|tile| tile.top()).collect::<Vec<_>>(), [20.0, 20.0, 315.0, 315.0]);
        assert_eq!(four[0].width(), 265.0);
        let seven = tiles(room, 7, 20.0, 10.0);
        for (i, a) in seven.iter().enumerate() {
            assert!(room.contains_rect(*a));
            assert!(seven[i + 1..].iter().all(|b| !a.intersects(*b)));
        }
        assert!(tiles(room, 0, 20.0, 10.0).is_empty());
    }

    #[test]
    fn pixels_are_counted_from_the_top_left() {
        assert_eq!(pixel(pos2(0.0, 1.0), 4), Some([0, 3]));
        assert_eq!(pixel(pos2(0.5, 0.24), 4), Some([2, 0]));
        assert_eq!((pixel(pos2(1.1, 0.0), 4), pixel(pos2(0.0, 0.0), 0)), (None, None));
    }
}
