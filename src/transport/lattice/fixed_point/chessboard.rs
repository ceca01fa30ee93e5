//! A grid cut in two like a chessboard, so that every neighbour of a cell is in the other half.
//!
//! In row (y, z) the cells of half h have x = 2·j + s with s = (y + z + h) mod 2. Its neighbours along y and z
//! have the same j in the other half, those along x have j − 1 + s and j + s: a row of one half is computed
//! from unbroken rows of the other. The 2 × 2 × 2 children of a coarse cell are four cells of each half, all
//! with j the coarse x.

use super::lit_rows::LitRows;
use crate::field::Grid;
use crate::transport::team;

/// Where the cells of a half lie: slab by slab, in each the four planes, all with a dark border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Cells along a side of the whole grid, at least 2.
    pub n: usize,
}

impl Shape {
    /// Cells in a row.
    pub fn width(self) -> usize {
        self.n / 2
    }

    /// From a row to the next. The last number of each is dark, and so the one before the next.
    pub fn row(self) -> usize {
        self.width() + 1
    }

    /// Numbers in one plane of a slab, a dark row at either end.
    pub fn plane(self) -> usize {
        self.row() * (self.n + 2)
    }

    /// Numbers in a slab.
    pub fn slab(self) -> usize {
        4 * self.plane()
    }

    /// Where row y begins in a plane of a slab.
    pub fn start(self, y: usize) -> usize {
        (y + 1) * self.row()
    }
}

/// One half of a grid.
#[derive(Clone, Debug)]
pub struct Half {
    /// All slabs, with a dark one before the first and behind the last.
    pub numbers: Vec<f32>,
}

impl Half {
    /// A dark half.
    pub fn new(shape: Shape) -> Self {
        Half { numbers: vec![0.0; (shape.n + 2) * shape.slab()] }
    }

    /// Adds another half.
    pub fn add(&mut self, other: &Half) {
        self.numbers.iter_mut().zip(&other.numbers).for_each(|(a, b)| *a += b);
    }

    /// Makes rows dark.
    pub fn clear(&mut self, shape: Shape, lit: &LitRows) {
        for z in 0..shape.n {
            let [from, to] = [lit.rows(z).start, lit.rows(z).end].map(|y| shape.start(y));
            for plane in 0..4 {
                let at = Half::at(shape, z) + plane * shape.plane();
                self.numbers[at + from..at + to].fill(0.0);
            }
        }
    }

    /// Where slab z begins.
    fn at(shape: Shape, z: usize) -> usize {
        (z + 1) * shape.slab()
    }

    /// Slab z with its four planes.
    pub fn slab(&self, shape: Shape, z: usize) -> &[f32] {
        &self.numbers[Self::at(shape, z)..][..shape.slab()]
    }

    /// Slabs z − 1, z and z + 1.
    pub fn around(&self, shape: Shape, z: usize) -> [&[f32]; 3] {
        let [before, here, behind] = [0, 1, 2].map(|i| (z + i) * shape.slab());
        [before, here, behind].map(|from| &self.numbers[from..][..shape.slab()])
    }

    /// All slabs, to write in; their borders must stay dark.
    pub fn slabs_mut(&mut self, shape: Shape) -> &mut [f32] {
        let slab = shape.slab();
        &mut self.numbers[slab..][..shape.n * slab]
    }
}

/// The parity s of the cells of half `h` in row (y, z).
pub fn parity(h: usize, y: usize, z: usize) -> usize {
    (y + z + h) % 2
}

/// Sets the `lit` rows of both halves to those of a grid times `unit`; the sum of the squares of all that is set.
pub fn split<'a>(grid: &Grid<f32>, unit: f32, lit: &LitRows, [even, odd]: &'a mut [Half; 2]) -> f64 {
    let shape = Shape { n: grid.side() };
    let slab = |(z, (even, odd)): (usize, (&mut [f32], &mut [f32]))| -> f64 {
        let mut squares = 0.0;
        for y in lit.rows(z) {
            let start = grid.layout().row_start(y, z);
            let (first, second) = if (y + z) % 2 == 0 { (&mut *even, &mut *odd) } else { (&mut *odd, &mut *even) };
            let mut sum = [0.0; 2];
            for (plane, numbers) in grid.planes().iter().enumerate() {
                let at = plane * shape.plane() + shape.start(y);
                let pairs = first[at..].iter_mut().zip(&mut second[at..]);
                for ((first, second), pair) in pairs.zip(numbers[start..][..shape.n].chunks_exact(2)) {
                    (*first, *second) = (unit * pair[0], unit * pair[1]);
                    sum[0] += f64::from(*first).powi(2);
                    sum[1] += f64::from(*second).powi(2);
                }
            }
            squares += sum[0] + sum[1];
        }
        squares
    };
    let slabs = |half: &'a mut Half| half.slabs_mut(shape).chunks_mut(shape.slab());
    team::share(slabs(even).zip(slabs(odd)).enumerate().collect(), slab).iter().sum()
}

/// Adds both halves over `unit` to a grid, half 1 being the sum of two.
pub fn join(even: &Half, odd: [&Half; 2], unit: f32, lit: &LitRows, grid: &mut Grid<f32>) {
    let back = 1.0 / unit;
    let shape = Shape { n: grid.side() };
    let layout = grid.layout();
    team::share(grid.planes_mut().into_iter().enumerate().collect(), |(plane, numbers): (usize, &mut [f32])| {
        for (y, z) in lit.all() {
            let row = &mut numbers[layout.row_start(y, z)..][..shape.n];
            let at = Half::at(shape, z) + plane * shape.plane() + shape.start(y);
            let [even, odd, more] = [even, odd[0], odd[1]].map(|half| &half.numbers[at..][..shape.width()]);
            let is_even_first = (y + z) % 2 == 0;
            let (pairs, _) = row.as_chunks_mut::<2>();
            for (pair, (even, (odd, more))) in pairs.iter_mut().zip(even.iter().zip(odd.iter().zip(more))) {
                let odd = odd + more;
                let [first, second] = if is_even_first { [*even, odd] } else { [odd, *even] };
                pair[0] += back * first;
                pair[1] += back * second;
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sh::Sh;
    use crate::transport::lattice::reach::everywhere;

    #[test]
    fn what_is_split_is_joined_again() {
        for n in [2, 4, 8] {
            let mut grid = Grid::new(n);
            for (i, cell) in grid.layout().cells().enumerate() {
                grid.set(cell, Sh([i as f32 + 1.0, -(i as f32), 0.5, 2.0]));
            }
            let mut joined = Grid::new(n);
            let shape = Shape { n };
            let mut halves = [Half::new(shape), Half::new(shape)];
            let lit = LitRows::rows_of(&everywhere(n));
            split(&grid, 0.25, &lit, &mut halves);
            let [even, odd] = &halves;
            join(even, [odd, &Half::new(shape)], 0.25, &lit, &mut joined);
            assert_eq!(joined, grid);
        }
    }
}
