//! `run`: a preset from injection to merge, with its error curves and pictures.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::cells::LevelArg;
use super::console::{remark, say};
use super::course::{self, Course};
use super::output::{self, Folder};
use super::{CliError, SceneArgs};
use crate::field::memory;
use crate::report::colour::{Paint, Theme};
use crate::report::error_figure::{ErrorFigure, Measure, Series};
use crate::report::glyph::Hue;
use crate::report::number::plain;
use crate::report::picture::{Panel, Picture};
use crate::report::slice::{Axis, Plane, Slice};
use crate::report::table;
use crate::simulation::options::{Options, Skip};
use crate::simulation::{Light, Simulation};
use crate::study::artefacts::jump::Steady;
use crate::study::artefacts::{Artefacts, Shares};
use crate::study::error::ErrorRow;
use crate::study::expectation::Expectation;
use crate::study::light;
use crate::study::stability::outlook;
use crate::system::interrupt;
use crate::system::memory::{free, in_words};

/// What to run, what to look at, where to write.
#[derive(Args, Debug, Clone)]
#[command(after_help = "Examples:\n  lpv-lab run presets/two-walls.ron --iterations 8 --out results\n  \
                        lpv-lab run mixed --factor 3.8 --axis linear --slice y=4 --level 1\n\n\
                        Written to the folder: errors.csv, errors.svg, errors.png, the source, target and accumulated grids as\n\
                        level-I.svg, level-I.png, merged.svg, merged.png, and summary.ron.")]
pub struct RunArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The folder for the results [default: lpv-lab-results/PRESET]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// The octree level to picture, 0 the finest; merged is always pictured
    #[arg(long, value_name = "I", default_value_t = 0)]
    level: usize,
    /// The slice to picture, such as z=16 [default: across z, where most light is injected]
    #[arg(long, value_name = "AXIS=CELL")]
    slice: Option<SliceArg>,
    /// The scale of the error axes; on a linear one the largest error hides the mean
    #[arg(long, value_enum, default_value_t = ScaleArg::Log)]
    axis: ScaleArg,
    /// The scale of the glyphs' radius; on a linear one light far from its source is too small to be seen
    #[arg(long, value_enum, default_value_t = ScaleArg::Log)]
    glyphs: ScaleArg,
    /// The colours of plots and pictures
    #[arg(long, value_enum, default_value_t = ThemeArg::Light)]
    theme: ThemeArg,
    /// Measure against what truly arrives along straight lines, too
    #[arg(long)]
    ballistic: bool,
    /// Measure the light on a mesh's surfaces against what truly reaches them, path traced, too
    #[arg(long)]
    surface: bool,
    /// Measure what the scene's camera sees against the path-traced picture, too
    #[arg(long)]
    picture: bool,
    /// Stop once all light still to come is proved to be at most this part of the accumulated light
    #[arg(long, value_name = "PART")]
    tolerance: Option<f64>,
    /// Leave nothing out that cannot matter, or nothing for these reasons; the results are the same to the
    /// last bit
    #[arg(long, value_name = "REASON,...", num_args = 0..=1, require_equals = true, value_delimiter = ',',
          default_missing_value = "reach,dark,channels")]
    no_skip: Vec<Reason>,
}

/// Why something need not be computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Reason {
    /// Light cannot have reached a cell yet
    Reach,
    /// A cell has gone dark again
    Dark,
    /// A colour is a multiple of another one
    Channels,
}

/// An axis and a cell along it.
#[derive(Clone, Copy, Debug)]
struct SliceArg(Axis, usize);

impl std::str::FromStr for SliceArg {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('=').and_then(|(axis, cell)| {
            let axis = Axis::ALL.into_iter().find(|a| Axis::name(a.across()) == axis.to_lowercase())?;
            Some(SliceArg(axis, cell.parse().ok()?))
        });
        parts.ok_or_else(|| "a slice is an axis and a cell along it, such as z=16".to_owned())
    }
}

/// Even steps, or powers of ten.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ScaleArg {
    Linear,
    Log,
}

/// How many powers of ten a logarithmic glyph spans.
const GLYPH_DECADES: f32 = 4.0;

/// Light or dark.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ThemeArg {
    Light,
    Dark,
}

impl ThemeArg {
    fn theme(self) -> Theme {
        match self {
            ThemeArg::Light => Theme::LIGHT,
            ThemeArg::Dark => Theme::DARK,
        }
    }
}

