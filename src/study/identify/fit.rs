//! Least squares from one dump to the next, and whether what is left is rounding.
//!
//! A step is linear in its few weights ([`super::port`]), so for each assumed geometry the weights come out as
//! numbers with error bars: minimise Σ ((S₁ − Σ_k w_k·column_k)/t)², t the rounding that the storage of S₁ (and of S₀,
//! where a port computes more finely than it dumps) leaves. A geometry is right if no number is off by more than t.

use super::light::{Light, Storage, is_lit};
use super::port::{Columns, KINDS, Kind, Port, weighted};
use crate::field::Cell;

/// Two dumps, one step apart.
#[derive(Clone, Debug)]
pub struct Step {
    /// The light before.
    pub before: Light,
    /// The light after.
    pub after: Light,
    /// How the light after was stored.
    pub storage: Storage,
    /// How the light before was.
    pub stored_before: Storage,
    /// Cells that are left out: an occluder is near.
    pub hidden: Vec<bool>,
}

/// How a port rounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// What it dumps is what it reads: the light before is exact.
    Stored,
    /// It computes in single precision and rounds for the dump.
    Dumped,
}

/// The largest error of a step's sums in single precision, over the sum of magnitudes.
const ARITHMETIC: f64 = 16.0 * 6e-8;

/// One that is usual: it weighs numbers that are small because large ones cancel.
const USUAL_ARITHMETIC: f64 = 6e-8;

/// Weights with their covariance.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The weight of each [`Kind`]; zero where it has none.
    pub weights: [f64; KINDS],
    /// Whether the data determine it.
    pub known: [bool; KINDS],
    /// The covariance of the weights.
    pub covariance: [[f64; KINDS]; KINDS],
    /// The sum of squares that is left over.
    pub left: f64,
    /// The sum of squares of what is explained and what is not.
    pub total: f64,
    /// The sums it was solved from, so that more data can join.
    pub sums: Sums,
}

impl Fit {
    /// One standard deviation of a weight.
    pub fn deviation(&self, kind: Kind) -> f64 {
        self.covariance[kind as usize][kind as usize].max(0.0).sqrt()
    }

    /// A weight.
    pub fn weight(&self, kind: Kind) -> f64 {
        self.weights[kind as usize]
    }
}

/// How a port's step agrees with the dump.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// The largest difference over its tolerance.
    pub worst: f64,
    /// Lit cells that agree in every number.
    pub agreeing: usize,
    /// Lit cells.
    pub cells: usize,
    /// The first cell that does not agree: z slowest, x fastest.
    pub first_wrong: Option<Cell>,
    /// Its light as it should be.
    pub expected: [f64; 4],
    /// Its light as it is.
    pub found: [f64; 4],
}

impl Agreement {
    /// Whether every number agrees.
    pub fn is_full(&self) -> bool {
        self.agreeing == self.cells
    }
}

/// The sums of a weighted least squares problem.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sums {
    products: [[f64; KINDS]; KINDS],
    targets: [f64; KINDS],
    total: f64,
}

impl Sums {
    /// Adds a cell: what each weight brings, what is found, and the tolerance of each number.
    pub fn add(&mut self, columns: &Columns, found: &[f64; 4], tolerance: &[f64; 4]) {
        for c in 0..4 {
            let w = 1.0 / (tolerance[c] * tolerance[c]);
            self.total += w * found[c] * found[c];
            for i in 0..KINDS {
                let scaled = w * columns[i][c];
                if scaled != 0.0 {
                    self.targets[i] += scaled * found[c];
                    for (product, column) in self.products[i].iter_mut().zip(&columns[..=i]) {
                        *product += scaled * column[c];
                    }
                }
            }
        }
    }

    /// Another problem with the same weights.
    pub fn join(&mut self, other: &Sums) {
        self.total += other.total;
        for i in 0..KINDS {
            self.targets[i] += other.targets[i];
            for j in 0..=i {
                self.products[i][j] += other.products[i][j];
            }
        }
    }

