//! `motion`: moving light frame by frame, with its flicker, pictures and an animation.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::console::{remark, say};
use super::output::Folder;
use super::{CliError, SceneArgs};
use crate::field::{Cell, Channels, Grid};
use crate::report::apng;
use crate::report::colour::{Paint, Theme};
use crate::report::glyph::Hue;
use crate::report::picture::{Panel, Picture};
use crate::report::plot::{Curve, Dash, Figure, Plot};
use crate::report::raster;
use crate::report::slice::{Axis, Plane, Slice};
use crate::report::table::Table;
use crate::scene::path::Placing;
use crate::study::motion::{self, Frame, Means, MotionError, Setting};

/// What moves, how it is run, where to write.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  lpv-lab motion moving-lobe --frames 48\n  lpv-lab motion moving-lobe --factor 3.8 --iterations 4 --descent leaves --leaf-distance 3\n  \
                        lpv-lab motion moving-lobe --warm --pin 20,16,16\n\n\
                        Injectors move along their paths: path: [(time: 0, by: (0, 0, 0)), (time: 2, by: (8, 0, 0))], seconds and cells.\n\
                        Written to the folder: motion.csv, pinned.csv, motion.svg, motion.png, frame-NNNN.png and animation.png."
)]
pub struct MotionArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Frames
    #[arg(long, value_name = "F", default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,
    /// Frames a second
    #[arg(long, value_name = "RATE", default_value_t = 24.0, value_parser = rate)]
    rate: f64,
    /// What becomes of fractions of a cell
    #[arg(long, value_enum, default_value_t = Place::Split)]
    place: Place,
    /// Start every frame from the light that the one before has moved
    #[arg(long)]
    warm: bool,
    /// Frames at the start that the printed means leave out [default: 16 with --warm, else 0]
    #[arg(long, value_name = "F")]
    settle: Option<usize>,
    /// A cell whose light is told frame by frame; more than once for several
    #[arg(long, value_name = "X,Y,Z", value_parser = cell)]
    pin: Vec<PinArg>,
    /// Leave the pictures out
    #[arg(long)]
    no_pictures: bool,
    /// The folder for the results [default: lpv-lab-results/motion-PRESET]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// What becomes of fractions of a cell.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Place {
    /// Light is split over the eight cells around its place
    Split,
    /// All of it goes to the nearest cell
    Nearest,
}

/// A cell.
#[derive(Clone, Copy, Debug)]
struct PinArg(Cell);

fn cell(text: &str) -> Result<PinArg, String> {
    let numbers: Option<Vec<usize>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    let cell = numbers.and_then(|numbers| Cell::try_from(numbers).ok());
    cell.map(PinArg).ok_or_else(|| "a cell is three numbers, such as 16,16,8".to_owned())
}

fn rate(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate: &f64| rate.is_finite() && *rate > 0.0);
    rate.ok_or_else(|| "a rate is a number of frames a second, above 0".to_owned())
}

impl From<MotionError> for CliError {
    fn from(error: MotionError) -> Self {
        CliError::Input(error.to_string())
    }
}

/// Does the command.
pub fn run(args: &MotionArgs) -> Result<(), CliError> {
    let (preset, problem) = args.scene.load()?;
    let n = problem.size;
    if let Some(PinArg([x, y, z])) = args.pin.iter().find(|PinArg(cell)| cell.iter().any(|c| *c >= n)) {
        return Err(CliError::Input(format!("--pin {x},{y},{z}: outside the volume; cells go from 0 to {}", n - 1)));
    }
    let settle = args.settle.unwrap_or(if args.warm { motion::SETTLING } else { 0 });
    if settle >= args.frames as usize {
        return Err(CliError::Input(format!(
            "{} frames: the first {settle} are left out of the means; use more --frames, or a smaller --settle",
            args.frames
        )));
    }
    let paths = preset.paths();
    if paths.iter().all(|path| path.is_empty()) {
        remark!("warning: no injector has a path, so nothing moves");
    }
    let out = args.out.clone();
    let folder = Folder::create(
        out.unwrap_or_else(|| PathBuf::from("lpv-lab-results").join(format!("motion-{}", args.scene.stem()))),
    )?;
    let setting = Setting {
        frames: args.frames as usize,
        rate: args.rate,
        placing: match args.place {
            Place::Split => Placing::Split,
            Place::Nearest => Placing::Nearest,
        },
        warm: args.warm,
        pinned: args.pin.iter().map(|PinArg(cell)| *cell).collect(),
    };
    let plane = Plane { axis: Axis::Z, index: problem.brightest_slab(Axis::Z.across()) };
    let channels = problem.channels();
    let mut pictures: Vec<Vec<u8>> = Vec::new();
    let mut failed = None;
    let frames = motion::run(&problem, &paths, &setting, |frame, light| {
        if args.no_pictures {
            return true;
        }
        let svg = picture(&preset.title, frame, light, &channels, plane);
        let png = raster::png(&svg).map_err(|e| CliError::Failed(format!("frame-{:04}.png: {e}", frame.number)));
        let written = png.and_then(|png| {
            folder.write(&format!("frame-{:04}.png", frame.number), &png)?;
            pictures.push(png);
            Ok(())
        });
        failed = written.err();
        failed.is_none()
    })?;
    if let Some(error) = failed {
        return Err(error);
    }
    folder.write_table("motion.csv", &table(&frames))?;
    folder.write_table("pinned.csv", &pinned(&frames, &setting))?;
    folder.write_svg_and_png("motion", &figure(&frames, &setting).to_svg())?;
    if !pictures.is_empty() {
        let animation = apng::join(&pictures, (1000.0 / args.rate).round().clamp(1.0, 65_535.0) as u16);
        folder.write("animation.png", animation.map_err(|error| CliError::Failed(error.to_string()))?)?;
    }
    if let Some(Means { frames: counted, flicker, error }) = Means::of(&frames, settle) {
        let flicker = flicker.map_or("-".to_owned(), |flicker| format!("{flicker:.4}"));
        let over = if settle == 0 { String::new() } else { format!(", over the last {counted}") };
        say!(
            "{} frames{over}: mean flicker {flicker}, mean L1 error {error:.4}; results in {}",
            frames.len(),
            folder.path().display()
        );
    }
    folder.finish();
    Ok(())
}

