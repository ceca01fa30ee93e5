//! `cells`: the light of every cell that is not dark, as the numbers that they are.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{CliError, SceneArgs, console};
use crate::field::{Grid, Share};
use crate::scene::cell_file::{self, Grids};
use crate::simulation::options::Options;
use crate::system::file::{check_target, write_whole_with};

/// What to print, and where.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  lpv-lab cells presets/one-lobe.ron --iterations 4 --level 0 --out cells.csv\n\n\
                        CSV columns: x,y,z, the source grid s0 to s3 and the accumulated grid a0 to a3 as (c00, c1-1, c10, c11),\n\
                        and for levels but the finest the grid's side; a merged grid has no source. A .npy file holds one grid as\n\
                        (n, n, n, 4), indexed [z, y, x]: the accumulated one unless --grid says otherwise. An injector of a CSV with\n\
                        both names one: File(path: \"cells.csv\", column: Accumulated).")]
pub struct CellsArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The octree level, 0 the finest, or `merged`
    #[arg(long, default_value = "0")]
    level: LevelArg,
    /// The colour
    #[arg(long, value_enum, default_value_t = ChannelArg::R)]
    channel: ChannelArg,
    /// The grid [default: both as CSV, accumulated as .npy]
    #[arg(long, value_enum)]
    grid: Option<GridArg>,
    /// The file to write, .csv or .npy; without it CSV goes to the terminal
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// A level of the octree, or the merged grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LevelArg {
    /// The merged grid.
    Merged,
    /// A level, 0 the finest.
    Level(usize),
}

impl std::str::FromStr for LevelArg {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "merged" {
            return Ok(LevelArg::Merged);
        }
        text.parse().map(LevelArg::Level).map_err(|_| "a level is a number from 0, the finest, or `merged`".to_owned())
    }
}

impl LevelArg {
    /// An error if the octree has no such level.
    pub fn check(self, levels: usize) -> Result<(), CliError> {
        match self {
            LevelArg::Level(i) if i >= levels => {
                Err(CliError::Input(format!("--level {i}: this octree has levels 0 to {} and `merged`", levels - 1)))
            }
            _ => Ok(()),
        }
    }
}

/// The light under way, or all that has been there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum GridArg {
    /// The source grid, S_k
    Source,
    /// The accumulated grid, S_A
    Accumulated,
}

/// One of the three colours.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum ChannelArg {
    /// Red
    R,
    /// Green
    G,
    /// Blue
    B,
}

/// How the cells are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Csv,
    Npy,
}

impl Format {
    /// The form that a file's name asks for.
    fn of(path: &Path) -> Result<Self, CliError> {
        match path.extension().and_then(|e| e.to_str()) {
            Some("npy") => Ok(Format::Npy),
            Some("csv") => Ok(Format::Csv),
            _ => Err(CliError::Input(format!("{}: the file must end in .csv or .npy", path.display()))),
        }
    }
}

/// Does the command.
pub fn run(args: &CellsArgs) -> Result<(), CliError> {
    // What cannot be written is told before the work.
    let out = args.out.as_deref().map(|path| Format::of(path).map(|format| (path, format))).transpose()?;
    if args.grid == Some(GridArg::Source) && args.level == LevelArg::Merged {
        let what = "--grid source: the merged grid is of accumulated light; take a level's, such as --level 0";
        return Err(CliError::Input(what.to_owned()));
    }
    let (_, problem) = args.scene.load()?;
    if let Some((path, _)) = out {
        check_target(path).map_err(|e| CliError::Failed(e.to_string()))?;
    }
    let mut simulation = args.scene.device.simulate(problem, Options::default())?;
    args.level.check(simulation.sizes().count())?;
    simulation.run(|_| true);
    if let Some(divergence) = simulation.divergence() {
        return Err(divergence.into());
    }

    let share = simulation.channels().rgb()[args.channel as usize];
    let light = &simulation.lights()[share.channel];
    let (source, accumulated) = match args.level {
        LevelArg::Level(i) => (Some(light.source.level(i)), Some(light.accumulated.level(i))),
        LevelArg::Merged => (None, light.merged.as_ref()),
    };
    if accumulated.is_none() {
        return Err(CliError::Failed("the run ended before the levels were merged".to_owned()));
    }
    let wanted = |grid| match (args.grid, out) {
        (Some(asked), _) => asked == grid,
        (None, Some((_, Format::Npy))) => grid == GridArg::Accumulated,
        (None, _) => true,
    };
    let source = source.filter(|_| wanted(GridArg::Source)).map(|grid| scaled(grid, share));
    let accumulated = accumulated.filter(|_| wanted(GridArg::Accumulated)).map(|grid| scaled(grid, share));
    let grids = Grids {
        source: source.as_ref(),
        accumulated: accumulated.as_ref(),
        // Cells of the finest level are the volume's own.
        side: matches!(args.level, LevelArg::Level(1..)),
    };
    match out {
        None => {
            console::stream(|out| cell_file::write_csv(out, grids));
            Ok(())
        }
        Some((path, Format::Csv)) => write_whole_with(path, |out| cell_file::write_csv(out, grids)),
        Some((path, Format::Npy)) => write_whole_with(path, |out| {
            let one = grids.source.or(grids.accumulated).ok_or(std::io::ErrorKind::InvalidInput)?;
            cell_file::write_npy(out, one)
        }),
    }
    .map_err(|e| CliError::Failed(e.to_string()))
}

/// A colour's light in a channel's grid.
fn scaled(grid: &Grid<f32>, share: Share) -> Grid<f32> {
    let mut grid = grid.clone();
    if share.scale != 1.0 {
        for plane in grid.planes_mut() {
            plane.iter_mut().for_each(|c| *c *= share.scale as f32);
        }
    }
    grid
}
