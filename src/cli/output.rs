//! The folder that a command writes its results to.

use std::path::{Path, PathBuf};

use super::CliError;
use crate::report::raster;
use crate::report::table::Table;
use crate::scene::file::write_whole;

/// A folder that exists.
pub struct Folder(PathBuf);

impl Folder {
    /// Creates the folder, if it is not there.
    pub fn create(path: PathBuf) -> Result<Self, CliError> {
        std::fs::create_dir_all(&path).map_err(|e| CliError::cannot_write(&path, e))?;
        Ok(Folder(path))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Writes a file in it, whole or not at all.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), CliError> {
        write_whole(&self.0.join(name), bytes.as_ref()).map_err(|e| CliError::Failed(e.to_string()))
    }

    /// Writes a table as CSV.
    pub fn write_table<const N: usize>(&self, name: &str, table: &Table<N>) -> Result<(), CliError> {
        let mut csv = Vec::new();
        table.write_csv(&mut csv).map_err(|e| CliError::Failed(format!("{name}: {e}")))?;
        self.write(name, csv)
    }

    /// Writes a drawing as `name`.svg and `name`.png.
    pub fn write_svg_and_png(&self, name: &str, svg: &str) -> Result<(), CliError> {
        let png = raster::png(svg).map_err(|e| CliError::Failed(format!("{name}.png: {e}")))?;
        self.write(&format!("{name}.svg"), svg)?;
        self.write(&format!("{name}.png"), png)
    }
}
