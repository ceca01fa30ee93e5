//! Points and directions with a known density, from even numbers.
//!
//! Every sampler maps numbers u, v from 0 to 1 and tells by which density its results are distributed.

use std::f64::consts::{FRAC_PI_4, TAU};

use glam::{DMat3, DVec2, DVec3};

/// A point of the unit disk, density 1/π: the concentric map (Shirley and Chiu 1997), which keeps even points even.
pub fn disk([u, v]: [f64; 2]) -> DVec2 {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return DVec2::ZERO;
    }
    let (radius, angle) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * (b / a)) } else { (b, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (a / b)) };
    radius * DVec2::from_angle(angle)
}

/// The columns x, y and z of a right-handed frame whose z is the unit vector `z` (Duff et al. 2017).
pub fn frame(z: DVec3) -> DMat3 {
    let sign = 1f64.copysign(z.z);
    let a = -1.0 / (sign + z.z);
    let b = z.x * z.y * a;
    let x = DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x);
    let y = DVec3::new(b, sign + z.y * z.y * a, -z.y);
    DMat3::from_cols(x, y, z)
}

/// A direction on the side of the unit vector `normal`, density cosθ/π per steradian.
pub fn cosine(normal: DVec3, uv: [f64; 2]) -> DVec3 {
    let p = disk(uv);
    frame(normal) * DVec3::new(p.x, p.y, (1.0 - p.length_squared()).max(0.0).sqrt())
}

/// A direction within the cone about the unit vector `axis` whose half angle has the cosine `edge`, −1 for the whole
/// sphere; density 1/(2π(1 − edge)) per steradian.
pub fn cone(axis: DVec3, edge: f64, [u, v]: [f64; 2]) -> DVec3 {
    let z = 1.0 - u * (1.0 - edge);
    let (sin, cos) = (TAU * v).sin_cos();
    let radius = (1.0 - z * z).max(0.0).sqrt();
    frame(axis) * DVec3::new(radius * cos, radius * sin, z)
}

/// Barycentric weights of an even point of a triangle, density 1 over its area: the square folded along its diagonal.
pub fn triangle([u, v]: [f64; 2]) -> [f64; 3] {
    let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
    [1.0 - u - v, u, v]
}

/// Chooses from weights by their running sums (the last is the total, above 0), and gives back the part of `u` that
/// was not used up: even again.
pub fn choose(sums: &[f64], u: f64) -> (usize, f64) {
    let Some(total) = sums.last() else { return (0, u) };
    let wanted = u * total;
    let i = sums.partition_point(|sum| *sum <= wanted).min(sums.len() - 1);
    let below = if i == 0 { 0.0 } else { sums[i - 1] };
    let left = (wanted - below) / (sums[i] - below);
    (i, if left.is_finite() { left.clamp(0.0, 1.0 - f64::EPSILON) } else { u })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::random::Random;

    const DRAWS: usize = 64_000;

    /// Chi-squared of draws over bins that are equally likely, beside what is exceeded once in ten thousand times
    /// (Wilson and Hilferty's approximation).
    fn fits(bins: usize, mut bin: impl FnMut([f64; 2]) -> usize) {
        let mut stream = Random::of([bins as u64, 5]);
        let mut counts = vec![0usize; bins];
        for _ in 0..DRAWS {
            counts[bin([stream.unit(), stream.unit()])] += 1;
        }
        let expected = DRAWS as f64 / bins as f64;
        let chi: f64 = counts.iter().map(|n| (*n as f64 - expected).powi(2) / expected).sum();
        let degrees = (bins - 1) as f64;
        let spread = 2.0 / (9.0 * degrees);
        let most = degrees * (1.0 - spread + 3.719 * spread.sqrt()).powi(3);
        assert!(chi < most, "{chi} over {bins} bins, {most}");
    }

    /// Which of 8 × 8 bins: `height` runs evenly from 0 to 1, and so does the angle.
    fn bin(height: f64, x: f64, y: f64) -> usize {
        let angle = (y.atan2(x) / TAU + 1.0).fract();
        let eighth = |t: f64| ((8.0 * t) as usize).min(7);
        8 * eighth(height) + eighth(angle)
    }

    const NORMALS: [DVec3; 4] = [DVec3::Z, DVec3::NEG_Z, DVec3::new(0.6, 0.0, -0.8), DVec3::new(-0.48, 0.64, 0.6)];

    #[test]
    fn the_disk_is_even() {
        fits(64, |uv| {
            let p = disk(uv);
            bin(p.length_squared(), p.x, p.y)
        });
    }

    #[test]
    fn cosine_directions_have_density_cosine_over_pi() {
        for normal in NORMALS {
            let frame = frame(normal);
            fits(64, |uv| {
                let way = frame.transpose() * cosine(normal, uv);
                assert!((way.length() - 1.0).abs() < 1e-12 && way.z >= 0.0);
                // The share of directions below θ is sin²θ.
                bin(1.0 - way.z * way.z, way.x, way.y)
            });
        }
    }

    #[test]
    fn cones_and_the_sphere_are_even() {
        for (normal, edge) in NORMALS.into_iter().zip([-1.0, 0.0, 0.9, 0.3]) {
            let frame = frame(normal);
            fits(64, |uv| {
                let way = frame.transpose() * cone(normal, edge, uv);
                assert!((way.length() - 1.0).abs() < 1e-12 && way.z >= edge - 1e-12);
                bin((1.0 - way.z) / (1.0 - edge), way.x, way.y)
            });
        }
    }

    #[test]
    fn triangles_are_even() {
        // The four triangles between the middles of the sides are equally likely.
        fits(4, |uv| {
            let weights = triangle(uv);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12 && weights.iter().all(|w| *w >= 0.0));
            weights.iter().position(|w| *w > 0.5).unwrap_or(3)
        });
    }

    #[test]
    fn choices_follow_their_weights_and_leave_even_numbers() {
        let sums = [2.0, 2.0, 5.0, 8.0];
        // 2 : 0 : 3 : 3, so 8 bins of one each, by what is left of u.
        let starts = [0.0, 2.0, 2.0, 5.0];
        let widths = [2.0, 0.0, 3.0, 3.0];
        fits(8, |[u, _]| {
            let (i, left) = choose(&sums, u);
            assert_ne!(i, 1);
            ((starts[i] + left * widths[i]) as usize).min(7)
        });
    }

    #[test]
    fn frames_are_right_handed() {
        for normal in NORMALS {
            let frame = frame(normal);
            assert!((frame.determinant() - 1.0).abs() < 1e-12);
            assert!((frame * frame.transpose() - DMat3::IDENTITY).to_cols_array().iter().all(|x| x.abs() < 1e-12));
        }
    }
}
