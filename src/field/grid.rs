//! One level of light: a cube of cells as four planes (c00, X, Y, Z), padded with a dark border.

use crate::sh::{Real, Sh};

/// A cell's place in its grid: (x, y, z), each from 0 to n − 1.
pub type Cell = [usize; 3];

/// What cells are compared by to be in the order of memory: x fastest, z slowest.
pub fn memory_order([x, y, z]: Cell) -> [usize; 3] {
    [z, y, x]
}

/// Cells with their light, in the order of memory: x fastest, z slowest.
pub type CellList<T> = Vec<(Cell, Sh<T>)>;

/// Where the cells of an n³ grid lie in one plane of memory. This is the one owner of the padding:
/// rows run along x and are followed by a gap, every slab of rows is followed by a dark row, and dark
/// slabs lie before the first and behind the last. So each of a cell's six neighbours can be read at a
/// constant distance, and those outside are dark without a test. Borders are shared (the gap behind
/// one row is the gap before the next), which keeps the padding under 10 % from n = 128 on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    n: usize,
    row: usize,
    slab: usize,
    first: usize,
    plane: usize,
}

impl Layout {
    /// The layout of an n³ grid.
    pub fn new(n: usize) -> Self {
        // One dark cell is enough; more keep rows on even places. Measured at 128³, eight are no faster than four.
        let gap = match n {
            256.. => 8,
            16.. => 4,
            _ => 1,
        };
        let row = n + gap;
        let slab = row * (n + 1);
        let first = (slab + row).next_multiple_of(16);
        let plane = (first + slab * (n + 1)).next_multiple_of(16);
        Layout { n, row, slab, first, plane }
    }

    /// Cells along a side.
    pub fn side(&self) -> usize {
        self.n
    }

    /// The distance in memory from a cell to its neighbour in +x, +y and +z.
    pub fn steps(&self) -> [usize; 3] {
        [1, self.row, self.slab]
    }

    /// Numbers in one plane, padding and all.
    pub fn plane_len(&self) -> usize {
        self.plane
    }

    /// Where a cell lies in a plane.
    #[inline]
    pub fn index(&self, [x, y, z]: Cell) -> usize {
        debug_assert!(x < self.n && y < self.n && z < self.n, "({x}, {y}, {z}) is outside {}³", self.n);
        self.first + z * self.slab + y * self.row + x
    }

    /// Where the row (y, z) begins in a plane.
    #[inline]
    pub fn row_start(&self, y: usize, z: usize) -> usize {
        self.index([0, y, z])
    }

    /// Every cell, x fastest, z slowest.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        let n = self.n;
        (0..n).flat_map(move |z| (0..n).flat_map(move |y| (0..n).map(move |x| [x, y, z])))
    }
}

/// An n³ cube of SH vectors, each in its own four planes. All padding is zero, always.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<T> {
    layout: Layout,
    planes: [Vec<T>; 4],
}

impl<T: Real> Grid<T> {
    /// A dark n³ grid.
    pub fn new(n: usize) -> Self {
        let layout = Layout::new(n);
        Grid { layout, planes: std::array::from_fn(|_| vec![T::ZERO; layout.plane_len()]) }
    }

    /// Cells along a side.
    pub fn side(&self) -> usize {
        self.layout.n
    }

    /// Where cells lie in the planes.
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// The four planes (c00, X, Y, Z), padding and all; [`Layout`] says where cells are.
    pub fn planes(&self) -> &[Vec<T>; 4] {
        &self.planes
    }

    /// The four planes, to write cells in. Whoever writes must leave the padding zero.
    pub fn planes_mut(&mut self) -> [&mut [T]; 4] {
        self.planes.each_mut().map(Vec::as_mut_slice)
    }

    /// The SH vector of a cell.
    #[inline]
    pub fn get(&self, cell: Cell) -> Sh<T> {
        self.at(self.layout.index(cell))
    }

    /// The SH vector at a place in the planes, as [`Layout::index`] gives it.
    #[inline]
    pub fn at(&self, i: usize) -> Sh<T> {
        let [c, x, y, z] = &self.planes;
        Sh([c[i], x[i], y[i], z[i]])
    }

