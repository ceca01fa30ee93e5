//! Where a parallel beam leaves a cell.
//!
//! Turn the cell so that the beam travels towards larger x, y and z, with direction (a, b, c) ≥ 0. A ray
//! that is X, Y, Z short of the three far faces leaves by x if X/a is the least of X/a, Y/b and Z/c. For a
//! beam that enters by the low x face X = 1, and Y and Z are spread evenly over 0 to 1, so it leaves
//!
//! ```text
//! by x:  (1 − b/a)₊·(1 − c/a)₊
//! by y:  ∫₀¹ min(1, b/a, b/c·Z) dZ  =  k/2 if k ≤ m, else m − m²/2k        m = min(1, b/a), k = b/c
//! by z:  the rest
//! ```
//!
//! and likewise for the low y and z faces: a table of nine numbers, exact by geometry. Light that starts
//! in the cell leaves in the shares a : b : c, as a beam does that fills all of it. (Shares of light that
//! starts evenly spread in the cell, or at its centre, come no nearer to MATH.md section 6: measured.)

use glam::DVec3;

use crate::scene::propagation::directions::Rule;

/// The shares of one direction, in the turned cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// `through[i][j]`: of the light that came in by the low face of axis i, what leaves by the far face of axis j.
    pub through: [[f64; 3]; 3],
    /// Of the light that starts in the cell, what leaves by each far face.
    pub start: [f64; 3],
}

impl Shares {
    /// The shares of direction `way`, of any signs.
    pub fn new(rule: Rule, way: DVec3) -> Self {
        let way = way.abs().to_array();
        let sum: f64 = way.iter().sum();
        let start = way.map(|c| c / sum);
        let through = match rule {
            Rule::Donor => [start; 3],
            Rule::Faces => [0, 1, 2].map(|i| from_face(way, i)),
        };
        Shares { through, start }
    }
}

/// What leaves by each far face of the light that came in by the low face of axis `i`.
fn from_face(way: [f64; 3], i: usize) -> [f64; 3] {
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    let mut shares = [0.0; 3];
    // No light comes in by a face along which it travels; what becomes of none does not matter.
    if way[i] > 0.0 {
        let ratio = |axis: usize| way[axis] / way[i];
        shares[i] = (1.0 - ratio(j)).max(0.0) * (1.0 - ratio(k)).max(0.0);
        shares[j] = aside(way[j], way[k], way[i]);
        shares[k] = 1.0 - shares[i] - shares[j];
    }
    shares
}

/// ∫₀¹ min(1, b/a, b/c·Z) dZ.
fn aside(b: f64, c: f64, a: f64) -> f64 {
    if b == 0.0 {
        return 0.0;
    }
    let most = (b / a).min(1.0);
    if b <= most * c { b / c / 2.0 } else { most - most * most * c / (2.0 * b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Which far face a ray from a place in the unit cell leaves by.
    fn exit(place: [f64; 3], way: [f64; 3]) -> usize {
        let time = |a: usize| (1.0 - place[a]) / way[a];
        (0..3).fold(0, |best, a| if time(a) < time(best) { a } else { best })
    }

    #[test]
    fn shares_are_those_of_many_rays() {
        let pieces = 60;
        let middle = |i: usize| (i as f64 + 0.5) / f64::from(pieces);
        for way in [[0.3, 0.5, 0.8], [0.9, 0.1, 0.2], [0.1, 0.8, 0.6], [0.6, 0.6, 0.5]] {
            let shares = Shares::new(Rule::Faces, DVec3::from_array(way));
            for axis in 0..3 {
                let mut counted = [0.0; 3];
                for (i, j) in (0..60 * 60).map(|p| (p / 60, p % 60)) {
                    let mut place = [0.0; 3];
                    (place[(axis + 1) % 3], place[(axis + 2) % 3]) = (middle(i), middle(j));
                    counted[exit(place, way)] += 1.0 / f64::from(pieces * pieces);
                }
                for (found, wanted) in shares.through[axis].iter().zip(counted) {
                    assert!((found - wanted).abs() < 0.01, "{way:?}, by face {axis}: {found}, {wanted}");
                }
            }
        }
    }

    #[test]
    fn all_that_comes_in_leaves() {
        for way in [DVec3::X, DVec3::new(0.0, -0.6, 0.8), DVec3::new(-0.48, 0.6, 0.64), DVec3::ONE] {
            for rule in Rule::ALL {
                let Shares { through, start } = Shares::new(rule, way);
                assert!((start.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{rule:?}, {way}");
                for (axis, shares) in through.iter().enumerate().filter(|(axis, _)| way[*axis] != 0.0) {
                    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{rule:?}, {way}, {axis}");
                    assert!(shares.iter().all(|s| *s >= 0.0));
                }
            }
        }
    }
}
