//! A port that is looked at: its dumps, what is told of them, and its grids beside the right ones.

use std::path::PathBuf;

use crate::field::{Channels, Grid};
use crate::report::port;
use crate::report::slice::{Axis, Plane, Slice};
use crate::sh::Sh;
use crate::study::identify::beside::{self, Beside};
use crate::study::identify::files::{Files, Role};
use crate::study::identify::identify;
use crate::study::identify::light::Light;
use crate::study::identify::verdict::Verdict;
use crate::study::pattern::Pattern;

/// What is asked of a port.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// Its dumps, each with what it is.
    pub files: Vec<(PathBuf, Role)>,
    /// The name of the pattern that was injected; `None` for a scene of its own.
    pub pattern: Option<&'static str>,
}

impl Default for Question {
    fn default() -> Self {
        Question { files: Vec::new(), pattern: Some("spaced") }
    }
}

/// What is seen of the grids.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sight {
    /// Which of the dumps, from the first.
    pub dump: usize,
    /// The axis that slices are cut across.
    pub axis: Axis,
    /// How far along it, in cells.
    pub index: usize,
}

/// A port that is looked at.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Port {
    /// What is asked.
    pub question: Question,
    /// What is seen.
    pub sight: Sight,
}

/// What was found out.
#[derive(Clone, Debug)]
pub struct Answer {
    /// All of it.
    pub verdict: Verdict,
    /// It in words, the first line whether the port is right.
    pub lines: Vec<String>,
    /// Its grids beside the right ones.
    pub grids: Vec<Beside>,
    /// The pattern that was injected.
    pub pattern: Option<Pattern>,
}

impl Question {
    /// Whether there is enough to look at: the injected grid and the one after the first iteration.
    pub fn is_complete(&self) -> bool {
        [Role::Injected, Role::Source(1)].iter().all(|wanted| self.files.iter().any(|(_, role)| role == wanted))
    }

    /// Looks at the dumps.
    pub fn answer(&self) -> Result<Answer, String> {
        let files = Files { files: self.files.clone(), scale: 1.0, size: None };
        let dumps = files.read().map_err(|error| error.to_string())?;
        let side = dumps.injected.side;
        let found = |name: &str| {
            Pattern::find(name, side)
                .ok_or_else(|| format!("there is no pattern {name} of {side}³ cells; choose another"))
        };
        let pattern = self.pattern.map(found).transpose()?;
        let verdict = identify(&dumps, pattern.as_ref(), &[]).map_err(|error| error.to_string())?;
        let (lines, grids) = (port::lines(&verdict), beside::beside(&dumps, &verdict));
        Ok(Answer { verdict, lines, grids, pattern })
    }
}

impl Answer {
    /// The first wrong cell's place among the grids, or the brightest one's in the last.
    pub fn start(&self) -> Sight {
        let Some(wrong) = &self.verdict.wrong else {
            let middle = self.grids.first().map_or(0, |grid| grid.found.side() / 2);
            return Sight { dump: self.grids.len().min(2).saturating_sub(1), axis: Axis::Z, index: middle };
        };
        let dump = self.grids.iter().position(|grid| grid.iteration == wrong.iteration).unwrap_or(0);
        Sight { dump, axis: Axis::Z, index: wrong.cell[2] }
    }

    /// The right grid, the port's, and the port's minus the right one, as slices.
    pub fn slices(&self, sight: Sight) -> Option<[Slice; 3]> {
        let Beside { found, right, .. } = self.grids.get(sight.dump)?;
        let mut difference = found.clone();
        difference.add_scaled(right, -1.0);
        Some([right, found, &difference].map(|light| slice(light, sight)))
    }

    /// A preset of the scheme that the port is nearest to, without its mistakes, on the pattern that was injected.
    pub fn corrected(&self) -> Option<String> {
        let (scheme, factor) = (self.verdict.scheme?, self.verdict.factor?);
        let factor = if factor.value > 9.4 { factor.value / (4.0 * std::f64::consts::PI) } else { factor.value };
        let preset = self.pattern.as_ref()?.preset();
        let right = format!("scheme: \"{scheme}\", factor: {:.4}", factor);
        Some(preset.replace("scheme: \"cascaded\", factor: 3.0", &right))
    }
}

fn slice(light: &Light, sight: Sight) -> Slice {
    let mut grid = Grid::<f32>::new(light.side());
    for (i, cell) in light.cells().iter().enumerate() {
        grid.set(light.cell(i), Sh(*cell).cast());
    }
    let plane = Plane { axis: sight.axis, index: sight.index };
    Slice::level(&[&grid], &Channels::of_colors(&[[1.0; 3]]), 0, plane)
}
