//! `render`: what a camera sees of a preset's light, and with `--truth` what it should see.

use std::path::PathBuf;
use std::str::FromStr;
use std::time::Instant;

use clap::{Args, ValueEnum};

use super::cells::LevelArg;
use super::console::say;
use super::numbers::{decimal, whole};
use super::output::Folder;
use super::{CliError, SceneArgs};
use crate::render::bounce::Bounces;
use crate::render::cells::Sampling;
use crate::render::image::Image;
use crate::render::seen::Seen;
use crate::render::stage::{Received, Set};
use crate::render::surface::Lit;
use crate::render::truth::Truth;
use crate::report::radiance;
use crate::report::table::Table;
use crate::simulation::options::Options;
use crate::study::picture::{self, Compared, flip};
use crate::study::surface::{self, Surfaces};
use crate::system::interrupt;

/// The most pixels of a picture.
const MOST_PIXELS: usize = 1 << 24;
/// The most samples a pixel.
const MOST_SAMPLES: usize = 1 << 20;
/// Places in a pixel that a picture of cells is the mean of.
const PLACES: u64 = 16;
/// Paths a patch of the surface, where the truth of surfaces is asked for.
const PATHS_A_PATCH: u64 = 512;

/// What to look at, how, and where to write.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  lpv-lab render cornell --sampling occupied --out cornell\n  \
                        lpv-lab render cornell --truth --samples 1024 --out cornell\n\n\
                        Written to the folder: picture.png, picture.npy and picture.pfm (linear radiance, float32, row 0 at the\n\
                        top), direct.npy, indirect.npy; with --truth truth.png, truth.npy, truth_error.npy (one standard\n\
                        deviation), difference.png (red: too bright), flip.png, sheet.png (truth and picture side by side) and\n\
                        picture.csv (metric,raw,fitted).")]
pub struct RenderArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Pixels across and down
    #[arg(long, value_name = "WxH", default_value = "512x512")]
    size: Size,
    /// How the light of cells is taken to surfaces; light that keeps its direction comes by the faces of cells,
    /// and is taken from the nearest patch, or smoothly
    #[arg(long, value_enum, default_value_t = SamplingArg::Nearest)]
    sampling: SamplingArg,
    /// The octree level to take light from, 0 the finest, or `merged`
    #[arg(long, default_value = "merged")]
    level: LevelArg,
    /// What radiance is multiplied with for PNG [default: what shows 98 in 100 pixels]
    #[arg(long, value_name = "E", value_parser = decimal, allow_negative_numbers = true)]
    exposure: Option<f64>,
    /// Let light go all its way, whatever the iterations: in one sweep where the transport can, else until the newest
    /// is a ten-thousandth of all
    #[arg(long)]
    converged: bool,
    /// Trace the truth, too, and measure the difference
    #[arg(long)]
    truth: bool,
    /// Bounces of the truth: a number, 0 for direct light alone, or `all`
    #[arg(long, value_name = "N", default_value = "1")]
    bounces: BouncesArg,
    /// Paths a pixel of the truth
    #[arg(long, value_name = "S", default_value_t = 256, value_parser = whole, allow_negative_numbers = true)]
    samples: usize,
    /// The folder for the results [default: lpv-lab-results/PRESET]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Pixels across and down.
#[derive(Clone, Copy, Debug)]
struct Size([usize; 2]);

impl FromStr for Size {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
        match sides {
            Some([w, h]) if w > 0 && h > 0 && usize::checked_mul(w, h).is_some_and(|all| all <= MOST_PIXELS) => {
                Ok(Size([w, h]))
            }
            Some(_) => Err(format!("a picture has 1 to {MOST_PIXELS} pixels")),
            None => Err("a size is pixels across and down, such as 512x512".to_owned()),
        }
    }
}

/// Bounces of the truth.
#[derive(Clone, Copy, Debug)]
struct BouncesArg(Bounces);

impl FromStr for BouncesArg {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "all" {
            return Ok(BouncesArg(Bounces::All));
        }
        let number = text.parse().map(|n| BouncesArg(Bounces::UpTo(n)));
        number.map_err(|_| "bounces are a number from 0, or `all`".to_owned())
    }
}

/// [`Sampling`] on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SamplingArg {
    /// The cell that the surface lies in
    Nearest,
    /// Between the eight nearest cells
    Trilinear,
    /// Between those of the eight that a surface passes through
    Occupied,
    /// Trilinear, less where light grows stronger behind the surface
    Damped,
    /// The cell half a cell before the surface
    Before,
}

impl SamplingArg {
    fn sampling(self) -> Sampling {
        match self {
            SamplingArg::Nearest => Sampling::Nearest,
            SamplingArg::Trilinear => Sampling::Trilinear,
            SamplingArg::Occupied => Sampling::Occupied,
            SamplingArg::Damped => Sampling::Damped,
            SamplingArg::Before => Sampling::Before,
        }
    }
}

/// Whoever waits may end it.
fn on(_: f64) -> bool {
    !interrupt::asked()
}

fn interrupted() -> CliError {
    CliError::Interrupted("interrupted before the picture was done: nothing is written".to_owned())
}

