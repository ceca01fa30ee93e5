//! Run time against error: what it is set against, and its figure for a paper.

use serde::{Deserialize, Serialize};

use super::Session;
use super::asides::Very;
use super::format::Format;
use crate::report::plot::{Curve, Dash, Figure, Plot};
use crate::study::pareto::{Row, front};
use crate::transport;
use crate::transport::ordinates;

/// The ways to treat levels, as rows name them.
pub const LEVELS: [&str; 4] = ["uniform", "same", "consistent", "converged"];

/// What run time is set against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ParetoChoice {
    /// What truly arrives, after the scalar that fits best: what a scheme costs.
    #[default]
    Ballistic,
    /// The fixed point of the scheme's own uniform volume: what the octree and stopping early cost.
    Uniform,
}

impl ParetoChoice {
    /// Both of them.
    pub const ALL: [ParetoChoice; 2] = [ParetoChoice::Ballistic, ParetoChoice::Uniform];

    fn reference(self) -> &'static str {
        match self {
            ParetoChoice::Ballistic => "ballistic",
            ParetoChoice::Uniform => "uniform",
        }
    }

    /// Its name on screen.
    pub fn name(self) -> &'static str {
        match self {
            ParetoChoice::Ballistic => "Against what truly arrives",
            ParetoChoice::Uniform => "Against the uniform fixed point",
        }
    }
}

/// Whether a row is of the propagator called `name`, with whatever directions if that is ordinates.
pub fn is_of(row: &Row, name: &str) -> bool {
    row.scheme == name || (name == ordinates::NAME && row.scheme.starts_with(name))
}

/// The rows against one reference that have a place in the plot: light that diverged has none.
pub fn against(rows: &[Row], choice: ParetoChoice) -> Vec<&Row> {
    let shown = |row: &&Row| point(row).iter().all(|part| part.is_finite() && *part > 0.0);
    rows.iter().filter(|row| row.reference == choice.reference()).filter(shown).collect()
}

/// Where a row stands: its time in milliseconds, and its error.
pub fn point(row: &Row) -> [f64; 2] {
    [row.seconds * 1e3, row.l1.fitted]
}

/// For a paper: a plot for each way to treat levels, each with what nothing beats among all.
pub fn figure(title: &str, rows: &[&Row], choice: ParetoChoice, format: &Format) -> Figure {
    let logged = |row: &Row| [point(row)[0].log10(), point(row)[1]];
    let schemes = transport::names();
    let plots = LEVELS.map(|levels| {
        let mut curves: Vec<Curve> = Vec::new();
        for (color, scheme) in schemes.iter().enumerate() {
            let ours = rows.iter().filter(|row| row.levels == levels && is_of(row, scheme));
            let points = ours.map(|row| logged(row)).collect();
            curves.push(Curve { name: (*scheme).to_owned(), points, color, dash: Dash::Points });
        }
        let points = front(rows).into_iter().map(logged).collect();
        let name = "what nothing beats".to_owned();
        curves.push(Curve { name, points, color: schemes.len(), dash: Dash::Dotted });
        Plot {
            title: format!("Levels: {levels}; against {}", choice.reference()),
            x_label: "log₁₀ of the time in ms".to_owned(),
            y_label: "L1 error, best fit".to_owned(),
            log_y: true,
            curves,
            marks: Vec::new(),
        }
    });
    let size = format.figure(plots.len());
    Figure { title: title.to_owned(), plots: plots.to_vec(), theme: format.theme(), size }
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
