//! The folder that a command writes its results to.

use std::path::{Path, PathBuf};

use super::CliError;
use crate::report::raster;

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

    /// Writes a file in it.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), CliError> {
        let path = self.0.join(name);
        std::fs::write(&path, bytes).map_err(|e| CliError::cannot_write(&path, e))
    }

    /// Writes a drawing as `name`.svg and `name`.png.
    pub fn write_svg_and_png(&self, name: &str, svg: &str) -> Result<(), CliError> {
        let png = raster::png(svg).map_err(|e| CliError::Failed(format!("{name}.png: {e}")))?;
        self.write(&format!("{name}.svg"), svg)?;
        self.write(&format!("{name}.png"), png)
    }
}
