//! The error plots on screen: curves over the iterations, as they grow.

use egui::{Align2, Color32, RichText, Ui, Vec2, vec2};
use egui_plot::{
    Corner, HoverPosition, Legend, Line, LineStyle, MarkerShape, Plot, PlotPoint, PlotPoints, Points, Text, VLine,
};

use crate::app::draw::axis::{decades, from_logarithm, iterations_apart};
use crate::app::draw::ink::color;
use crate::app::panels::field::name;
use crate::app::session::curves::Curves;
use crate::app::session::plots::Plots;
use crate::report::colour::Theme;
use crate::report::error_figure::Measure;

/// Curves of at most this many points show each of them.
const DOTTED_UP_TO: usize = 40;

/// What there is to plot, and how.
#[derive(Clone, Copy)]
pub struct Drawing<'a> {
    /// The runs, in the order of their legend.
    pub runs: &'a [&'a Curves],
    /// The colours.
    pub theme: &'a Theme,
    /// The iteration that is seen.
    pub now: usize,
}

/// The plots side by side in the room there is.
pub fn ui(ui: &mut Ui, plots: &Plots, drawing: &Drawing) {
    let room = ui.available_size();
    let count = plots.measures().count();
    if count == 0 {
        ui.weak("Nothing is chosen to be drawn: see Curves.");
    }
    let iterated = drawing.runs.iter().flat_map(|run| &run.rows).any(|row| row.iteration > 0);
    if !iterated {
        ui.weak("Errors over the iterations appear here once light has moved: press Space for the next iteration.");
        return;
    }
    let rows = || {
        let ours = drawing.runs.iter().flat_map(|run| &run.rows);
        ours.filter(|row| row.expectation == plots.metric && row.level == plots.level())
    };
    for left_out in plots.measures().filter_map(|measure| measure.left_out(rows())) {
        ui.small(format!("Relative error: {left_out}."));
    }
    if rows().next().is_some() && rows().all(|row| row.absolute_max == 0.0) {
        ui.small(format!("Every error is 0. {}.", plots.metric.summary()));
    }
    let room = vec2(room.x, ui.available_height());
    let gap = 8.0;
    let each = vec2(((room.x + gap) / count.max(1) as f32 - gap).max(80.0), room.y.max(60.0));
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = gap;
        plots.measures().for_each(|measure| plot(ui, plots, each, measure, drawing));
    });
}

fn plot(ui: &mut Ui, plots: &Plots, size: Vec2, measure: Measure, drawing: &Drawing) {
    let Drawing { runs, theme, now } = *drawing;
    let log = plots.log;
    let (metric, level) = (plots.metric, plots.level());
    let iterations = runs.iter().flat_map(|run| &run.rows).map(|row| row.iteration).max().unwrap_or(0);
    let mut plot = Plot::new(measure.title())
        .width(size.x)
        .height(size.y)
        .x_axis_label("Iteration k")
        .y_axis_label(measure.label())
        .legend(Legend::default().position(Corner::LeftBottom).background_alpha(0.6).follow_insertion_order(true))
        .include_x(0.0)
        .include_x(iterations.max(4) as f64)
        .allow_scroll(false)
        .link_cursor(egui::Id::unique("error plots"), [true, false])
        .grid_color(color(theme.grid))
        .y_axis_min_width(44.0)
        .x_grid_spacer(iterations_apart)
        .x_axis_formatter(|mark, _| if mark.value.fract() == 0.0 { format!("{}", mark.value) } else { String::new() })
        .label_formatter(move |position| Some(read_out(position, log)));
    plot = match log {
        true => plot.y_grid_spacer(decades).y_axis_formatter(|mark, _| from_logarithm(mark.value)),
        false => plot.include_y(0.0),
    };
    let response = plot.show(ui, |plot| {
        for run in runs {
            let many = runs.len() > 1;
            for quantity in measure.quantities().into_iter().filter(|quantity| plots.draws(quantity)) {
                let points = drawn(run.curve(metric, level, quantity.value), log);
                if points.is_empty() {
                    continue;
                }
                let ink = match many {
                    true => color(theme.curve(run.color)),
                    false => color(theme.curve(usize::from(quantity.dashed))),
                };
                // Of several runs the legend names each once: solid and broken lines are told apart above.
                let name = if many { run.name.clone() } else { quantity.name.to_owned() };
                let last = points.last().copied();
                curve(plot, name, points, ink, quantity.dashed);
                if let (true, false, Some([x, y])) = (many, quantity.dashed, last) {
                    // Lines of like colours are told apart where they end.
                    let text = RichText::new(&run.name).size(10.0).color(ink);
                    let text = Text::new("", PlotPoint::new(x, y), text);
                    plot.text(text.anchor(Align2::RIGHT_BOTTOM).allow_hover(false));
                }
            }
        }
        let mark = VLine::new("", now as f64).color(color(theme.muted)).width(1.0);
        plot.vline(mark.style(LineStyle::dotted_dense()).allow_hover(false));
    });
    name(&response.response, measure.title());
}

/// The points as drawn: their logarithms where the axis is logarithmic, zeros and what is not finite left out.
fn drawn(points: Vec<[f64; 2]>, log: bool) -> Vec<[f64; 2]> {
    let there = points.into_iter().filter(|[_, y]| y.is_finite() && (!log || *y > 0.0));
    there.map(|[x, y]| [x, if log { y.log10() } else { y }]).collect()
}

/// A line, with dots while it is short enough to tell them apart.
fn curve(plot: &mut egui_plot::PlotUi<'_>, name: String, points: Vec<[f64; 2]>, ink: Color32, dashed: bool) {
    if points.len() <= DOTTED_UP_TO {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_axis_leaves_out_what_it_cannot_show() {
        assert_eq!(drawn(vec![[0.0, 0.0], [1.0, 0.01], [2.0, f64::NAN]], true), [[1.0, -2.0]]);
    }
}
