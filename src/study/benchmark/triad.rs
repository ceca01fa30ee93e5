//! The machine's memory bandwidth: a = b + s·c over arrays that no cache holds.

use std::hint::black_box;
use std::time::Instant;

use rayon::prelude::*;

use super::median;

/// Numbers in each of the three arrays: 64 MiB of f32.
const NUMBERS: usize = 16 << 20;

/// Passes of one measurement. They take long enough for the system to give every thread a core of its own.
const PASSES: usize = 9;

/// The arrays.
pub struct Triad {
    a: Vec<f32>,
    b: Vec<f32>,
    c: Vec<f32>,
}

impl Triad {
    /// Arrays that have been written once, so that their pages exist.
    pub fn new() -> Self {
        Triad { a: vec![0.5; NUMBERS], b: vec![1.5; NUMBERS], c: vec![2.5; NUMBERS] }
    }

    /// Bytes a second, the median of several passes on the current threads; counted are two reads and one
    /// write of four bytes for each number, not that a write reads its cache line first.
    pub fn bandwidth(&mut self) -> f64 {
        let mut passes: Vec<f64> = (0..PASSES).map(|_| self.pass()).collect();
        median(&mut passes)
    }

    fn pass(&mut self) -> f64 {
        let piece = NUMBERS / rayon::current_num_threads();
        let started = Instant::now();
        let pieces = self.a.par_chunks_mut(piece).zip(self.b.par_chunks(piece)).zip(self.c.par_chunks(piece));
        pieces.for_each(|((a, b), c)| {
            for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                *a = b + 0.75 * c;
            }
        });
        black_box(&self.a);
        (3 * NUMBERS * size_of::<f32>()) as f64 / started.elapsed().as_secs_f64()
    }
}

impl Default for Triad {
    fn default() -> Self {
        Self::new()
    }
}
