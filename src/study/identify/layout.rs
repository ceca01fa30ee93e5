//! How a dump lies in its file: which index runs along which axis, and which number is which coefficient.
//!
//! The lengths of the cells' vectors are the same whatever the order and signs of the coefficients, so they are held
//! against the pattern's under all 48 symmetries of the cube and all shifts by a cell, and the best one tells the
//! axes. Least squares from the pattern's light to the dump's numbers then tells the coefficients.

use std::fmt;

use super::light::{Light, Storage};
use crate::field::Cell;

/// A dump as it is in its file: an array of shape (n, n, n, 4), C order.
#[derive(Clone, Debug, PartialEq)]
pub struct Dump {
    /// The array's side.
    pub side: usize,
    /// Its numbers, the last index fastest.
    pub numbers: Vec<[f64; 4]>,
    /// How they were stored.
    pub storage: Storage,
}

/// Which axis of the grid each index of the array runs along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes {
    /// The axis of the first, second and third index: 0 for x.
    pub order: [usize; 3],
    /// Whether the index runs the other way.
    pub reversed: [bool; 3],
}

impl Axes {
    /// The lab's own: [z, y, x].
    pub const LAB: Axes = Axes { order: [2, 1, 0], reversed: [false; 3] };

    /// All 48, the lab's first.
    fn all() -> Vec<Axes> {
        let orders = [[2, 1, 0], [0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1]];
        let flips = (0..8).map(|bits| std::array::from_fn(|a| bits >> a & 1 == 1));
        let all = flips.flat_map(|reversed| orders.map(|order| Axes { order, reversed }));
        all.collect()
    }

    /// Where a cell stands in the array.
    pub fn place(&self, cell: Cell, side: usize) -> usize {
        (0..3).fold(0, |place, i| {
            let c = cell[self.order[i]];
            place * side + if self.reversed[i] { side - 1 - c } else { c }
        })
    }
}

impl fmt::Display for Axes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for i in 0..3 {
            let sign = if self.reversed[i] { "-" } else { "" };
            write!(f, "{}{sign}{}", if i > 0 { " " } else { "" }, ["x", "y", "z"][self.order[i]])?;
        }
        Ok(())
    }
}

/// Which coefficient each number of a cell is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    /// For each of the four numbers: 0 for c00, 1 to 3 for X, Y, Z.
    pub order: [usize; 4],
    /// Its sign.
    pub signs: [f64; 4],
}

impl Coefficients {
    /// The published basis: (c00, −Y, Z, −X).
    pub const PUBLISHED: Coefficients = Coefficients { order: [0, 2, 3, 1], signs: [1.0, -1.0, 1.0, -1.0] };
}

impl fmt::Display for Coefficients {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for j in 0..4 {
            let sign = if self.signs[j] < 0.0 { "-" } else { "" };
            write!(f, "{}{sign}{}", if j > 0 { " " } else { "" }, ["c0", "X", "Y", "Z"][self.order[j]])?;
        }
        Ok(())
    }
}

/// How a dump lies in its file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// The array's axes.
    pub axes: Axes,
    /// The coefficients.
    pub coefficients: Coefficients,
}

impl Layout {
    /// The light of a dump.
    pub fn light(&self, dump: &Dump) -> Light {
        let mut light = Light::dark(dump.side);
        for i in 0..dump.numbers.len() {
            let numbers = dump.numbers[self.axes.place(light.cell(i), dump.side)];
            for (j, number) in numbers.iter().enumerate() {
                light.cells_mut()[i][self.coefficients.order[j]] = self.coefficients.signs[j] * number;
            }
        }
        light
    }
}

/// A shift by whole cells.
pub type Shift = [isize; 3];

/// The cell that is shifted, if it stays inside.
pub fn shifted(cell: Cell, by: Shift, side: usize) -> Option<Cell> {
    let mut moved = cell;
    for (c, step) in moved.iter_mut().zip(by) {
        *c = c.checked_add_signed(step).filter(|c| *c < side)?;
    }
    Some(moved)
}

