//! Errors over the iterations: what is known of each run.

use crate::study::error::ErrorRow;
use crate::study::expectation::Expectation;

/// What was measured of one run, in the order of its iterations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curves {
    /// What the legend calls it.
    pub name: String,
    /// Its errors.
    pub rows: Vec<ErrorRow>,
    /// Its colour, by number.
    pub color: usize,
    /// What each of its iterations took, in seconds.
    pub seconds: Vec<f64>,
}

impl Curves {
    /// A run of which nothing is known yet.
    pub fn new(name: String, color: usize) -> Self {
        Curves { name, color, ..Curves::default() }
    }

    /// Drops the errors of iteration `k` and later ones.
    pub fn forget_from(&mut self, k: usize) {
        self.rows.retain(|row| row.iteration < k);
    }

    /// Takes in the errors of an iteration in place of those that were known by the same metric.
    pub fn put(&mut self, iteration: usize, metric: Expectation, measured: Vec<ErrorRow>) {
        self.rows.retain(|row| (row.iteration, row.expectation) != (iteration, metric));
        self.rows.extend(measured);
        self.rows.sort_by_key(|row| row.iteration);
    }

    /// Its latest errors up to iteration `k`.
    pub fn last(&self, metric: Expectation, level: Option<usize>, k: usize) -> Option<&ErrorRow> {
        let rows = self.rows.iter().filter(|row| row.expectation == metric && row.level == level);
        rows.filter(|row| row.iteration <= k).max_by_key(|row| row.iteration)
    }

    /// What an iteration takes in the median, in milliseconds.
    pub fn milliseconds(&self) -> Option<f64> {
        let mut seconds = self.seconds.clone();
        seconds.sort_by(f64::total_cmp);
        seconds.get(seconds.len() / 2).map(|seconds| 1e3 * seconds)
    }

    /// (iteration, value) of the rows of a metric and a level.
    pub fn curve(&self, metric: Expectation, level: Option<usize>, value: fn(&ErrorRow) -> f64) -> Vec<[f64; 2]> {
        let rows = self.rows.iter().filter(|row| row.expectation == metric && row.level == level);
        rows.map(|row| [row.iteration as f64, value(row)]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(metric: Expectation, iteration: usize, absolute_mean: f64, best_fit: Option<f64>) -> Vec<ErrorRow> {
        let row = ErrorRow {
            iteration,
            expectation: metric,
            level: None,
            absolute_mean,
            absolute_max: 0.0,
            relative_mean: 0.0,
            relative_max: 0.0,
            l1_ratio: 0.0,
            l1_best_fit: best_fit,
            traced: None,
            undefined: 0,
        };
        vec![row]
    }

    /// A run with errors of the first iterations by two metrics, put in from the newest to the oldest.
    fn run(iterations: usize) -> Curves {
        let mut run = Curves::default();
        for k in (0..iterations).rev() {
            run.put(k, Expectation::Thesis, measured(Expectation::Thesis, k, k as f64, None));
            run.put(k, Expectation::Ballistic, measured(Expectation::Ballistic, k, 0.25, Some(0.5)));
        }
        run
    }

    fn fits(run: &Curves) -> Vec<[f64; 2]> {
        run.curve(Expectation::Ballistic, None, |row| row.l1_best_fit.unwrap())
    }

    #[test]
    fn going_back_drops_what_came_after() {
        let mut run = run(5);
        run.forget_from(2);
        assert_eq!(run.curve(Expectation::Thesis, None, |row| row.absolute_mean), [[0.0, 0.0], [1.0, 1.0]]);
        assert_eq!(fits(&run), [[0.0, 0.5], [1.0, 0.5]]);
        assert!(run.curve(Expectation::Thesis, Some(1), |row| row.absolute_mean).is_empty());
    }

    #[test]
    fn an_iteration_is_measured_anew_in_its_place() {
        let mut run = run(3);
        run.put(1, Expectation::Thesis, measured(Expectation::Thesis, 1, 7.0, None));
        assert_eq!(run.curve(Expectation::Thesis, None, |row| row.absolute_mean), [[0.0, 0.0], [1.0, 7.0], [2.0, 2.0]]);
        run.put(2, Expectation::Ballistic, measured(Expectation::Ballistic, 2, 0.125, Some(0.0625)));
        assert_eq!(fits(&run), [[0.0, 0.5], [1.0, 0.5], [2.0, 0.0625]]);
        assert_eq!(run.curve(Expectation::Thesis, None, |row| row.absolute_mean).len(), 3);
    }
}
