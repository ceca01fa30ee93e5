//! `identify`: is a port right? From dumps of its grid.

use std::path::{Path, PathBuf};

use clap::Args;

use super::console::say;
use super::output::Folder;
use super::{CliError, pattern};
use crate::field::Cell;
use crate::report::port;
use crate::scene::Problem;
use crate::study::identify::files::{Files, LATEST, Role};
use crate::study::identify::verdict::{Judgement, Verdict};
use crate::study::identify::{Dumps, identify};

/// The dumps, and what they are of.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  lpv-lab pattern spaced --size 8 --out pattern.h\n  \
                        (inject it into your port, dump the grid after injection and after iterations 1, 2 and 4)\n  \
                        lpv-lab identify --pattern spaced --injected s0.npy --source 1=s1.npy,2=s2.npy,4=s4.npy --accumulated 4=a4.npy --out verdict\n\n\
                        Dumps are .npy arrays of shape (n, n, n, 4), float16, float32 or float64, in any order of axes and coefficients, or CSV files of cells.\n\
                        The injected grid and the source grid after iteration 1 are needed, others tell more.\n\
                        DIR gets verdict.txt, identify.csv (item,value,uncertainty) and, where a cell is wrong, first-wrong-cell.svg and .png.\n\
                        Exit codes: 0 looked at, 1 --expect is not met, 2 a dump cannot be read.")]
pub struct IdentifyArgs {
    /// What was injected: `spaced`, `dense`, or `none` for a scene of your own
    #[arg(long, default_value = "spaced")]
    pattern: String,
    /// The grid after injection, before the first iteration
    #[arg(long, value_name = "FILE")]
    injected: PathBuf,
    /// Grids that the next iteration propagates, by iteration
    #[arg(long, value_name = "K=FILE", value_delimiter = ',', required = true)]
    source: Vec<Numbered>,
    /// Accumulated grids, by iteration
    #[arg(long, value_name = "K=FILE", value_delimiter = ',')]
    accumulated: Vec<Numbered>,
    /// What fixed-point numbers were multiplied by
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    scale: f64,
    /// Cells along a side, where all dumps are CSV files of few cells
    #[arg(long, value_name = "N")]
    size: Option<usize>,
    /// A preset whose occluders stand in the port's scene: cells that they reach are left out
    #[arg(long, value_name = "PRESET")]
    occluders: Option<PathBuf>,
    /// The scheme that the port must be, without a mistake: exit code 1 otherwise
    #[arg(long, value_name = "SCHEME")]
    expect: Option<String>,
    /// The folder for the results
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// A dump of an iteration.
#[derive(Clone, Debug)]
struct Numbered {
    iteration: usize,
    path: PathBuf,
}

impl std::str::FromStr for Numbered {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` names no dump; write the iteration and the file, such as 1=s1.npy");
        let (iteration, path) = text.split_once('=').ok_or_else(wrong)?;
        let iteration = iteration.trim().parse().ok().filter(|k| (1..=LATEST).contains(k)).ok_or_else(wrong)?;
        if path.is_empty() { Err(wrong()) } else { Ok(Numbered { iteration, path: path.into() }) }
    }
}

/// Does the command.
pub fn run(args: &IdentifyArgs) -> Result<(), CliError> {
    if let Some(scheme) = &args.expect
        && crate::transport::lattice::schemes::find(scheme).is_none()
    {
        let known = crate::transport::lattice::schemes::names().join(", ");
        return Err(CliError::Input(format!("--expect {scheme}: there is no such scheme; there are {known}")));
    }
    if !(args.scale.is_finite() && args.scale > 0.0) {
        return Err(CliError::Input("--scale: the factor must be a number above 0".to_owned()));
    }
    let folder = args.out.as_ref().map(Folder::create).transpose()?;
    let dumps = read(args)?;
    let side = dumps.injected.side;
    let pattern = match args.pattern.as_str() {
        "none" => None,
        name => Some(pattern::find(name, side)?),
    };
    let hidden = args.occluders.as_ref().map_or(Ok(Vec::new()), |preset| hidden(preset, side))?;
    let verdict = identify(&dumps, pattern.as_ref(), &hidden).map_err(|e| CliError::Input(e.to_string()))?;
    let lines = port::lines(&verdict);
    lines.iter().for_each(|line| say!("{line}"));
    if let Some(folder) = folder {
        write(&folder, &lines, &verdict)?;
        folder.finish();
    }
    match &args.expect {
        Some(scheme) if verdict.judgement != Judgement::Correct || verdict.scheme != Some(scheme.as_str()) => {
            Err(CliError::Failed(format!("--expect {scheme} is not met: {}", lines[0])))
        }
        _ => Ok(()),
    }
}

fn write(folder: &Folder, lines: &[String], verdict: &Verdict) -> Result<(), CliError> {
    folder.write("verdict.txt", lines.join("\n") + "\n")?;
    let csv = port::csv(verdict).map_err(|e| CliError::Failed(format!("identify.csv: {e}")))?;
    folder.write("identify.csv", csv)?;
    match port::picture(verdict) {
        Some(svg) => folder.write_svg_and_png("first-wrong-cell", &svg),
        None => Ok(()),
    }
}

/// Reads all dumps.
fn read(args: &IdentifyArgs) -> Result<Dumps, CliError> {
    let injected = (args.injected.clone(), Role::Injected);
    let source = args.source.iter().map(|dump| (dump.path.clone(), Role::Source(dump.iteration)));
    let accumulated = args.accumulated.iter().map(|dump| (dump.path.clone(), Role::Accumulated(dump.iteration)));
    let files = [injected].into_iter().chain(source).chain(accumulated).collect();
    let files = Files { files, scale: args.scale, size: args.size };
    files.read().map_err(|e| CliError::Input(e.to_string()))
}

/// The cells in which an occluder stands, and their neighbours, edges and corners too.
fn hidden(preset: &Path, side: usize) -> Result<Vec<bool>, CliError> {
    let opened = super::open(preset)?;
    let problem = Problem::build(&opened.preset, &opened.folder)?;
    if problem.size != side {
        let what = format!("{}: the preset has {}³ cells, the dumps have {side}³", preset.display(), problem.size);
        return Err(CliError::Input(what + "; give the preset of the port's scene"));
    }
    let mut hidden = vec![false; side.pow(3)];
    let around = |c: usize| c.saturating_sub(1)..(c + 2).min(side);
    for [x, y, z] in problem.solids.iter().map(|solid| -> Cell { solid.cell }) {
        for (z, y) in around(z).flat_map(|z| around(y).map(move |y| (z, y))) {
            around(x).for_each(|x| hidden[x + side * (y + side * z)] = true);
        }
    }
    Ok(hidden)
}
