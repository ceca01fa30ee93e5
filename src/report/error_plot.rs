//! The errors of a run as a figure: absolute above relative, mean and largest, over the iterations.

use super::colour::Theme;
use super::plot::{Curve, Dash, Figure, Mark, Plot};
use crate::study::error::{ErrorRow, Metric};

/// What is drawn of the errors, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorPlot<'a> {
    /// The head line.
    pub title: &'a str,
    /// What was measured; each metric and level becomes a curve of means and one of maxima, in the order
    /// in which they first appear.
    pub rows: &'a [ErrorRow],
    /// Whether the errors go by powers of ten.
    pub log: bool,
    /// An iteration to point out.
    pub current: Option<usize>,
    /// The colours.
    pub theme: Theme,
    /// Width and height, in pixels.
    pub size: [u32; 2],
}

/// An error of a row, and whether the row has one.
type Part = fn(&ErrorRow) -> f64;

impl ErrorPlot<'_> {
    /// The figure: two plots with the same curves.
    pub fn figure(&self) -> Figure {
        let undefined = self.rows.iter().map(|row| row.undefined).max().unwrap_or(0);
        let relative = match undefined {
            0 => "Relative error".to_owned(),
            1 => "Relative error (up to 1 cell undefined and left out)".to_owned(),
            n => format!("Relative error (up to {n} cells undefined and left out)"),
        };
        let plots = vec![
            self.plot("Absolute error", "|O − Ô|, SH coefficients", |r| r.absolute_mean, |r| r.absolute_max),
            self.plot(&relative, "|O − Ô| / |O|", |r| r.relative_mean, |r| r.relative_max),
        ];
        Figure { title: self.title.to_owned(), plots, theme: self.theme, size: self.size }
    }

    fn plot(&self, title: &str, y_label: &str, mean: Part, max: Part) -> Plot {
        let mut groups: Vec<(Metric, Option<usize>)> = Vec::new();
        for row in self.rows {
            if !groups.contains(&(row.metric, row.level)) {
                groups.push((row.metric, row.level));
            }
        }
        let one_metric = groups.iter().all(|(metric, _)| *metric == groups[0].0);
        let curves = groups.iter().enumerate().flat_map(|(color, &(metric, level))| {
            let level_name = level.map_or("all levels".to_owned(), |level| format!("level {level}"));
            let name = if one_metric { level_name } else { format!("{metric}, {level_name}") };
            let curve = |what: &str, part: Part, dash| {
                let rows = self.rows.iter().filter(|row| (row.metric, row.level) == (metric, level));
                let points = rows.map(|row| [row.iteration as f64, part(row)]).collect();
                Curve { name: format!("{what}, {name}"), points, color, dash }
            };
            [curve("mean", mean, Dash::Solid), curve("largest", max, Dash::Dashed)]
        });
        Plot {
            title: title.to_owned(),
            x_label: "iteration k".to_owned(),
            y_label: y_label.to_owned(),
            log_y: self.log,
            curves: curves.collect(),
            marks: self.current.map(|k| Mark { x: k as f64, label: format!("k = {k}") }).into_iter().collect(),
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
            metric: Metric::Thesis,
            level,
            absolute_mean: k,
            absolute_max: 2.0 * k,
            relative_mean: 3.0 * k,
            relative_max: 4.0 * k,
            l1_ratio: 0.5,
            undefined,
        }
    }

    #[test]
    fn each_level_is_a_curve_of_means_and_one_of_maxima() {
        let rows: Vec<ErrorRow> = (0..3).flat_map(|k| [row(k, None, 0), row(k, Some(1), k)]).collect();
        let plot = ErrorPlot {
            title: "A run",
            rows: &rows,
            log: true,
            current: Some(2),
            theme: Theme::DARK,
            size: [800, 600],
        };
        let figure = plot.figure();
        let [absolute, relative] = figure.plots.as_slice() else { panic!("two plots") };
        for (plot, [mean, max]) in [(absolute, [1.0, 2.0]), (relative, [3.0, 4.0])] {
            let names: Vec<&str> = plot.curves.iter().map(|c| c.name.as_str()).collect();
            assert_eq!(names, ["mean, all levels", "largest, all levels", "mean, level 1", "largest, level 1"]);
            for (curve, slope) in plot.curves.iter().zip([mean, max, mean, max]) {
                assert_eq!(curve.points, [[0.0, 0.0], [1.0, slope], [2.0, 2.0 * slope]]);
            }
            assert!(plot.log_y && plot.marks[0].x == 2.0);
        }
        assert!(relative.title.contains("up to 2 cells undefined"));
    }

    #[test]
    fn no_rows_make_two_empty_plots() {
        let empty =
            ErrorPlot { title: "", rows: &[], log: false, current: None, theme: Theme::LIGHT, size: [800, 600] };
        let svg = empty.figure().to_svg();
        assert_eq!(svg.matches("nothing to show").count(), 2);
    }
}