impl RunArgs {
    /// The arguments of `lpv-lab run PRESET`.
    pub fn of(preset: PathBuf) -> Self {
        RunArgs {
            scene: SceneArgs { preset, ..SceneArgs::default() },
            out: None,
            level: 0,
            slice: None,
            axis: ScaleArg::Log,
            glyphs: ScaleArg::Log,
            theme: ThemeArg::Light,
            ballistic: false,
            surface: false,
            picture: false,
            tolerance: None,
            no_skip: Vec::new(),
        }
    }

    /// What the light is held against beside what costs nothing.
    fn wanted(&self) -> Vec<Expectation> {
        let asked = [
            (self.ballistic, Expectation::Ballistic),
            (self.surface, Expectation::Surface),
            (self.picture, Expectation::Picture),
        ];
        asked.into_iter().filter(|(asked, _)| *asked).map(|(_, expectation)| expectation).collect()
    }

    fn options(&self) -> Result<Options, CliError> {
        if let Some(part) = self.tolerance.filter(|part| !(part.is_finite() && *part >= 0.0)) {
            return Err(CliError::Input(format!("--tolerance {part}: write a finite number, zero or more")));
        }
        let keeps = |reason| !self.no_skip.contains(&reason);
        let skip = Skip {
            reach: keeps(Reason::Reach),
            dark: keeps(Reason::Dark),
            channels: keeps(Reason::Channels),
            ..Skip::default()
        };
        Ok(Options { tolerance: self.tolerance, skip, ..Options::default() })
    }

    /// The preset to run.
    pub fn preset(&self) -> &Path {
        &self.scene.preset
    }

    /// The folder for the results.
    pub fn out(&self) -> PathBuf {
        output::results_of(self.out.as_deref(), &self.scene.preset)
    }
}

/// What summary.ron says of a run.
#[derive(Serialize)]
struct Summary<'a> {
    title: &'a str,
    size: usize,
    levels: usize,
    channels: usize,
    scheme: &'a str,
    factor: f64,
    iterations: usize,
    /// Seconds for all actions, errors and pictures aside.
    seconds: f64,
    /// Σ c00 of the accumulated light on level 0, all channels.
    energy: f64,
    /// The light of the newest snapshot over the injected light, on level 0.
    energy_left: f64,
    /// Cells that have received light, for each level.
    lit: Vec<usize>,
    /// The thesis metric over all levels after the last iteration.
    absolute_mean: f64,
    relative_mean: f64,
    undefined: usize,
    /// Cells computed over cells in the volume, all iterations, levels and channels.
    visited: f64,
    /// Cells left out because their light has gone dark, over cells in the volume.
    dark: f64,
    /// Light behind occluders over light there without them: on level 0, in the merged light, on each level.
    leak: Option<f64>,
    leak_merged: Option<f64>,
    leak_levels: Vec<Option<f64>>,
    /// Light behind its own source over light before it, in the same order.
    back_bleeding: Option<f64>,
    back_bleeding_merged: Option<f64>,
    back_bleeding_levels: Vec<Option<f64>>,
    /// The mean |ln| by which neighbours that are sampled on different levels differ too much, and over how many pairs.
    jump: Option<f64>,
    jump_pairs: usize,
    /// Finest cells whose merged light is negative in the mean over all directions.
    negative_cells: usize,
}

