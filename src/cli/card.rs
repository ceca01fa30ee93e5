//! `bench --only-card`: how fast a graphics card steps.

use super::CliError;
use super::console::{self, say};
use super::output::Folder;
use crate::field::Levels;
use crate::report::table::Table;
use crate::study::benchmark::card::card;

/// Measures volumes of these sides, prints the table and writes card.csv.
pub fn run(sizes: &[usize], rounds: usize, folder: &Folder) -> Result<(), CliError> {
    let sizes: Vec<Levels> = sizes.iter().filter_map(|side| Levels::new(*side, *side)).collect();
    let found = card(&sizes, rounds).map_err(|error| CliError::Failed(error.to_string()))?;
    let mut table = Table::new(["size", "loop", "microseconds", "ns_per_cell", "copy_fraction"]);
    for row in &found.rows {
        table.push([
            row.size.into(),
            row.what.into(),
            row.microseconds.into(),
            row.ns_per_cell.into(),
            row.copy_fraction.into(),
        ]);
    }
    console::print(format_args!("{}", table.to_text()));
    say!("\n{}: a copy moves {:.3} TB/s, read and written", found.name, found.copy_bandwidth * 1e-12);
    folder.write_table("card.csv", &table)
}
