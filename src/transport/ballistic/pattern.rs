//! Point lights of one kind: what arrives depends on the offset alone, so it is computed once an offset and
//! added up for every light.
//!
//! Of a wall that is a table of 2·n³ to 4·n³ offsets in place of n⁵ fluxes. Entries are rounded to single precision, to one
//! part in 10⁷; sums are taken in double.

use rayon::prelude::*;

use super::arrived_at;
use super::solid_angle::Extent;
use crate::field::Cell;
use crate::sh::Sh;

/// As many lights of a kind are worth a table.
const WORTH: usize = 16;

/// What arrives of one light, by the offset from it.
pub(super) struct Pattern {
    from: Vec<Cell>,
    /// The least offset, and how many there are, by axis.
    least: [isize; 3],
    size: [usize; 3],
    /// x fastest, z slowest.
    arrived: Vec<[f32; 4]>,
}

/// Patterns for all `points` in an n³ volume, if on the average many share one; else none.
pub(super) fn of_equals(points: &[(Cell, Sh<f64>)], extents: &[Extent], n: usize) -> Vec<Pattern> {
    let mut sorted = points.to_vec();
    let bits = |light: Sh<f64>| light.0.map(f64::to_bits);
    sorted.sort_by_key(|(_, light)| bits(*light));
    let kinds: Vec<_> = sorted.chunk_by(|a, b| bits(a.1) == bits(b.1)).collect();
    if kinds.len() * WORTH > points.len() {
        return Vec::new();
    }
    kinds.into_iter().map(|kind| Pattern::new(kind, extents, n)).collect()
}

impl Pattern {
    /// Of points that all hold the light of the first.
    fn new(points: &[(Cell, Sh<f64>)], extents: &[Extent], n: usize) -> Self {
        let light = points.first().map_or(Sh::ZERO, |(_, light)| *light);
        let from: Vec<Cell> = points.iter().map(|(cell, _)| *cell).collect();
        let along = |axis: usize| from.iter().map(move |cell| cell[axis]);
        let ends = [0, 1, 2].map(|axis| (along(axis).min().unwrap_or(0), along(axis).max().unwrap_or(0)));
        let (least, size) = (ends.map(|(_, last)| -(last as isize)), ends.map(|(first, last)| n + last - first));
        let at = |i: usize| {
            let place = [i % size[0], i / size[0] % size[1], i / size[0] / size[1]];
            let offset = [0, 1, 2].map(|axis| least[axis] + place[axis] as isize);
            arrived_at(light, offset, extents, n).cast().0
        };
        let arrived = (0..size.iter().product()).into_par_iter().map(at).collect();
        Pattern { from, least, size, arrived }
    }

    /// Adds what arrives in row (y, z).
    pub(super) fn add_row(&self, y: usize, z: usize, light: &mut [Sh<f64>]) {
        for from in &self.from {
            let to = [0, y, z];
            let [x, y, z] = [0, 1, 2].map(|axis| (to[axis] as isize - from[axis] as isize - self.least[axis]) as usize);
            let row = &self.arrived[(z * self.size[1] + y) * self.size[0] + x..];
            for (light, arrived) in light.iter_mut().zip(row) {
                light.0.iter_mut().zip(arrived).for_each(|(sum, c)| *sum += f64::from(*c));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{extents, from_one};
    use super::*;
    use crate::field::Layout;
    use glam::DVec3;

    #[test]
    fn a_pattern_gives_what_its_lights_give_one_by_one() {
        let (n, lobe) = (8, Sh::lobe(DVec3::new(0.0, 0.6, -0.8)));
        let points: Vec<(Cell, Sh<f64>)> = Layout::new(n).cells().step_by(5).map(|cell| (cell, lobe)).collect();
        let extents = extents(n);
        let patterns = of_equals(&points, &extents, n);
        assert_eq!(patterns.len(), 1);
        for (y, z) in [(0, 0), (3, 7), (7, 4)] {
            let mut row = vec![Sh::ZERO; n];
            patterns[0].add_row(y, z, &mut row);
            for (x, found) in row.into_iter().enumerate() {
                let wanted: Sh<f64> = points.iter().map(|p| from_one(p, [x, y, z], &extents, None, n)).sum();
                assert!((found - wanted).max_norm() < 1e-6 * wanted.max_norm(), "({x}, {y}, {z})");
            }
        }
    }

    #[test]
    fn lights_that_differ_have_no_pattern() {
        let points: Vec<(Cell, Sh<f64>)> =
            (0..32).map(|i| ([i % 8, 0, i / 8], Sh([1.0 + i as f64, 0.0, 0.0, 0.0]))).collect();
        assert!(of_equals(&points, &extents(8), 8).is_empty());
    }
}
