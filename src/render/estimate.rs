//! Means with error bars: many integrals at once, refined batch by batch.
//!
//! Item i (a pixel, a patch of a surface) is the mean of a function over the unit cube. A *batch* is one shifted set of
//! [points](super::sequence::Points) for every item; its shift comes from the item's and the batch's number, so nothing depends on threads
//! or on the other items. With m_b the means of B batches, the estimate is their mean m, and its standard deviation
//!
//! ```text
//! σ = √( Σ_b (m_b − m)² / (B·(B − 1)) )
//! ```

use rayon::prelude::*;

use crate::system::random::Random;

/// How many batches tell an error bar.
pub const BATCHES: u32 = 16;
/// The most dimensions in which samples are evenly spread.
pub const DIMENSIONS: usize = 6;
/// Items that a thread takes at once.
const PIECE: usize = 64;

/// One sample of a batch.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Its number in the batch, from 0: that of its point in a sequence.
    pub number: u64,
    /// The item's shifts in this batch, for as many dimensions as there may be ([`Points::at`](super::sequence::Points::at)).
    pub shift: [u64; DIMENSIONS],
    /// As many random numbers as are wanted, unrelated to those of other samples.
    pub more: Random,
}

/// Estimates of K numbers for each item.
#[derive(Clone, Debug)]
pub struct Estimates<const K: usize> {
    seed: u64,
    batches: u32,
    samples: u64,
    /// For each item and number the mean of the batches, and Σ (m_b − m)² (Welford's sums).
    sums: Vec<[[f64; 2]; K]>,
}

/// Whoever waits for a long computation: told from time to time which share of it is done, says whether to go on.
pub type Watch<'a> = &'a (dyn Fn(f64) -> bool + Sync);

impl<const K: usize> Estimates<K> {
    /// Nothing known yet about so many items.
    pub fn new(items: usize, seed: u64) -> Self {
        Estimates { seed, batches: 0, samples: 0, sums: vec![[[0.0; 2]; K]; items] }
    }

    /// Adds a batch of `samples` for every item. `of` takes one: the item's number and numbers to place it by. Returns
    /// whether `watch` let it finish; if not, the estimates are as they were.
    pub fn add_batch(&mut self, samples: u64, watch: Watch, of: impl Fn(usize, Sample) -> [f64; K] + Sync) -> bool {
        let (seed, batch) = (self.seed, u64::from(self.batches));
        let pieces = self.sums.len().div_ceil(PIECE).max(1);
        let done = std::sync::atomic::AtomicUsize::new(0);
        let piece = |piece: usize| -> Option<Vec<[f64; K]>> {
            let items = piece * PIECE..((piece + 1) * PIECE).min(self.sums.len());
            let share = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) as f64 / pieces as f64;
            watch(share).then(|| items.map(|item| mean([seed, item as u64, batch], samples, &of)).collect())
        };
        let Some(means) = (0..pieces).into_par_iter().map(piece).collect::<Option<Vec<_>>>() else { return false };
        self.batches += 1;
        self.samples += samples;
        let count = f64::from(self.batches);
        for (sums, found) in self.sums.iter_mut().zip(means.into_iter().flatten()) {
            for ([mean, squares], found) in sums.iter_mut().zip(found) {
                let before = found - *mean;
                *mean += before / count;
                *squares += before * (found - *mean);
            }
        }
        true
    }

    /// As many batches as an error bar wants, of `samples` for each item altogether (at least one a batch).
    #[cfg(test)]
    pub fn add_all(&mut self, samples: u64, watch: Watch, of: impl Fn(usize, Sample) -> [f64; K] + Sync) -> bool {
        let each = samples.div_ceil(u64::from(BATCHES)).max(1);
        (0..BATCHES).all(|batch| {
            let share = |share: f64| watch((f64::from(batch) + share) / f64::from(BATCHES));
            self.add_batch(each, &share, &of)
        })
    }

    /// How many items there are.
    pub fn len(&self) -> usize {
        self.sums.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.sums.is_empty()
    }

    /// Batches so far.
    pub fn batches(&self) -> u32 {
        self.batches
    }

    /// Samples of every item so far.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// The estimates of an item.
    pub fn mean(&self, item: usize) -> [f64; K] {
        self.sums[item].map(|[mean, _]| mean)
    }

    /// The standard deviations of an item's estimates; infinite before there are two batches.
    pub fn deviation(&self, item: usize) -> [f64; K] {
        let count = f64::from(self.batches);
        let of =
            |squares: f64| if self.batches < 2 { f64::INFINITY } else { (squares / (count * (count - 1.0))).sqrt() };
        self.sums[item].map(|[_, squares]| of(squares))
    }
}

/// The mean of one batch, `of_batch`: seed, item and batch.
fn mean<const K: usize>(of_batch: [u64; 3], samples: u64, of: &impl Fn(usize, Sample) -> [f64; K]) -> [f64; K] {
    let mut stream = Random::of(of_batch);
    let (shift, later) = (stream.words(), stream.bits());
    let mut sum = [0.0; K];
    for number in 0..samples {
        let sample = Sample { number, shift, more: Random::of([later, number]) };
        for (sum, value) in sum.iter_mut().zip(of(of_batch[1] as usize, sample)) {
            *sum += value;
        }
    }
    sum.map(|sum| sum / samples as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::sequence::Points;

    /// Item i is ∫ (i + 1)·x·y over the unit square, a quarter of i + 1.
    fn estimates(samples: u64) -> Estimates<1> {
        let mut estimates = Estimates::new(300, 9);
        assert!(estimates.add_all(samples, &|_| true, |item, sample| {
            let [x, y, ..] = Points::<6>::new().at(&sample.shift, sample.number);
            [(item + 1) as f64 * x * y]
        }));
        estimates
    }

    #[test]
    fn error_bars_are_as_wide_as_the_errors() {
        let estimates = estimates(256);
        let score = |item: usize| {
            let error = estimates.mean(item)[0] - (item + 1) as f64 / 4.0;
            error / estimates.deviation(item)[0]
        };
        let squares: f64 = (0..300).map(|item| score(item).powi(2)).sum();
        // The square of Student's t with 15 degrees of freedom is 15/13 in the mean.
        assert!((squares / 300.0 - 15.0 / 13.0).abs() < 0.4, "{}", squares / 300.0);
        assert_eq!((estimates.batches(), estimates.samples()), (16, 256));
    }

    #[test]
    fn more_samples_are_more_exact() {
        let error = |samples| {
            let estimates = estimates(samples);
            (0..300).map(|item| estimates.deviation(item)[0]).sum::<f64>()
        };
        assert!(error(4096) < 0.2 * error(256));
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits() {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| estimates(64).sums)
        };
        assert_eq!(on(1), on(3));
    }

    #[test]
    fn whoever_watches_may_end_it_and_nothing_has_changed() {
        let mut estimates = estimates(16);
        let before = estimates.sums.clone();
        assert!(!estimates.add_batch(4, &|share| share < 0.5, |_, _| [1.0]));
        assert_eq!(estimates.sums, before);
        assert_eq!(estimates.batches(), 16);
    }

    #[test]
    fn one_batch_tells_no_error() {
        let mut estimates = Estimates::<1>::new(1, 0);
        assert!(estimates.add_batch(4, &|_| true, |_, _| [1.0]));
        assert_eq!(estimates.deviation(0), [f64::INFINITY]);
    }
}
