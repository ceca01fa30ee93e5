//! Errors over the iterations: what is known of each run, and the curves that can be drawn of it.

use crate::app::worker::track::Measured;
use crate::study::error::{ErrorRow, Metric};

/// What was measured of one run, in the order of its iterations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// What the legend calls it.
    pub name: String,
    /// Its errors.
    pub rows: Vec<ErrorRow>,
    /// (iteration, L1 ratio against what truly arrives after the scalar that fits best), where it is known.
    pub fits: Vec<[f64; 2]>,
    /// Its colour, by number.
    pub color: usize,
}

impl Curves {
    /// A run of which nothing is known yet.
    pub fn new(name: String, color: usize) -> Self {
        Curves { name, color, ..Curves::default() }
    }

    /// Drops the errors of iteration `k` and later ones.
    pub fn forget_from(&mut self, k: usize) {
        self.rows.retain(|row| row.iteration < k);
        self.fits.retain(|[iteration, _]| *iteration < k as f64);
    }

    /// Takes in the errors of an iteration in place of those that were known by the same metric.
    pub fn put(&mut self, iteration: usize, metric: Metric, measured: Measured) {
        self.rows.retain(|row| (row.iteration, row.metric) != (iteration, metric));
        self.rows.extend(measured.rows);
        self.rows.sort_by_key(|row| row.iteration);
        if metric == Metric::Ballistic {
            self.fits.retain(|[k, _]| *k != iteration as f64);
            self.fits.extend(measured.best_fit.map(|fitted| [iteration as f64, fitted]));
            self.fits.sort_by(|a, b| a[0].total_cmp(&b[0]));
        }
    }

    /// (iteration, value) of the rows of a metric and a level.
    pub fn curve(&self, metric: Metric, level: Option<usize>, value: fn(&ErrorRow) -> f64) -> Vec<[f64; 2]> {
        let rows = self.rows.iter().filter(|row| row.metric == metric && row.level == level);
        rows.map(|row| [row.iteration as f64, value(row)]).collect()
    }
}

/// A quantity that can be drawn over the iterations.
pub struct Quantity {
    /// Its name in legends.
    pub name: &'static str,
    /// Its curve for a run, a metric and a level.
    pub curve: fn(&Curves, Metric, Option<usize>) -> Vec<[f64; 2]>,
    /// Whether its line is broken.
    pub dashed: bool,
}

/// The quantities that share a plot.
pub struct Group {
    /// What the plot is called.
    pub title: &'static str,
    /// What is drawn, with its unit, in few words.
    pub label: &'static str,
    /// The same as a formula.
    pub axis: &'static str,
    /// What it draws.
    pub quantities: [Quantity; 2],
}

/// The plot of absolute errors, that of relative ones, that of L1 ratios.
pub const GROUPS: [Group; 3] = [
    Group {
        title: "Absolute error",
        label: "Absolute error (SH)",
        axis: "|O − Ô|, SH coefficients",
        quantities: [
            Quantity { name: "average", curve: |run, m, l| run.curve(m, l, |row| row.absolute_mean), dashed: false },
            Quantity { name: "maximum", curve: |run, m, l| run.curve(m, l, |row| row.absolute_max), dashed: true },
        ],
    },
    Group {
        title: "Relative error",
        label: "Relative error",
        axis: "|O − Ô| / |O|",
        quantities: [
            Quantity { name: "average", curve: |run, m, l| run.curve(m, l, |row| row.relative_mean), dashed: false },
            Quantity { name: "maximum", curve: |run, m, l| run.curve(m, l, |row| row.relative_max), dashed: true },
        ],
    },
    Group {
        title: "L1 ratio",
        label: "L1 ratio",
        axis: "Σ|O − Ô| / Σ|Ô|",
        quantities: [
            Quantity { name: "as it is", curve: |run, m, l| run.curve(m, l, |row| row.l1_ratio), dashed: false },
            Quantity {
                name: "best fit",
                curve: |run, metric, _| if metric == Metric::Ballistic { run.fits.clone() } else { Vec::new() },
                dashed: true,
            },
        ],
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(metric: Metric, iteration: usize, absolute_mean: f64, best_fit: Option<f64>) -> Measured {
        let row = ErrorRow {
            iteration,
            metric,
            level: None,
            absolute_mean,
            absolute_max: 0.0,
            relative_mean: 0.0,
            relative_max: 0.0,
            l1_ratio: 0.0,
            undefined: 0,
        };
        Measured { rows: vec![row], best_fit }
    }

    /// A run with errors of the first iterations by two metrics, put in from the newest to the oldest.
    fn run(iterations: usize) -> Curves {
        let mut run = Curves::default();
        for k in (0..iterations).rev() {
            run.put(k, Metric::Thesis, measured(Metric::Thesis, k, k as f64, None));
            run.put(k, Metric::Ballistic, measured(Metric::Ballistic, k, 0.25, Some(0.5)));
        }
        run
    }

    #[test]
    fn going_back_drops_what_came_after() {
        let mut run = run(5);
        run.forget_from(2);
        assert_eq!(run.curve(Metric::Thesis, None, |row| row.absolute_mean), [[0.0, 0.0], [1.0, 1.0]]);
        assert_eq!(run.fits, [[0.0, 0.5], [1.0, 0.5]]);
        assert!(run.curve(Metric::Thesis, Some(1), |row| row.absolute_mean).is_empty());
    }

    #[test]
    fn an_iteration_is_measured_anew_in_its_place() {
        let mut run = run(3);
        run.put(1, Metric::Thesis, measured(Metric::Thesis, 1, 7.0, None));
        assert_eq!(run.curve(Metric::Thesis, None, |row| row.absolute_mean), [[0.0, 0.0], [1.0, 7.0], [2.0, 2.0]]);
        run.put(2, Metric::Ballistic, measured(Metric::Ballistic, 2, 0.125, Some(0.0625)));
        assert_eq!(run.fits, [[0.0, 0.5], [1.0, 0.5], [2.0, 0.0625]]);
        assert_eq!(run.curve(Metric::Thesis, None, |row| row.absolute_mean).len(), 3);
    }
}
