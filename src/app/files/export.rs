//! What the window shows, as files: curves as CSV, plots and slices as SVG and PNG.

use std::error::Error;
use std::path::Path;

use crate::app::draw::glyphs::Scales;
use crate::app::lab::Lab;
use crate::app::panels::errors::{Group, Plots, Run, Tab};
use crate::app::panels::pareto;
use crate::app::session::command::Command;
use crate::app::session::format::Format;
use crate::app::session::settings::Settings;
use crate::app::session::view::{Heat, View};
use crate::app::worker::look::Shown;
use crate::report::glyph::Hue;
use crate::report::picture::{Panel, Picture};
use crate::report::plot::{Curve, Dash, Figure, Mark, Plot};
use crate::report::slice::Axis;
use crate::report::{raster, table};
use crate::scene::file::write_whole;
use crate::study::error::Metric;

/// Why there is nothing to export of a line.
const NO_LINE: &str = "the light along the line is not computed yet; try again when it is shown";

/// The curves as a table, of the form of `errors.csv`; with several runs a column before it names the run, and where
/// what truly arrives is known a column after it holds the L1 ratio after the scalar that fits best.
fn csv(runs: &[&Run]) -> Result<String, Box<dyn Error>> {
    let mut out = csv::Writer::from_writer(Vec::new());
    let several = runs.len() > 1;
    let fitted = runs.iter().any(|run| !run.fits.is_empty());
    for (i, run) in runs.iter().enumerate() {
        let mut bytes = Vec::new();
        table::errors(&run.rows).write_csv(&mut bytes)?;
        let mut rows = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes.as_slice());
        for (line, row) in rows.records().enumerate().filter(|(line, _)| i == 0 || *line > 0) {
            let name = if line == 0 { "run" } else { run.name.as_str() };
            let fit = match line.checked_sub(1).map(|at| &run.rows[at]) {
                None => "l1_best_fit".to_owned(),
                Some(row) if row.metric == Metric::Ballistic => {
                    let here = |[k, _]: &&[f64; 2]| *k == row.iteration as f64;
                    run.fits.iter().find(here).map(|[_, fit]| fit.to_string()).unwrap_or_default()
                }
                Some(_) => String::new(),
            };
            let after = fitted.then_some(fit.as_str());
            out.write_record(several.then_some(name).into_iter().chain(row?.iter()).chain(after))?;
        }
    }
    Ok(String::from_utf8(out.into_inner()?)?)
}

/// The error plots as a figure for a paper: the curves that are on screen.
fn figure(title: &str, plots: &Plots, runs: &[&Run], seen: usize) -> Figure {
    let (metric, level) = (plots.metric(), plots.level());
    let level_name = level.map_or("all levels".to_owned(), |level| format!("level {level}"));
    let plot = |group: &Group| {
        let mut curves = Vec::new();
        for run in runs {
            for (i, quantity) in group.quantities.iter().enumerate().filter(|(_, quantity)| plots.draws(quantity)) {
                let several = runs.len() > 1;
                curves.push(Curve {
                    name: if several { format!("{}, {}", run.name, quantity.name) } else { quantity.name.to_owned() },
                    points: (quantity.curve)(run, metric, level),
                    color: if several { run.color } else { i },
                    dash: if quantity.dashed { Dash::Dashed } else { Dash::Solid },
                });
            }
        }
        curves.retain(|curve| !curve.points.is_empty());
        Plot {
            title: format!("{}, {metric}, {level_name}", group.title),
            x_label: "iteration k".to_owned(),
            y_label: group.axis.to_owned(),
            log_y: plots.log,
            curves,
            marks: vec![Mark { x: seen as f64, label: format!("k = {seen}") }],
        }
    };
    let drawn: Vec<Plot> = plots.groups().map(plot).collect();
    let size = plots.format.figure(drawn.len());
    Figure { title: title.to_owned(), plots: drawn, theme: plots.format.theme(), size }
}

