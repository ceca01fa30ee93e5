//! Random numbers that come again: the same seed, the same numbers, on every machine.

/// 2⁻⁵³, the spacing of the numbers given.
const SPACING: f64 = 1.0 / (1u64 << 53) as f64;

/// The number from 0 up to but not including 1 that the high 53 of these bits are.
pub fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * SPACING
}

/// SplitMix64 (Steele, Lea and Flood 2014): small, fast, and even enough for scenes and for shifts of point sets.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The numbers of `seed`.
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }

    /// The stream of the numbers `of`: one for each pixel, batch and point.
    pub fn of<const N: usize>(of: [u64; N]) -> Self {
        let mut stream = Random(0);
        for number in of {
            stream.0 = stream.bits() ^ number;
        }
        stream
    }

    /// 64 even bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from 0 up to but not including 1.
    pub fn unit(&mut self) -> f64 {
        unit(self.bits())
    }

    /// `D` times 64 even bits: a shift of a set of points.
    pub fn words<const D: usize>(&mut self) -> [u64; D] {
        std::array::from_fn(|_| self.bits())
    }

    /// A number from `low` up to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A whole number below `count`, which is at least 1.
    pub fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// True once in `count` times.
    pub fn once_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_numbers_come() {
        // The first outputs for seed 1234567 as the reference implementation in C gives them.
        let mut random = Random::new(1_234_567);
        let found: [u64; 3] = std::array::from_fn(|_| random.bits());
        assert_eq!(found, [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]);
    }

    #[test]
    fn numbers_fill_their_range_and_stay_in_it() {
        let mut random = Random::new(1);
        let mut seen = [0; 5];
        for _ in 0..1000 {
            seen[random.below(5)] += 1;
            let x = random.between(-2.0, 3.0);
            assert!((-2.0..3.0).contains(&x));
        }
        assert!(seen.iter().all(|count| *count > 100), "{seen:?}");
    }

    #[test]
    fn streams_of_other_numbers_differ_and_fill_their_range() {
        let first = |of: [u64; 2]| Random::of(of).bits();
        assert_ne!(first([1, 2]), first([2, 1]));
        assert_ne!(first([0, 0]), first([0, 1]));
        let mut bins = [0u32; 16];
        for seed in 0..16_000 {
            bins[(Random::of([seed, 7]).unit() * 16.0) as usize] += 1;
        }
        // Chi-squared with 15 degrees of freedom exceeds 37.7 once in a thousand times.
        let chi: f64 = bins.iter().map(|n| (f64::from(*n) - 1000.0).powi(2) / 1000.0).sum();
        assert!(chi < 37.7, "{chi}");
    }
}
