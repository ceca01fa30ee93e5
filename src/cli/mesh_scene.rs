//! What a scene with a mesh takes while it is worked on, as `bench` measures it: a table and `scenes.csv`.

use super::CliError;
use super::console::{self, say};
use super::output::Folder;
use crate::report::table::Table;
use crate::study::benchmark::mesh_scene;

/// Measures, prints and writes the file.
pub fn run(rounds: usize, folder: &Folder) -> Result<(), CliError> {
    let mut table = Table::new(["scene", "work", "threads", "ms"]);
    for row in mesh_scene::measure(rounds)? {
        table.push([
            row.scene.as_str().into(),
            row.work.as_str().into(),
            row.threads.into(),
            (1e3 * row.seconds).into(),
        ]);
    }
    say!("\nA scene with a mesh:");
    console::print(format_args!("{}", table.to_text()));
    folder.write_table("scenes.csv", &table)
}
