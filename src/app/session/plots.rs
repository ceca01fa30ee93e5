//! What the plots at the window's foot show, and how they are taken home.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::curves::{GROUPS, Group, Quantity};
use super::format::Format;
use super::line::LineChoice;
use super::pareto::ParetoChoice;
use crate::study::error::Metric;

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
    /// Which of [`GROUPS`] are drawn.
    pub groups: [bool; 3],
    /// Whether averages are drawn, and L1 ratios as they are.
    pub average: bool,
    /// Whether maxima are drawn, and L1 ratios after the best fit.
    pub maximum: bool,
    /// The level, or all together.
    pub level: Option<usize>,
    /// What errors are against.
    #[serde(serialize_with = "name", deserialize_with = "named")]
    pub metric: Metric,
    /// The line of cells.
    pub line: LineChoice,
    /// What run time is set against.
    pub pareto: ParetoChoice,
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
            metric: Metric::Thesis,
            line: LineChoice::default(),
            pareto: ParetoChoice::default(),
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
    pub fn groups(&self) -> impl Iterator<Item = &'static Group> {
        GROUPS.iter().zip(self.groups).filter_map(|(group, drawn)| drawn.then_some(group))
    }

    /// The level that is drawn: all where the metric does not tell levels apart.
    pub fn level(&self) -> Option<usize> {
        self.level.filter(|_| tells_levels_apart(self.metric))
    }
}

/// Whether a metric has a row for each level.
pub fn tells_levels_apart(metric: Metric) -> bool {
    matches!(metric, Metric::Thesis | Metric::Corrected)
}

/// What a metric compares, in a line.
pub fn about(metric: Metric) -> &'static str {
    match metric {
        Metric::Thesis => "Every level against the mean of its children",
        Metric::Corrected => "Every level against a uniform volume, downsampled",
        Metric::Merged => "The merged light against a uniform volume",
        Metric::Ballistic => "The merged light that has moved against what truly arrives along straight lines",
    }
}

/// Writes a metric's name.
fn name<S: Serializer>(metric: &Metric, serializer: S) -> Result<S::Ok, S::Error> {
    metric.name().serialize(serializer)
}

/// Reads a metric's name; the thesis's for one that is not known.
fn named<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Metric, D::Error> {
    let name = String::deserialize(deserializer)?;
    Ok(Metric::ALL.into_iter().find(|metric| metric.name() == name).unwrap_or(Metric::Thesis))
}
