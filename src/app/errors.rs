//! The error plots: curves over the iterations, as they grow.

use std::collections::BTreeSet;

use egui::{Color32, ComboBox, Ui, vec2};
use egui_plot::{
    Corner, GridInput, GridMark, HoverPosition, Legend, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points, VLine,
};
use serde::{Deserialize, Serialize};

use super::mesh::color;
use crate::report::colour::Theme;
use crate::study::error::{ErrorRow, Metric};

/// The error rows of one run, in the order of its iterations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// What the legend calls it.
    pub name: String,
    /// Its rows.
    pub rows: Vec<ErrorRow>,
    /// Its colour, by number.
    pub color: usize,
}

impl Run {
    /// Takes in the rows of one iteration; those of it and later ones that were there are dropped.
    pub fn update(&mut self, iteration: usize, rows: Vec<ErrorRow>) {
        self.rows.retain(|row| row.iteration < iteration);
        self.rows.extend(rows);
    }

    /// (iteration, value) of the rows of a metric and a level.
    pub fn curve(&self, metric: Metric, level: Option<usize>, value: fn(&ErrorRow) -> f64) -> Vec<[f64; 2]> {
        let rows = self.rows.iter().filter(|row| row.metric == metric && row.level == level);
        rows.map(|row| [row.iteration as f64, value(row)]).collect()
    }
}

/// A number of a row that can be drawn.
pub struct Quantity {
    /// Its name in legends.
    pub name: &'static str,
    /// Where it is.
    pub value: fn(&ErrorRow) -> f64,
    /// Whether its line is broken.
    pub dashed: bool,
}

/// The two quantities of the plot of absolute errors.
pub const ABSOLUTE: [Quantity; 2] = [
    Quantity { name: "average", value: |row| row.absolute_mean, dashed: false },
    Quantity { name: "maximum", value: |row| row.absolute_max, dashed: true },
];
/// The two quantities of the plot of relative errors.
pub const RELATIVE: [Quantity; 2] = [
    Quantity { name: "average", value: |row| row.relative_mean, dashed: false },
    Quantity { name: "maximum", value: |row| row.relative_max, dashed: true },
];

/// What there is to plot, and how.
#[derive(Clone, Copy)]
pub struct Curves<'a> {
    /// The runs, in the order of their legend.
    pub runs: &'a [&'a Run],
    /// The colours.
    pub theme: &'a Theme,
    /// The iteration that is seen.
    pub now: usize,
}

/// What the plots show.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Plots {
    /// Whether the vertical axes are logarithmic.
    pub log: bool,
    /// Whether averages are drawn.
    pub average: bool,
    /// Whether maxima are drawn.
    pub maximum: bool,
    /// The level, or all together.
    pub level: Option<usize>,
    /// The metric, by its name.
    pub metric: String,
}

impl Default for Plots {
    fn default() -> Self {
        Plots { log: true, average: true, maximum: true, level: None, metric: Metric::Thesis.name().to_owned() }
    }
}

impl Plots {
    /// Whether a quantity is drawn.
    pub fn draws(&self, quantity: &Quantity) -> bool {
        if quantity.dashed { self.maximum } else { self.average }
    }

    /// The metric that is drawn: the chosen one where a run has it, else the first there is.
    pub fn metric(&self, runs: &[&Run]) -> Metric {
        let mut metrics = runs.iter().flat_map(|run| &run.rows).map(|row| row.metric);
        metrics.clone().find(|metric| metric.name() == self.metric).or(metrics.next()).unwrap_or(Metric::Thesis)
    }

    /// The controls over the plots.
    pub fn controls(&mut self, ui: &mut Ui, runs: &[&Run]) {
        let metrics: BTreeSet<&str> = runs.iter().flat_map(|run| &run.rows).map(|row| row.metric.name()).collect();
        let shown = self.metric(runs).name();
        if metrics.len() > 1 {
            let choice = ComboBox::from_id_salt("metric").selected_text(shown).width(84.0).show_ui(ui, |ui| {
                for metric in &metrics {
                    ui.selectable_value(&mut self.metric, (*metric).to_owned(), *metric).on_hover_text(about(metric));
                }
            });
            super::controls::name(&choice.response.on_hover_text(about(shown)), "Error metric");
        }
        let levels: BTreeSet<usize> = runs.iter().flat_map(|run| &run.rows).filter_map(|row| row.level).collect();
        let text = |level: Option<usize>| level.map_or("All levels".to_owned(), |level| format!("Level {level}"));
        let choice =
            ComboBox::from_id_salt("error level").selected_text(text(self.level)).width(84.0).show_ui(ui, |ui| {
                for level in std::iter::once(None).chain(levels.into_iter().map(Some)) {
                    ui.selectable_value(&mut self.level, level, text(level));
                }
            });
        super::controls::name(&choice.response, "Error level");
        ui.checkbox(&mut self.average, "Average —").on_hover_text("Solid lines");
        ui.checkbox(&mut self.maximum, "Maximum - -").on_hover_text("Broken lines");
        ui.checkbox(&mut self.log, "Log axis")
            .on_hover_text("A logarithmic vertical axis; errors of zero are left out");
    }

