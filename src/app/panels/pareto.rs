//! Run time against error for the scene as it is: which scheme, how many iterations and which levels pay.

use std::sync::Arc;

use egui::{Context, Ui};
use egui_plot::{HoverPosition, Line, LineStyle, MarkerShape, Plot, PlotPoints, Points};
use serde::{Deserialize, Serialize};

use crate::app::draw::axis::{decades, from_logarithm};
use crate::app::draw::ink::color;
use crate::app::lab::Lab;
use crate::app::panels::controls::name;
use crate::app::panels::plots::{legend_row, small_row};
use crate::app::panels::toolbar;
use crate::app::session::command::Command;
use crate::app::session::errand::Errand;
use crate::app::session::format::Format;
use crate::report::colour::Theme;
use crate::report::plot::{Curve, Dash, Figure, Plot as PaperPlot};
use crate::scene::Problem;
use crate::study::pareto::{Row, front, measure, measure_against};
use crate::transport;
use crate::transport::ballistic::Ballistic;

/// Rounds over all ways; medians are shown.
const ROUNDS: usize = 3;
/// The ways to treat levels, and the marks that tell them apart.
const LEVELS: [(&str, MarkerShape, &str); 4] = [
    ("uniform", MarkerShape::Circle, "⏺ finest level alone"),
    ("same", MarkerShape::Square, "⏹ one factor for all levels"),
    ("consistent", MarkerShape::Up, "⏶ consistent levels"),
    ("converged", MarkerShape::Cross, "✖ fixed point, solved for"),
];

/// What run time is set against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ParetoChoice {
    /// What truly arrives, after the scalar that fits best: what a scheme costs.
    #[default]
    Ballistic,
    /// The fixed point of the scheme's own uniform volume: what the octree and stopping early cost.
    Uniform,
}

impl ParetoChoice {
    fn reference(self) -> &'static str {
        match self {
            ParetoChoice::Ballistic => "ballistic",
            ParetoChoice::Uniform => "uniform",
        }
    }

    fn name(self) -> &'static str {
        match self {
            ParetoChoice::Ballistic => "Against what truly arrives",
            ParetoChoice::Uniform => "Against the uniform fixed point",
        }
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

/// Whether a row is of the propagator called `name`, whatever it adds of its settings.
fn is_of(row: &Row, name: &str) -> bool {
    row.scheme.split('-').next() == Some(name)
}

/// The rows against one reference that have a place in the plot: light that diverged has none.
pub fn against(rows: &[Row], choice: ParetoChoice) -> Vec<&Row> {
    let shown = |row: &&Row| point(row).iter().all(|part| part.is_finite() && *part > 0.0);
    rows.iter().filter(|row| row.reference == choice.reference()).filter(shown).collect()
}

/// Where a row stands: its time in milliseconds, and its error.
fn point(row: &Row) -> [f64; 2] {
    [row.seconds * 1e3, row.l1.fitted]
}

/// For a paper: a plot for each way to treat levels, each with what nothing beats among all.
pub fn figure(title: &str, rows: &[&Row], choice: ParetoChoice, format: &Format) -> Figure {
    let logged = |row: &Row| [point(row)[0].log10(), point(row)[1]];
    let schemes = transport::names();
    let plots = LEVELS.map(|(levels, ..)| {
        let mut curves: Vec<Curve> = Vec::new();
        for (color, scheme) in schemes.iter().enumerate() {
            let ours = rows.iter().filter(|row| row.levels == levels && is_of(row, scheme));
            let points = ours.map(|row| logged(row)).collect();
            curves.push(Curve { name: (*scheme).to_owned(), points, color, dash: Dash::Points });
        }
        let points = front(rows).into_iter().map(logged).collect();
        let name = "what nothing beats".to_owned();
        curves.push(Curve { name, points, color: schemes.len(), dash: Dash::Dotted });
        PaperPlot {
            title: format!("Levels: {levels}; against {}", choice.reference()),
            x_label: "log₁₀ of the time in ms".to_owned(),
            y_label: "L1 error, best fit".to_owned(),
            log_y: true,
            curves,
            marks: Vec::new(),
        }
    });
    let size = format.figure(plots.len());
    Figure { title: title.to_owned(), plots: plots.to_vec(), theme: format.theme(), size }
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
        let combo = egui::ComboBox::from_id_salt("pareto reference").selected_text(choice.name()).width(188.0);
        let combo = combo.show_ui(ui, |ui| {
            for one in [ParetoChoice::Ballistic, ParetoChoice::Uniform] {
                ui.selectable_value(choice, one, one.name());
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
        let schemes = transport::names().into_iter().enumerate();
        legend_row(ui, schemes.map(|(i, scheme)| (color(theme.curve(i)), scheme.to_owned())));
        small_row(ui, |ui| {
            for (_, _, text) in LEVELS {
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
                for (levels, shape, _) in LEVELS {
                    let ours = rows.iter().filter(|row| is_of(row, scheme) && row.levels == levels);
                    let points: Vec<[f64; 2]> = ours.map(|row| logged(row)).collect();
                    let points = Points::new(scheme, PlotPoints::new(points)).shape(shape);
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
    format!("{}, k = {}, {}\n{milliseconds:.3} ms: L1 {error:.3e}", row.scheme, row.iterations, row.levels)
}
