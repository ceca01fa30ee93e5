//! From the document that people write to a [`Problem`]: what it asks for, resolved to cells. Transports take it
//! from here.
//!
//! [`preset`] is the document that people write and the window edits; [`Problem::build`] checks it, reads the
//! files it names and lists the light and the occupied cells. Which names of schemes there are is known a floor
//! above: [`crate::transport::preset`] reads presets and checks those too.

pub mod builtin;
pub mod cell_file;
pub(crate) mod doubts;
pub(crate) mod dump_file;
pub(crate) mod emitter;
pub(crate) mod error;
pub(crate) mod file;
pub mod injector;
pub mod mesh_scene;
pub mod occluder;
pub mod path;
pub(crate) mod placement;
pub(crate) mod preset;
pub mod propagation;
pub mod shadow_map;
pub mod stage;
pub(crate) mod voxels;

mod npy;
mod occluder_file;
mod place;
pub(crate) mod receiver;
mod region;
mod row_text;
mod rows;
mod solids;
mod syntax;
mod value;

use std::path::Path;
use std::sync::Arc;

pub use emitter::{Cosine, Emitter, Injected};
pub use error::{Fault, Place, SceneError, Step};
pub use occluder::Occlusion;
pub use placement::Placement;
pub use preset::Preset;
pub use propagation::Propagation;
pub use receiver::Receiver;
pub use solids::Solid;
pub use stage::Stage;
pub use voxels::Voxels;

use crate::field::{Cell, Channels, Grid, Marks};
use crate::sh::{Real, Sh};
use occluder::{Accumulate, OcclusionMode};
use stage::Cache;

/// The most cells that injectors and occluders of one scene may hold together, overlaps counted: half of a
/// 256³ volume. It bounds what building a scene costs (under 1.5 GiB), whatever a preset asks for.
pub const MOST_CELLS: usize = 1 << 23;

/// All that a transport needs to know. Simulations share it and never change it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Problem {
    /// Cells along a side of the volume, n: a power of two.
    pub size: usize,
    /// The side of the coarsest level: a power of two, at most `size`.
    pub coarsest: usize,
    /// The light of each enabled injector, in the preset's order, then that of the mesh's virtual point lights. Where
    /// they share cells they add.
    pub sources: Vec<Source>,
    /// The occupied cells, each once, z slowest and x fastest.
    pub solids: Vec<Solid>,
    /// What stands between the light's cells for fuzzy occlusion, where a mesh tells more than `solids`: a blocker of
    /// cell g stands at the corner that the cells g and g + (1, 1, 1) share. Empty where it is the solids.
    pub between: Vec<Solid>,
    /// What wants to know the light that it receives; none.
    pub receivers: Vec<receiver::Receiver>,
    /// The mesh in its volume with its lights, where the preset has one.
    pub stage: Option<Arc<Stage>>,
    /// How occupied cells act.
    pub occlusion: Occlusion,
    /// How light is propagated.
    pub propagation: Propagation,
}

/// Light to inject.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Source {
    /// Red, green and blue, each ≥ 0. The light is not multiplied by it yet.
    pub color: [f64; 3],
    /// Cells, each once, with their light, the injector's multiplier applied.
    pub light: Vec<(Cell, Sh<f64>)>,
    /// The same light as it leaves surfaces, for transports that keep directions; empty where it comes from none.
    pub cosines: Vec<Cosine>,
}

impl Problem {
    /// Resolves a preset; files are looked for in `folder`, the preset's own.
    pub fn build(preset: &Preset, folder: &Path) -> Result<Problem, SceneError> {
        Problem::build_with(preset, folder, &Cache::default(), &mut |_| {})
    }