/// Does the command.
pub fn run(args: &RunArgs) -> Result<(), CliError> {
    let (preset, problem) = args.scene.load()?;
    let wanted = args.wanted();
    let problem = wanted.iter().fold(problem, |problem, expectation| expectation.prepared(problem));
    let plane = plane(args.slice, problem.size, |axis| problem.brightest_slab(axis))?;
    if let Some(warning) = outlook::warning(&problem) {
        remark!("warning: {warning}");
    }
    let mut simulation = args.scene.device.simulate(problem, args.options()?)?;
    LevelArg::Level(args.level).check(simulation.sizes().count())?;
    // References, fixed points and pictures take about twice what the light does.
    let needed = 2 * memory::of_simulation::<f32>(simulation.sizes(), simulation.lights().len());
    if let Some(free) = free().filter(|free| *free < needed) {
        return Err(CliError::Failed(format!(
            "measuring this run needs {} of memory and {} are free; use a smaller size, or `lpv-lab cells`",
            in_words(needed),
            in_words(free)
        )));
    }
    let folder = Folder::of_preset(args.out.as_deref(), &args.scene.preset)?;
    interrupt::listen();
    let references = course::references(simulation.problem(), &wanted)?;
    let steady = Steady::of(simulation.problem())?;
    let Course { rows, jumps, seconds, interrupted } = course::run(&mut simulation, &references, steady.as_ref())?;

    let title = if preset.title.is_empty() { args.scene.stem() } else { preset.title.clone() };
    folder.write_table("errors.csv", &table::errors(&rows, &jumps))?;
    if rows.iter().any(|row| row.traced.is_some()) {
        folder.write_table("truth.csv", &table::traced(&rows))?;
    }
    let all_levels: Vec<ErrorRow> = rows.iter().filter(|row| row.level.is_none()).copied().collect();
    let plot = ErrorFigure {
        title: &format!("{title}: error after each iteration"),
        series: &Series::of_run(&all_levels),
        measures: &[Measure::Absolute, Measure::Relative],
        means: true,
        largest: true,
        log: args.axis == ScaleArg::Log,
        current: None,
        theme: args.theme.theme(),
        size: [960, 900],
    };
    folder.write_svg_and_png("errors", &plot.figure().to_svg())?;
    let views =
        [(format!("level-{}", args.level), LevelArg::Level(args.level)), ("merged".to_owned(), LevelArg::Merged)];
    for (name, view) in views {
        folder.write_svg_and_png(&name, &picture(args, &simulation, &title, view, plane))?;
    }

    // Of light that has diverged, or was left half way, nothing can be said.
    let whole = simulation.divergence().is_none() && !interrupted;
    let artefacts = if whole { Artefacts::of(&simulation, steady.as_ref())? } else { Artefacts::default() };
    let leak = artefacts.leak.clone().unwrap_or_default();
    let back_bleeding = artefacts.back_bleeding.clone().unwrap_or_default();
    let propagation = &simulation.problem().propagation;
    let thesis = all_levels.iter().rev().find(|row| row.expectation == Expectation::Thesis);
    let summary = Summary {
        title: &title,
        size: simulation.sizes().finest(),
        levels: simulation.sizes().count(),
        channels: simulation.channels().count(),
        scheme: &propagation.scheme,
        factor: propagation.factor,
        iterations: simulation.iteration(),
        seconds,
        energy: simulation.lights().iter().map(|light| light.accumulated.level(0).energy()).sum(),
        energy_left: light::energy_left(&simulation),
        lit: (0..simulation.sizes().count()).map(|i| simulation.index().level(i).count()).collect(),
        absolute_mean: thesis.map_or(0.0, |row| row.absolute_mean),
        relative_mean: thesis.map_or(0.0, |row| row.relative_mean),
        undefined: thesis.map_or(0, |row| row.undefined),
        visited: simulation.work().share(),
        dark: simulation.work().dark_share(),
        leak: leak.finest(),
        leak_merged: leak.merged,
        leak_levels: leak.levels,
        back_bleeding: back_bleeding.finest(),
        back_bleeding_merged: back_bleeding.merged,
        back_bleeding_levels: back_bleeding.levels,
        jump: artefacts.jump.map(|jump| jump.mean),
        jump_pairs: artefacts.jump.map_or(0, |jump| jump.pairs),
        negative_cells: artefacts.negative,
    };
    let text = ron::ser::to_string_pretty(&summary, ron::ser::PrettyConfig::new())
        .map_err(|e| CliError::Failed(format!("summary.ron: {e}")))?;
    folder.write("summary.ron", text.as_bytes())?;
    say!(
        "{} iterations in {seconds:.3} s, {}, {}; results in {}",
        simulation.iteration(),
        simulation.work(),
        match simulation.channels().count() {
            1 => "1 channel for 3 colours".to_owned(),
            count => format!("{count} channels for 3 colours"),
        },
        folder.path().display()
    );
    if let Some(bound) = simulation.still_to_come() {
        say!("light still to come: at most {bound:.2e} of what has been accumulated");
    }
    for line in rows.iter().filter(|row| row.iteration == simulation.iteration()).filter_map(traced_line) {
        say!("{line}");
    }
    for line in artefact_lines(&artefacts) {
        say!("{line}");
    }
    let path = folder.path().to_path_buf();
    folder.finish();
    // What was computed before is written all the same: it is good.
    if let Some(divergence) = simulation.divergence() {
        return Err(divergence.into());
    }
    if interrupted {
        let (done, asked) = (simulation.iteration(), simulation.problem().propagation.iterations);
        let what = format!("interrupted after iteration {done} of {asked}: what was computed is in {}", path.display());
        return Err(CliError::Interrupted(what));
    }
    Ok(())
}

