//! Light in the cells of a cube as the identification computes with it, in double precision whatever a dump is
//! written in, and how finely a dump's numbers can be told apart.

use crate::field::Cell;
use crate::sh::Sh;

/// The light of an n³ grid, (c00, X, Y, Z) a cell; x runs fastest, z slowest.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    side: usize,
    cells: Vec<[f64; 4]>,
}

impl Light {
    /// A dark n³ grid.
    pub fn dark(side: usize) -> Self {
        Light { side, cells: vec![[0.0; 4]; side.pow(3)] }
    }

    /// Cells along a side.
    pub fn side(&self) -> usize {
        self.side
    }

    /// Where a cell stands in [`Self::cells`].
    pub fn index(&self, [x, y, z]: Cell) -> usize {
        x + self.side * (y + self.side * z)
    }

    /// The cell that stands at an index of [`Self::cells`].
    pub fn cell(&self, index: usize) -> Cell {
        [index % self.side, index / self.side % self.side, index / self.side.pow(2)]
    }

    /// All cells.
    pub fn cells(&self) -> &[[f64; 4]] {
        &self.cells
    }

    /// All cells, to write.
    pub fn cells_mut(&mut self) -> &mut [[f64; 4]] {
        &mut self.cells
    }

    /// The light of a cell.
    pub fn get(&self, cell: Cell) -> [f64; 4] {
        self.cells[self.index(cell)]
    }

    /// Adds to the light of a cell.
    pub fn add(&mut self, cell: Cell, light: Sh<f64>) {
        let i = self.index(cell);
        for (sum, c) in self.cells[i].iter_mut().zip(light.0) {
            *sum += c;
        }
    }

    /// `scale` times another grid of the same size, added cell by cell.
    pub fn add_scaled(&mut self, other: &Light, scale: f64) {
        for (to, from) in self.cells.iter_mut().zip(&other.cells) {
            for (a, b) in to.iter_mut().zip(from) {
                *a += scale * b;
            }
        }
    }

    /// The largest coefficient's magnitude.
    pub fn largest(&self) -> f64 {
        self.cells.iter().flatten().fold(0.0, |largest, c| c.abs().max(largest))
    }

    /// The indices of the cells that are not dark.
    pub fn lit(&self) -> Vec<usize> {
        (0..self.cells.len()).filter(|&i| is_lit(&self.cells[i])).collect()
    }

    /// The sum of c00 over all cells.
    pub fn energy(&self) -> f64 {
        self.cells.iter().map(|c| c[0]).sum()
    }
}

/// Whether a cell's light is not dark.
pub fn is_lit(cell: &[f64; 4]) -> bool {
    cell.iter().any(|c| *c != 0.0)
}

/// How a dump's numbers were stored before they were written to the file, as the numbers themselves tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Storage {
    /// 16-bit floating point: eleven significant bits.
    Half,
    /// 32-bit floating point.
    Single,
    /// 64-bit floating point. Ports compute in single precision even where they write double.
    Double,
    /// Whole multiples of a step.
    Fixed(f64),
}

impl Storage {
    /// What the numbers need: the coarsest storage that holds all of them. `scale` is what a fixed-point dump was
    /// multiplied by; its numbers come divided by it already.
    pub fn of<'a>(numbers: impl Iterator<Item = &'a f64> + Clone, scale: f64) -> Storage {
        let holds = |fits: &dyn Fn(f64) -> bool| numbers.clone().all(|&c| fits(c));
        if scale != 1.0 && holds(&|c| ((c * scale).round() - c * scale).abs() < 1e-6 * (c * scale).abs().max(1.0)) {
            return Storage::Fixed(1.0 / scale);
        }
        if holds(&|c| half(c) == c) {
            return Storage::Half;
        }
        if holds(&|c| f64::from(c as f32) == c) { Storage::Single } else { Storage::Double }
    }

    /// The largest distance between a number and what is stored of it.
    pub fn rounding(self, number: f64) -> f64 {
        match self {
            Storage::Half => half_step(number) / 2.0,
            // A port in double precision is rare and a dump that went through text has nine digits.
            Storage::Single | Storage::Double => number.abs() * f64::from(f32::EPSILON) / 2.0 + 1e-44,
            Storage::Fixed(step) => step / 2.0,
        }
    }

    /// Its name in the report.
    pub fn name(self) -> &'static str {
        match self {
            Storage::Half => "f16",
            Storage::Single => "f32",
            Storage::Double => "f64",
            Storage::Fixed(_) => "fixed",
        }
    }
}

/// The distance of neighbouring half-precision numbers near `number`: 2^(e − 10), 2^−24 near zero.
fn half_step(number: f64) -> f64 {
    let magnitude = number.abs();
    if magnitude < 2f64.powi(-14) {
        return 2f64.powi(-24);
    }
    let exponent = ((magnitude.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    2f64.powi(exponent.min(15) - 10)
}

/// The nearest half-precision number, ties to even; infinite beyond 65504.
pub fn half(number: f64) -> f64 {
    let step = half_step(number);
    let rounded = (number / step).round_ties_even() * step;
    if rounded.abs() > 65504.0 { f64::INFINITY.copysign(rounded) } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_precision_rounds_as_the_standard_says() {
        for (number, rounded) in [
            (1.0, 1.0),
            (1.0 + 2f64.powi(-11), 1.0),
            (1.0 + 3.0 * 2f64.powi(-11), 1.0 + 2f64.powi(-9)),
            (65504.0, 65504.0),
            (2f64.powi(-24), 2f64.powi(-24)),
            (0.4 * 2f64.powi(-24), 0.0),
            (-0.333, -0.3330078125),
        ] {
            assert_eq!(half(number), rounded, "{number}");
        }
        assert!(half(70000.0).is_infinite());
    }

    #[test]
    fn numbers_tell_their_storage() {
        let numbers = [0.886_226_925_452_758, -0.3, 0.0];
        let of = |map: &dyn Fn(f64) -> f64| Storage::of(numbers.map(map).iter(), 1.0);
        assert_eq!(of(&half), Storage::Half);
        assert_eq!(of(&|c| f64::from(c as f32)), Storage::Single);
        assert_eq!(of(&|c| c), Storage::Double);
        let fixed = numbers.map(|c| (c * 1000.0f64).round() / 1000.0);
        assert_eq!(Storage::of(fixed.iter(), 1000.0), Storage::Fixed(0.001));
        for number in [0.333, 1e-5, 7.7, -120.0] {
            assert!((half(number) - number).abs() <= Storage::Half.rounding(number));
        }
    }
}
