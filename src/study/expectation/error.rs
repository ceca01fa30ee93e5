//! How far light is from what it ought to be, in numbers (000, 6.2 and 7; MATH.md section 5).
//!
//! Light O is compared with an expectation Ô ([`super`]), cell by cell, in the norm
//! ‖v‖∞ = max |v_j| over the four coefficients of all three colours:
//!
//! - absolute error ‖O − Ô‖∞, mean and maximum over cells;
//! - relative error ‖O − Ô‖∞ / ‖O‖∞; where O is dark and Ô is not it is undefined, so the cell is left
//!   out of the mean and counted; where both are dark it is 0;
//! - L1 ratio Σ‖O − Ô‖∞ / Σ‖Ô‖∞, which no dark cell can blow up.
//!
//! Means divide by the cells really summed. The thesis divides by (8^l − 8)/7, which is that number only
//! if the 1³ level does not exist, as in its GPU version.

use super::Expectation;

/// The error of one level, or of all together, after one iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorRow {
    /// Iterations done, k; 0 is the downsampled injection.
    pub iteration: usize,
    /// What the light was held against.
    pub expectation: Expectation,
    /// The level, or `None` for all levels together.
    pub level: Option<usize>,
    /// Mean of ‖O − Ô‖∞, in units of SH coefficients.
    pub absolute_mean: f64,
    /// Largest ‖O − Ô‖∞.
    pub absolute_max: f64,
    /// Mean of ‖O − Ô‖∞ / ‖O‖∞ over the cells where it is defined.
    pub relative_mean: f64,
    /// Largest ‖O − Ô‖∞ / ‖O‖∞ where it is defined.
    pub relative_max: f64,
    /// Σ‖O − Ô‖∞ / Σ‖Ô‖∞; 0 where all is dark, infinite where only the expectation is.
    pub l1_ratio: f64,
    /// The same after the one scalar that fits best; `None` where the expectation has no scale of its own.
    pub l1_best_fit: Option<f64>,
    /// Cells whose relative error is undefined: dark where light was expected.
    pub undefined: usize,
    /// What more is told of light that is held against a path-traced truth.
    pub traced: Option<Traced>,
}

/// Light on surfaces, or a picture, against its path-traced truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traced {
    /// All that was found over all that is true.
    pub mean_ratio: f64,
    /// Of light on surfaces, how found and true light go together: 1 where one is a multiple of the other.
    pub correlation: Option<f64>,
    /// Of pictures: RMSE, relMSE and mean FLIP ([`crate::study::picture`]).
    pub picture: Option<[f64; 3]>,
    /// The truth's own error, to be compared with the L1 ratio: what of that may be the truth's fault.
    pub noise: f64,
}

/// The error of one cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellError {
    /// ‖O − Ô‖∞.
    pub absolute: f64,
    /// ‖O − Ô‖∞ / ‖O‖∞; `None` where it is undefined: only the expectation is lit.
    pub relative: Option<f64>,
}

impl CellError {
    /// From ‖O − Ô‖∞ and ‖O‖∞.
    #[inline]
    pub fn new(difference: f64, found: f64) -> Self {
        let relative = match found {
            found if found > 0.0 => Some(difference / found),
            _ if difference > 0.0 => None,
            _ => Some(0.0),
        };
        CellError { absolute: difference, relative }
    }
}

/// Sums over cells, from which an [`ErrorRow`] is made.
///
/// ```
/// use lpv_lab::study::error::Tally;
/// use lpv_lab::study::expectation::Expectation;
///
/// let mut tally = Tally::default();
/// tally.add(0.5, 1.0, 1.5); // ‖O − Ô‖, ‖O‖ and ‖Ô‖ of a cell
/// tally.add(0.3, 0.0, 0.3); // dark where light was expected
/// let row = tally.row(4, Expectation::Merged, None);
/// assert_eq!((row.absolute_mean, row.relative_mean, row.undefined), (0.4, 0.5, 1));
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Cells, each by its weight: those that have a relative error, and those that have none.
    weights: [f64; 2],
    undefined: usize,
    absolute: f64,
    absolute_max: f64,
    relative: f64,
    relative_max: f64,
    expected: f64,
}

