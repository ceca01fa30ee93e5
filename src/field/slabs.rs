//! A grid cut into runs of slabs, so that threads can write side by side without locks.

use std::ops::Range;

use super::grid::{Cell, Grid, Layout};
use crate::sh::{Real, Sh};

/// Some slabs of a grid, those z that lie in a range, to be written.
#[derive(Debug)]
pub struct Slabs<'a, T> {
    layout: Layout,
    slabs: Range<usize>,
    /// Where they begin in the planes of the grid.
    begin: usize,
    planes: [&'a mut [T]; 4],
}

impl<T: Real> Grid<T> {
    /// The grid in runs of slabs; `ends` rises and has the z after the last slab of each run, at the end the grid's side.
    pub fn cut(&mut self, ends: &[usize]) -> Vec<Slabs<'_, T>> {
        let layout = self.layout();
        let place = |z: usize| match z {
            0 => 0,
            z if z >= layout.side() => layout.plane_len(),
            z => layout.row_start(0, z),
        };
        let mut runs = Vec::with_capacity(ends.len());
        let (mut rest, mut from) = (self.planes_mut(), 0);
        for &end in ends {
            let (begin, length) = (place(from), place(end) - place(from));
            let [c, x, y, z] = rest.map(|plane| plane.split_at_mut(length));
            runs.push(Slabs { layout, slabs: from..end, begin, planes: [c.0, x.0, y.0, z.0] });
            (rest, from) = ([c.1, x.1, y.1, z.1], end);
        }
        runs
    }
}

impl<T: Real> Slabs<'_, T> {
    /// Which slabs they are.
    pub fn range(&self) -> Range<usize> {
        self.slabs.clone()
    }

    /// Where they begin in the planes of the grid: what lies at i there lies at i less this in [`Self::planes_mut`].
    pub fn begin(&self) -> usize {
        self.begin
    }

    /// The places in the planes of the grid that they cover.
    pub fn places(&self) -> Range<usize> {
        self.begin..self.begin + self.planes[0].len()
    }

    /// Their part of every plane, padding and all. Whoever writes must leave the padding zero.
    pub fn planes_mut(&mut self) -> [&mut [T]; 4] {
        self.planes.each_mut().map(|plane| &mut **plane)
    }

    /// Sets a cell of the grid that lies in them.
    #[inline]
    pub fn set(&mut self, cell: Cell, value: Sh<T>) {
        let i = self.layout.index(cell) - self.begin;
        let [c, x, y, z] = &mut self.planes;
        [c[i], x[i], y[i], z[i]] = value.0;
    }

    /// Adds to a cell of the grid that lies in them.
    #[inline]
    pub fn add(&mut self, cell: Cell, value: Sh<T>) {
        let i = self.layout.index(cell) - self.begin;
        self.planes.iter_mut().zip(value.0).for_each(|(plane, c)| plane[i] += c);
    }

    /// The row (y, z) of the grid, from the cell x on, to write.
    #[inline]
    pub fn row_mut(&mut self, x: Range<usize>, y: usize, z: usize) -> [&mut [T]; 4] {
        let start = self.layout.row_start(y, z) - self.begin;
        self.planes.each_mut().map(|plane| &mut plane[start + x.start..start + x.end])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_lies_in_the_run_of_its_slab() {
        let mut grid = Grid::<f32>::new(8);
        let value = |[x, y, z]: Cell| Sh([1.0 + x as f32, y as f32, z as f32, 0.5]);
        let mut runs = grid.cut(&[1, 4, 8]);
        assert_eq!(runs.iter().map(Slabs::range).collect::<Vec<_>>(), [0..1, 1..4, 4..8]);
        assert!(runs.windows(2).all(|two| two[0].places().end == two[1].begin()));
        for run in &mut runs {
            for z in run.range() {
                for (y, x) in (0..8).flat_map(|y| (0..8).map(move |x| (y, x))) {
                    if x < 4 {
                        run.set([x, y, z], value([x, y, z]));
                    } else {
                        run.row_mut(x..x + 1, y, z).into_iter().zip(value([x, y, z]).0).for_each(|(to, c)| to[0] = c);
                    }
                }
            }
        }
        assert!(grid.iter().all(|(cell, light)| light == value(cell)));
        assert_eq!(grid.energy(), grid.iter().map(|(_, light)| f64::from(light.0[0])).sum::<f64>());
    }
}
