//! The rows of `bench --device gpu`: how fast a graphics card steps.

use super::CliError;
use super::console::say;
use crate::field::Levels;
use crate::report::table::{Table, Value};
use crate::study::benchmark::KernelRow;
use crate::study::benchmark::card::card;

/// Measures volumes of these sides, adds them to the table of `kernels.csv` behind the processor's `rows`, and tells what
/// has no column there.
pub fn add(sizes: &[usize], rounds: usize, rows: &[KernelRow], table: &mut Table<9>) -> Result<(), CliError> {
    let sizes: Vec<Levels> = sizes.iter().filter_map(|side| Levels::new(*side, *side)).collect();
    let found = card(&sizes, rounds).map_err(|error| CliError::Failed(error.to_string()))?;
    say!("{}: a copy moves {:.3} TB/s, read and written", found.name, found.copy_bandwidth * 1e-12);
    for row in &found.rows {
        // The usual way of writing it, on one thread of the processor, where that was measured.
        let usual = rows.iter().find(|one| one.kernel == "aos" && one.size == row.size && one.threads == 1);
        table.push([
            "cascaded".into(),
            row.size.into(),
            "gpu".into(),
            row.kernel.into(),
            row.ns_per_cell.into(),
            usual.map_or(Value::from(""), |usual| (usual.ns_per_cell / row.ns_per_cell).into()),
            row.copy_fraction.into(),
            1.0.into(),
            (row.bytes as usize).into(),
        ]);
        let what = if row.kernel == "card-thesis" { "its four iterations" } else { "an iteration" };
        let clock = if row.by_its_clock { "by the card's clock" } else { "until the card answers" };
        say!("  {} at n = {}: {what} in {:.1} us {clock}", row.kernel, row.size, row.microseconds);
    }
    Ok(())
}
