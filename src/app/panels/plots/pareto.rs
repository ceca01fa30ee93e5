//! Run time against error for the scene as it is: which scheme, how many iterations and which levels pay.

use egui::{Align2, ComboBox, RichText, Ui};
use egui_plot::{HoverPosition, Line, LineStyle, MarkerShape, Plot, PlotPoint, PlotPoints, Points, Text};

use super::rows::{legend_row, small_row};
use crate::app::draw::axis::{decades, from_logarithm};
use crate::app::draw::ink::color;
use crate::app::panels::button::button;
use crate::app::panels::field::name;
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::command::Command;
use crate::app::session::pareto::{CHOICES, against, choice_name};
use crate::report::colour::Theme;
use crate::report::pareto_figure::{point, schemes};
use crate::scene::propagation::Policy;
use crate::scene::propagation::descent::Descent;
use crate::scene::{Preset, Propagation};
use crate::study::pareto::{Row, Treatment, front};

/// The treatments of the levels, the marks that tell them apart, and what the legend says.
const TREATMENTS: [(Treatment, MarkerShape, &str); 5] = [
    (Treatment::Uniform, MarkerShape::Circle, "⏺ finest level alone"),
    (Treatment::Octree(Policy::Same), MarkerShape::Square, "⏹ one factor for all levels"),
    (Treatment::Octree(Policy::Consistent), MarkerShape::Up, "⏶ consistent levels"),
    (Treatment::Descent, MarkerShape::Diamond, "◆ a descent, coarse levels first"),
    (Treatment::Converged, MarkerShape::Cross, "✖ fixed point, solved for"),
];

/// How near to a point a click is meant for it, in points of the screen.
const NEAR: f64 = 12.0;

