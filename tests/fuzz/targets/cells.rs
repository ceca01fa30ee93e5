//! What must hold for any bytes that are read as cells, whatever the format.

use lpv_lab::scene::cell_file::{self, Column};

use super::scratch;

/// Reads `bytes` as a file of this name: one line that says why not, or cells inside the volume with finite light.
pub fn check(name: &str, bytes: &[u8]) {
    let path = scratch::file(name, bytes);
    for column in [None, Some(Column::Source), Some(Column::Accumulated)] {
        match cell_file::read(&path, 2, column) {
            Ok(cells) => {
                assert!(cells.len() <= 8);
                assert!(cells.iter().all(|(cell, light)| cell.iter().all(|c| *c < 2) && light.max_norm().is_finite()));
            }
            Err(error) => {
                let line = error.to_string();
                assert!(line.lines().count() == 1 && line.contains(name) && line.contains("; "), "{line}");
            }
        }
    }
}
