//! The errors of one or more runs as a figure, and what its plots are called: the same for the files of `run`, for the
//! window's plots and for what it exports.

use super::colour::Theme;
use super::plot::{Curve, Dash, Figure, Mark, Plot};
use crate::study::error::ErrorRow;
use crate::study::expectation::Expectation;

/// The largest relative error that is drawn. Above it light is next to nothing where some is expected: the number says how
/// early a front arrives, and an axis that reaches it shows nothing else.
pub const LARGEST_RELATIVE: f64 = 1e3;

/// A relative error as it is drawn.
fn drawn_relative(error: f64) -> f64 {
    if error <= LARGEST_RELATIVE { error } else { f64::NAN }
}

/// The errors that share a plot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Measure {
    /// ‖O − Ô‖∞.
    Absolute,
    /// ‖O − Ô‖∞ / ‖O‖∞.
    Relative,
    /// Σ‖O − Ô‖∞ / Σ‖Ô‖∞.
    L1,
}

/// A number of a row that is drawn over the iterations.
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    /// Its name in legends.
    pub name: &'static str,
    /// Its value; not finite where a row has none.
    pub value: fn(&ErrorRow) -> f64,
    /// Whether its line is broken: the largest errors, and those after the best fit.
    pub dashed: bool,
}

impl Measure {
    /// All of them, in the order in which they are drawn.
    pub const ALL: [Measure; 3] = [Measure::Absolute, Measure::Relative, Measure::L1];

    /// What the plot is called.
    pub fn title(self) -> &'static str {
        match self {
            Measure::Absolute => "Absolute error",
            Measure::Relative => "Relative error",
            Measure::L1 => "L1 ratio",
        }
    }

    /// The same with its unit, for an axis with little room.
    pub fn label(self) -> &'static str {
        match self {
            Measure::Absolute => "Absolute error (SH)",
            Measure::Relative => "Relative error",
            Measure::L1 => "L1 ratio",
        }
    }

    /// The same as a formula.
    pub fn formula(self) -> &'static str {
        match self {
            Measure::Absolute => "|O − Ô|, SH coefficients",
            Measure::Relative => "|O − Ô| / |O|",
            Measure::L1 => "Σ|O − Ô| / Σ|Ô|",
        }
    }

    /// What is drawn of it.
    pub fn quantities(self) -> [Quantity; 2] {
        let quantity = |name, value, dashed| Quantity { name, value, dashed };
        match self {
            Measure::Absolute => {
                [quantity("mean", |row| row.absolute_mean, false), quantity("largest", |row| row.absolute_max, true)]
            }
            Measure::Relative => [
                quantity("mean", |row| drawn_relative(row.relative_mean), false),
                quantity("largest", |row| drawn_relative(row.relative_max), true),
            ],
            Measure::L1 => [
                quantity("as it is", |row| row.l1_ratio, false),
                quantity("best fit", |row| row.l1_best_fit.unwrap_or(f64::NAN), true),
            ],
        }
    }

    /// What its plot leaves out of these rows, in words; `None` where that is nothing.
    pub fn left_out<'a>(self, rows: impl IntoIterator<Item = &'a ErrorRow>) -> Option<String> {
        if self != Measure::Relative {
            return None;
        }
        let (mut undefined, mut beyond) = (0, 0);
        for row in rows {
            undefined = undefined.max(row.undefined);
            beyond +=
                [row.relative_mean, row.relative_max].iter().filter(|error| drawn_relative(**error).is_nan()).count();
        }
        let cells = if undefined == 1 { "cell" } else { "cells" };
        let undefined = (undefined > 0).then(|| format!("up to {undefined} {cells} undefined and left out"));
        let values = if beyond == 1 { "value" } else { "values" };
        let beyond = (beyond > 0).then(|| format!("{beyond} {values} above {LARGEST_RELATIVE} not drawn"));
        let parts: Vec<String> = undefined.into_iter().chain(beyond).collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    }
}

/// The errors of one run against one expectation on one level, or on all together.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What legends call it.
    pub name: String,
    /// Its rows, in the order of their iterations.
    pub rows: Vec<ErrorRow>,
    /// Its colour, by number.
    pub color: usize,
}