/// The axes and the shift under which a dump has light where the pattern has, and how alike they are, 0 to 1.
pub fn align(dump: &Dump, expected: &Light) -> (Axes, Shift, f64) {
    let side = dump.side;
    let length = |c: &[f64; 4]| c.iter().map(|c| c * c).sum::<f64>().sqrt();
    let found: Vec<f64> = dump.numbers.iter().map(length).collect();
    let wanted: Vec<(Cell, f64)> =
        expected.lit().into_iter().map(|i| (expected.cell(i), length(&expected.cells()[i]))).collect();
    let norm = |lengths: &mut dyn Iterator<Item = f64>| lengths.map(|l| l * l).sum::<f64>().sqrt();
    let scale = norm(&mut found.iter().copied()) * norm(&mut wanted.iter().map(|w| w.1));
    let mut best = (Axes::LAB, [0; 3], -1.0);
    let mut shifts: Vec<Shift> = (0..27).map(|i: isize| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]).collect();
    shifts.sort_by_key(|s| s.iter().map(|c| c.abs()).sum::<isize>());
    for shift in shifts {
        for axes in Axes::all() {
            let products = wanted.iter().filter_map(|&(cell, l)| Some((shifted(cell, shift, side)?, l)));
            let alike = products.map(|(cell, l)| l * found[axes.place(cell, side)]).sum::<f64>() / scale.max(1e-300);
            if alike > best.2 + 1e-9 {
                best = (axes, shift, alike);
            }
        }
    }
    best
}

/// The coefficients that a dump's numbers most likely are, from the light that was injected: the largest entries of
/// the 4×4 matrix that takes one to the other.
pub fn coefficients(dump: &Dump, axes: Axes, expected: &Light) -> Option<Coefficients> {
    let side = dump.side;
    let mut normal = [[0.0; 4]; 4];
    let mut targets = [[0.0; 4]; 4];
    for i in expected.lit() {
        let light = expected.cells()[i];
        let numbers = dump.numbers[axes.place(expected.cell(i), side)];
        for a in 0..4 {
            for b in 0..4 {
                normal[a][b] += light[a] * light[b];
                targets[a][b] += light[a] * numbers[b];
            }
        }
    }
    let matrix = solved(normal, targets)?;
    let mut entries: Vec<(usize, usize, f64)> = (0..16).map(|i| (i / 4, i % 4, matrix[i / 4][i % 4])).collect();
    entries.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
    let (mut order, mut signs) = ([usize::MAX; 4], [0.0; 4]);
    for (component, number, entry) in entries {
        if order[number] == usize::MAX && !order.contains(&component) && entry != 0.0 {
            order[number] = component;
            signs[number] = entry.signum();
        }
    }
    (!order.contains(&usize::MAX)).then_some(Coefficients { order, signs })
}

/// The solution of four linear systems with one matrix, by elimination.
fn solved(mut matrix: [[f64; 4]; 4], mut targets: [[f64; 4]; 4]) -> Option<[[f64; 4]; 4]> {
    for i in 0..4 {
        let pivot = (i..4).max_by(|&a, &b| matrix[a][i].abs().total_cmp(&matrix[b][i].abs()))?;
        if matrix[pivot][i].abs() < 1e-12 {
            return None;
        }
        matrix.swap(i, pivot);
        targets.swap(i, pivot);
        for row in (0..4).filter(|row| *row != i) {
            let factor = matrix[row][i] / matrix[i][i];
            for c in 0..4 {
                matrix[row][c] -= factor * matrix[i][c];
                targets[row][c] -= factor * targets[i][c];
            }
        }
    }
    for i in 0..4 {
        let pivot = matrix[i][i];
        targets[i].iter_mut().for_each(|t| *t /= pivot);
    }
    Some(targets)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::pattern::Pattern;

    #[test]
    fn any_layout_is_read_from_the_pattern() {
        let pattern = Pattern::find("spaced", 8).unwrap();
        let mut expected = Light::dark(8);
        pattern.lobes().iter().for_each(|lobe| expected.add(lobe.cell, lobe.light()));
        for (axes, order) in Axes::all().into_iter().zip([[0, 1, 2, 3], [3, 2, 1, 0], [1, 0, 3, 2]].into_iter().cycle())
        {
            let coefficients_there = Coefficients { order, signs: [1.0, -1.0, 1.0, -1.0] };
            let mut numbers = vec![[0.0; 4]; 512];
            for i in expected.lit() {
                let light = expected.cells()[i];
                let place = axes.place(expected.cell(i), 8);
                numbers[place] = std::array::from_fn(|j| coefficients_there.signs[j] * light[order[j]]);
            }
            let dump = Dump { side: 8, numbers, storage: Storage::Double };
            let (found, shift, alike) = align(&dump, &expected);
            assert_eq!((found, shift), (axes, [0; 3]));
            assert!((alike - 1.0).abs() < 1e-12);
            let layout = Layout { axes, coefficients: coefficients(&dump, axes, &expected).unwrap() };
            assert_eq!(layout.coefficients, coefficients_there);
            assert_eq!(layout.light(&dump), expected);
        }
    }
}
