//! Errors over the iterations: what is known of each run, and what of it the plots show.

mod drawing;

use egui::{ComboBox, Ui};
use serde::{Deserialize, Serialize};

pub use drawing::Curves;

use crate::app::panels::controls::name;
use crate::app::panels::line::LineChoice;
use crate::app::panels::plots::lasting_menu;
use crate::app::session::format::Format;
use crate::report::error_figure::{Measure, Quantity};
use crate::study::error::ErrorRow;
use crate::study::expectation::Expectation;

/// What was measured of one run, in the order of its iterations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// What the legend calls it.
    pub name: String,
    /// Its errors.
    pub rows: Vec<ErrorRow>,
    /// (iteration, L1 ratio against what truly arrives after the scalar that fits best), where it is known.
    pub fits: Vec<[f64; 2]>,
    /// Its colour, by number.
    pub color: usize,
}

impl Run {
    /// A run of which nothing is known yet.
    pub fn new(name: String, color: usize) -> Self {
        Run { name, color, ..Run::default() }
    }

    /// Drops the errors of iteration `k` and later ones.
    pub fn forget_from(&mut self, k: usize) {
        self.rows.retain(|row| row.iteration < k);
        self.fits.retain(|[iteration, _]| *iteration < k as f64);
    }

    /// Takes in the errors of an iteration in place of those that were known by the same metric.
    pub fn put(&mut self, iteration: usize, metric: Expectation, measured: Vec<ErrorRow>) {
        self.rows.retain(|row| (row.iteration, row.expectation) != (iteration, metric));
        self.rows.extend(&measured);
        self.rows.sort_by_key(|row| row.iteration);
        if metric == Expectation::Ballistic {
            self.fits.retain(|[k, _]| *k != iteration as f64);
            let fitted = measured.iter().filter_map(|row| row.l1_best_fit);
            self.fits.extend(fitted.map(|fitted| [iteration as f64, fitted]));
            self.fits.sort_by(|a, b| a[0].total_cmp(&b[0]));
        }
    }

    /// (iteration, value) of the rows of a metric and a level.
    pub fn curve(&self, metric: Expectation, level: Option<usize>, value: fn(&ErrorRow) -> f64) -> Vec<[f64; 2]> {
        let rows = self.rows.iter().filter(|row| row.expectation == metric && row.level == level);
        rows.map(|row| [row.iteration as f64, value(row)]).collect()
    }
}

/// The plots that share the foot of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tab {
    /// Errors over the iterations.
    #[default]
    Errors,
    /// Light along a line of cells.
    Line,
    /// Run time against error.
    Pareto,
}

/// What the plots show, and how they are taken home.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Plots {
    /// Which plots are seen.
    pub tab: Tab,
    /// Whether the vertical axes are logarithmic.
    pub log: bool,
    /// Which of [`Measure::ALL`] are drawn.
    pub groups: [bool; 3],
    /// Whether averages are drawn, and L1 ratios as they are.
    pub average: bool,
    /// Whether maxima are drawn, and L1 ratios after the best fit.
    pub maximum: bool,
    /// The level, or all together.
    pub level: Option<usize>,
    /// The metric, by its name.
    pub metric: String,
    /// The line of cells.
    pub line: LineChoice,
    /// What run time is set against.
    pub pareto: Expectation,
    /// Size and colours of exports.
    pub format: Format,
}

impl Default for Plots {
    fn default() -> Self {
        Plots {
            tab: Tab::default(),
            log: true,
            groups: [true, true, false],
            average: true,
            maximum: true,
            level: None,
            metric: Expectation::Thesis.name().to_owned(),
            line: LineChoice::default(),
            pareto: Expectation::Ballistic,
            format: Format::default(),
        }
    }
}

impl Plots {
    /// Whether a quantity is drawn.
    pub fn draws(&self, quantity: &Quantity) -> bool {
        if quantity.dashed { self.maximum } else { self.average }
    }

    /// The plots that are drawn.
    pub fn measures(&self) -> impl Iterator<Item = Measure> {
        Measure::ALL.into_iter().zip(self.groups).filter_map(|(measure, drawn)| drawn.then_some(measure))
    }