impl Series {
    /// A series for each expectation and level of one run's rows, in the order in which they first appear.
    ///
    /// ```
    /// use lpv_lab::report::colour::Theme;
    /// use lpv_lab::report::error_figure::{ErrorFigure, Measure, Series};
    /// use lpv_lab::study::error::Tally;
    /// use lpv_lab::study::expectation::Expectation;
    ///
    /// let row = |k: usize| {
    ///     let mut tally = Tally::default();
    ///     tally.add(0.5f64.powi(k as i32), 1.0, 1.0);
    ///     tally.row(k, Expectation::Merged, None)
    /// };
    /// let figure = ErrorFigure {
    ///     title: "Halved in every iteration",
    ///     series: &Series::of_run(&[row(0), row(1), row(2)]),
    ///     measures: &Measure::ALL,
    ///     means: true,
    ///     largest: false,
    ///     log: true,
    ///     current: None,
    ///     theme: Theme::LIGHT,
    ///     size: [800, 900],
    /// };
    /// assert!(figure.figure().to_svg().contains("Absolute error, merged"));
    /// ```
    pub fn of_run(rows: &[ErrorRow]) -> Vec<Series> {
        let mut groups: Vec<(Expectation, Option<usize>)> = Vec::new();
        for row in rows {
            if !groups.contains(&(row.expectation, row.level)) {
                groups.push((row.expectation, row.level));
            }
        }
        let one = groups.iter().all(|(expectation, _)| *expectation == groups[0].0);
        let series = groups.iter().enumerate().map(|(color, &(expectation, level))| {
            let level_name = level_name(level);
            let name = if one { level_name } else { format!("{expectation}, {level_name}") };
            let rows = rows.iter().filter(|row| (row.expectation, row.level) == (expectation, level));
            Series { name, rows: rows.copied().collect(), color }
        });
        series.collect()
    }

    /// (iteration, value) of its rows.
    pub fn points(&self, quantity: &Quantity) -> Vec<[f64; 2]> {
        self.rows.iter().map(|row| [row.iteration as f64, (quantity.value)(row)]).collect()
    }
}

/// A level as legends and titles name it.
pub fn level_name(level: Option<usize>) -> String {
    level.map_or("all levels".to_owned(), |level| format!("level {level}"))
}

/// What is drawn of the errors, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorFigure<'a> {
    /// The head line.
    pub title: &'a str,
    /// What was measured. Of a single series legends name the quantities alone.
    pub series: &'a [Series],
    /// The plots, from top to bottom.
    pub measures: &'a [Measure],
    /// Whether solid lines are drawn: means, and L1 ratios as they are.
    pub means: bool,
    /// Whether broken lines are drawn: the largest errors, and L1 ratios after the best fit.
    pub largest: bool,
    /// Whether the errors go by powers of ten.
    pub log: bool,
    /// An iteration to point out.
    pub current: Option<usize>,
    /// The colours.
    pub theme: Theme,
    /// Width and height, in pixels.
    pub size: [u32; 2],
}

