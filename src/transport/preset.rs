//! Presets that can be run: what [`crate::scene`] reads, with the name of their scheme checked as well.

use std::path::Path;

use crate::scene::error::{Fault, SceneError};
use crate::scene::preset::LONGEST;
use crate::scene::{Preset, Problem, file};

/// Reads a preset's text; `name` is the file that errors name.
///
/// ```
/// use lpv_lab::transport::preset;
///
/// let misspelt = "(version: 1, propagation: (scheme: \"cascade\"))";
/// let error = preset::parse(misspelt, "walls.ron".as_ref()).unwrap_err().to_string();
/// assert!(error.starts_with("walls.ron:1:36: the scheme `cascade` is not known; did you mean `cascaded`?"));
/// ```
pub fn parse(text: &str, name: &Path) -> Result<Preset, SceneError> {
    let preset = Preset::parse(text, name)?;
    check_name(&preset).map_err(|fault| SceneError::from(fault).at_its_place(text, name))?;
    Ok(preset)
}

/// Reads a preset from a file.
pub fn read(path: &Path) -> Result<Preset, SceneError> {
    parse(&file::read_text(path, LONGEST)?, path)
}

/// Reads a preset from a file and resolves it; errors tell the place in the file.
pub fn load(path: &Path) -> Result<(Preset, Problem), SceneError> {
    let text = file::read_text(path, LONGEST)?;
    let preset = parse(&text, path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let problem = Problem::build(&preset, folder).map_err(|error| error.at_its_place(&text, path))?;
    Ok((preset, problem))
}

/// Whether every value is one that can be run; [`parse`] applies the same rules.
pub fn check(preset: &Preset) -> Result<(), Fault> {
    preset.check()?;
    check_name(preset)
}

fn check_name(preset: &Preset) -> Result<(), Fault> {
    super::check(&preset.propagation).map_err(|fault| fault.field("propagation"))
}
