//! Light along a line of cells through the slice, on screen.

use egui::{DragValue, Ui};
use egui_plot::{HoverPosition, LineStyle, Plot, PlotPoint, PlotPoints, VLine};

use super::rows::legend_row;
use crate::app::draw::axis::{decades, from_logarithm, iterations_apart};
use crate::app::draw::ink::color;
use crate::app::panels::field::{self, name};
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::line::Course;
use crate::report::colour::Theme;
use crate::report::slice::Axis;

/// The controls over the plot.
pub fn controls(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let axis = session.settings.view.axis;
    let line = session.line();
    let mut plots = session.settings.plots.clone();
    let choice = &mut plots.line;
    ui.label("along");
    for (upwards, along) in [(false, axis.columns()), (true, axis.rows())] {
        let tab = ui.selectable_label(choice.upwards == upwards, Axis::name(along));
        let tab = tab.on_hover_text(format!("A line of cells along {}", Axis::name(along)));
        name(&tab, &format!("Line along {}", Axis::name(along)));
        if tab.clicked() && choice.upwards != upwards {
            (choice.upwards, choice.at) = (upwards, None);
        }
    }
    let beside = if choice.upwards { axis.columns() } else { axis.rows() };
    let mut at = line.through[beside];
    let field = DragValue::new(&mut at).range(0..=session.run.progress.side.max(1) - 1).speed(0.1);
    let field = field::add(ui, field.prefix(format!("{} = ", Axis::name(beside))));
    name(&field.clone().on_hover_text("Which line of the slice, in finest cells"), "Line at");
    if field.changed() {
        choice.at = Some(at);
    }
    let across = axis.across();
    ui.label(format!("{} = {} (the slice)", Axis::name(across), line.through[across]));
    ui.checkbox(&mut choice.log, "Log axis").on_hover_text("A logarithmic vertical axis; darkness is left out");
    asks.changed(&session.settings.plots, plots, |plots| Ask::Plots(Box::new(plots)));
}

/// The plot.
pub fn ui(ui: &mut Ui, session: &Session, theme: &Theme) {
    match session.course() {
        Some(course) => plot(ui, &course, session.settings.plots.line.log, theme),
        None if session.profiles_are_given_up() => drop(ui.weak("The light along the line could not be computed.")),
        None => drop(ui.spinner()),
    }
}

/// A course as a plot.
fn plot(ui: &mut Ui, course: &Course, log: bool, theme: &Theme) {
    let named = course.curves.iter().enumerate().filter(|(_, (_, points))| !points.is_empty());
    let named = named.map(|(i, (name, _))| (color(theme.curve(i)), (*name).to_owned()));
    let borders = (color(theme.muted), "dotted: another level is sampled, its number to the right".to_owned());
    legend_row(ui, named.chain([borders]));
    let shown = |y: f64| if log { y.log10() } else { y };
    let mut plot = Plot::new("light along a line")
        .x_axis_label(format!("Cell along {}", course.axis))
        .y_axis_label("c00 (SH coefficient)")
        .allow_scroll(false)
        .grid_color(color(theme.grid))
        .y_axis_min_width(44.0)
        .x_grid_spacer(iterations_apart)
        .label_formatter(move |position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                let c00 = if log { 10f64.powf(position.y) } else { position.y };
                Some(format!("{plot_name}\ncell {:.0}: c00 = {c00:.3e}", position.x))
            }
            HoverPosition::Elsewhere { .. } => None,
        });
    plot = match log {
        true => plot.y_grid_spacer(decades).y_axis_formatter(|mark, _| from_logarithm(mark.value)),
        false => plot.include_y(0.0),
    };
    let all = course.curves.iter().flat_map(|(_, points)| points);
    let top = shown(all.map(|[_, y]| *y).fold(0.0, f64::max));
    let response = plot.show(ui, |plot| {
        for (x, level) in &course.borders {
            let border = VLine::new("", *x).color(color(theme.muted)).width(1.0);
            plot.vline(border.style(LineStyle::dotted_dense()).allow_hover(false));
            let text = egui::RichText::new(format!(" {level}")).color(color(theme.muted)).size(10.5);
            let text = egui_plot::Text::new("", PlotPoint::new(*x, top), text);
            plot.text(text.anchor(egui::Align2::LEFT_TOP).allow_hover(false));
        }
        for (i, (name, points)) in course.curves.iter().enumerate() {
            let (width, style) = match i {
                0 => (3.0, LineStyle::dotted_dense()),
                _ => (1.6, LineStyle::Solid),
            };
            // Darkness has no logarithm: it interrupts the line.
            for run in points.split(|[_, y]| log && *y <= 0.0).filter(|run| !run.is_empty()) {
                let run: Vec<[f64; 2]> = run.iter().map(|[x, y]| [*x, shown(*y)]).collect();
                let line = egui_plot::Line::new(*name, PlotPoints::new(run)).color(color(theme.curve(i)));
                plot.line(line.width(width).style(style));
            }
        }
    });
    name(&response.response, "Light along the line");
}
