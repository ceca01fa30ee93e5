//! From pixels to rays: a pinhole camera.
//!
//! A picture of w × h pixels spans the vertical field of view from its lower to its upper edge; pixels are
//! square. A pixel is the mean over its square, so rays are asked for with places between pixels: (0, 0) is
//! the corner of the picture at the top left, (w, h) the one at the bottom right.

use glam::DVec3;

/// A camera made ready for pictures of one size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where all rays begin, in metres.
    pub from: DVec3,
    /// The unit vector straight ahead.
    ahead: DVec3,
    /// From the picture's middle to the middle of its right edge, at distance 1.
    right: DVec3,
    /// From the picture's middle to the middle of its upper edge, at distance 1.
    up: DVec3,
    width: usize,
    height: usize,
}

impl View {
    /// The view from `from` towards `to`, with `up` upwards in the picture and a vertical field of view of `fov`
    /// degrees.
    ///
    /// `None` where there is no such view: no pixels, `to` at `from`, `up` along the view or a field of view that
    /// is not between 0 and 180 degrees.
    ///
    /// ```
    /// use glam::DVec3;
    /// use lpv_lab::render::view::View;
    ///
    /// let view = View::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 90.0, [200, 100]).unwrap();
    /// // The middle of the right edge: light there comes from half a width to the right, which looking along
    /// // +z is -x.
    /// let way = view.way([200.0, 50.0]);
    /// assert!((way - DVec3::new(-2.0, 0.0, 1.0).normalize()).length() < 1e-12);
    /// ```
    pub fn new(from: DVec3, to: DVec3, up: DVec3, fov: f64, [width, height]: [usize; 2]) -> Option<Self> {
        let ahead = (to - from).try_normalize()?;
        let right = ahead.cross(up.try_normalize()?).try_normalize()?;
        if width == 0 || height == 0 || !(fov > 0.0 && fov < 180.0) {
            return None;
        }
        let half = (0.5 * fov.to_radians()).tan();
        let aspect = width as f64 / height as f64;
        Some(View { from, ahead, right: right * half * aspect, up: right.cross(ahead) * half, width, height })
    }

    /// Pixels across and down.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The unit vector from the camera through a place in the picture, in pixels from the top left.
    pub fn way(&self, [x, y]: [f64; 2]) -> DVec3 {
        let across = 2.0 * x / self.width as f64 - 1.0;
        let upwards = 1.0 - 2.0 * y / self.height as f64;
        (self.ahead + across * self.right + upwards * self.up).normalize()
    }

    /// Where in the picture a point is seen, in pixels from the top left; `None` for points that are not ahead.
    /// The place may lie outside the picture.
    pub fn place(&self, point: DVec3) -> Option<[f64; 2]> {
        let offset = point - self.from;
        let depth = offset.dot(self.ahead);
        if depth <= 0.0 {
            return None;
        }
        let along = |axis: DVec3| offset.dot(axis) / (depth * axis.length_squared());
        let (across, upwards) = (along(self.right), along(self.up));
        Some([0.5 * (across + 1.0) * self.width as f64, 0.5 * (1.0 - upwards) * self.height as f64])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> View {
        View::new(DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 2.5, -1.0), DVec3::Y, 40.0, [320, 200]).unwrap()
    }

    #[test]
    fn the_edges_span_the_field_of_view() {
        let view = view();
        let angle = view.way([160.0, 0.0]).angle_between(view.way([160.0, 200.0]));
        assert!((angle.to_degrees() - 40.0).abs() < 1e-9);
        let across = view.way([0.0, 100.0]).angle_between(view.way([320.0, 100.0]));
        assert!(((0.5 * across).tan() / 20f64.to_radians().tan() - 1.6).abs() < 1e-12);
        assert!(view.way([160.0, 0.0]).y > view.way([160.0, 200.0]).y, "row 0 is at the top");
    }

    #[test]
    fn a_point_along_a_pixels_ray_is_seen_there() {
        let view = view();
        for place in [[0.0, 0.0], [13.25, 170.5], [319.0, 1.0]] {
            let seen = view.place(view.from + 7.0 * view.way(place)).unwrap();
            assert!((seen[0] - place[0]).abs() < 1e-9 && (seen[1] - place[1]).abs() < 1e-9, "{seen:?} {place:?}");
        }
        assert_eq!(view.place(view.from - view.ahead), None);
    }

    #[test]
    fn what_is_no_view_is_none() {
        let (from, to) = (DVec3::ZERO, DVec3::X);
        assert!(View::new(from, from, DVec3::Y, 40.0, [4, 4]).is_none());
        assert!(View::new(from, to, DVec3::X, 40.0, [4, 4]).is_none());
        assert!(View::new(from, to, DVec3::ZERO, 40.0, [4, 4]).is_none());
        for fov in [0.0, 180.0, -1.0, f64::NAN] {
            assert!(View::new(from, to, DVec3::Y, fov, [4, 4]).is_none());
        }
        assert!(View::new(from, to, DVec3::Y, 40.0, [0, 4]).is_none());
    }
}
