//! What the window shows, as files: curves as CSV, plots and slices as SVG and PNG.

use std::error::Error;
use std::path::Path;

use crate::app::draw::scales::Scales;
use crate::app::session::Session;
use crate::app::session::command::Command;
use crate::app::session::curves::Curves;
use crate::app::session::format::Format;
use crate::app::session::pareto;
use crate::app::session::plots::{Plots, Tab};
use crate::app::session::view::{Heat, View};
use crate::app::worker::look::Shown;
use crate::report::error_figure::{ErrorFigure, Measure, Series};
use crate::report::picture::{Panel, Picture};
use crate::report::plot::Figure;
use crate::report::slice::Axis;
use crate::report::{pareto_figure, raster, table};
use crate::scene::file::write_whole;

/// Why there is nothing to export of a line.
const NO_LINE: &str = "the light along the line is not computed yet; try again when it is shown";

/// The curves as a table, of the form of `errors.csv`; with several runs a column before it names the run, and where
/// what truly arrives is known a column after it holds the L1 ratio after the scalar that fits best.
fn csv(runs: &[&Curves]) -> Result<String, Box<dyn Error>> {
    let mut out = csv::Writer::from_writer(Vec::new());
    let several = runs.len() > 1;
    let fitted = runs.iter().flat_map(|run| &run.rows).any(|row| row.l1_best_fit.is_some());
    for (i, run) in runs.iter().enumerate() {
        let mut bytes = Vec::new();
        table::errors(&run.rows, &[]).write_csv(&mut bytes)?;
        let mut rows = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes.as_slice());
        for (line, row) in rows.records().enumerate().filter(|(line, _)| i == 0 || *line > 0) {
            let name = if line == 0 { "run" } else { run.name.as_str() };
            let fit = match line.checked_sub(1).map(|at| &run.rows[at]) {
                None => "l1_best_fit".to_owned(),
                Some(row) => row.l1_best_fit.map(|fit| fit.to_string()).unwrap_or_default(),
            };
            let after = fitted.then_some(fit.as_str());
            out.write_record(several.then_some(name).into_iter().chain(row?.iter()).chain(after))?;
        }
    }
    Ok(String::from_utf8(out.into_inner()?)?)
}

/// The error plots as a figure for a paper: the curves that are on screen.
fn figure(title: &str, plots: &Plots, runs: &[&Curves], seen: usize, format: &Format) -> Figure {
    let (expectation, level) = (plots.metric, plots.level());
    let series = runs.iter().map(|run| {
        let rows = run.rows.iter().filter(|row| row.expectation == expectation && row.level == level);
        Series { name: run.name.clone(), rows: rows.copied().collect(), color: run.color }
    });
    let measures: Vec<Measure> = plots.measures().collect();
    let figure = ErrorFigure {
        title,
        series: &series.collect::<Vec<_>>(),
        measures: &measures,
        means: plots.average,
        largest: plots.maximum,
        log: plots.log,
        current: Some(seen),
        theme: format.theme(),
        size: format.figure(measures.len()),
    };
    figure.figure()
}

/// The slices as a picture for a paper.
fn slices(title: &str, view: &View, shown: &[Shown], titles: &[String], format: &Format) -> String {
    let scales = Scales::of(view, shown);
    let panels = shown.iter().zip(titles);
    let panels =
        panels.map(|(shown, title)| Panel { title, slice: &shown.slice, scale: scales.scale(shown).glyph }).collect();
    let plane = view.plane();
    let subtitle = format!("{}, cut at {} = {}", view.layer.name(), Axis::name(plane.axis.across()), plane.index);
    let picture = Picture {
        title,
        subtitle: &subtitle,
        panels,
        hue: view.hue,
        paint: scales.paint(view),
        heat: view.heat == Heat::Mean,
        theme: format.theme(),
        width: format.width(),
    };
    picture.to_svg_set(format.text(), format.height().map(f64::from))
}

/// Does an export command with the file that was chosen for it.
pub fn save(session: &Session, command: Command, path: &Path) -> Result<(), Box<dyn Error>> {
    Ok(write_whole(path, &exported(session, command, path)?)?)
}

fn exported(session: &Session, command: Command, path: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
    if command == Command::ExportCsv {
        return Ok(numbers(session)?.into_bytes());
    }
    let svg = picture(session, command, &session.settings.plots.format)?;
    let png = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    if !png {
        return Ok(svg.into_bytes());
    }
    Ok(raster::png_at(&svg, session.settings.plots.format.pixels_each())?)
}

/// The picture that an export command makes, as SVG; of an animation the picture that is seen.
pub fn picture(session: &Session, command: Command, format: &Format) -> Result<String, Box<dyn Error>> {
    match command {
        Command::ExportSvg | Command::ExportPng => plots_picture(session, format),
        _ => Ok(grids_picture(session, format)),
    }
}

/// Puts the plots' numbers, or a picture, on the clipboard; says what was done.
pub fn copy(session: &Session, command: Command, ctx: &egui::Context) -> Result<&'static str, Box<dyn Error>> {
    match command {
        Command::CopyCurves => {
            ctx.copy_text(numbers(session)?);
            Ok("The plots' numbers are on the clipboard, as CSV")
        }
        Command::CopyGrids => {
            copy_picture(session, &grids_picture(session, &session.settings.plots.format), ctx)?;
            Ok("The slices are on the clipboard, as a picture")
        }
        _ => {
            copy_picture(session, &plots_picture(session, &session.settings.plots.format)?, ctx)?;
            Ok("The plots are on the clipboard, as a picture")
        }
    }
}

fn copy_picture(session: &Session, svg: &str, ctx: &egui::Context) -> Result<(), Box<dyn Error>> {
    let pixels = raster::pixels(svg, session.settings.plots.format.pixels_each())?;
    let size = [pixels.width() as usize, pixels.height() as usize];
    ctx.copy_image(egui::ColorImage::from_rgba_premultiplied(size, pixels.data()));
    Ok(())
}

/// What the plots show, as CSV.
fn numbers(session: &Session) -> Result<String, Box<dyn Error>> {
    let mut bytes = Vec::new();
    match session.settings.plots.tab {
        Tab::Errors => return csv(&session.run.all_curves()),
        Tab::Line => session.course().ok_or(NO_LINE)?.table().write_csv(&mut bytes)?,
        Tab::Pareto => {
            let rows: Vec<_> = session.pareto_rows().iter().collect();
            table::pareto(&rows).write_csv(&mut bytes)?;
        }
    }
    Ok(String::from_utf8(bytes)?)
}

/// The plots as SVG.
fn plots_picture(session: &Session, format: &Format) -> Result<String, Box<dyn Error>> {
    let (title, plots) = (session.document.name(), &session.plots());
    let figure = match plots.tab {
        Tab::Errors => figure(&title, plots, &session.run.all_curves(), session.seen(), format),
        Tab::Line => session.course().ok_or(NO_LINE)?.figure(&title, plots.line.log, format),
        Tab::Pareto => {
            let rows = pareto::against(session.pareto_rows(), plots.pareto);
            pareto_figure::figure(&title, &rows, format.theme(), |count| format.figure(count))
        }
    };
    Ok(figure.to_svg_set(format.text()))
}

/// The slices as SVG.
pub fn grids_picture(session: &Session, format: &Format) -> String {
    slices(&session.document.name(), &session.settings.view, &session.sight.shown, &session.titles(), format)
}