    /// Both plots, side by side in the room there is.
    pub fn ui(&self, ui: &mut Ui, curves: &Curves) {
        let room = ui.available_size();
        let each = vec2(((room.x - 8.0) / 2.0).max(80.0), room.y.max(60.0));
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = 8.0;
            self.plot(ui, each, "Absolute error (SH coefficient)", &ABSOLUTE, curves);
            self.plot(ui, each, "Relative error", &RELATIVE, curves);
        });
    }

    fn plot(&self, ui: &mut Ui, size: egui::Vec2, title: &str, quantities: &[Quantity], curves: &Curves) {
        let Curves { runs, theme, now } = *curves;
        let log = self.log;
        let metric = self.metric(runs);
        let iterations = runs.iter().flat_map(|run| &run.rows).map(|row| row.iteration).max().unwrap_or(0);
        let mut plot = Plot::new(title)
            .width(size.x)
            .height(size.y)
            .x_axis_label("Iteration k")
            .y_axis_label(title)
            .legend(Legend::default().position(Corner::RightBottom).background_alpha(0.6).follow_insertion_order(true))
            .include_x(0.0)
            .include_x(iterations.max(4) as f64)
            .allow_scroll(false)
            .link_cursor(egui::Id::unique("error plots"), [true, false])
            .grid_color(color(theme.grid))
            .y_axis_min_width(44.0)
            .x_grid_spacer(iterations_apart)
            .x_axis_formatter(
                |mark, _| if mark.value.fract() == 0.0 { format!("{}", mark.value) } else { String::new() },
            )
            .label_formatter(move |position| Some(read_out(position, log)));
        plot = match log {
            true => plot.y_grid_spacer(decades).y_axis_formatter(|mark, _| power_of_ten(mark.value)),
            false => plot.include_y(0.0),
        };
        let response = plot.show(ui, |plot| {
            for run in runs {
                let many = runs.len() > 1;
                for quantity in quantities.iter().filter(|quantity| self.draws(quantity)) {
                    let points = drawn(run.curve(metric, self.level, quantity.value), log);
                    let ink = match many {
                        true => color(theme.curve(run.color)),
                        false => color(theme.curve(usize::from(quantity.dashed))),
                    };
                    // Of several runs the legend names each once: solid and broken lines are told apart above.
                    let name = if many { run.name.clone() } else { quantity.name.to_owned() };
                    curve(plot, name, points, ink, quantity.dashed);
                }
            }
            let mark = VLine::new("", now as f64).color(color(theme.muted)).width(1.0);
            plot.vline(mark.style(LineStyle::dotted_dense()).allow_hover(false));
        });
        super::controls::name(&response.response, title);
    }
}

/// What a metric compares, in a line.
fn about(metric: &str) -> &'static str {
    match Metric::ALL.into_iter().find(|known| known.name() == metric) {
        Some(Metric::Thesis) => "Every level against the mean of its children",
        Some(Metric::Corrected) => "Every level against a uniform volume, downsampled",
        Some(Metric::Merged) => "The merged light against a uniform volume",
        Some(Metric::Ballistic) => "The merged light that has moved against what truly arrives",
        None => "",
    }
}

/// The points as drawn: their logarithms where the axis is logarithmic, zeros and what is not finite left out.
fn drawn(points: Vec<[f64; 2]>, log: bool) -> Vec<[f64; 2]> {
    let there = points.into_iter().filter(|[_, y]| y.is_finite() && (!log || *y > 0.0));
    there.map(|[x, y]| [x, if log { y.log10() } else { y }]).collect()
}

