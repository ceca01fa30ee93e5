//! Where the plane of a slice cuts a mesh: lines over the cells that it passes through.

use std::sync::Arc;

use egui::{Painter, Stroke};

use super::ink::color;
use super::placing::Placing;
use crate::report::colour::Theme;
use crate::report::slice::Plane;
use crate::scene::Stage;

/// A line in a slice, from and to a (column, row) in finest cells.
type Line = [[f32; 2]; 2];

/// The lines of the slice that was drawn last.
#[derive(Debug, Default)]
pub struct MeshCut {
    known: Option<(Arc<Stage>, Plane, Vec<Line>)>,
}

impl MeshCut {
    /// Draws the cut of a scene by a plane.
    pub fn draw(&mut self, painter: &Painter, stage: &Arc<Stage>, plane: Plane, placing: &Placing, theme: &Theme) {
        if self.known.as_ref().is_none_or(|(of, at, _)| !Arc::ptr_eq(of, stage) || *at != plane) {
            self.known = Some((Arc::clone(stage), plane, lines(stage, plane)));
        }
        let Some((.., lines)) = &self.known else { return };
        let stroke = Stroke::new(1.5, color(theme.ink).gamma_multiply(0.75));
        let painter = painter.with_clip_rect(placing.clip);
        for line in lines {
            painter.line_segment(line.map(|[column, row]| placing.at(column, row)), stroke);
        }
    }
}

/// Where the triangles meet the plane through the middles of the slice's cells.
fn lines(stage: &Stage, plane: Plane) -> Vec<Line> {
    let mesh = &stage.model.mesh;
    let at = |triangle: usize| mesh.corners(triangle).map(|corner| stage.placement.in_cells(corner).to_array());
    (0..mesh.len()).filter_map(|triangle| line(at(triangle), plane)).collect()
}

/// Where one triangle, in finest cells, meets it. A triangle that lies in the plane meets it everywhere, and has none.
fn line(corners: [[f64; 3]; 3], plane: Plane) -> Option<Line> {
    let axis = plane.axis;
    let height = corners.map(|corner| corner[axis.across()] - (plane.index as f64 + 0.5));
    let mut ends =
        (0..3).map(|i| (i, (i + 1) % 3)).filter(|(a, b)| (height[*a] < 0.0) != (height[*b] < 0.0)).map(|(a, b)| {
            let part = height[a] / (height[a] - height[b]);
            [axis.columns(), axis.rows()].map(|k| (corners[a][k] + part * (corners[b][k] - corners[a][k])) as f32)
        });
    Some([ends.next()?, ends.next()?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::slice::Axis;

    #[test]
    fn a_triangle_is_cut_where_its_edges_cross_the_plane() {
        // Upright over the diagonal of a square of 4 cells, its tip at z = 2.
        let corners = [[0.0, 0.0, 0.0], [4.0, 4.0, 0.0], [2.0, 2.0, 2.0]];
        let cut = |index| line(corners, Plane { axis: Axis::Z, index });
        // At z = 0.5 a quarter of the way up, at 1.5 three quarters.
        assert_eq!(cut(0).unwrap().map(|[x, _]| x), [3.5, 0.5]);
        assert_eq!(cut(1).unwrap().map(|[_, y]| y), [2.5, 1.5]);
        assert_eq!(cut(2), None);
        let flat = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [0.0, 1.0, 0.5]];
        assert_eq!(line(flat, Plane { axis: Axis::Z, index: 0 }), None);
    }
}
