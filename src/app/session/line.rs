//! Light along a line of cells through the slice: where the merged light jumps from level to level, with one
//! factor for all levels and with levels that agree, beside the uniform volume (000, figure 14).

use serde::{Deserialize, Serialize};

use super::Session;
use super::format::Format;
use crate::report::glyph::Hue;
use crate::report::plot::{Curve, Dash, Figure, Mark, Plot as PaperPlot};
use crate::report::slice::Axis;
use crate::report::table::{Table, Value};
use crate::scene::propagation::Policy;
use crate::study::profile::{Line, Policies};

/// Which line of cells is drawn, and how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LineChoice {
    /// Whether it runs up the slice, in place of across it.
    pub upwards: bool,
    /// Its row or column in the slice; where most light is injected if none was chosen.
    pub at: Option<usize>,
    /// Whether the vertical axis is logarithmic.
    pub log: bool,
}

impl Default for LineChoice {
    fn default() -> Self {
        LineChoice { upwards: false, at: None, log: true }
    }
}

/// What is drawn of a line of cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// What it is and where.
    pub title: String,
    /// The axis that it runs along.
    pub axis: &'static str,
    /// (cell, c00) of the uniform volume, and of the merged light under each policy, with their names.
    pub curves: Vec<(&'static str, Vec<[f64; 2]>)>,
    /// Where the sampled level changes, and to which.
    pub borders: Vec<(f64, usize)>,
}

impl Course {
    fn new(policies: &Policies, line: Line, hue: Hue) -> Self {
        let points = |light: Vec<[crate::sh::Sh<f32>; 3]>| -> Vec<[f64; 2]> {
            light.into_iter().enumerate().map(|(i, rgb)| [i as f64, f64::from(hue.of(rgb).0[0])]).collect()
        };
        let mut curves = vec![("uniform volume", points(policies.uniform(line)))];
        for policy in Policy::ALL {
            let name = match policy {
                Policy::Same => "merged, one factor for all levels",
                Policy::Consistent => "merged, consistent levels",
                Policy::Exact => "merged, exact levels",
                Policy::Ahead => "merged, exact levels ahead",
            };
            curves.push((name, points(policies.merged(policy, line))));
        }
        let levels = policies.levels(line);
        let changes = levels.windows(2).enumerate().filter(|(_, pair)| pair[0] != pair[1]);
        let borders = changes.map(|(i, pair)| (i as f64 + 0.5, pair[1])).collect();
        let beside = (0..3).filter(|axis| *axis != line.along);
        let beside: Vec<String> = beside.map(|axis| format!("{} = {}", Axis::name(axis), line.through[axis])).collect();
        let axis = Axis::name(line.along);
        let title = format!("Light along {axis}, {}, k = {}", beside.join(", "), policies.iteration());
        Course { title, axis, curves, borders }
    }

    /// For a paper.
    pub fn figure(&self, title: &str, log: bool, format: &Format) -> Figure {
        let curve = |(i, (name, points)): (usize, &(&'static str, Vec<[f64; 2]>))| Curve {
            name: (*name).to_owned(),
            points: points.clone(),
            color: i,
            dash: if i == 0 { Dash::Dotted } else { Dash::Solid },
        };
        let mark = |(x, level): &(f64, usize)| Mark { x: *x, label: level.to_string() };
        let plot = PaperPlot {
            title: format!("{}; levels above", self.title),
            x_label: format!("cell along {}", self.axis),
            y_label: "c00, SH coefficient".to_owned(),
            log_y: log,
            curves: self.curves.iter().enumerate().filter(|(_, (_, points))| !points.is_empty()).map(curve).collect(),
            marks: self.borders.iter().map(mark).collect(),
            ..PaperPlot::default()
        };
        Figure { title: title.to_owned(), plots: vec![plot], theme: format.theme(), size: format.figure(1) }
    }

    /// As a table: a row for each cell.
    pub fn table(&self) -> Table<4> {
        let mut table = Table::new(["cell", "uniform", "same", "consistent"]);
        for (i, [_, uniform]) in self.curves[0].1.iter().enumerate() {
            let light = |curve: usize| {
                let point = self.curves.get(curve).and_then(|(_, points)| points.get(i));
                point.map_or(Value::Text(String::new()), |[_, c00]| Value::Number(*c00))
            };
            table.push([i.into(), Value::Number(*uniform), light(1), light(2)]);
        }
        table
    }
}

impl Session {
    /// The line of cells that is chosen.
    pub fn line(&self) -> Line {
        let LineChoice { upwards, at, .. } = self.settings.plots.line;
        let plane = self.settings.view.plane();
        let (along, beside) = match upwards {
            false => (plane.axis.columns(), plane.axis.rows()),
            true => (plane.axis.rows(), plane.axis.columns()),
        };
        let progress = &self.run.progress;
        let last = progress.side.max(1) - 1;
        let mut through = progress.brightest.map(|c| c.min(last));
        through[plane.axis.across()] = plane.index.min(last);
        through[beside] = at.unwrap_or(through[beside]).min(last);
        Line { along, through }
    }

    /// Where the line begins and ends, in finest cells.
    pub fn line_ends(&self) -> [[f32; 3]; 2] {
        let line = self.line();
        let mut ends = [line.through.map(|c| c as f32 + 0.5); 2];
        ends[0][line.along] = 0.0;
        ends[1][line.along] = self.run.progress.side as f32;
        ends
    }

    /// The light along it, once it is computed.
    pub fn course(&self) -> Option<Course> {
        let (_, policies) = self.asides.profiles.latest()?;
        Some(Course::new(policies, self.line(), self.settings.view.hue))
    }
}
