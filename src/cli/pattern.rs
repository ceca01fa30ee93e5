//! `pattern`: lights to inject into a port, so that `identify` can tell what it does.

use std::path::PathBuf;

use clap::Args;

use super::{CliError, console};
use crate::field::Grid;
use crate::scene::cell_file;
use crate::study::pattern::Pattern;
use crate::system::file::write_whole;

/// Which pattern, and where to.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  lpv-lab pattern spaced --size 8 --out pattern.h\n  lpv-lab pattern dense --out pattern.csv\n\n\
                        The ending of the file chooses its form: .csv lists the lobes as x,y,z,dx,dy,dz,multiplier; .h is a C header of them;\n\
                        .ron is a preset that injects them; .npy is the injected grid, (n, n, n, 4), indexed [z, y, x].\n\
                        Add each lobe, multiplier times the clamped cosine lobe about its direction, to its cell; lobes in a cell add up.\n\
                        `spaced` shows most: weak cells for the shares of faces, lone lobes aslant of the axes for clamps, lit borders.\n\
                        `dense` lights every cell: in half precision it alone shows a wrong digit of a weight."
)]
pub struct PatternArgs {
    /// The pattern: `spaced` or `dense`
    name: String,
    /// Cells along a side: 8 or 16 for `spaced`, 8 for `dense`
    #[arg(long, value_name = "N", default_value_t = 8)]
    size: usize,
    /// The file to write, .csv, .ron, .npy or .h; without it the CSV goes to the terminal
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// The pattern of a name and size, or what there is.
pub fn find(name: &str, size: usize) -> Result<Pattern, CliError> {
    Pattern::find(name, size).ok_or_else(|| {
        let known: Vec<String> = Pattern::list().map(|(name, side)| format!("{name} at {side}³")).collect();
        CliError::Input(format!("there is no pattern `{name}` at {size}³; there are {}", known.join(", ")))
    })
}

/// Does the command.
pub fn run(args: &PatternArgs) -> Result<(), CliError> {
    let pattern = find(&args.name, args.size)?;
    let Some(path) = &args.out else {
        console::print(format_args!("{}", pattern.csv()));
        return Ok(());
    };
    let bytes = match path.extension().and_then(|e| e.to_str()) {
        Some("csv") => pattern.csv().as_bytes().to_vec(),
        Some("ron") => pattern.preset().into_bytes(),
        Some("h") => pattern.header().into_bytes(),
        Some("npy") => {
            let mut grid = Grid::<f32>::new(pattern.side());
            let mut exact = Grid::<f64>::new(pattern.side());
            pattern.lobes().iter().for_each(|lobe| exact.add(lobe.cell, lobe.light()));
            exact.iter().for_each(|(cell, light)| grid.set(cell, light.cast()));
            let mut bytes = Vec::new();
            cell_file::write_npy(&mut bytes, &grid)
                .map_err(|e| CliError::Failed(format!("{}: {e}", path.display())))?;
            bytes
        }
        _ => {
            let what = format!("{}: the file must end in .csv, .ron, .npy or .h", path.display());
            return Err(CliError::Input(what));
        }
    };
    write_whole(path, &bytes).map_err(|e| CliError::Failed(e.to_string()))
}
