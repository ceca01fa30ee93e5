//! Polygons cut to rectangles: the glyph of a coarse cell is seen only where nothing finer covers it.

use egui::{Pos2, Rect, pos2};

/// What of a convex polygon lies in a rectangle: Sutherland and Hodgman, "Reentrant polygon clipping" (1974), edge by
/// edge. `room` is overwritten; the answer is in `polygon`.
pub fn to_rect(polygon: &mut Vec<Pos2>, rect: Rect, room: &mut Vec<Pos2>) {
    let edges: [(usize, f32, f32); 4] =
        [(0, rect.left(), 1.0), (0, rect.right(), -1.0), (1, rect.top(), 1.0), (1, rect.bottom(), -1.0)];
    for (axis, at, sign) in edges {
        room.clear();
        // How far a corner is inside this edge.
        let inside = |p: Pos2| sign * (if axis == 0 { p.x } else { p.y } - at);
        for i in 0..polygon.len() {
            let (from, to) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            let (a, b) = (inside(from), inside(to));
            if a >= 0.0 {
                room.push(from);
            }
            if (a >= 0.0) != (b >= 0.0) {
                let t = a / (a - b);
                room.push(pos2(from.x + t * (to.x - from.x), from.y + t * (to.y - from.y)));
            }
        }
        std::mem::swap(polygon, room);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the area of a polygon.
    fn area(polygon: &[Pos2]) -> f32 {
        let next = |i: usize| polygon[(i + 1) % polygon.len()];
        polygon.iter().enumerate().map(|(i, p)| p.x * next(i).y - next(i).x * p.y).sum::<f32>().abs() / 2.0
    }

    #[test]
    fn a_triangle_is_cut_by_each_edge() {
        let triangle = [pos2(0.0, 0.0), pos2(4.0, 0.0), pos2(0.0, 4.0)];
        for (rect, expected) in [
            (Rect::from_min_max(pos2(-1.0, -1.0), pos2(5.0, 5.0)), 8.0),
            (Rect::from_min_max(pos2(0.0, 0.0), pos2(2.0, 2.0)), 4.0),
            (Rect::from_min_max(pos2(1.0, 0.0), pos2(4.0, 4.0)), 4.5),
            (Rect::from_min_max(pos2(3.0, 3.0), pos2(4.0, 4.0)), 0.0),
        ] {
            let mut polygon = triangle.to_vec();
            to_rect(&mut polygon, rect, &mut Vec::new());
            assert!((area(&polygon) - expected).abs() < 1e-5, "{rect:?}: {polygon:?}");
        }
    }
}
