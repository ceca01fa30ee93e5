//! What the plots at the window's foot show, and how they are taken home.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::format::Format;
use super::line::LineChoice;
use crate::report::error_figure::{Measure, Quantity};
use crate::study::expectation::Expectation;

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
    /// What errors are against; [`Expectation::Run`] is the run with the star, whatever that is.
    #[serde(serialize_with = "name", deserialize_with = "named")]
    pub metric: Expectation,
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
            groups: [false, false, true],
            average: true,
            maximum: true,
            level: None,
            metric: Expectation::Run,
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

    /// The level that is drawn: all where the metric does not tell levels apart.
    pub fn level(&self) -> Option<usize> {
        self.level.filter(|_| self.metric.has_levels())
    }
}

/// Writes a metric's name.
fn name<S: Serializer>(metric: &Expectation, serializer: S) -> Result<S::Ok, S::Error> {
    metric.name().serialize(serializer)
}

/// Reads a metric's name; the star's for one that is not known.
fn named<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Expectation, D::Error> {
    let name = String::deserialize(deserializer)?;
    Ok(Expectation::ALL.into_iter().find(|metric| metric.name() == name).unwrap_or(Expectation::Run))
}
