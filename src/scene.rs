//! The scene: what a preset asks for, resolved to cells. The simulation takes it from here.
//!
//! [`preset`] is the document that people write and the window edits; [`Scene::build`] checks it, reads the
//! files it names and lists the light and the occupied cells.

pub mod cell_file;
pub mod error;
pub mod file;
pub mod injector;
pub mod occluder;
pub mod preset;

mod blockers;
mod npy;
mod occluder_file;
mod place;
mod region;
mod rows;
mod syntax;

use std::path::Path;

pub use error::SceneError;
pub use occluder::Occlusion;
pub use preset::{Preset, Propagation};

pub use crate::propagate::geometry::Blocker;

use crate::field::Cell;
use crate::sh::Sh;
use error::{Problem, Step};

/// The most cells that injectors and occluders of one scene may hold together, overlaps counted: half of a
/// 256³ volume. It bounds what building a scene costs (under 1.5 GiB), whatever a preset asks for.
pub const MOST_CELLS: usize = 1 << 23;

/// All that a simulation needs to know.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Cells along a side of the volume, n: a power of two.
    pub size: usize,
    /// The side of the coarsest level: a power of two, at most `size`.
    pub coarsest: usize,
    /// The light of each enabled injector, in the preset's order. Where they share cells they add.
    pub sources: Vec<Source>,
    /// The occupied cells, each once, z slowest and x fastest.
    pub blockers: Vec<Blocker>,
    /// How occupied cells act.
    pub occlusion: Occlusion,
    /// How light is propagated.
    pub propagation: Propagation,
}

/// Light to inject.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Red, green and blue, each ≥ 0. The light is not multiplied by it yet.
    pub color: [f64; 3],
    /// Cells, each once, with their light, the injector's multiplier applied.
    pub light: Vec<(Cell, Sh<f64>)>,
}

impl Scene {
    /// Resolves a preset; files are looked for in `folder`, the preset's own.
    pub fn build(preset: &Preset, folder: &Path) -> Result<Scene, SceneError> {
        preset.check()?;
        let mut left = MOST_CELLS;
        let mut sources = Vec::new();
        for (i, injector) in preset.injectors.iter().enumerate().filter(|(_, injector)| injector.enabled) {
            let light =
                take(&mut left, injector.cell_count(preset.size), |most| injector.light(preset.size, folder, most))
                    .map_err(|error| error.within(Step::Item(i)).within(Step::Field("injectors")))?;
            sources.push(Source { color: injector.color, light });
        }
        let mut filled = Vec::new();
        for (i, occluder) in preset.occluders.iter().enumerate().filter(|(_, occluder)| occluder.enabled) {
            let cells =
                take(&mut left, occluder.cell_count(preset.size), |most| occluder.cells(preset.size, folder, most))
                    .map_err(|error| error.within(Step::Item(i)).within(Step::Field("occluders")))?;
            filled.extend(cells);
        }
        Ok(Scene {
            size: preset.size,
            coarsest: preset.coarsest,
            sources,
            blockers: blockers::resolve(filled, preset.size),
            occlusion: preset.occlusion,
            propagation: preset.propagation.clone(),
        })
    }

    /// Reads a preset from a file and resolves it; errors tell the place in the file.
    pub fn load(path: &Path) -> Result<(Preset, Scene), SceneError> {
        let text = file::read_text(path, preset::LONGEST)?;
        let preset = Preset::parse(&text, path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        match Scene::build(&preset, folder) {
            Ok(scene) => Ok((preset, scene)),
            Err(SceneError::Document(problem)) => Err(place::at_its_place(problem, &text, path)),
            Err(error) => Err(error),
        }
    }
}

/// Lists cells by `list` while the scene has room for them: `known` cells, or as many as a file turns out to hold.
fn take<T>(
    left: &mut usize,
    known: usize,
    list: impl FnOnce(usize) -> Result<Vec<T>, SceneError>,
) -> Result<Vec<T>, SceneError> {
    if known > *left {
        let what = format!("with this the scene holds more than {MOST_CELLS} cells of light and occluders");
        return Err(Problem::new(what, "use fewer or smaller ones, or a smaller volume").into());
    }
    let cells = list(*left)?;
    *left -= cells.len().min(*left);
    Ok(cells)
}