/// A line, with dots while it is short enough to tell them apart.
fn curve(plot: &mut egui_plot::PlotUi<'_>, name: String, points: Vec<[f64; 2]>, ink: Color32, dashed: bool) {
    if points.len() <= 40 {
        let dots = Points::new(name.clone(), PlotPoints::new(points.clone()));
        plot.points(dots.radius(2.2).color(ink).shape(MarkerShape::Circle).allow_hover(false));
    }
    let style = if dashed { LineStyle::dashed_loose() } else { LineStyle::Solid };
    plot.line(Line::new(name, PlotPoints::new(points)).color(ink).width(1.6).style(style));
}

/// What stands beside the pointer.
fn read_out(position: &HoverPosition<'_>, log: bool) -> String {
    let value = |y: f64| if log { 10f64.powf(y) } else { y };
    match position {
        HoverPosition::NearDataPoint { plot_name, position, .. } => {
            format!("{plot_name}\nk = {:.0}:  {:.3e}", position.x, value(position.y))
        }
        HoverPosition::Elsewhere { position } => format!("k = {:.1}: {:.3e}", position.x, value(position.y)),
    }
}

/// The lines of the axis of iterations: whole numbers, one, two or five times a power of ten apart.
pub fn iterations_apart(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let wanted = (high - low) / 8.0;
    if !wanted.is_finite() || wanted <= 0.0 {
        return Vec::new();
    }
    let power = 10f64.powf(wanted.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|part| part * power).into_iter().find(|step| *step >= wanted);
    let step = step.unwrap_or(1.0).max(1.0);
    let places = (low / step).ceil() as i64..=(high / step).floor() as i64;
    // The spacing tells the plot how bold a line is and whether its number has room.
    places.map(|i| GridMark { value: i as f64 * step, step_size: 10.0 * input.base_step_size.max(step) }).collect()
}

/// The lines of a logarithmic axis: one for each power of ten, fewer where they would crowd, and its double
/// and fivefold where there is room.
fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let step = input.base_step_size.ceil().max(1.0);
    if !(low.is_finite() && high.is_finite()) || (high - low) / step > 1000.0 {
        return Vec::new();
    }
    let between: &[f64] = if high - low < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let powers = (low / step).floor() as i64..=(high / step).floor() as i64;
    let marks = powers.flat_map(|i| between.iter().map(move |part| i as f64 * step + part.log10()));
    marks.filter(|value| (low..=high).contains(value)).map(|value| GridMark { value, step_size: step }).collect()
}

/// A number on an axis, from its logarithm; the window's fonts have no raised minus.
fn power_of_ten(exponent: f64) -> String {
    let power = (exponent + 1e-9).floor();
    let part = 10f64.powf(exponent - power).round();
    format!("{part}e{power}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(iteration: usize, absolute_mean: f64) -> ErrorRow {
        ErrorRow {
            iteration,
            metric: Metric::Thesis,
            level: None,
            absolute_mean,
            absolute_max: 0.0,
            relative_mean: 0.0,
            relative_max: 0.0,
            l1_ratio: 0.0,
            undefined: 0,
        }
    }

    #[test]
    fn going_back_drops_what_came_after() {
        let mut run = Run::default();
        for k in 0..5 {
            run.update(k, vec![row(k, k as f64)]);
        }
        run.update(2, vec![row(2, 9.0)]);
        assert_eq!(run.curve(Metric::Thesis, None, ABSOLUTE[0].value), [[0.0, 0.0], [1.0, 1.0], [2.0, 9.0]]);
        assert!(run.curve(Metric::Thesis, Some(1), ABSOLUTE[0].value).is_empty());
    }

    #[test]
    fn a_log_axis_leaves_out_what_it_cannot_show() {
        assert_eq!(drawn(vec![[0.0, 0.0], [1.0, 0.01], [2.0, f64::NAN]], true), [[1.0, -2.0]]);
        assert_eq!(power_of_ten(-12.0), "1e-12");
        assert_eq!(power_of_ten(5f64.log10() - 3.0), "5e-3");
        let apart = |high| iterations_apart(GridInput { bounds: (-0.2, high), base_step_size: 0.01 });
        assert_eq!(apart(5.2).iter().map(|mark| mark.value).collect::<Vec<_>>(), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(
            apart(33.0).iter().map(|mark| mark.value).collect::<Vec<_>>(),
            [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0]
        );
        let marks = decades(GridInput { bounds: (-3.2, 0.4), base_step_size: 0.2 });
        assert_eq!(marks.iter().map(|mark| mark.value).collect::<Vec<_>>(), [-3.0, -2.0, -1.0, 0.0]);
    }
}
