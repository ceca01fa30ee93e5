//! Numbers for Monte Carlo integrals: even, and the same on every machine and for any number of threads.
//!
//! [`Points`] is Roberts' additive sequence R_d: with φ the positive root of φ^(d+1) = φ + 1, point i is the
//! fractional part of s + i·(φ⁻¹, φ⁻², …, φ⁻ᵈ). It is computed in 64-bit fixed point, where sums wrap round as
//! fractional parts do, so nothing is rounded however large i is. The shift s makes a set of points random
//! (Cranley and Patterson 1976): the mean over one set is an unbiased estimate, and those of several sets tell
//! its error. [`Random`](crate::system::random::Random) gives s, and numbers where there is no fixed count of
//! dimensions.
//!
//! (M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018.)

use crate::system::random::unit;

/// Roberts' sequence in D dimensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Points<const D: usize> {
    step: [u64; D],
}

impl<const D: usize> Points<D> {
    /// The sequence.
    pub fn new() -> Self {
        // Products, not a library's powers: their last bits must be the same on every machine.
        let power = |base: f64, exponent: usize| (0..exponent).fold(1.0, |product, _| product * base);
        // Newton's method from above: the function is convex there.
        let mut phi = 2f64;
        for _ in 0..64 {
            phi -= (power(phi, D + 1) - phi - 1.0) / ((D + 1) as f64 * power(phi, D) - 1.0);
        }
        let whole = power(2.0, 64);
        let step = std::array::from_fn(|j| (whole / power(phi, j + 1)) as u64);
        Points { step }
    }

    /// Point `i` of the sequence shifted by `shift`, each coordinate from 0 up to but not including 1.
    pub fn at(&self, shift: &[u64; D], i: u64) -> [f64; D] {
        std::array::from_fn(|j| unit(shift[j].wrapping_add(i.wrapping_mul(self.step[j]))))
    }
}

impl<const D: usize> Default for Points<D> {
    fn default() -> Self {
        Points::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::random::Random;

    #[test]
    fn one_dimension_is_the_golden_ratio_and_two_the_plastic_number() {
        let golden = Points::<1>::new().at(&[0], 1)[0];
        assert!((golden - 0.618_033_988_749_894_8).abs() < 1e-15);
        let [x, y] = Points::<2>::new().at(&[0, 0], 1);
        assert!((x - 0.754_877_666_246_692_8).abs() < 1e-15 && (y - 0.569_840_290_998_053_2).abs() < 1e-15);
    }

    #[test]
    fn points_integrate_better_than_random_ones_and_without_bias() {
        // ∫ Π 2·x_j over the unit cube of six dimensions is 1; its standard deviation is √((4/3)⁶ − 1) = 2.15.
        let points = Points::<6>::new();
        let mean = |shift: &[u64; 6], count: u64| {
            let value = |i| points.at(shift, i).iter().map(|x| 2.0 * x).product::<f64>();
            (0..count).map(value).sum::<f64>() / count as f64
        };
        let count = 256;
        let errors: Vec<f64> = (0..400).map(|seed| mean(&Random::of([seed]).words(), count) - 1.0).collect();
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / 400.0).sqrt();
        let bias = errors.iter().sum::<f64>() / 400.0;
        assert!(rms < 0.75 * 2.15 / (count as f64).sqrt(), "{rms}");
        assert!(bias.abs() < 4.0 * rms / 20.0, "{bias}, {rms}");
    }
}
