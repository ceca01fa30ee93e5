//! How much of a point light's field a cell cuts out, and what it catches of a light in two bands.
//!
//! Cells are unit cubes, the light is at the centre of one. A cube is seen from outside as up to three
//! squares. For a polygon seen from the origin both integrals that two bands need have closed forms:
//!
//! - its solid angle ∫ dω, a sum over triangles of 2·atan2(a·(b×c), 1 + a·b + b·c + c·a), the corners
//!   being unit vectors (van Oosterom and Strackee);
//! - its vector ∫ ω dω = ½·Σ_edges Θ·n, with Θ the angle between the edge's ends and n the unit normal of the
//!   plane through them and the origin (Lambert).
//!
//! So ∫ (K0·c00 + K1·(X, Y, Z)·ω) dω is exact. Where the light is negative in some directions and
//! positive in others within one cell, its positive part is summed over small pieces instead.

use glam::DVec3;

use crate::sh::{K0, K1, Sh};

/// ∫ dω and ∫ ω dω over the directions in which a cell is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// The solid angle, in steradians.
    pub solid_angle: f64,
    /// The vector; its length is at most the solid angle.
    pub vector: DVec3,
}

/// The faces of the cell at `offset` that are seen from the centre of the cell at the origin, as the three
/// vectors centre, half width and half height, turned so that their triple product is positive.
pub fn visible_faces(offset: DVec3) -> impl Iterator<Item = [DVec3; 3]> {
    DVec3::AXES.into_iter().enumerate().filter_map(move |(i, axis)| {
        let along = offset.dot(axis);
        let sign = along.signum();
        let (u, v) = (DVec3::AXES[(i + 1) % 3] * 0.5, DVec3::AXES[(i + 2) % 3] * 0.5 * sign);
        (along.abs() > 0.5).then_some([offset - axis * (0.5 * sign), u, v])
    })
}

/// What a cell at `offset` from the light, in cells, is seen as; nothing for the light's own cell.
pub fn of_cell(offset: DVec3) -> Extent {
    visible_faces(offset).map(of_face).fold(Extent::default(), |sum, face| Extent {
        solid_angle: sum.solid_angle + face.solid_angle,
        vector: sum.vector + face.vector,
    })
}

/// What a rectangle is seen as, given as in [`visible_faces`].
pub fn of_face([centre, u, v]: [DVec3; 3]) -> Extent {
    let corners = [centre - u - v, centre + u - v, centre + u + v, centre - u + v].map(DVec3::normalize);
    let [a, b, c, d] = corners;
    let mut vector = DVec3::ZERO;
    for (from, to) in [(a, b), (b, c), (c, d), (d, a)] {
        let normal = from.cross(to);
        let sine = normal.length();
        vector += normal * (0.5 * sine.atan2(from.dot(to)) / sine);
    }
    Extent { solid_angle: triangle(a, b, c) + triangle(a, c, d), vector }
}

fn triangle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    2.0 * a.dot(b.cross(c)).atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

/// The flux of max(0, light) into the cell at `offset` from the light, `extent` being [`of_cell`] of it.
pub fn flux(light: Sh<f64>, offset: DVec3, extent: &Extent) -> f64 {
    let (mean, slope) = (K0 * light.0[0], light.vector() * K1);
    let linear = mean * extent.solid_angle + slope.dot(extent.vector);
    let steepest = slope.length();
    if mean >= steepest {
        return linear;
    }
    // The cell lies in the cone of half angle ρ about its centre; the light grows towards `slope`, and is
    // least and most in the cone at the angles that are ρ further from it and ρ nearer to it.
    let distance = offset.length();
    let cosine = slope.dot(offset) / (steepest * distance);
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let radius_sine = (0.75f64.sqrt() / distance).min(1.0);
    let radius_cosine = (1.0 - radius_sine * radius_sine).sqrt();
    let furthest = if cosine <= -radius_cosine { -1.0 } else { cosine * radius_cosine - sine * radius_sine };
    let nearest = if cosine >= radius_cosine { 1.0 } else { cosine * radius_cosine + sine * radius_sine };
    if mean + steepest * furthest >= 0.0 {
        linear
    } else if mean + steepest * nearest <= 0.0 {
        0.0
    } else {
        positive_part(light, offset)
    }
}

/// The flux of max(0, light) by the midpoint rule on the visible faces.
fn positive_part(light: Sh<f64>, offset: DVec3) -> f64 {
    let pieces = if offset.length() < 4.0 { 24 } else { 6 };
    visible_faces(offset).map(|face| over_pieces(face, pieces, |direction| light.eval(direction).max(0.0))).sum()
}

