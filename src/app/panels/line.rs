//! Light along a line of cells through the slice: where the merged light jumps from level to level, with one
//! factor for all levels and with levels that agree, beside the uniform volume (000, figure 14).

use std::sync::Arc;

use egui::{Context, DragValue, Ui};
use egui_plot::{HoverPosition, LineStyle, Plot, PlotPoint, PlotPoints, VLine};
use serde::{Deserialize, Serialize};

use crate::app::draw::axis::{decades, from_logarithm, iterations_apart};
use crate::app::draw::ink::color;
use crate::app::lab::Lab;
use crate::app::panels::controls::name;
use crate::app::panels::errors::Tab;
use crate::app::panels::plots::legend_row;
use crate::app::session::errand::Errand;
use crate::app::session::format::Format;
use crate::report::colour::Theme;
use crate::report::glyph::Hue;
use crate::report::plot::{Curve, Dash, Figure, Mark, Plot as PaperPlot};
use crate::report::slice::Axis;
use crate::report::table::{Table, Value};
use crate::scene::Problem;
use crate::scene::propagation::Policy;
use crate::study::profile::{Line, Policies};

/// Which line of cells is drawn, and how.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LineChoice {
    /// Whether it runs up the slice, in place of across it.
    pub upwards: bool,
    /// Its row or column in the slice; where most light is injected if none was chosen.
    pub at: Option<usize>,
    /// Whether the vertical axis is logarithmic.
    pub log: bool,
}

impl Default for LineChoice {
    fn default() -> Self {
        LineChoice { upwards: false, at: None, log: true }
    }
}

/// The scene under each policy, as far as it is computed.
#[derive(Debug, Default)]
pub struct Profiles {
    of: Option<Arc<Problem>>,
    /// With the iteration that was asked for; light that diverges ends before it.
    known: Option<(usize, Arc<Policies>)>,
    underway: Option<(usize, Errand<Policies>)>,
    given_up: bool,
}

impl Profiles {
    /// Whether they are being computed.
    pub fn is_underway(&self) -> bool {
        self.underway.is_some()
    }

    /// Has them computed for `iteration`, going on from what is known where it can.
    fn seek(&mut self, problem: &Arc<Problem>, iteration: usize, ctx: &Context) -> std::io::Result<()> {
        if !self.of.as_ref().is_some_and(|of| Arc::ptr_eq(of, problem)) {
            *self = Profiles { of: Some(Arc::clone(problem)), ..Profiles::default() };
        }
        let known = self.known.as_ref().map(|(asked, _)| *asked);
        if self.underway.is_some() || self.given_up || known == Some(iteration) {
            return Ok(());
        }
        let start = self.known.as_ref().filter(|(asked, _)| *asked < iteration).map(|(_, known)| Arc::clone(known));
        let problem = Arc::clone(problem);
        let errand = Errand::start("line of cells", ctx, move |watch| {
            let mut policies = match start {
                Some(start) => Arc::unwrap_or_clone(start),
                None => Policies::new(&problem).map_err(|error| error.to_string())?,
            };
            policies.advance(iteration, |k| watch.go_on(k as f64 / iteration.max(1) as f64));
            Ok(policies)
        })?;
        self.underway = Some((iteration, errand));
        Ok(())
    }
}

/// What is drawn of a line of cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// What it is and where.
    pub title: String,
    /// The axis that it runs along.
    pub axis: &'static str,
    /// (cell, c00) of the uniform volume, and of the merged light under each policy, with their names.
    pub curves: Vec<(&'static str, Vec<[f64; 2]>)>,
    /// Where the sampled level changes, and to which.
    pub borders: Vec<(f64, usize)>,
}

impl Course {
    fn new(policies: &Policies, line: Line, hue: Hue) -> Self {
        let points = |light: Vec<[crate::sh::Sh<f32>; 3]>| -> Vec<[f64; 2]> {
            light.into_iter().enumerate().map(|(i, rgb)| [i as f64, f64::from(hue.of(rgb).0[0])]).collect()
        };
        let mut curves = vec![("uniform volume", points(policies.uniform(line)))];
        for policy in Policy::ALL {
            let name = match policy {
                Policy::Same => "merged, one factor for all levels",
                Policy::Consistent => "merged, consistent levels",
                Policy::Exact => "merged, exact levels",
            };
            curves.push((name, points(policies.merged(policy, line))));
        }
        let levels = policies.levels(line);
        let changes = levels.windows(2).enumerate().filter(|(_, pair)| pair[0] != pair[1]);
        let borders = changes.map(|(i, pair)| (i as f64 + 0.5, pair[1])).collect();
        let beside = (0..3).filter(|axis| *axis != line.along);
        let beside: Vec<String> = beside.map(|axis| format!("{} = {}", Axis::name(axis), line.through[axis])).collect();
        let axis = Axis::name(line.along);
        let title = format!("Light along {axis}, {}, k = {}", beside.join(", "), policies.iteration());
        Course { title, axis, curves, borders }
    }

