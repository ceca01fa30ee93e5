//! Cuts a polygon into triangles: a fan where it is convex, else ear by ear.
//!
//! The corners are seen along the polygon's normal by Newell's method, which holds for polygons that are not
//! quite flat. An ear is a corner that turns the polygon's way and whose triangle holds no other corner.

use glam::{DVec2, DVec3, Vec3};

/// The triangles of a polygon as numbers of its corners, two fewer than it has corners. A polygon that crosses
/// itself, or has no area, gives a fan.
pub(super) fn triangles(corners: &[Vec3]) -> Vec<[usize; 3]> {
    let n = corners.len();
    let fan = || (1..n - 1).map(|i| [0, i, i + 1]).collect();
    if n <= 3 {
        return if n == 3 { vec![[0, 1, 2]] } else { Vec::new() };
    }
    let Some(flat) = flattened(corners) else { return fan() };
    let turn = |a: usize, b: usize, c: usize| (flat[b] - flat[a]).perp_dot(flat[c] - flat[b]);
    if (0..n).all(|i| turn(i, (i + 1) % n, (i + 2) % n) >= 0.0) {
        return fan();
    }
    let mut left: Vec<usize> = (0..n).collect();
    let mut cut = Vec::with_capacity(n - 2);
    let (mut at, mut without) = (0, 0);
    while left.len() > 3 {
        let m = left.len();
        let [a, b, c] = [left[at % m], left[(at + 1) % m], left[(at + 2) % m]];
        let holds =
            |p: usize| ![a, b, c].contains(&p) && turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
        if turn(a, b, c) > 0.0 && !left.iter().any(|p| holds(*p)) {
            cut.push([a, b, c]);
            left.remove((at + 1) % m);
            (at, without) = (at % left.len(), 0);
        } else {
            (at, without) = ((at + 1) % m, without + 1);
            if without > m {
                // It crosses itself: what is left has no ear.
                return fan();
            }
        }
    }
    cut.push([left[0], left[1], left[2]]);
    cut
}

/// The corners in the polygon's plane, running counter-clockwise; `None` where it has no area.
fn flattened(corners: &[Vec3]) -> Option<Vec<DVec2>> {
    let first = corners[0].as_dvec3();
    let from_first = |i: usize| corners[i % corners.len()].as_dvec3() - first;
    let normal: DVec3 = (0..corners.len()).map(|i| from_first(i).cross(from_first(i + 1))).sum();
    let normal = normal.try_normalize()?;
    let (x, y) = normal.any_orthonormal_pair();
    Some((0..corners.len()).map(|i| DVec2::new(from_first(i).dot(x), from_first(i).dot(y))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[Vec3], triangles: &[[usize; 3]]) -> f64 {
        let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length() / 2.0;
        triangles.iter().map(|t| area(t.map(|i| corners[i].as_dvec3()))).sum()
    }

    #[test]
    fn a_polygon_of_any_shape_keeps_its_area() {
        // An L of area 3 and a comb of area 2·5 − 2·1·1, in a slanted plane and turned either way.
        let shapes: [(&[[f32; 2]], f64); 3] = [
            (&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]], 3.0),
            (
                &[
                    [0., 0.],
                    [5., 0.],
                    [5., 2.],
                    [4., 2.],
                    [4., 1.],
                    [3., 1.],
                    [3., 2.],
                    [2., 2.],
                    [2., 1.],
                    [1., 1.],
                    [1., 2.],
                    [0., 2.],
                ],
                8.0,
            ),
            (&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 1.0),
        ];
        for (shape, expected) in shapes {
            let (u, v) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.0, 0.0, 1.0));
            let mut corners: Vec<Vec3> = shape.iter().map(|[x, y]| u * *x + v * *y).collect();
            for _ in 0..2 * corners.len() {
                let cut = triangles(&corners);
                assert_eq!(cut.len(), corners.len() - 2);
                assert!((area(&corners, &cut) - expected).abs() < 1e-6, "{corners:?}");
                corners.rotate_left(1);
            }
            corners.reverse();
            assert!((area(&corners, &triangles(&corners)) - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn what_has_no_plane_or_crosses_itself_ends_in_a_fan() {
        let line: Vec<Vec3> = (0..5).map(|i| Vec3::X * i as f32).collect();
        assert_eq!(triangles(&line).len(), 3);
        let star: Vec<Vec3> =
            (0..5).map(|i| f32::to_radians(144.0 * i as f32)).map(|a| Vec3::new(a.cos(), a.sin(), 0.0)).collect();
        assert_eq!(triangles(&star).len(), 3);
        assert!(triangles(&line[..2]).is_empty());
    }
}
