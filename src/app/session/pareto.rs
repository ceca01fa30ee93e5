//! What of the time against error is drawn.

use crate::report::pareto_figure::point;
use crate::study::expectation::Expectation;
use crate::study::pareto::Row;

/// What time can be set against.
pub const CHOICES: [Expectation; 3] = [Expectation::Ballistic, Expectation::Merged, Expectation::Surface];

/// What the choice of an expectation says.
pub fn choice_name(expectation: Expectation) -> &'static str {
    match expectation {
        Expectation::Ballistic => "Against what truly arrives",
        Expectation::Surface => "Against what truly reaches surfaces",
        _ => "Against the uniform fixed point",
    }
}

/// The rows against one expectation that have a place in the plot: light that diverged has none.
pub fn against(rows: &[Row], expectation: Expectation) -> Vec<&Row> {
    let shown = |row: &&Row| point(row).iter().all(|part| part.is_finite() && *part > 0.0);
    rows.iter().filter(|row| row.expectation == expectation).filter(shown).collect()
}
