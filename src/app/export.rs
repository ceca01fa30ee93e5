//! What the window shows, as files: curves as CSV, plots and slices as SVG and PNG.

use std::error::Error;
use std::path::Path;

use super::command::Command;
use super::errors::{Group, Plots, Run};
use super::glyphs::Scales;
use super::lab::Lab;
use super::look::Shown;
use super::view::{Heat, View};
use crate::report::colour::Theme;
use crate::report::glyph::Hue;
use crate::report::picture::{Panel, Picture};
use crate::report::plot::{Curve, Dash, Figure, Mark, Plot};
use crate::report::slice::Axis;
use crate::report::{raster, table};
use crate::scene::file::write_whole;

/// The width and height of exported plots, in pixels: a column of a page at 300 dots per inch.
const PLOT_SIZE: [u32; 2] = [1200, 1000];
/// The width of exported slices, in pixels.
const SLICES_WIDTH: u32 = 1800;

/// The curves as a table, of the form of `errors.csv`; with several runs a column before it names the run.
pub fn csv(runs: &[&Run]) -> Result<String, Box<dyn Error>> {
    let mut out = csv::Writer::from_writer(Vec::new());
    let several = runs.len() > 1;
    for (i, run) in runs.iter().enumerate() {
        let mut bytes = Vec::new();
        table::errors(&run.rows).write_csv(&mut bytes)?;
        let mut rows = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes.as_slice());
        for (line, row) in rows.records().enumerate().filter(|(line, _)| i == 0 || *line > 0) {
            let name = if line == 0 { "run" } else { run.name.as_str() };
            out.write_record(several.then_some(name).into_iter().chain(row?.iter()))?;
        }
    }
    Ok(String::from_utf8(out.into_inner()?)?)
}

/// The plots as a figure for a paper: the curves that are on screen.
pub fn figure(title: &str, plots: &Plots, runs: &[&Run], seen: usize) -> Figure {
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
    let drawn = plots.groups().map(plot).collect();
    Figure { title: title.to_owned(), plots: drawn, theme: Theme::LIGHT, size: PLOT_SIZE }
}

/// The slices as a picture for a paper.
pub fn slices(title: &str, view: &View, shown: &[Shown], titles: &[String]) -> String {
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
        theme: Theme::LIGHT,
        width: SLICES_WIDTH,
    };
    picture.to_svg()
}

impl Lab {
    /// Does an export command with the file that was chosen for it.
    pub(super) fn export(&mut self, command: Command, path: &Path) {
        match self.exported(command, path).and_then(|bytes| Ok(write_whole(path, &bytes)?)) {
            Ok(()) => self.say(format!("Saved {}", path.display())),
            Err(error) => self.fail(error.to_string()),
        }
    }

    fn exported(&self, command: Command, path: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
        let runs = self.curves();
        let svg = match command {
            Command::ExportCsv => return Ok(csv(&runs)?.into_bytes()),
            Command::ExportGrids => {
                let titles: Vec<String> = self.shown.iter().map(|shown| self.title(shown)).collect();
                slices(&self.document.name(), &self.settings.view, &self.shown, &titles)
            }
            _ => figure(&self.document.name(), &self.settings.plots, &runs, self.seen()).to_svg(),
        };
        let png = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
        if png { Ok(raster::png(&svg)?) } else { Ok(svg.into_bytes()) }
    }

    /// Puts the curves on the clipboard.
    pub(super) fn copy_curves(&mut self, ctx: &egui::Context) {
        match csv(&self.curves()) {
            Ok(text) => {
                ctx.copy_text(text);
                self.say("The error curves are on the clipboard, as CSV".to_owned());
            }
            Err(error) => self.fail(error.to_string()),
        }
    }
}
