//! Sets of directions, each with its share of the sphere.

use std::f64::consts::PI;

use glam::DVec3;

use crate::scene::propagation::directions::Lattice;
use crate::sh::SPHERE;

/// A direction and the solid angle that it stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// The unit vector in which light travels.
    pub way: DVec3,
    /// In steradians; 4π over all directions of a set.
    pub weight: f64,
}

/// About `count` directions, at least one: exactly so many on the spiral, the nearest 8·k² on the octahedron.
pub fn directions(lattice: Lattice, count: usize) -> Vec<Direction> {
    match lattice {
        Lattice::Fibonacci => fibonacci(count.max(1)),
        Lattice::Octahedral => octahedral(((count as f64 / 8.0).sqrt().round() as usize).max(1)),
    }
}

/// (004, eq. 2.3 and 2.4), with g the golden angle π·(3 − √5).
fn fibonacci(count: usize) -> Vec<Direction> {
    let golden = PI * (3.0 - 5f64.sqrt());
    let weight = SPHERE / count as f64;
    (0..count)
        .map(|i| {
            let middle = i as f64 + 0.5;
            let z = 1.0 - 2.0 * middle / count as f64;
            let radius = (1.0 - z * z).sqrt();
            let (sin, cos) = (golden * middle).sin_cos();
            Direction { way: DVec3::new(radius * cos, radius * sin, z), weight }
        })
        .collect()
}

fn octahedral(k: usize) -> Vec<Direction> {
    let corner = |i: usize, j: usize| DVec3::new(i as f64, j as f64, (k - i - j) as f64).normalize();
    let mut octant = Vec::new();
    for i in 0..k {
        for j in 0..k - i {
            octant.push([corner(i, j), corner(i + 1, j), corner(i, j + 1)]);
            if i + j + 1 < k {
                octant.push([corner(i + 1, j + 1), corner(i, j + 1), corner(i + 1, j)]);
            }
        }
    }
    let signs = (0..8).map(|s| DVec3::new(sign(s, 1), sign(s, 2), sign(s, 4)));
    signs
        .flat_map(|signs| {
            octant.iter().map(move |&[a, b, c]| {
                let solid = 2.0 * a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
                Direction { way: (a + b + c).normalize() * signs, weight: solid }
            })
        })
        .collect()
}

fn sign(bits: usize, bit: usize) -> f64 {
    if bits & bit == 0 { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_covers_the_sphere_and_leans_nowhere() {
        for lattice in Lattice::ALL {
            for count in [8, 24, 48, 96, 192, 400] {
                let set = directions(lattice, count);
                let covered: f64 = set.iter().map(|d| d.weight).sum();
                assert!((covered - SPHERE).abs() < 1e-12, "{lattice:?} {count}");
                let mean: DVec3 = set.iter().map(|d| d.way * d.weight).sum();
                assert!(mean.length() < 0.2 / count as f64 * SPHERE, "{lattice:?} {count}: {mean}");
                assert!(set.iter().all(|d| (d.way.length() - 1.0).abs() < 1e-14));
            }
        }
        assert_eq!(directions(Lattice::Fibonacci, 24).len(), 24);
        assert_eq!(directions(Lattice::Octahedral, 192).len(), 200);
    }

    #[test]
    fn the_octahedral_set_keeps_the_symmetries_of_the_cube() {
        let set = directions(Lattice::Octahedral, 72);
        let has = |way: DVec3| set.iter().any(|d| (d.way - way).length() < 1e-12);
        for d in &set {
            assert!(has(DVec3::new(d.way.y, d.way.z, d.way.x)));
            assert!(has(DVec3::new(d.way.y, d.way.x, d.way.z)));
            assert!(has(DVec3::new(-d.way.x, d.way.y, d.way.z)));
        }
    }
}
