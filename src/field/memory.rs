//! What light takes of the machine's memory.

use super::grid::Layout;
use super::octree::Levels;

/// Bytes of a simulation's light: for each channel the octrees source, target and accumulated and the
/// merged grid, all in numbers of type `T`, and a bit a cell for the index volume.
pub fn of_simulation<T>(sizes: Levels, channels: usize) -> u64 {
    let octree: u64 = sizes.sides().map(of_grid::<T>).sum();
    let light = 3 * octree + of_grid::<T>(sizes.finest());
    light * channels as u64 + sizes.cells() as u64 / 8
}

/// Bytes of one grid of side `n`, padding and all.
pub fn of_grid<T>(n: usize) -> u64 {
    4 * Layout::new(n).plane_len() as u64 * size_of::<T>() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Grid, IndexVolume, Octree};
    use crate::system::memory::in_words;

    #[test]
    fn what_is_computed_is_what_is_allocated() {
        for (size, coarsest) in [(1, 1), (8, 1), (64, 2)] {
            let sizes = Levels::new(size, coarsest).unwrap();
            let light = 3 * Octree::<f32>::new(sizes).bytes() + Grid::<f32>::new(size).bytes();
            let computed = of_simulation::<f32>(sizes, 2);
            let allocated = (2 * light + IndexVolume::new(sizes).bytes()) as u64;
            // Marks are kept in whole words a row, which small levels do not fill.
            assert!(computed <= allocated && allocated - computed < allocated / 10 + 1024, "{computed}, {allocated}");
        }
    }

    #[test]
    fn the_largest_volume_is_told_in_words() {
        let sizes = Levels::new(1024, 1).unwrap();
        // 3 · 8/7 + 1 grids of 4 · 4 bytes a cell, less than 10 % more with padding.
        let least = (3.0 * 8.0 / 7.0 + 1.0) * 16.0;
        let words = in_words(of_simulation::<f32>(sizes, 1));
        let told: f64 = words.strip_suffix(" GiB").unwrap().parse().unwrap();
        assert!(told > least && told < 1.1 * least, "{words}");
    }
}