    /// The metric that is drawn.
    pub fn metric(&self) -> Expectation {
        Expectation::ALL.into_iter().find(|metric| metric.name() == self.metric).unwrap_or(Expectation::Thesis)
    }

    /// The level that is drawn: all where the metric does not tell levels apart.
    pub fn level(&self) -> Option<usize> {
        self.level.filter(|_| self.metric().has_levels())
    }

    /// The controls over the plots; `levels` are those of the octree.
    pub fn controls(&mut self, ui: &mut Ui, levels: usize) {
        let chosen = self.metric();
        let choice = ComboBox::from_id_salt("metric").selected_text(chosen.name()).width(76.0).show_ui(ui, |ui| {
            for metric in Expectation::ALL {
                ui.selectable_value(&mut self.metric, metric.name().to_owned(), metric.name())
                    .on_hover_text(metric.summary());
            }
        });
        name(&choice.response.on_hover_text(chosen.summary()), "Error metric");
        let text = |level: Option<usize>| level.map_or("All levels".to_owned(), |level| format!("Level {level}"));
        ui.add_enabled_ui(chosen.has_levels(), |ui| {
            let shown = text(self.level());
            let choice = ComboBox::from_id_salt("error level").selected_text(shown).width(76.0).show_ui(ui, |ui| {
                for level in std::iter::once(None).chain((1..levels).map(Some)) {
                    ui.selectable_value(&mut self.level, level, text(level));
                }
            });
            name(&choice.response, "Error level");
        });
        let menu = lasting_menu(ui, "Curves", |ui| {
            for (measure, drawn) in Measure::ALL.into_iter().zip(&mut self.groups) {
                ui.checkbox(drawn, measure.title());
            }
            ui.separator();
            ui.checkbox(&mut self.average, "Average —").on_hover_text("Solid lines; of L1 ratios, as they are");
            ui.checkbox(&mut self.maximum, "Maximum - -").on_hover_text("Broken lines; of L1 ratios, the best fit");
            ui.separator();
            ui.checkbox(&mut self.log, "Log axis")
                .on_hover_text("A logarithmic vertical axis; errors of zero are left out");
        });
        menu.on_hover_text("Which errors are drawn, and how");
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
            undefined: 0,
        };
        vec![row]
    }

    /// A run with errors of the first iterations by two metrics, put in from the newest to the oldest.
    fn run(iterations: usize) -> Run {
        let mut run = Run::default();
        for k in (0..iterations).rev() {
            run.put(k, Expectation::Thesis, measured(Expectation::Thesis, k, k as f64, None));
            run.put(k, Expectation::Ballistic, measured(Expectation::Ballistic, k, 0.25, Some(0.5)));
        }
        run
    }

    #[test]
    fn going_back_drops_what_came_after() {
        let mut run = run(5);
        run.forget_from(2);
        assert_eq!(run.curve(Expectation::Thesis, None, |row| row.absolute_mean), [[0.0, 0.0], [1.0, 1.0]]);
        assert_eq!(run.fits, [[0.0, 0.5], [1.0, 0.5]]);
        assert!(run.curve(Expectation::Thesis, Some(1), |row| row.absolute_mean).is_empty());
    }

    #[test]
    fn an_iteration_is_measured_anew_in_its_place() {
        let mut run = run(3);
        run.put(1, Expectation::Thesis, measured(Expectation::Thesis, 1, 7.0, None));
        assert_eq!(run.curve(Expectation::Thesis, None, |row| row.absolute_mean), [[0.0, 0.0], [1.0, 7.0], [2.0, 2.0]]);
        run.put(2, Expectation::Ballistic, measured(Expectation::Ballistic, 2, 0.125, Some(0.0625)));
        assert_eq!(run.fits, [[0.0, 0.5], [1.0, 0.5], [2.0, 0.0625]]);
        assert_eq!(run.curve(Expectation::Thesis, None, |row| row.absolute_mean).len(), 3);
    }
}