/// The controls over the plot.
pub fn controls(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    let mut plots = session.settings.plots.clone();
    let choice = &mut plots.pareto;
    let combo = ComboBox::from_id_salt("pareto reference").selected_text(choice_name(*choice)).width(188.0);
    let combo = combo.show_ui(ui, |ui| {
        let has_mesh = session.document.preset.scene.is_some();
        for one in CHOICES.into_iter().filter(|one| has_mesh || !one.needs_mesh()) {
            ui.selectable_value(choice, one, choice_name(one));
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
pub fn ui(ui: &mut Ui, session: &Session, theme: &Theme, asks: &mut Asks) {
    let rows = against(session.pareto_rows(), session.settings.plots.pareto);
    if rows.is_empty() {
        let text = "Measure runs every scheme with 1 to 32 iterations on the scene of this run (the finest level \
                    alone, one factor for all levels, and consistent levels), solves for its fixed point, and \
                    what finds all light at once.";
        ui.weak(text);
        return;
    }
    let schemes = schemes(&rows);
    let named = schemes.iter().enumerate();
    legend_row(ui, named.map(|(i, scheme)| (color(theme.curve(i)), (*scheme).to_owned())));
    small_row(ui, |ui| {
        for (treatment, _, text) in TREATMENTS {
            // A descent is there where the scene asks for one.
            if treatment == Treatment::Descent && rows.iter().all(|row| row.treatment != treatment) {
                continue;
            }
            ui.small(text);
            ui.add_space(8.0);
        }
        ui.small("— what nothing beats in both");
        ui.add_space(8.0);
        ui.small("|–| from the fastest round to the slowest");
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
        for row in front(&rows) {
            let [x, y] = logged(row);
            let text = RichText::new(format!(" {}", row.setting())).size(10.0).color(color(theme.ink));
            plot.text(Text::new("", PlotPoint::new(x, y), text).anchor(Align2::LEFT_BOTTOM).allow_hover(false));
        }
        for (i, scheme) in schemes.iter().enumerate() {
            for (treatment, shape, _) in TREATMENTS {
                let is_ours = |row: &&&Row| row.scheme == *scheme && row.treatment == treatment;
                let ours = rows.iter().filter(is_ours);
                let ours: Vec<&Row> = ours.copied().collect();
                for row in &ours {
                    let ends = PlotPoints::new(bar(row).to_vec());
                    plot.line(Line::new(*scheme, ends).color(color(theme.curve(i))).width(1.0).allow_hover(false));
                }
                let points: Vec<[f64; 2]> = ours.iter().map(|row| logged(row)).collect();
                let points = Points::new(*scheme, PlotPoints::new(points)).shape(shape);
                plot.points(points.radius(3.5).color(color(theme.curve(i))));
            }
        }
        plot.pointer_coordinate().map(|at| (at, plot.transform().dpos_dvalue()))
    });
    name(&response.response, "Run time against error");
    if let (true, Some((at, scale))) = (response.response.clicked(), response.inner) {
        let away = |row: &&&Row| {
            let [x, y] = logged(row);
            ((x - at.x) * scale[0]).hypot((y - at.y) * scale[1])
        };
        let nearest = rows.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        if let Some(row) = nearest.filter(|row| away(row) < NEAR) {
            asks.ask(Ask::Preset(Box::new(loaded(&session.document.preset, row))));
            asks.ask(Ask::Say(format!("Loaded {}", describe(row).replace('\n', ": "))));
        }
    }
}

/// The two ends of a row's bar on the plot: its fastest and its slowest round.
fn bar(row: &Row) -> [[f64; 2]; 2] {
    row.spread.map(|seconds| [(1e3 * seconds).log10(), point(row)[1].log10()])
}

/// The preset with the setting of a row.
fn loaded(preset: &Preset, row: &Row) -> Preset {
    let mut preset = preset.clone();
    let snapshots = preset.propagation.snapshots;
    let descent = if row.treatment == Treatment::Descent { row.propagation.descent } else { Descent::Off };
    preset.propagation = Propagation { iterations: row.iterations, snapshots, descent, ..row.propagation.clone() };
    match row.treatment {
        Treatment::Octree(policy) => preset.propagation.levels = policy,
        Treatment::Descent => preset.coarsest = 1,
        Treatment::Uniform | Treatment::Converged => preset.coarsest = preset.size,
    }
    preset
}

/// What stands beside a point.
fn describe(row: &Row) -> String {
    let [milliseconds, error] = point(row);
    let [fastest, slowest] = row.spread.map(|seconds| 1e3 * seconds);
    let setting = format!("{}, {}", row.setting(), row.levels());
    format!("{setting}\n{milliseconds:.3} ms ({fastest:.3} to {slowest:.3}): L1 {error:.3e}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::expectation::Expectation;
    use crate::study::fit::BestFit;

    fn row(treatment: Treatment) -> Row {
        Row {
            preset: "mixed".to_owned(),
            scheme: "axial",
            propagation: Propagation {
                scheme: "axial".to_owned(),
                factor: 2.5,
                iterations: 9,
                ..Propagation::default()
            },
            treatment,
            size: 32,
            iterations: 4,
            seconds: 1e-2,
            spread: [1e-3, 1e-1],
            expectation: Expectation::Ballistic,
            l1: BestFit { raw: 0.5, fitted: 0.1, scale: 1.0 },
        }
    }

    #[test]
    fn a_click_loads_the_setting_that_its_point_names() {
        let octree = row(Treatment::Octree(Policy::Consistent));
        assert!(octree.setting().ends_with(", k = 4, p = 2.5"), "{}", octree.setting());
        let preset = loaded(&Preset { size: 32, coarsest: 1, ..Preset::default() }, &octree);
        let Propagation { scheme, factor, iterations, levels, .. } = &preset.propagation;
        assert_eq!((scheme.as_str(), *factor, *iterations, *levels), ("axial", 2.5, 4, Policy::Consistent));
        assert_eq!(preset.coarsest, 1);
        assert_eq!(loaded(&preset, &row(Treatment::Uniform)).coarsest, 32);
    }

    #[test]
    fn a_bar_reaches_from_the_fastest_round_to_the_slowest_at_its_own_error() {
        assert_eq!(bar(&row(Treatment::Uniform)), [[0.0, -1.0], [2.0, -1.0]]);
    }
}
