//! Time against error as a figure, the same for the files of `bench` and for what the window exports: a plot for each
//! scene and reference, a colour a scheme, a shape a treatment of the levels, and the line of what nothing beats.

use super::colour::Theme;
use super::plot::{Curve, Dash, Figure, Key, Plot, Shape};
use crate::scene::propagation::Policy;
use crate::study::expectation::Expectation;
use crate::study::pareto::{Row, Treatment, front};

/// What rows are to have in common so that their errors can be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind<'a> {
    /// The scene.
    pub preset: &'a str,
    /// The side of the volume.
    pub size: usize,
    /// What the light was held against.
    pub expectation: Expectation,
}

impl<'a> Kind<'a> {
    /// The kind of a row.
    pub fn of(row: &'a Row) -> Self {
        Kind { preset: &row.preset, size: row.size, expectation: row.expectation }
    }

    /// Every kind among the rows, in their order.
    pub fn all(rows: &[&'a Row]) -> Vec<Self> {
        let mut kinds = Vec::new();
        for kind in rows.iter().map(|row| Kind::of(row)) {
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
        kinds
    }

    /// The rows of this kind.
    pub fn rows(&self, rows: &[&'a Row]) -> Vec<&'a Row> {
        rows.iter().copied().filter(|row| Kind::of(row) == *self).collect()
    }
}

/// The shape that a treatment of the levels is drawn as.
pub fn shape(treatment: Treatment) -> Shape {
    match treatment {
        Treatment::Uniform => Shape::Disc,
        Treatment::Octree(Policy::Same) => Shape::Square,
        Treatment::Octree(Policy::Consistent | Policy::Exact | Policy::Ahead) => Shape::Triangle,
        Treatment::Descent => Shape::Diamond,
        Treatment::Converged => Shape::Cross,
    }
}

/// What a treatment of the levels is, in a few words.
pub fn treatment_summary(treatment: Treatment) -> &'static str {
    match treatment {
        Treatment::Uniform => "finest level alone",
        Treatment::Octree(Policy::Same) => "one factor for all levels",
        Treatment::Octree(Policy::Consistent) => "consistent levels",
        Treatment::Octree(Policy::Exact) => "exact levels",
        Treatment::Octree(Policy::Ahead) => "exact levels, ahead",
        Treatment::Descent => "a descent, coarse levels first",
        Treatment::Converged => "fixed point, solved for",
    }
}

/// The schemes among the rows, in their order: a scheme's place is the number of its colour.
pub fn schemes(rows: &[&Row]) -> Vec<&'static str> {
    let mut schemes = Vec::new();
    for row in rows {
        if !schemes.contains(&row.scheme) {
            schemes.push(row.scheme);
        }
    }
    schemes
}

/// Where a row stands: its time in milliseconds, and its error after the best scalar.
pub fn point(row: &Row) -> [f64; 2] {
    [row.seconds * 1e3, row.l1.fitted]
}

/// The figure: of each scene the largest size, against each expectation.
pub fn figure(title: &str, rows: &[&Row], theme: Theme, size: impl FnOnce(usize) -> [u32; 2]) -> Figure {
    let schemes = schemes(rows);
    let largest = |kind: &Kind| rows.iter().all(|row| row.preset != kind.preset || row.size <= kind.size);
    let plot = |kind: Kind| {
        let ours = kind.rows(rows);
        let mut curves = vec![Curve {
            name: "what nothing beats".to_owned(),
            points: front(&ours).into_iter().map(point).collect(),
            color: schemes.len(),
            dash: Dash::Dotted,
        }];
        for (color, scheme) in schemes.iter().enumerate() {
            for (i, treatment) in Treatment::ALL.into_iter().enumerate() {
                let points = ours.iter().filter(|row| (row.scheme, row.treatment) == (*scheme, treatment));
                let name = if i == 0 { (*scheme).to_owned() } else { String::new() };
                let dash = Dash::Points(shape(treatment));
                curves.push(Curve { name, points: points.map(|row| point(row)).collect(), color, dash });
            }
        }
        let key = |treatment| Key { shape: shape(treatment), text: treatment_summary(treatment).to_owned() };
        Plot {
            title: format!("{}, n = {}, against {}", kind.preset, kind.size, kind.expectation.against()),
            x_label: "time, ms".to_owned(),
            y_label: "L1 error, best fit".to_owned(),
            log_x: true,
            log_y: true,
            curves,
            // A descent is there where a scene asks for one.
            keys: Treatment::ALL
                .into_iter()
                .filter(|one| *one != Treatment::Descent || ours.iter().any(|row| row.treatment == *one))
                .map(key)
                .collect(),
            ..Plot::default()
        }
    };
    let plots: Vec<Plot> = Kind::all(rows).into_iter().filter(largest).map(plot).collect();
    let size = size(plots.len());
    Figure { title: title.to_owned(), plots, theme, size }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Propagation;
    use crate::study::fit::BestFit;

    fn row(scheme: &'static str, treatment: Treatment, seconds: f64, fitted: f64) -> Row {
        Row {
            preset: "mixed".to_owned(),
            scheme,
            propagation: Propagation::default(),
            treatment,
            size: 32,
            iterations: 4,
            seconds,
            spread: [seconds; 2],
            expectation: Expectation::Ballistic,
            l1: BestFit { raw: 2.0 * fitted, fitted, scale: 1.0 },
        }
    }

    #[test]
    fn a_plot_shows_every_way_of_the_largest_size_and_what_nothing_beats() {
        let rows = [
            row("cascaded", Treatment::Uniform, 1e-3, 0.5),
            row("axial", Treatment::Converged, 2e-3, 0.25),
            Row { size: 16, ..row("axial", Treatment::Uniform, 1e-3, 0.25) },
        ];
        let rows: Vec<&Row> = rows.iter().collect();
        assert_eq!(Kind::all(&rows).len(), 2);
        let figure = figure("t", &rows, Theme::LIGHT, |plots| [800, 300 * plots as u32]);
        let [plot] = figure.plots.as_slice() else { panic!("one plot") };
        assert_eq!(plot.title, "mixed, n = 32, against what truly arrives");
        assert_eq!(plot.curves[0].points, [[1.0, 0.5], [2.0, 0.25]]);
        let drawn: Vec<(&str, usize)> =
            plot.curves[1..].iter().map(|curve| (curve.name.as_str(), curve.points.len())).collect();
        let nothing = ("", 0);
        assert_eq!(drawn[..5], [("cascaded", 1), nothing, nothing, nothing, nothing]);
        assert_eq!(drawn[5..], [("axial", 0), nothing, nothing, nothing, ("", 1)]);
        assert_eq!(plot.curves[10].dash, Dash::Points(Shape::Cross));
    }
}
