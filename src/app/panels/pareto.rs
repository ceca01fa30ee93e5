//! Run time against error for the scene as it is: which scheme, how many iterations and which levels pay.

use std::sync::Arc;

use egui::{Context, Ui};
use egui_plot::{HoverPosition, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points};

use crate::app::draw::axis::{decades, from_logarithm};
use crate::app::draw::ink::color;
use crate::app::lab::Lab;
use crate::app::panels::controls::name;
use crate::app::panels::plots::{legend_row, small_row};
use crate::app::panels::toolbar;
use crate::app::session::command::Command;
use crate::app::session::errand::Errand;
use crate::report::colour::Theme;
use crate::report::pareto_figure::{point, propagator_name, schemes};
use crate::scene::Problem;
use crate::scene::propagation::Policy;
use crate::study::expectation::Expectation;
use crate::study::pareto::{Row, Treatment, front, measure, measure_against};
use crate::transport::ballistic::Ballistic;

/// Rounds over all ways; medians are shown.
const ROUNDS: usize = 3;
/// The treatments of the levels, the marks that tell them apart, and what the legend says.
const TREATMENTS: [(Treatment, MarkerShape, &str); 4] = [
    (Treatment::Uniform, MarkerShape::Circle, "⏺ finest level alone"),
    (Treatment::Octree(Policy::Same), MarkerShape::Square, "⏹ one factor for all levels"),
    (Treatment::Octree(Policy::Consistent), MarkerShape::Up, "⏶ consistent levels"),
    (Treatment::Converged, MarkerShape::Cross, "✖ fixed point, solved for"),
];

/// What the choice of an expectation says.
fn choice_name(expectation: Expectation) -> &'static str {
    match expectation {
        Expectation::Ballistic => "Against what truly arrives",
        _ => "Against the uniform fixed point",
    }
}

/// What was measured.
#[derive(Debug, Default)]
pub struct Pareto {
    of: Option<Arc<Problem>>,
    rows: Vec<Row>,
    underway: Option<Errand<Vec<Row>>>,
}

impl Pareto {
    /// Whether it is being measured.
    pub fn is_underway(&self) -> bool {
        self.underway.is_some()
    }
}

/// Measures a scene on a thread of its own.
fn start(
    problem: Arc<Problem>,
    title: String,
    known: Option<Arc<Ballistic>>,
    ctx: &Context,
) -> std::io::Result<Errand<Vec<Row>>> {
    Errand::start("run time against error", ctx, move |watch| {
        let go_on = |share| watch.go_on(share);
        let rows = match known {
            Some(truth) => measure_against(&title, &problem, &truth, ROUNDS, &go_on),
            None => measure(&title, &problem, ROUNDS, &go_on),
        };
        let rows = rows.map_err(|error| error.to_string())?;
        rows.ok_or_else(|| "the measurement was called off".to_owned())
    })
}

/// The rows against one expectation that have a place in the plot: light that diverged has none.
pub fn against(rows: &[Row], expectation: Expectation) -> Vec<&Row> {
    let shown = |row: &&Row| point(row).iter().all(|part| part.is_finite() && *part > 0.0);
    rows.iter().filter(|row| row.expectation == expectation).filter(shown).collect()
}

impl Lab {
    /// What was measured last.
    pub fn pareto_rows(&self) -> &[Row] {
        &self.pareto.rows
    }

    /// Starts to measure the scene that runs.
    pub(in crate::app) fn measure_pareto(&mut self, ctx: &Context) {
        let Some(problem) = self.problem.clone() else { return };
        let known = self.truth.known().filter(|truth| truth.is_of(&problem)).cloned();
        match start(Arc::clone(&problem), self.document.name(), known, ctx) {
            Ok(errand) => self.pareto = Pareto { of: Some(problem), rows: Vec::new(), underway: Some(errand) },
            Err(error) => self.fail(format!("no thread to measure on: {error}")),
        }
    }

    /// Takes in what was measured.
    pub(in crate::app) fn hear_pareto(&mut self, ctx: &Context) {
        let Some(errand) = &self.pareto.underway else { return };
        match errand.answer() {
            None => return ctx.request_repaint_after_secs(0.1),
            Some(Ok(rows)) => self.pareto.rows = rows,
            Some(Err(line)) => self.fail(line),
        }
        self.pareto.underway = None;
    }

    pub(in crate::app) fn pareto_controls(&mut self, ui: &mut Ui) {
        let choice = &mut self.settings.plots.pareto;
        let combo = egui::ComboBox::from_id_salt("pareto reference").selected_text(choice_name(*choice)).width(188.0);
        let combo = combo.show_ui(ui, |ui| {
            for one in [Expectation::Ballistic, Expectation::Merged] {
                ui.selectable_value(choice, one, choice_name(one));
            }
        });
        name(&combo.response.on_hover_text("What errors are against"), "Error against");
        match &self.pareto.underway {
            Some(errand) => {
                let bar = egui::ProgressBar::new(errand.share() as f32).desired_width(120.0).show_percentage();
                name(&ui.add(bar), "Progress of the measurement");
                let cancel = ui.button("Cancel");
                name(&cancel, "Cancel the measurement");
                if cancel.clicked() {
                    self.pareto.underway = None;
                }
            }
            None => toolbar::button(self, ui, Command::Measure),
        }
        let other = self.pareto.of.as_ref().zip(self.problem.as_ref()).is_some_and(|(of, now)| !Arc::ptr_eq(of, now));
        if other && !self.pareto.rows.is_empty() {
            ui.colored_label(ui.visuals().warn_fg_color, "of an earlier run");
        }
    }

    pub(in crate::app) fn pareto_plot(&mut self, ui: &mut Ui, theme: &Theme) {
        let rows = against(&self.pareto.rows, self.settings.plots.pareto);
        if rows.is_empty() {
            let text = "Measure runs every scheme with 1 to 32 iterations on the scene of this run (the finest level \
                        alone, one factor for all levels, and consistent levels), solves for its fixed point, and \
                        sweeps with 24 to 200 ordinates.";
            ui.weak(text);
            return;
        }
        let schemes = schemes(&rows);
        let named = schemes.iter().enumerate();
        legend_row(ui, named.map(|(i, scheme)| (color(theme.curve(i)), (*scheme).to_owned())));
        small_row(ui, |ui| {
            for (_, _, sign) in TREATMENTS {
                ui.small(sign);
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
            for (i, scheme) in schemes.iter().enumerate() {
                for (treatment, shape, _) in TREATMENTS {
                    let is_ours = |row: &&&Row| row.propagator.scheme == *scheme && row.treatment == treatment;
                    let ours = rows.iter().filter(is_ours);
                    let points: Vec<[f64; 2]> = ours.map(|row| logged(row)).collect();
                    let points = Points::new(*scheme, PlotPoints::new(points)).shape(shape);
                    plot.points(points.radius(3.5).color(color(theme.curve(i))));
                }
            }
        });
        name(&response.response, "Run time against error");
    }
}

/// What stands beside a point.
fn describe(row: &Row) -> String {
    let [milliseconds, error] = point(row);
    let name = propagator_name(&row.propagator);
    format!("{name}, k = {}, {}\n{milliseconds:.3} ms: L1 {error:.3e}", row.iterations, row.treatment.name())
}