/// The slices as a picture for a paper.
fn slices(title: &str, view: &View, shown: &[Shown], titles: &[String], format: &Format) -> String {
    let scales = Scales::of(view, shown);
    let panels = shown.iter().zip(titles);
    let panels =
        panels.map(|(shown, title)| Panel { title, slice: &shown.slice, scale: scales.scale(shown).glyph }).collect();
    let plane = view.plane();
    let subtitle = format!("{}, cut at {} = {}", view.layer.name(), Axis::name(plane.axis.across()), plane.index);
    let hue: Hue = view.hue();
    let picture = Picture {
        title,
        subtitle: &subtitle,
        panels,
        hue,
        paint: view.paint(),
        heat: view.heat == Heat::Mean,
        theme: format.theme(),
        width: format.width(),
    };
    picture.to_svg_set(format.text(), format.height().map(f64::from))
}

impl Lab {
    /// Does an export command with the file that was chosen for it.
    pub(in crate::app) fn export(&mut self, command: Command, path: &Path) {
        match self.exported(command, path).and_then(|bytes| Ok(write_whole(path, &bytes)?)) {
            Ok(()) => self.say(format!("Saved {}", path.display())),
            Err(error) => self.fail(error.to_string()),
        }
    }

    fn exported(&self, command: Command, path: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
        let svg = match command {
            Command::ExportCsv => return Ok(self.numbers()?.into_bytes()),
            Command::ExportGrids => self.grids_picture(),
            _ => self.plots_picture()?,
        };
        let png = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
        if !png {
            return Ok(svg.into_bytes());
        }
        Ok(raster::png_at(&svg, self.settings.plots.format.pixels_each())?)
    }

    /// Puts the plots' numbers, or a picture, on the clipboard.
    pub(in crate::app) fn copy(&mut self, command: Command, ctx: &egui::Context) {
        let copied = match command {
            Command::CopyCurves => self.numbers().map(|text| ctx.copy_text(text)),
            Command::CopyGrids => self.copy_picture(&self.grids_picture(), ctx),
            _ => self.plots_picture().and_then(|svg| self.copy_picture(&svg, ctx)),
        };
        let what = match command {
            Command::CopyCurves => "The plots' numbers are on the clipboard, as CSV",
            Command::CopyGrids => "The slices are on the clipboard, as a picture",
            _ => "The plots are on the clipboard, as a picture",
        };
        match copied {
            Ok(()) => self.say(what.to_owned()),
            Err(error) => self.fail(error.to_string()),
        }
    }

    fn copy_picture(&self, svg: &str, ctx: &egui::Context) -> Result<(), Box<dyn Error>> {
        let pixels = raster::pixels(svg, self.settings.plots.format.pixels_each())?;
        let size = [pixels.width() as usize, pixels.height() as usize];
        ctx.copy_image(egui::ColorImage::from_rgba_premultiplied(size, pixels.data()));
        Ok(())
    }

    /// What the plots show, as CSV.
    fn numbers(&self) -> Result<String, Box<dyn Error>> {
        let mut bytes = Vec::new();
        match self.settings.plots.tab {
            Tab::Errors => return csv(&self.curves()),
            Tab::Line => self.course().ok_or(NO_LINE)?.table().write_csv(&mut bytes)?,
            Tab::Pareto => {
                let rows: Vec<_> = self.pareto_rows().iter().collect();
                table::pareto(&rows).write_csv(&mut bytes)?;
            }
        }
        Ok(String::from_utf8(bytes)?)
    }

    /// The plots as SVG.
    fn plots_picture(&self) -> Result<String, Box<dyn Error>> {
        let (title, plots) = (self.document.name(), &self.settings.plots);
        let figure = match plots.tab {
            Tab::Errors => figure(&title, plots, &self.curves(), self.seen()),
            Tab::Line => self.course().ok_or(NO_LINE)?.figure(&title, plots.line.log, &plots.format),
            Tab::Pareto => {
                let rows = pareto::against(self.pareto_rows(), plots.pareto);
                pareto::figure(&title, &rows, plots.pareto, &plots.format)
            }
        };
        Ok(figure.to_svg_set(plots.format.text()))
    }

    /// The slices as SVG.
    fn grids_picture(&self) -> String {
        let titles: Vec<String> = self.shown.iter().map(|shown| self.title(shown)).collect();
        let Settings { view, plots, .. } = &self.settings;
        slices(&self.document.name(), view, &self.shown, &titles, &plots.format)
    }
}
