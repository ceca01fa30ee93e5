//! `cells`: the light of every cell that is not dark, as the numbers that they are.

use std::fs::File;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{CliError, SceneArgs};
use crate::field::{Grid, Share};
use crate::scene::cell_file;
use crate::simulation::Simulation;

/// What to print, and where.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  lpv-lab cells presets/one-lobe.ron --iterations 4 --level 0 --out cells.csv\n\n\
                        CSV columns: x,y,z, the source grid s0 to s3 and the accumulated grid a0 to a3 as (c00, c1-1, c10, c11);\n\
                        a merged grid has no source. A .npy file holds the accumulated grid as (n, n, n, 4), indexed [z, y, x].")]
pub struct CellsArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The octree level, 0 the finest, or `merged`
    #[arg(long, default_value = "0")]
    level: LevelArg,
    /// The colour
    #[arg(long, value_enum, default_value_t = ChannelArg::R)]
    channel: ChannelArg,
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

/// Does the command.
pub fn run(args: &CellsArgs) -> Result<(), CliError> {
    let (_, problem) = args.scene.load()?;
    let mut simulation = Simulation::<f32>::new(problem)?;
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
    let source = source.map(|grid| scaled(grid, share));
    let accumulated = accumulated
        .map(|grid| scaled(grid, share))
        .ok_or_else(|| CliError::Failed("the run ended before the levels were merged".to_owned()))?;

    let Some(path) = &args.out else {
        let mut out = BufWriter::new(std::io::stdout().lock());
        let written = cell_file::write_csv(&mut out, source.as_ref(), &accumulated).and_then(|()| out.flush());
        return match written {
            // Whoever reads may stop early, as `head` does.
            Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
            written => written.map_err(|e| CliError::Failed(format!("cannot write to the terminal: {e}"))),
        };
    };
    let npy = match path.extension().and_then(|e| e.to_str()) {
        Some("npy") => true,
        Some("csv") => false,
        _ => return Err(CliError::Input(format!("{}: the file must end in .csv or .npy", path.display()))),
    };
    let write = || {
        let mut out = BufWriter::new(File::create(path)?);
        if npy {
            cell_file::write_npy(&mut out, &accumulated)?;
        } else {
            cell_file::write_csv(&mut out, source.as_ref(), &accumulated)?;
        }
        out.flush()
    };
    write().map_err(|e: std::io::Error| CliError::cannot_write(path, e))
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
