//! Any bytes as an array of cells: one line that says why not, or cells inside the volume with finite light.
#![no_main]

mod scratch;

use libfuzzer_sys::fuzz_target;
use lpv_lab::scene::cell_file::{self, Column};

fuzz_target!(|bytes: &[u8]| {
    let path = scratch::file("cells.npy", bytes);
    for column in [Column::Source, Column::Accumulated] {
        match cell_file::read(&path, 2, column) {
            Ok(cells) => {
                assert!(cells.len() <= 8);
                assert!(cells.iter().all(|(cell, light)| cell.iter().all(|c| *c < 2) && light.max_norm().is_finite()));
            }
            Err(error) => {
                let line = error.to_string();
                assert!(line.lines().count() == 1 && line.contains("cells.npy") && line.contains("; "), "{line}");
            }
        }
    }
});