impl Tally {
    /// Takes in one cell: ‖O − Ô‖∞, ‖O‖∞ and ‖Ô‖∞.
    #[inline]
    pub fn add(&mut self, difference: f64, found: f64, expected: f64) {
        self.add_weighed(1.0, difference, found, expected);
    }

    /// The same for what counts as so many cells.
    #[inline]
    pub fn add_weighed(&mut self, weight: f64, difference: f64, found: f64, expected: f64) {
        let error = CellError::new(difference, found);
        self.absolute += weight * error.absolute;
        self.absolute_max = self.absolute_max.max(error.absolute);
        self.expected += weight * expected;
        match error.relative {
            Some(relative) => {
                self.weights[0] += weight;
                self.relative += weight * relative;
                self.relative_max = self.relative_max.max(relative);
            }
            None => {
                self.weights[1] += weight;
                self.undefined += 1;
            }
        }
    }

    /// Takes in all the cells of another tally.
    pub fn merge(&mut self, other: &Tally) {
        (0..2).for_each(|i| self.weights[i] += other.weights[i]);
        self.undefined += other.undefined;
        self.absolute += other.absolute;
        self.absolute_max = self.absolute_max.max(other.absolute_max);
        self.relative += other.relative;
        self.relative_max = self.relative_max.max(other.relative_max);
        self.expected += other.expected;
    }

    /// The row that says it.
    pub fn row(&self, iteration: usize, expectation: Expectation, level: Option<usize>) -> ErrorRow {
        let [defined, undefined] = self.weights;
        let mean = |sum: f64, weight: f64| if weight == 0.0 { 0.0 } else { sum / weight };
        ErrorRow {
            iteration,
            expectation,
            level,
            absolute_mean: mean(self.absolute, defined + undefined),
            absolute_max: self.absolute_max,
            relative_mean: mean(self.relative, defined),
            relative_max: self.relative_max,
            l1_ratio: if self.absolute == 0.0 { 0.0 } else { self.absolute / self.expected },
            l1_best_fit: None,
            undefined: self.undefined,
            traced: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tally_counts_what_the_definitions_say() {
        let mut tally = Tally::default();
        tally.add(0.0, 0.0, 0.0); // dark, expected dark: error 0
        tally.add(0.3, 0.0, 0.3); // dark, expected light: undefined
        tally.add(0.5, 1.0, 1.5);
        tally.add(0.2, 0.1, 0.1);
        let row = tally.row(7, Expectation::Thesis, Some(2));
        assert!((row.absolute_mean - 0.25).abs() < 1e-15);
        assert_eq!(row.absolute_max, 0.5);
        assert!((row.relative_mean - (0.0 + 0.5 + 2.0) / 3.0).abs() < 1e-15);
        assert_eq!(row.relative_max, 2.0);
        assert!((row.l1_ratio - 1.0 / 1.9).abs() < 1e-15);
        assert_eq!((row.undefined, row.iteration, row.level), (1, 7, Some(2)));
    }

    #[test]
    fn joined_tallies_are_one_tally() {
        let cells = [(0.0, 0.0, 0.0), (0.3, 0.0, 0.3), (0.5, 1.0, 1.5), (0.2, 0.1, 0.1)];
        let of = |cells: &[(f64, f64, f64)]| {
            let mut tally = Tally::default();
            cells.iter().for_each(|&(d, f, e)| tally.add(d, f, e));
            tally
        };
        let mut joined = of(&cells[..2]);
        joined.merge(&of(&cells[2..]));
        let row = |t: Tally| t.row(0, Expectation::Thesis, None);
        assert_eq!(row(joined), row(of(&cells)));
    }

    #[test]
    fn a_cell_that_is_dark_where_light_was_expected_has_no_relative_error() {
        assert_eq!(CellError::new(0.25, 0.5), CellError { absolute: 0.25, relative: Some(0.5) });
        assert_eq!(CellError::new(0.25, 0.0), CellError { absolute: 0.25, relative: None });
        assert_eq!(CellError::new(0.0, 0.0).relative, Some(0.0));
    }
}
