//! The faces of a cell: the six directions of the grid and the solid angles under which a neighbour's
//! faces are seen.

use std::f64::consts::PI;

use glam::DVec3;

use crate::field::Cell;
use crate::sh::Sh;

/// The solid angle of a neighbour's far face, seen from the centre of the sending cell: 4·asin(1/10)
/// (000, 3.2.3; MATH.md section 2).
pub fn far_solid_angle() -> f64 {
    4.0 * 0.1f64.asin()
}

/// The solid angle of each of a neighbour's four side faces. The five faces fill what the shared face
/// spans, 2π/3. Many public ports carry 0.4234413544 here: one digit wrong, and the five no longer fill it.
pub fn side_solid_angle() -> f64 {
    (2.0 * PI / 3.0 - far_solid_angle()) / 4.0
}

/// One of the six directions in which a cell has a neighbour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Direction {
    axis: usize,
    positive: bool,
}

impl Direction {
    /// +X, −X, +Y, −Y, +Z, −Z.
    pub const ALL: [Direction; 6] = [
        Direction { axis: 0, positive: true },
        Direction { axis: 0, positive: false },
        Direction { axis: 1, positive: true },
        Direction { axis: 1, positive: false },
        Direction { axis: 2, positive: true },
        Direction { axis: 2, positive: false },
    ];

    /// Its place in [`Self::ALL`].
    pub fn index(self) -> usize {
        2 * self.axis + usize::from(!self.positive)
    }

    /// The axis it lies on: 0 for x, 1 for y, 2 for z.
    pub fn axis(self) -> usize {
        self.axis
    }

    /// Whether it points towards larger indices.
    pub fn is_positive(self) -> bool {
        self.positive
    }

    /// The direction the other way.
    pub fn opposite(self) -> Self {
        Direction { positive: !self.positive, ..self }
    }

    /// The neighbour of `cell` in this direction, if it lies in an n³ grid.
    pub fn neighbour(self, mut cell: Cell, n: usize) -> Option<Cell> {
        let c = &mut cell[self.axis];
        *c = if self.positive { *c + 1 } else { c.checked_sub(1)? };
        (*c < n).then_some(cell)
    }

    /// As a unit vector.
    pub fn vector(self) -> DVec3 {
        self.turn(DVec3::X)
    }

    /// Turns a vector that is given for light going +X, so that it fits light going this way: a rotation
    /// or a reflection of the cube that takes +X here. A scheme that has the symmetry of the cell does
    /// not care which one.
    pub fn turn(self, v: DVec3) -> DVec3 {
        let along = if self.positive { v.x } else { -v.x };
        match self.axis {
            0 => DVec3::new(along, v.y, v.z),
            1 => DVec3::new(v.y, along, v.z),
            _ => DVec3::new(v.z, v.y, along),
        }
    }

    /// [`Self::turn`] for a function on the sphere.
    pub fn turn_sh(self, f: Sh<f64>) -> Sh<f64> {
        let v = self.turn(f.vector());
        Sh([f.0[0], v.x, v.y, v.z])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_five_faces_fill_the_shared_one() {
        assert!((far_solid_angle() + 4.0 * side_solid_angle() - 2.0 * PI / 3.0).abs() < 1e-15);
        assert!((far_solid_angle() - 0.400_669_684_6).abs() < 1e-10);
        assert!((side_solid_angle() - 0.423_431_354_4).abs() < 1e-10);
    }

    /// The solid angle of an axis-aligned square, summed over small pieces.
    fn solid_angle(centre: DVec3, half_u: DVec3, half_v: DVec3, normal: DVec3) -> f64 {
        let pieces = 400;
        let mut sum = 0.0;
        for i in 0..pieces {
            for j in 0..pieces {
                let at = |k: i32| (f64::from(k) + 0.5) * 2.0 / f64::from(pieces) - 1.0;
                let r = centre + half_u * at(i) + half_v * at(j);
                sum += r.dot(normal).abs() / r.length().powi(3);
            }
        }
        sum * 4.0 * half_u.length() * half_v.length() / f64::from(pieces * pieces)
    }

    #[test]
    fn solid_angles_agree_with_the_geometry_of_the_neighbour() {
        let (y, z) = (DVec3::Y / 2.0, DVec3::Z / 2.0);
        let far = solid_angle(DVec3::X * 1.5, y, z, DVec3::X);
        assert!((far - far_solid_angle()).abs() < 1e-6);
        let side = solid_angle(DVec3::new(1.0, 0.5, 0.0), DVec3::X / 2.0, z, DVec3::Y);
        assert!((side - side_solid_angle()).abs() < 1e-6);
    }

    #[test]
    fn turning_takes_x_to_each_direction_and_keeps_angles() {
        let (u, v) = (DVec3::new(0.3, -0.8, 0.5), DVec3::new(-0.1, 0.4, 0.9));
        let mut seen = Vec::new();
        for d in Direction::ALL {
            assert!((d.turn(u).dot(d.turn(v)) - u.dot(v)).abs() < 1e-15);
            let sign = if d.is_positive() { 1.0 } else { -1.0 };
            assert_eq!(d.vector().to_array()[d.axis()], sign);
            assert!(!seen.contains(&d.vector().to_array()));
            seen.push(d.vector().to_array());
        }
    }
}