    /// The row (y, z) of each plane.
    #[inline]
    pub fn row(&self, y: usize, z: usize) -> [&[T]; 4] {
        let start = self.layout.row_start(y, z);
        self.planes.each_ref().map(|plane| &plane[start..start + self.layout.n])
    }

    /// The row (y, z) of each plane, to write.
    #[inline]
    pub fn row_mut(&mut self, y: usize, z: usize) -> [&mut [T]; 4] {
        let (start, n) = (self.layout.row_start(y, z), self.layout.n);
        self.planes.each_mut().map(|plane| &mut plane[start..start + n])
    }

    /// Sets a cell.
    #[inline]
    pub fn set(&mut self, cell: Cell, value: Sh<T>) {
        let i = self.layout.index(cell);
        let [c, x, y, z] = &mut self.planes;
        [c[i], x[i], y[i], z[i]] = value.0;
    }

    /// Adds to a cell.
    #[inline]
    pub fn add(&mut self, cell: Cell, value: Sh<T>) {
        self.set(cell, self.get(cell) + value);
    }

    /// Makes every cell dark.
    pub fn clear(&mut self) {
        for plane in &mut self.planes {
            plane.fill(T::ZERO);
        }
    }

    /// Takes over every cell of a grid of the same size.
    pub fn copy_from(&mut self, other: &Self) {
        for (to, from) in self.planes.iter_mut().zip(&other.planes) {
            to.copy_from_slice(from);
        }
    }

    /// Adds a grid of the same size, cell by cell.
    pub fn add_grid(&mut self, other: &Self) {
        for (to, from) in self.planes.iter_mut().zip(&other.planes) {
            for (a, b) in to.iter_mut().zip(from) {
                *a += *b;
            }
        }
    }

    /// Multiplies every cell by `factor`.
    pub fn scale(&mut self, factor: T) {
        self.planes.iter_mut().flatten().for_each(|c| *c *= factor);
    }

    /// Every cell with its SH vector, x fastest, z slowest.
    pub fn iter(&self) -> impl Iterator<Item = (Cell, Sh<T>)> + '_ {
        self.layout.cells().map(|cell| (cell, self.get(cell)))
    }

    /// The sum of c00 over all cells; up to a constant, the light's energy.
    pub fn energy(&self) -> f64 {
        self.planes[0].iter().map(|c| c.to_f64()).sum()
    }

    /// Bytes of memory it holds.
    pub fn bytes(&self) -> usize {
        4 * self.layout.plane_len() * size_of::<T>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_neighbour_is_at_its_step_and_those_outside_are_dark_padding() {
        for n in [1, 2, 4, 8, 16] {
            let layout = Layout::new(n);
            let mut taken = vec![false; layout.plane_len()];
            for cell in layout.cells() {
                assert!(!std::mem::replace(&mut taken[layout.index(cell)], true), "two cells share a place");
            }
            for cell in layout.cells() {
                for axis in 0..3 {
                    let here = layout.index(cell);
                    let step = layout.steps()[axis];
                    for (inside, there) in [(cell[axis] + 1 < n, here + step), (cell[axis] > 0, here - step)] {
                        assert_eq!(taken[there], inside, "n = {n}, {cell:?}, axis {axis}");
                    }
                }
            }
        }
    }

    #[test]
    fn padding_costs_under_ten_percent_from_128_on() {
        for n in [128usize, 256, 512] {
            let used = Layout::new(n).plane_len() as f64 / (n * n * n) as f64;
            assert!(used < 1.10, "n = {n}: {used}");
        }
    }

    #[test]
    fn cells_keep_what_is_written_and_add_up() {
        let mut grid = Grid::<f64>::new(4);
        let value = Sh([1.0, 2.0, 3.0, 4.0]);
        grid.set([1, 2, 3], value);
        grid.add([1, 2, 3], value);
        assert_eq!(grid.get([1, 2, 3]), value * 2.0);
        assert_eq!(grid.energy(), 2.0);
        assert_eq!(grid.iter().filter(|(_, v)| !v.is_zero()).count(), 1);
        let mut sum = grid.clone();
        sum.add_grid(&grid);
        assert_eq!(sum.get([1, 2, 3]), value * 4.0);
    }
}