    /// The weights; a weight that the data do not determine is zero. `deviation` is one standard deviation over the
    /// tolerance.
    pub fn solve(&self, deviation: f64) -> Fit {
        let mut known = [false; KINDS];
        // Cholesky on the correlation matrix, skipping what depends on the columns before it.
        let scale: [f64; KINDS] = std::array::from_fn(|i| self.products[i][i].sqrt());
        let mut lower = [[0.0; KINDS]; KINDS];
        for i in 0..KINDS {
            if scale[i] == 0.0 {
                continue;
            }
            for j in (0..i).filter(|j| known[*j]).collect::<Vec<_>>() {
                let inner: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
                lower[i][j] = (self.products[i][j] / (scale[i] * scale[j]) - inner) / lower[j][j];
            }
            let pivot = 1.0 - (0..i).map(|k| lower[i][k] * lower[i][k]).sum::<f64>();
            if pivot > 1e-9 {
                known[i] = true;
                lower[i][i] = pivot.sqrt();
            } else {
                lower[i] = [0.0; KINDS];
            }
        }
        // The inverse of the lower triangle gives the weights and their covariance.
        let mut inverse = [[0.0; KINDS]; KINDS];
        for i in (0..KINDS).filter(|i| known[*i]) {
            inverse[i][i] = 1.0 / lower[i][i];
            for j in (0..i).filter(|j| known[*j]) {
                let inner: f64 = (j..i).map(|k| lower[i][k] * inverse[k][j]).sum();
                inverse[i][j] = -inner / lower[i][i];
            }
        }
        let mut covariance = [[0.0; KINDS]; KINDS];
        for i in (0..KINDS).filter(|i| known[*i]) {
            for j in (0..KINDS).filter(|j| known[*j]) {
                let inner: f64 = (0..KINDS).map(|k| inverse[k][i] * inverse[k][j]).sum();
                covariance[i][j] = inner / (scale[i] * scale[j]);
            }
        }
        let weights: [f64; KINDS] =
            std::array::from_fn(|i| (0..KINDS).map(|j| covariance[i][j] * self.targets[j]).sum());
        let explained: f64 = (0..KINDS).map(|i| weights[i] * self.targets[i]).sum();
        covariance.iter_mut().flatten().for_each(|c| *c *= deviation * deviation);
        Fit {
            weights,
            known,
            covariance,
            left: (self.total - explained).max(0.0),
            total: self.total,
            sums: self.clone(),
        }
    }
}

impl Step {
    /// The cells in which a port could bring light, or in which light is found.
    pub fn receivers(&self) -> Vec<Cell> {
        let side = self.before.side();
        let mut near = vec![false; side.pow(3)];
        let lit = self.before.lit();
        for i in self.after.lit() {
            near[i] = true;
        }
        for i in lit {
            near[i] = true;
            let cell = self.before.cell(i);
            for axis in 0..3 {
                let mut other = cell;
                for c in [cell[axis].wrapping_sub(1), cell[axis] + 1] {
                    if c < side {
                        other[axis] = c;
                        near[self.before.index(other)] = true;
                    }
                }
            }
        }
        (0..near.len()).filter(|&i| near[i] && !self.hidden[i]).map(|i| self.before.cell(i)).collect()
    }

    /// The weights of a port from some cells, all numbers of equal weight: quick, to rank ports by what is left.
    pub fn rough(&self, port: &Port, receivers: &[Cell]) -> Fit {
        let mut sums = Sums::default();
        for &cell in receivers {
            let columns = port.columns(&self.before, &self.after, cell).unwrap_or_default();
            sums.add(&columns, &self.after.get(cell), &[1.0; 4]);
        }
        sums.solve(0.0)
    }

    /// The weights of a port, each number weighted by its rounding, and how the step then agrees with the dump.
    pub fn precise(&self, port: &Port, rounding: Rounding, receivers: &[Cell]) -> (Fit, Agreement) {
        let rough = self.rough(port, receivers);
        let usual = self.usual_errors(port, &rough.weights, rounding, receivers);
        let mut sums = Sums::default();
        self.collect(port, receivers, &usual, true, &mut sums);
        let fit = sums.solve(DEVIATION);
        let tolerances = self.tolerances(port, &rough.weights, rounding, receivers);
        let agreement = self.agreement(port, &fit, receivers, &tolerances);
        (fit, agreement)
    }

    /// Adds every number, weighted by its tolerance; `own` says whether what a cell keeps is looked for.
    pub fn collect(&self, port: &Port, receivers: &[Cell], tolerances: &[[f64; 4]], own: bool, sums: &mut Sums) {
        for (&cell, tolerance) in receivers.iter().zip(tolerances) {
            let mut columns = port.columns(&self.before, &self.after, cell).unwrap_or_default();
            if !own {
                columns[Kind::Own0 as usize] = [0.0; 4];
                columns[Kind::Own1 as usize] = [0.0; 4];
            }
            sums.add(&columns, &self.after.get(cell), tolerance);
        }
    }

    /// How far each number of the receivers may be off.
    pub fn tolerances(
        &self,
        port: &Port,
        weights: &[f64; KINDS],
        rounding: Rounding,
        receivers: &[Cell],
    ) -> Vec<[f64; 4]> {
        self.errors(port, weights, rounding, receivers, ARITHMETIC)
    }

