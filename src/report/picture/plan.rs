//! Where the parts of a picture stand: panels in rows, with lines of text above and below them.

use super::super::svg::wrapped;
use super::legend::{LEADING, Legend};
use super::{Picture, Seen};

/// Around a picture, in heights of text.
pub const MARGIN: f64 = 1.4;
/// Left of each panel, for its axis.
const GUTTER: f64 = 3.5;
/// Between a panel and the next one's axis.
const GAP: f64 = 1.4;
/// Panels whose side is at least this many heights of text may stand side by side.
const LARGE_ENOUGH: f64 = 13.0;
/// Above and below a panel with one line of text each: title; axis and scale.
const ABOVE: f64 = 2.4;
const BELOW: f64 = 5.6;

/// The places, in pixels.
pub struct Plan {
    /// The side of each panel.
    pub side: f64,
    /// The picture's height.
    pub height: f64,
    /// Where the legend begins.
    pub legend: f64,
    /// The lines below the picture's title.
    pub subtitle: Vec<String>,
    /// The lines above each panel.
    pub titles: Vec<Vec<String>>,
    /// The lines below each panel.
    pub scales: Vec<Vec<String>>,
    columns: usize,
    /// The first panel's upper left corner, and from there to the next column and row.
    first: [f64; 2],
    step: [f64; 2],
}

impl Plan {
    /// Places a picture `width` pixels wide, and as high as given or as it takes, with text `em` pixels high.
    pub fn new(picture: &Picture, width: f64, height: Option<f64>, em: f64, legend: &Legend, seen: &[Seen]) -> Self {
        let plans = (1..=picture.panels.len().max(1)).rev();
        let plans = plans.map(|columns| Plan::with_columns(picture, width, height, em, legend, seen, columns));
        let mut best: Option<Plan> = None;
        for plan in plans {
            let better = best.as_ref().is_none_or(|best| match height {
                Some(_) => plan.side > best.side,
                None => best.side < LARGE_ENOUGH * em,
            });
            if better {
                best = Some(plan);
            }
        }
        best.unwrap_or_else(|| Plan::with_columns(picture, width, height, em, legend, seen, 1))
    }

    fn with_columns(
        picture: &Picture,
        width: f64,
        height: Option<f64>,
        em: f64,
        legend: &Legend,
        seen: &[Seen],
        columns: usize,
    ) -> Self {
        let count = picture.panels.len().max(1);
        let (rows, across) = (count.div_ceil(columns) as f64, columns as f64);
        let room = width - 2.0 * MARGIN * em;
        let widest = ((room - (across - 1.0) * GAP * em) / across - GUTTER * em).max(em);
        let subtitle = match picture.subtitle {
            "" => Vec::new(),
            text => wrapped(text, em, room),
        };
        let mut plan = Plan {
            side: widest,
            height: 0.0,
            legend: 0.0,
            subtitle,
            titles: Vec::new(),
            scales: Vec::new(),
            columns,
            first: [0.0; 2],
            step: [0.0; 2],
        };
        // A lower picture has narrower panels, whose texts may take more lines: twice settles it.
        for _ in 0..2 {
            let side = plan.side;
            plan.titles = picture.panels.iter().map(|panel| wrapped(panel.title, 1.15 * em, side)).collect();
            let scales = picture.panels.iter().zip(seen);
            plan.scales = scales.map(|(panel, seen)| legend.scale_text(panel.scale, *seen, side)).collect();
            let more = |texts: &[Vec<String>]| {
                LEADING * em * texts.iter().map(|lines| lines.len().saturating_sub(1)).max().unwrap_or(0) as f64
            };
            let (above, below) = (ABOVE * em + more(&plan.titles), BELOW * em + more(&plan.scales));
            let head = match plan.subtitle.len() {
                0 => (MARGIN + 1.5) * em,
                lines => (MARGIN + 3.0 + LEADING * (lines as f64 - 1.0)) * em,
            };
            let foot = legend.height() + MARGIN * em;
            if let Some(height) = height {
                let highest = (height - head - foot) / rows - above - below;
                plan.side = widest.min(highest).max(em);
            }
            let used = across * (plan.side + GUTTER * em) + (across - 1.0) * GAP * em;
            plan.first = [MARGIN * em + GUTTER * em + (room - used) / 2.0, head + above];
            plan.step = [plan.side + (GUTTER + GAP) * em, plan.side + above + below];
            plan.legend = head + rows * plan.step[1];
            plan.height = height.unwrap_or((plan.legend + foot).ceil());
        }
        plan
    }

    /// The upper left corner of a panel.
    pub fn corner(&self, panel: usize) -> [f64; 2] {
        let (column, row) = ((panel % self.columns) as f64, (panel / self.columns) as f64);
        [self.first[0] + column * self.step[0], self.first[1] + row * self.step[1]]
    }
}
