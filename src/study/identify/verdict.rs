//! What was found out about a port.

use std::fmt;

use super::layout::Layout;
use crate::field::Cell;

/// A number with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// How far off it may be: six standard deviations and what single precision leaves.
    pub uncertainty: f64,
}

impl Estimate {
    /// A number with one standard deviation.
    pub fn of(value: f64, deviation: f64) -> Self {
        Estimate { value, uncertainty: 6.0 * deviation + 4e-7 * value.abs() }
    }

    /// Whether it may be `number`.
    pub fn holds(&self, number: f64) -> bool {
        (self.value - number).abs() <= self.uncertainty
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // As many digits as the uncertainty leaves, one more.
        let digits = (1.0 - self.uncertainty.max(1e-12).log10().floor()).clamp(0.0, 9.0) as usize;
        write!(f, "{:.digits$} ± {:.digits$}", self.value, self.uncertainty)
    }
}

/// Whether a port is right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judgement {
    /// It does what a known scheme says.
    Correct,
    /// It does what a known scheme says, but for mistakes that are known.
    Mistakes,
    /// It does something that is not known.
    Unknown,
}

impl Judgement {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Judgement::Correct => "correct",
            Judgement::Mistakes => "mistakes",
            Judgement::Unknown => "unknown",
        }
    }
}

/// A mistake that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// The mistake, an id of [`super::catalogue`].
    pub id: &'static str,
    /// Which form it has here; empty where there is one only.
    pub detail: String,
    /// Other mistakes that these dumps cannot tell from it.
    pub or: Vec<&'static str>,
}

/// A cell that is not as it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrong {
    /// In which grid: 0 the injected one, k the source after k iterations.
    pub iteration: usize,
    /// Where.
    pub cell: Cell,
    /// Its light as it should be, (c00, X, Y, Z).
    pub expected: [f64; 4],
    /// Its light as it is.
    pub found: [f64; 4],
}

/// A law of light propagation that a port breaks.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// Its name: reach, symmetry, translation, homogeneity, additivity.
    pub name: &'static str,
    /// How it is broken.
    pub how: String,
}

/// All that was found out.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Right, wrong in a known way, or unknown.
    pub judgement: Judgement,
    /// The known scheme that it is, or is nearest to.
    pub scheme: Option<&'static str>,
    /// Four times the gain of the mean: the propagation factor p of `cascaded` (for the other schemes their own p).
    pub factor: Option<Estimate>,
    /// The side face's weight over the far face's.
    pub ratio: Option<Estimate>,
    /// Which faces are clamped.
    pub clamp: String,
    /// What lies beyond the border.
    pub border: String,
    /// What an iteration keeps.
    pub snapshots: String,
    /// What the accumulated grid sums.
    pub sum: String,
    /// How dumps lie in their files.
    pub layout: Layout,
    /// The storage's name.
    pub storage: &'static str,
    /// What injected lights were multiplied with, where a pattern is known.
    pub injection: Option<(Estimate, String)>,
    /// The mistakes.
    pub mistakes: Vec<Named>,
    /// What these dumps cannot tell, and what would.
    pub notes: Vec<String>,
    /// Broken laws, where the port is unknown.
    pub laws: Vec<Law>,
    /// The first cell that differs from the right scheme.
    pub wrong: Option<Wrong>,
    /// Lit cells of the first iteration that agree with the port as told, and lit cells.
    pub agreeing: (usize, usize),
}