    /// For a paper.
    pub fn figure(&self, title: &str, log: bool, format: &Format) -> Figure {
        let curve = |(i, (name, points)): (usize, &(&'static str, Vec<[f64; 2]>))| Curve {
            name: (*name).to_owned(),
            points: points.clone(),
            color: i,
            dash: if i == 0 { Dash::Dotted } else { Dash::Solid },
        };
        let mark = |(x, level): &(f64, usize)| Mark { x: *x, label: level.to_string() };
        let plot = PaperPlot {
            title: format!("{}; levels above", self.title),
            x_label: format!("cell along {}", self.axis),
            y_label: "c00, SH coefficient".to_owned(),
            log_y: log,
            curves: self.curves.iter().enumerate().filter(|(_, (_, points))| !points.is_empty()).map(curve).collect(),
            marks: self.borders.iter().map(mark).collect(),
        };
        Figure { title: title.to_owned(), plots: vec![plot], theme: format.theme(), size: format.figure(1) }
    }

    /// As a table: a row for each cell.
    pub fn table(&self) -> Table<4> {
        let mut table = Table::new(["cell", "uniform", "same", "consistent"]);
        for (i, [_, uniform]) in self.curves[0].1.iter().enumerate() {
            let light = |curve: usize| {
                let point = self.curves.get(curve).and_then(|(_, points)| points.get(i));
                point.map_or(Value::Text(String::new()), |[_, c00]| Value::Number(*c00))
            };
            table.push([i.into(), Value::Number(*uniform), light(1), light(2)]);
        }
        table
    }

    fn ui(&self, ui: &mut Ui, log: bool, theme: &Theme) {
        let named = self.curves.iter().enumerate().filter(|(_, (_, points))| !points.is_empty());
        let named = named.map(|(i, (name, _))| (color(theme.curve(i)), (*name).to_owned()));
        let borders = (color(theme.muted), "dotted: another level is sampled, its number to the right".to_owned());
        legend_row(ui, named.chain([borders]));
        let shown = |y: f64| if log { y.log10() } else { y };
        let mut plot = Plot::new("light along a line")
            .x_axis_label(format!("Cell along {}", self.axis))
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
        let all = self.curves.iter().flat_map(|(_, points)| points);
        let top = shown(all.map(|[_, y]| *y).fold(0.0, f64::max));
        let response = plot.show(ui, |plot| {
            for (x, level) in &self.borders {
                let border = VLine::new("", *x).color(color(theme.muted)).width(1.0);
                plot.vline(border.style(LineStyle::dotted_dense()).allow_hover(false));
                let text = egui::RichText::new(format!(" {level}")).color(color(theme.muted)).size(10.5);
                let text = egui_plot::Text::new("", PlotPoint::new(*x, top), text);
                plot.text(text.anchor(egui::Align2::LEFT_TOP).allow_hover(false));
            }
            for (i, (name, points)) in self.curves.iter().enumerate() {
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
}

impl Lab {
    /// Has the light along the line computed while it is looked at.
    pub(in crate::app) fn seek_profiles(&mut self, ctx: &Context) {
        if self.settings.plots.tab != Tab::Line {
            self.profiles.underway = None;
            return;
        }
        let seen = self.seen();
        if let Some(problem) = &self.problem
            && let Err(error) = self.profiles.seek(problem, seen, ctx)
        {
            self.profiles.given_up = true;
            self.fail(format!("no thread for the line of cells: {error}"));
        }
        let Some((asked, errand)) = &self.profiles.underway else { return };
        match errand.answer() {
            None => return ctx.request_repaint_after_secs(0.1),
            Some(Ok(policies)) => self.profiles.known = Some((*asked, Arc::new(policies))),
            Some(Err(line)) => {
                self.profiles.given_up = true;
                self.fail(line);
            }
        }
        self.profiles.underway = None;
    }

    /// The line of cells that is chosen.
    pub fn line(&self) -> Line {
        let LineChoice { upwards, at, .. } = self.settings.plots.line;
        let plane = self.settings.view.plane();
        let (along, beside) = match upwards {
            false => (plane.axis.columns(), plane.axis.rows()),
            true => (plane.axis.rows(), plane.axis.columns()),
        };
        let last = self.progress.side.max(1) - 1;
        let mut through = self.progress.brightest.map(|c| c.min(last));
        through[plane.axis.across()] = plane.index.min(last);
        through[beside] = at.unwrap_or(through[beside]).min(last);
        Line { along, through }
    }

    /// The light along it, once it is computed.
    pub fn course(&self) -> Option<Course> {
        let (_, policies) = self.profiles.known.as_ref()?;
        Some(Course::new(policies, self.line(), self.settings.view.hue()))
    }

    pub(in crate::app) fn line_controls(&mut self, ui: &mut Ui) {
        let axis = self.settings.view.axis();
        let line = self.line();
        let choice = &mut self.settings.plots.line;
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
        let field = DragValue::new(&mut at).range(0..=self.progress.side.max(1) - 1).speed(0.1);
        let field = ui.add(field.prefix(format!("{} = ", Axis::name(beside))));
        name(&field.clone().on_hover_text("Which line of the slice, in finest cells"), "Line at");
        if field.changed() {
            choice.at = Some(at);
        }
        let across = axis.across();
        ui.label(format!("{} = {} (the slice)", Axis::name(across), line.through[across]));
        ui.checkbox(&mut choice.log, "Log axis").on_hover_text("A logarithmic vertical axis; darkness is left out");
    }

    pub(in crate::app) fn line_plot(&mut self, ui: &mut Ui, theme: &Theme) {
        match self.course() {
            Some(course) => course.ui(ui, self.settings.plots.line.log, theme),
            None if self.profiles.given_up => drop(ui.weak("The light along the line could not be computed.")),
            None => drop(ui.spinner()),
        }
    }
}