/// How far the light is from a path-traced truth, in a line.
fn traced_line(row: &ErrorRow) -> Option<String> {
    let traced = row.traced?;
    let number = |value: f64| plain(value, 3);
    let more = match (traced.correlation, traced.picture) {
        (Some(correlation), _) => format!(", correlation {}", number(correlation)),
        (_, Some([rmse, rel_mse, flip])) => {
            format!(", RMSE {}, relMSE {}, FLIP {}", number(rmse), number(rel_mse), number(flip))
        }
        _ => String::new(),
    };
    Some(format!(
        "{} against {}: mean ratio {}, L1 {}, fitted {}{more} (the truth's own error {})",
        row.expectation,
        row.expectation.against(),
        number(traced.mean_ratio),
        number(row.l1_ratio),
        row.l1_best_fit.map_or_else(|| "-".to_owned(), number),
        number(traced.noise)
    ))
}

/// What went wrong with the light, a line for each kind.
fn artefact_lines(artefacts: &Artefacts) -> Vec<String> {
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| plain(value, 3));
    let shares = |what: &str, shares: &Shares| {
        let levels: Vec<String> = shares.levels.iter().skip(1).map(|level| number(*level)).collect();
        let coarser =
            if levels.is_empty() { String::new() } else { format!("; levels from 1 on {}", levels.join(" ")) };
        format!("{what}: level 0 {}, merged {}{coarser}", number(shares.finest()), number(shares.merged))
    };
    let mut lines = Vec::new();
    lines.extend(artefacts.leak.iter().map(|leak| shares("leak (light behind occluders / there without them)", leak)));
    lines.extend(artefacts.back_bleeding.iter().map(|back| shares("light behind its own source / before it", back)));
    lines.extend(artefacts.jump.iter().map(|jump| {
        let undefined = if jump.undefined == 0 { String::new() } else { format!(", {} undefined", jump.undefined) };
        format!("jumps between levels: mean |ln| {} over {} pairs{undefined}", plain(jump.mean, 3), jump.pairs)
    }));
    if artefacts.negative > 0 {
        lines.push(format!("negative light: in {} cells", artefacts.negative));
    }
    lines
}

/// The slice asked for, or the one across z in which most light is injected.
fn plane(asked: Option<SliceArg>, size: usize, brightest: impl Fn(usize) -> usize) -> Result<Plane, CliError> {
    match asked {
        Some(SliceArg(axis, index)) if index >= size => Err(CliError::Input(format!(
            "--slice {}={index}: outside the volume; cells go from 0 to {}",
            Axis::name(axis.across()),
            size - 1
        ))),
        Some(SliceArg(axis, index)) => Ok(Plane { axis, index }),
        None => Ok(Plane { axis: Axis::Z, index: brightest(Axis::Z.across()) }),
    }
}

/// Source, target and accumulated light side by side, as SVG.
fn picture(args: &RunArgs, simulation: &Simulation<f32>, title: &str, view: LevelArg, plane: Plane) -> String {
    let cut = |octree: fn(&Light<f32>) -> &crate::field::Octree<f32>| {
        let octrees: Vec<_> = simulation.lights().iter().map(octree).collect();
        match view {
            LevelArg::Level(i) => {
                let grids: Vec<_> = octrees.iter().map(|octree| octree.level(i)).collect();
                Slice::level(&grids, simulation.channels(), i, plane)
            }
            LevelArg::Merged => Slice::merged(&octrees, simulation.index(), simulation.channels(), plane),
        }
    };
    let k = simulation.iteration();
    let accumulated = match view {
        LevelArg::Merged => Slice::of_merged(simulation, plane),
        LevelArg::Level(_) => cut(|light| &light.accumulated),
    };
    let slices = [cut(|light| &light.source), cut(|light| &light.target), accumulated];
    let target = if k == 0 { "Target".to_owned() } else { format!("Target, still S_{}", k - 1) };
    let names = [format!("Source, S_{k}"), target, "Accumulated, S_A".to_owned()];
    let decades = (args.glyphs == ScaleArg::Log).then_some(GLYPH_DECADES);
    let panels = names.iter().zip(&slices).map(|(name, slice)| Panel::fitted(name, slice, Hue::Mean, decades));
    let propagation = &simulation.problem().propagation;
    let what = match view {
        LevelArg::Level(i) => format!("level {i}"),
        LevelArg::Merged => "all levels merged".to_owned(),
    };
    let subtitle = format!(
        "{what}, {} = {}, k = {k}, {}, p = {}",
        Axis::name(plane.axis.across()),
        plane.index,
        propagation.scheme,
        propagation.factor
    );
    let [red, green, blue] = simulation.channels().rgb();
    let white = red == green && green == blue;
    let picture = Picture {
        title,
        subtitle: &subtitle,
        panels: panels.collect(),
        hue: Hue::Mean,
        paint: if white { Paint::Single } else { Paint::Light },
        heat: false,
        theme: args.theme.theme(),
        width: 1800,
    };
    picture.to_svg()
}