/// ∫ f dω over a rectangle by the midpoint rule on `pieces`² pieces.
fn over_pieces([centre, u, v]: [DVec3; 3], pieces: i32, f: impl Fn(DVec3) -> f64) -> f64 {
    let normal = u.cross(v) * 4.0;
    let at = |i: i32| f64::from(2 * i + 1 - pieces) / f64::from(pieces);
    let places = (0..pieces).flat_map(|i| (0..pieces).map(move |j| (i, j)));
    let sum: f64 = places
        .map(|(i, j)| {
            let place = centre + u * at(i) + v * at(j);
            let distance = place.length();
            f(place / distance) * place.dot(normal) / distance.powi(3)
        })
        .sum();
    sum / f64::from(pieces * pieces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sh::SPHERE;
    use std::f64::consts::PI;

    const OFFSETS: [DVec3; 6] = [
        DVec3::new(1.0, 0.0, 0.0),
        DVec3::new(0.0, -1.0, 1.0),
        DVec3::new(1.0, 1.0, -1.0),
        DVec3::new(-3.0, 0.0, 2.0),
        DVec3::new(2.0, 5.0, -4.0),
        DVec3::new(0.0, 0.0, -20.0),
    ];

    #[test]
    fn closed_forms_agree_with_summing_small_pieces() {
        for offset in OFFSETS {
            let extent = of_cell(offset);
            let sum =
                |f: &dyn Fn(DVec3) -> f64| -> f64 { visible_faces(offset).map(|face| over_pieces(face, 400, f)).sum() };
            assert!((extent.solid_angle / sum(&|_| 1.0) - 1.0).abs() < 1e-5, "{offset}");
            for axis in DVec3::AXES {
                let found = extent.vector.dot(axis);
                assert!((found - sum(&|w| w.dot(axis))).abs() < 1e-5 * extent.solid_angle, "{offset}");
            }
        }
    }

    #[test]
    fn the_shared_face_fills_a_sixth_of_all_directions_and_far_cells_their_projected_area() {
        assert!((of_cell(DVec3::X).solid_angle - SPHERE / 6.0).abs() < 1e-14);
        let offset = DVec3::new(40.0, -30.0, 20.0);
        let u = offset.normalize();
        let projected = (u.x.abs() + u.y.abs() + u.z.abs()) / offset.length_squared();
        assert!((of_cell(offset).solid_angle / projected - 1.0).abs() < 1e-3);
    }

    /// The faces through which all light leaves a cube of `2·m + 1` cells about the light, each with the
    /// offset of the cell behind it.
    fn shell(m: i32) -> impl Iterator<Item = (DVec3, [DVec3; 3])> {
        let inside = move |c: DVec3| c.abs().max_element() <= f64::from(m);
        let range = move || -m - 1..=m + 1;
        let cells = range().flat_map(move |x| range().flat_map(move |y| range().map(move |z| (x, y, z))));
        cells.map(|(x, y, z)| DVec3::new(x.into(), y.into(), z.into())).filter(move |c| !inside(*c)).flat_map(
            move |cell| {
                let shared = move |[centre, _, _]: &[DVec3; 3]| inside(cell + (*centre - cell) * 2.0);
                visible_faces(cell).filter(shared).map(move |face| (cell, face))
            },
        )
    }

    #[test]
    fn what_arrives_at_a_closed_shell_is_what_left() {
        // A lobe about n in two bands is ¼ + ½·cos θ; its positive part, over cos θ ≥ −½, sums to 9π/8.
        let lobe = Sh::<f64>::lobe(DVec3::new(2.0, -3.0, 6.0) / 7.0);
        let directed = Sh([0.1, 0.0, 0.7, -0.2]);
        let left = |light: Sh<f64>| {
            let (mean, slope) = (K0 * light.0[0], K1 * light.vector().length());
            let edge = (-mean / slope).max(-1.0);
            2.0 * PI * (mean * (1.0 - edge) + 0.5 * slope * (1.0 - edge * edge))
        };
        assert!((left(lobe) - 9.0 * PI / 8.0).abs() < 1e-12);
        for m in [0, 1, 4, 9] {
            for light in [lobe, directed, Sh([1.0, 0.2, 0.1, 0.0])] {
                // Light that enters a cell by several faces is split among them as the faces' solid angles are.
                let arrived: f64 = shell(m)
                    .map(|(cell, face)| {
                        let (mean, slope) = (K0 * light.0[0], light.vector() * K1);
                        let seen = of_face(face);
                        let linear = mean * seen.solid_angle + slope.dot(seen.vector);
                        let whole = of_cell(cell);
                        let all = mean * whole.solid_angle + slope.dot(whole.vector);
                        let caught = flux(light, cell, &whole);
                        if (caught - all).abs() < 1e-15 { linear } else { caught_by(light, face) }
                    })
                    .sum();
                assert!((arrived / left(light) - 1.0).abs() < 0.005, "m = {m}, {light:?}: {arrived}");
            }
        }
    }

    /// The flux of max(0, light) through one face, where `flux` gave less than the closed form for its cell.
    fn caught_by(light: Sh<f64>, face: [DVec3; 3]) -> f64 {
        over_pieces(face, 24, |direction| light.eval(direction).max(0.0))
    }

    #[test]
    fn the_positive_part_is_that_of_many_small_pieces() {
        let light = Sh([0.1, 0.0, 0.7, -0.2]);
        for offset in OFFSETS {
            let found = flux(light, offset, &of_cell(offset));
            let wanted: f64 =
                visible_faces(offset).map(|face| over_pieces(face, 400, |w| light.eval(w).max(0.0))).sum();
            let scale = of_cell(offset).solid_angle;
            assert!((found - wanted).abs() < 2e-3 * scale, "{offset}: {found}, {wanted}");
        }
    }
}
