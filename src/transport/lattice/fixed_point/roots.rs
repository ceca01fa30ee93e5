//! Where the polynomials of the solver have their zeros.
//!
//! Far from borders light is a sum of waves, and on a wave with phases (a, b, c) from cell to cell P is a 4 × 4
//! matrix of the share's five numbers. Between the mean and the direction along t it is
//!
//! ```text
//! |  m      −2i·β·sin |      m = 2α·Σ cos       d = 2δ·cos + 2ε·Σ cos of the other two
//! | −2i·γ·sin   d     |      eigenvalues (m + d)/2 ± √( ((m − d)/2)² − 4βγ·Σ sin² )
//! ```
//!
//! for waves along an axis, a diagonal of a face or one of the cube, which reach furthest out. The squares of
//! these are where the spectrum of P² lies. The zeros are Leja points of it: each is where the polynomial so
//! far is largest, kept real so that one step is one zero. In this order no product of the
//! first few ever grows much, which single precision would not forgive.

use std::f64::consts::PI;

use crate::transport::lattice::kernel::form::Share;

/// Waves looked at along each diagonal.
const WAVES: usize = 64;
/// Nothing nearer to 1 is resolved: a step's length is one over the distance.
const LARGEST: f64 = 0.9999;

/// Zeros of polynomials that are small on the spectrum of P², as many as are asked for.
#[derive(Clone, Debug)]
pub struct Roots {
    spectrum: Vec<Point>,
    found: Vec<f64>,
}

/// A point of the spectrum, with the logarithm of the polynomial's magnitude there.
#[derive(Clone, Copy, Debug)]
struct Point {
    real: f64,
    imaginary: f64,
    log: f64,
}

impl Roots {
    /// For one level's operator on an n³ grid.
    pub fn new(share: &Share<f32>, n: usize) -> Self {
        let mut spectrum = Vec::new();
        // The longest wave that is dark just outside the grid, and the shortest.
        let longest = PI / (n + 1) as f64;
        for j in 0..=WAVES {
            let phase = longest + (PI - 2.0 * longest) * j as f64 / WAVES as f64;
            for axes in 1..=3 {
                for across in [longest, PI - longest] {
                    spectrum.extend(squares(share, phase, across, axes));
                }
            }
        }
        Roots { spectrum, found: Vec::new() }
    }

    /// Zero number `k`, from 0; the first is 0.
    pub fn get(&mut self, k: usize) -> f64 {
        while self.found.len() <= k {
            let largest = self.spectrum.iter().max_by(|a, b| a.log.total_cmp(&b.log));
            let root = if self.found.is_empty() { 0.0 } else { largest.map_or(0.0, |point| point.real) };
            for point in &mut self.spectrum {
                // The little in the sum keeps the logarithm finite where the zero is.
                let distance = (point.real - root).powi(2) + point.imaginary.powi(2) + 1e-12;
                point.log += 0.5 * distance.ln() - (1.0 - root).ln();
            }
            self.found.push(root);
        }
        self.found[k]
    }
}

/// The squares of both eigenvalues for a wave of one `phase` along some of the axes, `across` along the others.
fn squares(share: &Share<f32>, phase: f64, across: f64, axes: usize) -> impl Iterator<Item = Point> {
    let [alpha, beta, gamma, delta, epsilon] =
        [share.alpha, share.beta, share.gamma, share.delta, share.epsilon].map(f64::from);
    let (cos, others) = (phase.cos(), (3 - axes) as f64 * across.cos());
    let sum = axes as f64 * cos + others;
    let (mean, direction) = (2.0 * alpha * sum, 2.0 * delta * cos + 2.0 * epsilon * (sum - cos));
    let coupling = 4.0 * beta * gamma * axes as f64 * phase.sin().powi(2);
    let (middle, square) = ((mean + direction) / 2.0, ((mean - direction) / 2.0).powi(2) - coupling);
    [1.0, -1.0].into_iter().map(move |sign| {
        let (real, imaginary) =
            if square >= 0.0 { (middle + sign * square.sqrt(), 0.0) } else { (middle, sign * (-square).sqrt()) };
        let (real, imaginary) = (real * real - imaginary * imaginary, 2.0 * real * imaginary);
        Point { real: real.min(LARGEST), imaginary, log: 0.0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::lattice::kernel::form::Form;
    use crate::transport::lattice::schemes;
    use crate::transport::lattice::stencil::Stencil;

    #[test]
    fn a_uniform_wave_has_the_gains_of_the_stencil() {
        let stencil = Stencil::<f32>::new(&schemes::find("cascaded").unwrap(), 3.8, false);
        let share = Form::of(&stencil).unwrap().share;
        let mut wanted = stencil.uniform_gain().map(|gain| gain * gain);
        let mut found: Vec<f64> = squares(&share, 0.0, 0.0, 3).map(|point| point.real).collect();
        wanted.sort_by(f64::total_cmp);
        found.sort_by(f64::total_cmp);
        assert!(found.iter().zip(wanted).all(|(f, w)| (f - w).abs() < 1e-6), "{found:?}, {wanted:?}");
    }

    #[test]
    fn the_polynomials_fall_everywhere_on_the_spectrum() {
        let stencil = Stencil::<f32>::new(&schemes::find("cascaded").unwrap(), 3.8, false);
        let mut roots = Roots::new(&Form::of(&stencil).unwrap().share, 64);
        let zeros: Vec<f64> = (0..30).map(|k| roots.get(k)).collect();
        assert_eq!(zeros[0], 0.0);
        let largest = |degree: usize| {
            let at = |point: &Point| -> f64 {
                let factor = |root: &f64| (point.real - root).hypot(point.imaginary) / (1.0 - root);
                zeros[..degree].iter().map(factor).product()
            };
            roots.spectrum.iter().map(at).fold(0.0, f64::max)
        };
        // Iterating: 0.95^(2k).
        assert!(largest(10) < 0.1 && largest(20) < 1e-3 && largest(30) < 1e-5);
    }
}