    /// How far each number of the receivers usually is off at most: by this numbers are weighted.
    pub fn usual_errors(
        &self,
        port: &Port,
        weights: &[f64; KINDS],
        rounding: Rounding,
        receivers: &[Cell],
    ) -> Vec<[f64; 4]> {
        self.errors(port, weights, rounding, receivers, USUAL_ARITHMETIC)
    }

    fn errors(
        &self,
        port: &Port,
        weights: &[f64; KINDS],
        rounding: Rounding,
        receivers: &[Cell],
        arithmetic: f64,
    ) -> Vec<[f64; 4]> {
        let errors = port.of_errors();
        let weights = weights.map(f64::abs);
        let carried = |light: &Light, storage: Storage| {
            let mut errors = light.clone();
            for c in errors.cells_mut().iter_mut().flatten() {
                let stored = if rounding == Rounding::Dumped { storage.rounding(*c) } else { 0.0 };
                *c = c.abs() * arithmetic + stored;
            }
            errors
        };
        let before = carried(&self.before, self.stored_before);
        let after = carried(&self.after, self.storage);
        let faint = self.after.largest() * 1e-9 + 1e-40;
        let tolerance = |&cell: &Cell| {
            let columns = errors.columns(&before, &after, cell).unwrap_or_default();
            let error = weighted(&weights, &columns);
            let found = self.after.get(cell);
            std::array::from_fn(|c| error[c] + self.storage.rounding(found[c]) * 1.0001 + faint)
        };
        receivers.iter().map(tolerance).collect()
    }

    /// How the step with fitted weights agrees with the dump.
    fn agreement(&self, port: &Port, fit: &Fit, receivers: &[Cell], tolerances: &[[f64; 4]]) -> Agreement {
        let deviations: [f64; KINDS] = std::array::from_fn(|i| fit.covariance[i][i].max(0.0).sqrt());
        let mut agreement =
            Agreement { worst: 0.0, agreeing: 0, cells: 0, first_wrong: None, expected: [0.0; 4], found: [0.0; 4] };
        for (&cell, tolerance) in receivers.iter().zip(tolerances) {
            let columns = port.columns(&self.before, &self.after, cell).unwrap_or_default();
            let expected = weighted(&fit.weights, &columns);
            // The weights are not known exactly.
            let unsure = weighted(&deviations, &columns.map(|column| column.map(f64::abs)));
            let found = self.after.get(cell);
            if !is_lit(&found) && !is_lit(&expected) {
                continue;
            }
            let off =
                (0..4).map(|c| (expected[c] - found[c]).abs() / (tolerance[c] + 3.0 * unsure[c])).fold(0.0, f64::max);
            agreement.cells += 1;
            agreement.worst = agreement.worst.max(off);
            if off <= SLACK {
                agreement.agreeing += 1;
            } else if agreement.first_wrong.is_none() {
                (agreement.first_wrong, agreement.expected, agreement.found) = (Some(cell), expected, found);
            }
        }
        agreement
    }
}

/// A number that is rounded is off by up to its tolerance, evenly: one standard deviation is 1/√3 of it.
pub const DEVIATION: f64 = 0.577_350_269_189_625_8;

/// Fitted weights take some of the tolerance.
pub const SLACK: f64 = 1.1;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sh::Sh;
    use crate::transport::lattice::schemes;

    #[test]
    fn weights_come_back_with_their_errors() {
        let port = Port::of(&schemes::all()[0]);
        let mut weights = [0.0; KINDS];
        weights[Kind::Far as usize] = 0.09;
        weights[Kind::Side as usize] = 0.11;
        weights[Kind::Own0 as usize] = 0.5;
        let mut before = Light::dark(5);
        before.add([2, 2, 2], Sh([0.75, 0.25, -0.125, 0.5]));
        before.add([1, 3, 2], Sh([0.5, -0.25, 0.375, 0.0]));
        let mut after = port.step(&weights, &before);
        after.cells_mut().iter_mut().flatten().for_each(|c| *c = super::super::light::half(*c));
        let hidden = vec![false; 125];
        let step = Step { before, after, storage: Storage::Half, stored_before: Storage::Half, hidden };
        let (fit, agreement) = step.precise(&port, Rounding::Stored, &step.receivers());
        assert!(agreement.is_full(), "{agreement:?}");
        for kind in [Kind::Far, Kind::Side, Kind::Own0] {
            let off = (fit.weight(kind) - weights[kind as usize]).abs();
            assert!(off < 4.0 * fit.deviation(kind) && fit.deviation(kind) < 1e-3, "{kind:?} {off}");
        }
        assert!(!fit.known[Kind::Near as usize]);
    }
}