impl ErrorFigure<'_> {
    /// The figure: a plot for each measure, all with the same curves.
    pub fn figure(&self) -> Figure {
        let plots = self.measures.iter().map(|measure| self.plot(*measure)).collect();
        Figure { title: self.title.to_owned(), plots, theme: self.theme, size: self.size }
    }

    fn plot(&self, measure: Measure) -> Plot {
        let mut curves = Vec::new();
        for series in self.series {
            let quantities = measure.quantities().into_iter().enumerate();
            for (i, quantity) in quantities.filter(|(_, q)| if q.dashed { self.largest } else { self.means }) {
                let points = series.points(&quantity);
                if points.iter().all(|[_, value]| value.is_nan()) {
                    continue;
                }
                let (name, color) = match self.series.len() {
                    1 => (quantity.name.to_owned(), i),
                    _ => (format!("{}, {}", quantity.name, series.name), series.color),
                };
                let dash = if quantity.dashed { Dash::Dashed } else { Dash::Solid };
                curves.push(Curve { name, points, color, dash });
            }
        }
        Plot {
            title: self.plot_title(measure),
            x_label: "iteration k".to_owned(),
            y_label: measure.formula().to_owned(),
            log_y: self.log,
            curves,
            marks: self.current.map(|k| Mark { x: k as f64, label: format!("k = {k}") }).into_iter().collect(),
            ..Plot::default()
        }
    }

    /// The measure, what all series have in common, and how many cells are left out of a mean.
    fn plot_title(&self, measure: Measure) -> String {
        let rows = || self.series.iter().flat_map(|series| &series.rows);
        let mut title = measure.title().to_owned();
        if let Some(first) = rows().next() {
            if rows().all(|row| row.expectation == first.expectation) {
                title += &format!(", {}", first.expectation);
            }
            if rows().all(|row| row.level == first.level) && first.expectation.has_levels() {
                title += &format!(", {}", level_name(first.level));
            }
        }
        match measure.left_out(rows()) {
            Some(left_out) => format!("{title} ({left_out})"),
            None => title,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(iteration: usize, level: Option<usize>, undefined: usize) -> ErrorRow {
        let k = iteration as f64;
        ErrorRow {
            iteration,
            expectation: Expectation::Thesis,
            level,
            absolute_mean: k,
            absolute_max: 2.0 * k,
            relative_mean: 3.0 * k,
            relative_max: 4.0 * k,
            l1_ratio: 5.0 * k,
            l1_best_fit: None,
            traced: None,
            undefined,
        }
    }

    fn of<'a>(series: &'a [Series], measures: &'a [Measure]) -> ErrorFigure<'a> {
        ErrorFigure {
            title: "A run",
            series,
            measures,
            means: true,
            largest: true,
            log: true,
            current: Some(2),
            theme: Theme::DARK,
            size: [800, 600],
        }
    }

    #[test]
    fn each_level_is_a_curve_of_means_and_one_of_the_largest() {
        let rows: Vec<ErrorRow> = (0..3).flat_map(|k| [row(k, None, 0), row(k, Some(1), k)]).collect();
        let series = Series::of_run(&rows);
        let figure = of(&series, &Measure::ALL).figure();
        let [absolute, relative, l1] = figure.plots.as_slice() else { panic!("three plots") };
        for (plot, [mean, largest]) in [(absolute, [1.0, 2.0]), (relative, [3.0, 4.0])] {
            let names: Vec<&str> = plot.curves.iter().map(|c| c.name.as_str()).collect();
            assert_eq!(names, ["mean, all levels", "largest, all levels", "mean, level 1", "largest, level 1"]);
            for (curve, slope) in plot.curves.iter().zip([mean, largest, mean, largest]) {
                assert_eq!(curve.points, [[0.0, 0.0], [1.0, slope], [2.0, 2.0 * slope]]);
            }
            assert!(plot.log_y && plot.marks[0].x == 2.0);
        }
        // No row has a best fit: its curves are not there.
        assert_eq!(
            l1.curves.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(),
            ["as it is, all levels", "as it is, level 1"]
        );
        assert!(relative.title.contains("up to 2 cells undefined") && absolute.title == "Absolute error, thesis");
    }

    #[test]
    fn what_is_not_wanted_is_not_drawn_and_a_lone_series_needs_no_name() {
        let series = [Series { name: "A".to_owned(), rows: vec![row(0, None, 0), row(1, None, 1)], color: 3 }];
        let figure = ErrorFigure { largest: false, ..of(&series, &[Measure::Relative]) }.figure();
        let [plot] = figure.plots.as_slice() else { panic!("one plot") };
        assert_eq!(plot.curves.iter().map(|c| (c.name.as_str(), c.color)).collect::<Vec<_>>(), [("mean", 0)]);
        assert_eq!(plot.title, "Relative error, thesis, all levels (up to 1 cell undefined and left out)");
    }

    #[test]
    fn relative_errors_of_next_to_no_light_are_told_and_do_not_stretch_the_axis() {
        let rows = [row(1, None, 0), ErrorRow { relative_mean: 1e3, relative_max: 1e14, ..row(2, None, 0) }];
        let series = [Series { name: "A".to_owned(), rows: rows.to_vec(), color: 0 }];
        let figure = of(&series, &[Measure::Relative]).figure();
        let largest =
            figure.plots[0].curves.iter().flat_map(|curve| &curve.points).map(|[_, y]| *y).fold(0.0, f64::max);
        assert_eq!(largest, 1e3);
        assert!(figure.plots[0].title.ends_with("(1 value above 1000 not drawn)"), "{}", figure.plots[0].title);
    }

    #[test]
    fn no_rows_make_empty_plots() {
        let svg = of(&[], &[Measure::Absolute, Measure::Relative]).figure().to_svg();
        assert_eq!(svg.matches("nothing to show").count(), 2);
    }
}