    /// The same with what earlier scenes were made from at hand; `progress` is told how much of a mesh is read, 0 to 1.
    pub fn build_with(
        preset: &Preset,
        folder: &Path,
        cache: &Cache,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Problem, SceneError> {
        preset.check()?;
        let mut left = MOST_CELLS;
        let mut sources = Vec::new();
        for (i, injector) in preset.injectors.iter().enumerate().filter(|(_, injector)| injector.enabled) {
            let light =
                take(&mut left, injector.cell_count(preset.size), |most| injector.light(preset.size, folder, most))
                    .map_err(|error| error.within(Step::Item(i)).within(Step::Field("injectors")))?;
            sources.push(Source { color: injector.color, light, ..Source::default() });
        }
        let mut filled = Vec::new();
        for (i, occluder) in preset.occluders.iter().enumerate().filter(|(_, occluder)| occluder.enabled) {
            let cells =
                take(&mut left, occluder.cell_count(preset.size), |most| occluder.cells(preset.size, folder, most))
                    .map_err(|error| error.within(Step::Item(i)).within(Step::Field("occluders")))?;
            filled.extend(cells);
        }
        let (mut mesh, mut between, mut stage) = (Vec::new(), Vec::new(), None);
        if let Some(scene) = &preset.scene {
            let made = Stage::new(scene, preset.size, folder, cache, progress)
                .map_err(|error| error.within(Step::Field("scene")))?;
            sources.extend(made.injected.sources.iter().cloned());
            mesh.clone_from(&made.voxels.solids);
            between = solids::over(made.between.solids.clone(), filled.clone(), preset.size);
            stage = Some(Arc::new(made));
        }
        Ok(Problem {
            size: preset.size,
            coarsest: preset.coarsest,
            sources,
            solids: solids::over(mesh, filled, preset.size),
            between,
            receivers: Vec::new(),
            stage,
            occlusion: preset.occlusion,
            propagation: preset.propagation.clone(),
        })
    }

    /// How often a whole run propagates ([`Propagation::actions`]).
    pub fn actions(&self) -> usize {
        self.propagation.actions(self.size, self.coarsest)
    }

    /// The slab of cells across an axis (0 for x) into which most light is injected; among equals the one
    /// nearest the middle.
    pub fn brightest_slab(&self, axis: usize) -> usize {
        let mut energy = vec![0.0; self.size];
        for source in &self.sources {
            let weight: f64 = source.color.iter().sum();
            for (cell, light) in &source.light {
                energy[cell[axis]] += weight * light.0[0];
            }
        }
        let most = energy.iter().copied().fold(0.0, f64::max);
        let middle = self.size / 2;
        // A hair's breadth of rounding must not decide between slabs that are meant to be equal.
        let nearest = (0..self.size).filter(|&i| energy[i] >= most * (1.0 - 1e-9)).min_by_key(|&i| i.abs_diff(middle));
        nearest.unwrap_or(middle)
    }

    /// What stands between the light's cells for fuzzy occlusion.
    pub fn blockers(&self) -> &[Solid] {
        if self.between.is_empty() { &self.solids } else { &self.between }
    }

    /// Whether anything stands in light's way.
    pub fn has_occluders(&self) -> bool {
        self.occlusion.mode != OcclusionMode::Off && !self.solids.is_empty()
    }

    /// The fewest channels that carry its light: one a colour where a surface may tint the light.
    pub fn channels(&self) -> Channels {
        let tints = |[red, green, blue]: [f64; 3]| red != green || green != blue;
        if self.has_occluders() && self.solids.iter().any(|solid| tints(solid.albedo)) {
            return Channels::separate();
        }
        let colors: Vec<[f64; 3]> = self.sources.iter().map(|source| source.color).collect();
        Channels::of_colors(&colors)
    }

    /// The light that is injected into the finest cells, by channel.
    pub fn injected<T: Real>(&self, channels: &Channels) -> Vec<Grid<T>> {
        let channel = |channel: usize| {
            let mut grid = Grid::new(self.size);
            for source in &self.sources {
                let weight = channels.weight(channel, source.color);
                source.light.iter().for_each(|(cell, light)| grid.add(*cell, (*light * weight).cast()));
            }
            grid
        };
        (0..channels.count()).map(channel).collect()
    }

    /// The cells of level `level` (0 the finest) that accumulate light; `None` where all do.
    pub fn accumulating(&self, level: usize) -> Option<Marks> {
        if self.occlusion.accumulate == Accumulate::Everywhere {
            return None;
        }
        let mut occupied = Marks::new(self.size >> level);
        self.solids.iter().for_each(|solid| occupied.set(solid.cell.map(|c| c >> level)));
        Some(occupied)
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
        return Err(Fault::new(what, "use fewer or smaller ones, or a smaller volume").into());
    }
    let cells = list(*left)?;
    *left -= cells.len().min(*left);
    Ok(cells)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::injector::{Injector, InjectorKind, Side};
    use super::occluder::{Axis, Occluder, OccluderKind};
    use super::*;

    /// The scene of one injector in a volume of side 8.
    fn lit_by(injector: Injector) -> Problem {
        let preset = Preset { size: 8, injectors: vec![injector], ..Preset::default() };
        Problem::build(&preset, Path::new("")).unwrap()
    }

    #[test]
    fn a_wall_lights_its_side_and_sends_inwards() {
        for (i, side) in Side::ALL.into_iter().enumerate() {
            let problem = lit_by(Injector::new(InjectorKind::Wall { side }));
            let (axis, at, sign) = (i / 2, [0, 7][i % 2], [1.0, -1.0][i % 2]);
            let light = &problem.sources[0].light;
            assert_eq!(light.len(), 64);
            assert!(light.iter().all(|(cell, _)| cell[axis] == at), "{side:?}");
            let lobe = Sh::lobe(DVec3::AXES[axis] * sign);
            assert!(light.iter().all(|(_, sh)| *sh == lobe), "{side:?}");
        }
    }

    #[test]
    fn direction_is_normalised_the_multiplier_applied_and_the_colour_kept_apart() {
        for length in [1e-300, 5.0, 1e300] {
            let problem = lit_by(Injector {
                direction: Some([0.0, -0.6 * length, 0.8 * length]),
                multiplier: 2.5,
                color: [0.1, 0.2, 0.3],
                ..Injector::new(InjectorKind::Single { cell: [1, 2, 3] })
            });
            let [(cell, sh)] = problem.sources[0].light[..] else { panic!("one cell") };
            let expected = Sh::<f64>::lobe(DVec3::new(0.0, -0.6, 0.8)) * 2.5;
            assert_eq!((cell, problem.sources[0].color), ([1, 2, 3], [0.1, 0.2, 0.3]));
            assert!((sh - expected).max_norm() < 1e-14, "{sh:?} {expected:?}");
        }
    }

    #[test]
    fn a_rectangle_holds_both_ends_and_what_is_switched_off_does_nothing() {
        let rectangle = InjectorKind::Rectangle { from: [4, 4, 6], to: [6, 7, 6] };
        let off = Occluder { enabled: false, ..Occluder::new(OccluderKind::Plane { axis: Axis::X, at: 1 }) };
        let preset = Preset {
            size: 8,
            injectors: vec![Injector { enabled: false, ..Injector::new(rectangle.clone()) }, Injector::new(rectangle)],
            occluders: vec![off],
            ..Preset::default()
        };
        let problem = Problem::build(&preset, Path::new("")).unwrap();
        assert_eq!((problem.sources.len(), problem.sources[0].light.len(), problem.solids.len()), (1, 12, 0));
    }

    #[test]
    fn a_scene_of_too_many_cells_is_refused_before_they_are_listed() {
        let all = OccluderKind::Box { from: [0; 3], to: [1023; 3] };
        let preset = Preset { size: 1024, occluders: vec![Occluder::new(all)], ..Preset::default() };
        let error = Problem::build(&preset, Path::new("")).unwrap_err().to_string();
        assert!(error.starts_with("occluders[0]: ") && error.contains("8388608 cells"), "{error}");
    }
}
