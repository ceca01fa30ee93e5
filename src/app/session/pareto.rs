//! Run time against error: what it is set against, and what was measured.

use super::Session;
use super::asides::Very;
use crate::report::pareto_figure::point;
use crate::study::expectation::Expectation;
use crate::study::pareto::Row;

/// What run time can be set against.
pub const CHOICES: [Expectation; 2] = [Expectation::Ballistic, Expectation::Merged];

/// What the choice of an expectation says.
pub fn choice_name(expectation: Expectation) -> &'static str {
    match expectation {
        Expectation::Ballistic => "Against what truly arrives",
        _ => "Against the uniform fixed point",
    }
}

/// The rows against one expectation that have a place in the plot: light that diverged has none.
pub fn against(rows: &[Row], expectation: Expectation) -> Vec<&Row> {
    let shown = |row: &&Row| point(row).iter().all(|part| part.is_finite() && *part > 0.0);
    rows.iter().filter(|row| row.expectation == expectation).filter(shown).collect()
}

impl Session {
    /// What was measured last.
    pub fn pareto_rows(&self) -> &[Row] {
        self.asides.pareto.latest().map_or(&[], |(_, rows)| rows)
    }

    /// Whether what was measured is of another problem than the one that runs.
    pub fn pareto_is_old(&self) -> bool {
        let now = self.run.problem.as_ref();
        self.asides.pareto.latest().zip(now).is_some_and(|(((Very(of), _), _), now)| !std::sync::Arc::ptr_eq(of, now))
    }
}
