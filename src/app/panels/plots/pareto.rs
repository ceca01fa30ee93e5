//! Run time against error for the scene as it is: which scheme, how many iterations and which levels pay.

use egui::{ComboBox, Ui};
use egui_plot::{HoverPosition, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points};

use super::rows::{legend_row, small_row};
use crate::app::draw::axis::{decades, from_logarithm};
use crate::app::draw::ink::color;
use crate::app::panels::button::button;
use crate::app::panels::field::name;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::command::Command;
use crate::app::session::pareto::{LEVELS, ParetoChoice, against, is_of, point};
use crate::report::colour::Theme;
use crate::study::pareto::{Row, front};
use crate::transport;

/// The marks that tell the ways to treat levels apart.
const MARKS: [(MarkerShape, &str); 4] = [
    (MarkerShape::Circle, "⏺ finest level alone"),
    (MarkerShape::Square, "⏹ one factor for all levels"),
    (MarkerShape::Up, "⏶ consistent levels"),
    (MarkerShape::Cross, "✖ fixed point, solved for"),
];

/// The controls over the plot.
pub fn controls(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let mut plots = session.settings.plots.clone();
    let choice = &mut plots.pareto;
    let combo = ComboBox::from_id_salt("pareto reference").selected_text(choice.name()).width(188.0);
    let combo = combo.show_ui(ui, |ui| {
        for one in ParetoChoice::ALL {
            ui.selectable_value(choice, one, one.name());
        }
    });
    name(&combo.response.on_hover_text("What errors are against"), "Error against");
    asks.changed(&session.settings.plots, plots, |plots| Ask::Plots(Box::new(plots)));
    match session.asides.pareto.share() {
        Some(share) => {
            let bar = egui::ProgressBar::new(share as f32).desired_width(120.0).show_percentage();
            name(&ui.add(bar), "Progress of the measurement");
            let cancel = ui.button("Cancel");
            name(&cancel, "Cancel the measurement");
            if cancel.clicked() {
                asks.ask(Ask::CancelMeasurement);
            }
        }
        None => button(ui, session, Command::Measure, asks),
    }
    if session.pareto_is_old() && !session.pareto_rows().is_empty() {
        ui.colored_label(ui.visuals().warn_fg_color, "of an earlier run");
    }
}

/// The plot.
pub fn ui(ui: &mut Ui, session: &Session, theme: &Theme) {
    let rows = against(session.pareto_rows(), session.settings.plots.pareto);
    if rows.is_empty() {
        let text = "Measure runs every scheme with 1 to 32 iterations on the scene of this run (the finest level \
                    alone, one factor for all levels, and consistent levels), solves for its fixed point, and \
                    sweeps with 24 to 200 ordinates.";
        ui.weak(text);
        return;
    }
    let schemes = transport::names().into_iter().enumerate();
    legend_row(ui, schemes.map(|(i, scheme)| (color(theme.curve(i)), scheme.to_owned())));
    small_row(ui, |ui| {
        for (_, text) in MARKS {
            ui.small(text);
            ui.add_space(8.0);
        }
        ui.small("— what nothing beats in both");
    });
    let logged = |row: &Row| point(row).map(f64::log10);
    let names: Vec<([f64; 2], String)> = rows.iter().map(|row| (logged(row), describe(row))).collect();
    let plot = Plot::new("run time against error")
        .x_axis_label("Run time (ms)")
        .y_axis_label("L1 error, best fit")
        .allow_scroll(false)
        .grid_color(color(theme.grid))
        .y_axis_min_width(44.0)
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .x_axis_formatter(|mark, _| from_logarithm(mark.value))
        .y_axis_formatter(|mark, _| from_logarithm(mark.value))
        .label_formatter(move |position| {
            let HoverPosition::NearDataPoint { position, .. } = position else { return None };
            let here = |at: &[f64; 2]| *at == [position.x, position.y];
            names.iter().find(|(at, _)| here(at)).map(|(_, name)| name.clone())
        });
    let response = plot.show(ui, |plot| {
        let beaten: Vec<[f64; 2]> = front(&rows).into_iter().map(logged).collect();
        let line = Line::new("what nothing beats", PlotPoints::new(beaten)).color(color(theme.ink)).width(1.2);
        plot.line(line.style(LineStyle::Solid).allow_hover(false));
        for (i, scheme) in transport::names().into_iter().enumerate() {
            for (levels, (shape, _)) in LEVELS.into_iter().zip(MARKS) {
                let ours = rows.iter().filter(|row| is_of(row, scheme) && row.levels == levels);
                let points: Vec<[f64; 2]> = ours.map(|row| logged(row)).collect();
                let points = Points::new(scheme, PlotPoints::new(points)).shape(shape);
                plot.points(points.radius(3.5).color(color(theme.curve(i))));
            }
        }
    });
    name(&response.response, "Run time against error");
}

/// What stands beside a point.
fn describe(row: &Row) -> String {
    let [milliseconds, error] = point(row);
    format!("{}, k = {}, {}\n{milliseconds:.3} ms: L1 {error:.3e}", row.scheme, row.iterations, row.levels)
}
