//! `schemes`: every propagation scheme with its gains and critical factors, computed.

use clap::Args;

use super::CliError;
use super::console::{self, say};
use crate::report::table::{Table, Value};
use crate::study::stability;
use crate::transport::lattice::schemes;
use crate::transport::{Kind, kinds};

/// What to show.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  lpv-lab schemes\n  lpv-lab schemes --long\n\n\
                        Gains: what an iteration at factor 1 multiplies the mean and the direction of a uniform field by.\n\
                        Critical factors: above them light in an open volume of that size grows without bound.\n\
                        The transports below the table are no schemes of the lattice: they are chosen alike, and have no critical factor.")]
pub struct SchemesArgs {
    /// Tell also what each is, where it was published and what it gets wrong
    #[arg(long)]
    long: bool,
}

/// Does the command.
pub fn run(args: &SchemesArgs) -> Result<(), CliError> {
    let mut table = Table::new(["scheme", "mean gain", "direction", "p < 2³", "4³", "8³", "16³", "32³"]);
    for scheme in schemes::all() {
        let found = stability::of_scheme(&scheme, &stability::SIZES);
        let critical = |i: usize| found.critical.get(i).map_or("-".into(), |(_, factor)| Value::Number(*factor));
        table.push([
            scheme.name.into(),
            found.mean_gain.into(),
            found.direction_gain.into(),
            critical(0),
            critical(1),
            critical(2),
            critical(3),
            critical(4),
        ]);
    }
    console::print(format_args!("{}", table.to_text()));
    let bounded = |kind: &&Kind| !kind.can.grows;
    for kind in kinds().iter().filter(|kind| args.long || bounded(kind)) {
        say!("\n{}: {}; p = {} keeps all", kind.name, kind.summary, kind.conserving);
        if args.long {
            say!("  source: {}\n  flaws: {}", kind.source, kind.flaws);
        }
    }
    Ok(())
}