/// Does the command.
pub fn run(args: &RenderArgs) -> Result<(), CliError> {
    if !(1..=MOST_SAMPLES).contains(&args.samples) {
        return Err(CliError::Input(format!("--samples {}: write 1 to {MOST_SAMPLES}", args.samples)));
    }
    if let Some(exposure) = args.exposure.filter(|e| !(e.is_finite() && *e > 0.0)) {
        return Err(CliError::Input(format!("--exposure {exposure}: write a finite number above 0")));
    }
    let (_, problem) = args.scene.load()?;
    let Some(stage) = problem.stage.clone() else {
        let name = args.scene.preset.display();
        return Err(CliError::Input(format!("{name}: there is no mesh to look at; give it a `scene`, as cornell has")));
    };
    let Size(size) = args.size;
    let set = Set::new(&stage);
    let view = set.view(size).ok_or_else(|| CliError::Input("the scene's camera sees nothing".to_owned()))?;
    let mut simulation = args.scene.device.simulate(set.prepared(problem), Options::default())?;
    if let LevelArg::Level(_) = args.level {
        args.level.check(simulation.sizes().count())?;
    }
    let folder = Folder::of_preset(args.out.as_deref(), &args.scene.preset)?;
    let begin = Instant::now();
    if args.converged {
        simulation.settle(|_| !interrupt::asked());
    } else {
        simulation.run(|_| !interrupt::asked());
    }
    if let Some(divergence) = simulation.divergence() {
        return Err(divergence.into());
    }
    let travelled = begin.elapsed();

    let world = set.world();
    let level = match args.level {
        LevelArg::Merged => None,
        LevelArg::Level(i) => Some(i),
    };
    let received = Received::of(&set, &simulation, level, args.sampling.sampling());
    let begin = Instant::now();
    let seen = Seen::new(&world, &view, PLACES, |at, normal| received.at(at, normal), &on).ok_or_else(interrupted)?;
    let drawn = begin.elapsed();

    let truth = if args.truth {
        let picture = Truth::traced(&world, view, args.bounces.0, args.samples as u64, &on).ok_or_else(interrupted)?;
        let lit = Lit::traced(&world, set.patches(), args.bounces.0, PATHS_A_PATCH, &on).ok_or_else(interrupted)?;
        Some((picture, lit))
    } else {
        None
    };
    let reference = truth.as_ref().map(|(truth, _)| truth.total());
    let exposure = args.exposure.map_or_else(|| reference.as_ref().unwrap_or(&seen.total()).exposure(), |e| e as f32);

    let total = seen.total();
    write_image(&folder, "picture", &total, Some(exposure))?;
    folder.write_with("picture.pfm", |out| total.write_pfm(out))?;
    write_image(&folder, "direct", &seen.direct, None)?;
    write_image(&folder, "indirect", &seen.indirect, None)?;
    let propagation = &simulation.problem().propagation;
    let way = match simulation.iteration() {
        0 if args.converged => "one sweep".to_owned(),
        iterations => format!("{iterations} iterations"),
    };
    say!(
        "{}, p = {}, {way} in {:.3} s; {} × {} pixels in {:.3} s",
        propagation.scheme,
        propagation.factor,
        travelled.as_secs_f64(),
        size[0],
        size[1],
        drawn.as_secs_f64()
    );
    if let (Some((truth, lit)), Some(reference)) = (&truth, &reference) {
        write_image(&folder, "truth", reference, Some(exposure))?;
        folder.write_with("truth_error.npy", |out| truth.deviation().write_npy(out))?;
        let failed = |error| CliError::Failed(format!("a picture: {error}"));
        folder.write("difference.png", radiance::difference(reference, &total, exposure).map_err(failed)?)?;
        let map = flip::flip(reference, &total, exposure, flip::PIXELS_A_DEGREE);
        folder.write("flip.png", radiance::map(size[0], &map).map_err(failed)?)?;
        folder.write("sheet.png", radiance::side_by_side(&[reference, &total], exposure).map_err(failed)?)?;
        let compared = picture::compare(reference, &seen, exposure);
        let surfaces = surface::compare(set.patches(), &received.patches(), lit);
        let table = table(&compared, &surfaces, truth.noise());
        folder.write_table("picture.csv", &table)?;
        console_table(&table);
    }
    say!("results in {}", folder.path().display());
    folder.finish();
    Ok(())
}

fn console_table(table: &Table<3>) {
    super::console::print(format_args!("{}", table.to_text()));
}

fn write_image(folder: &Folder, name: &str, image: &Image, exposure: Option<f32>) -> Result<(), CliError> {
    folder.write_with(&format!("{name}.npy"), |out| image.write_npy(out))?;
    let Some(exposure) = exposure else { return Ok(()) };
    let png = radiance::png(image, exposure).map_err(|e| CliError::Failed(format!("{name}.png: {e}")))?;
    folder.write(&format!("{name}.png"), png)
}

/// What differs, as it is and after the scale of the indirect light that fits best.
fn table(picture: &Compared, surfaces: &Surfaces, noise: f64) -> Table<3> {
    let mut table = Table::new(["metric", "raw", "fitted"]);
    let mut row = |name: &str, raw: f64, fitted: f64| table.push([name.into(), raw.into(), fitted.into()]);
    let (raw, fitted) = (picture.raw, picture.fitted);
    row("rmse", raw.rmse, fitted.rmse);
    row("relmse", raw.rel_mse, fitted.rel_mse);
    row("flip", raw.flip, fitted.flip);
    row("mean_ratio", raw.mean_ratio, fitted.mean_ratio);
    row("scale", 1.0, picture.scale);
    row("truth_noise", noise, noise);
    row("surface_l1", surfaces.l1, surfaces.l1_fitted);
    row("surface_mean_ratio", surfaces.mean_ratio, surfaces.mean_ratio * surfaces.scale);
    row("surface_scale", 1.0, surfaces.scale);
    row("surface_correlation", surfaces.correlation, surfaces.correlation);
    row("surface_noise", surfaces.noise, surfaces.noise);
    table
}