fn table(frames: &[Frame]) -> Table<5> {
    let mut table = Table::new(["frame", "time", "flicker_mean", "flicker_max", "l1_ratio"]);
    for frame in frames {
        let [mean, most] = frame.flicker.unwrap_or([f64::NAN; 2]);
        table.push([frame.number.into(), frame.time.into(), mean.into(), most.into(), frame.error.into()]);
    }
    table
}

fn pinned(frames: &[Frame], setting: &Setting) -> Table<7> {
    let mut table = Table::new(["frame", "time", "x", "y", "z", "merged", "right"]);
    for frame in frames {
        for ([x, y, z], [found, right]) in setting.pinned.iter().zip(&frame.pinned) {
            let cell = [(*x).into(), (*y).into(), (*z).into()];
            let [x, y, z] = cell;
            table.push([frame.number.into(), frame.time.into(), x, y, z, (*found).into(), (*right).into()]);
        }
    }
    table
}

/// Flicker over time, and below it the light of the pinned cells.
fn figure(frames: &[Frame], setting: &Setting) -> Figure {
    let over_time = |name: &str, color: usize, dash: Dash, of: &dyn Fn(&Frame) -> f64| Curve {
        name: name.to_owned(),
        points: frames.iter().map(|frame| [frame.time, of(frame)]).collect(),
        color,
        dash,
    };
    let flicker = |i: usize| move |frame: &Frame| frame.flicker.map_or(f64::NAN, |flicker| flicker[i]);
    let plot = |title: &str, y_label: &str, curves| Plot {
        title: title.to_owned(),
        x_label: "seconds".to_owned(),
        y_label: y_label.to_owned(),
        log_x: false,
        log_y: true,
        keys: Vec::new(),
        curves,
        marks: Vec::new(),
    };
    let curves =
        vec![over_time("mean", 0, Dash::Solid, &flicker(0)), over_time("largest", 0, Dash::Dashed, &flicker(1))];
    let mut plots = vec![plot("Flicker", "|Δ ln(S + ε) − Δ ln(U + ε)|", curves)];
    if !setting.pinned.is_empty() {
        let curves = setting.pinned.iter().enumerate().flat_map(|(i, [x, y, z])| {
            let name = format!("({x}, {y}, {z})");
            let right = format!("({x}, {y}, {z}), as it ought to be");
            [
                over_time(&name, i, Dash::Solid, &|frame| frame.pinned[i][0]),
                over_time(&right, i, Dash::Dotted, &|frame| frame.pinned[i][1]),
            ]
        });
        plots.push(plot("Merged light at pinned cells", "c00", curves.collect()));
    }
    let height = 360 * plots.len() as u32;
    Figure { title: "Light that moves".to_owned(), plots, theme: Theme::LIGHT, size: [960, height] }
}

fn picture(title: &str, frame: &Frame, light: &[Grid<f32>], channels: &Channels, plane: Plane) -> String {
    let grids: Vec<&Grid<f32>> = light.iter().collect();
    let slice = Slice::level(&grids, channels, 0, plane);
    let [red, green, blue] = channels.rgb();
    let subtitle =
        format!("frame {}, {:.3} s, {} = {}", frame.number, frame.time, Axis::name(plane.axis.across()), plane.index);
    let picture = Picture {
        title,
        subtitle: &subtitle,
        panels: vec![Panel::fitted("Merged light", &slice, Hue::Mean, Some(4.0))],
        hue: Hue::Mean,
        paint: if red == green && green == blue { Paint::Single } else { Paint::Light },
        heat: false,
        theme: Theme::LIGHT,
        width: 700,
    };
    picture.to_svg()
}
