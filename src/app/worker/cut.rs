//! Cuts what the window asks to see out of a simulation. It runs on the worker, so that the window
//! never walks a volume.

mod cloud;

use std::sync::Arc;

use crate::app::worker::look::{Layer, Light, Look, Of, Pane, Shown, State};
use crate::app::worker::track::{self, Track};
use crate::field::{Channels, Grid, Octree, downsample_into};
use crate::report::slice::{Plane, Slice};
use crate::sh::Sh;
use crate::simulation::Simulation;
use crate::study::expectation::{Expectation, References};
use crate::study::light;
pub use cloud::cloud;

/// Everything that `look` asks for. What is not there is left out: tracks, and what truly arrives while it is not
/// known.
pub fn panes(tracks: &mut [Track], references: &References, star: usize, look: &Look) -> Vec<Shown> {
    let Some(first) = tracks.first() else { return Vec::new() };
    // Where levels are asked for, volumes of a single level show the mean light in cells as large.
    let last = first.now().sizes().count() - 1;
    let layer = match look.layer {
        Layer::Level(level) => Layer::Level(level.min(last)),
        Layer::Merged => Layer::Merged,
    };
    let look = Look { layer, ..look.clone() };
    let mut references = references.clone();
    let mut of: Option<Option<usize>> = None;
    let mut shown = Vec::new();
    for pane in &look.panes {
        let iteration = pane.state.iteration;
        // Views of one iteration share what their errors are against.
        if look.against == Expectation::Run && of != Some(iteration) {
            references.run = track::merged(tracks, star, iteration);
            of = Some(iteration);
        }
        shown.extend(cut(tracks, &references, *pane, &look));
    }
    shown
}

fn cut(tracks: &mut [Track], references: &References, pane: Pane, look: &Look) -> Option<Shown> {
    let Look { layer, plane, .. } = *look;
    let other = match pane.minus {
        None => None,
        Some(state) => Some(taken(tracks, references, pane, state, look)?),
    };
    let track = match pane.state.of {
        Of::Track(track) => tracks.get_mut(track)?,
        // It is seen beside the document's own propagator, in the same iteration.
        Of::Truth => tracks.first_mut()?,
    };
    let forgotten = track.at(pane.state.iteration).is_none();
    let state = track.at(if forgotten { None } else { pane.state.iteration })?;
    let mut slice = match pane.state.of {
        Of::Truth => flat(references.ballistic.as_ref()?.light(), state.channels(), layer, plane),
        Of::Track(_) if pane.moved() => flat(&light::moved(state), state.channels(), layer, plane),
        Of::Track(_) => slice(state, pane.light, layer, plane),
    };
    let has_errors = other.is_none() && pane.light == Light::Accumulated && pane.state.of != Of::Truth;
    if let Some(other) = other {
        slice.subtract(&other);
    }
    let held = if has_errors { look.against.of(state, references) } else { None };
    let errors =
        held.map_or_else(Vec::new, |held| slice.cells.iter().map(|cell| held.cell(cell.level, cell.cell)).collect());
    let plane = slice.plane;
    let side = slice.side;
    let finest = |i: usize| plane.axis.cell(plane.index, i % side, i / side);
    let index = (0..side * side).map(|i| state.sampled_level(finest(i)) as u8).collect();
    let in_cut = state.problem().solids.iter().filter(|b| b.cell[plane.axis.across()] == plane.index);
    let occupied = in_cut.map(|b| [b.cell[plane.axis.columns()], b.cell[plane.axis.rows()]]).collect();
    let slice = Arc::new(slice);
    let of_run = None;
    Some(Shown { pane, iteration: state.iteration(), forgotten, slice, of_run, errors, index, occupied })
}

/// What is taken away from a view.
fn taken(
    tracks: &mut [Track],
    references: &References,
    pane: Pane,
    state: State,
    &Look { layer, plane, .. }: &Look,
) -> Option<Slice> {
    match state.of {
        Of::Truth => Some(flat(references.ballistic.as_ref()?.light(), tracks.first()?.now().channels(), layer, plane)),
        Of::Track(track) => {
            let state = tracks.get_mut(track)?.at(state.iteration)?;
            match pane.moved() {
                true => Some(flat(&light::moved(state), state.channels(), layer, plane)),
                false => Some(slice(state, pane.light, layer, plane)),
            }
        }
    }
}

/// A volume of one level, the mean light of the cells of a coarser level where that is asked for.
fn flat(grids: &[Grid<f32>], channels: &Channels, layer: Layer, plane: Plane) -> Slice {
    let level = if let Layer::Level(level) = layer { level } else { 0 };
    let coarse = |grid: &Grid<f32>| {
        (0..level).fold(grid.clone(), |finer, _| {
            let mut coarser = Grid::new(finer.side() / 2);
            downsample_into(&finer, &mut coarser);
            coarser
        })
    };
    let coarse: Vec<Grid<f32>> = grids.iter().map(coarse).collect();
    Slice::level(&coarse.iter().collect::<Vec<_>>(), channels, level, plane)
}

/// A channel's octree.
pub fn octree(light: &crate::simulation::Light<f32>, which: Light) -> &Octree<f32> {
    match which {
        Light::Source => &light.source,
        Light::Target => &light.target,
        Light::Accumulated => &light.accumulated,
    }
}

fn octrees(simulation: &Simulation<f32>, light: Light) -> Vec<&Octree<f32>> {
    simulation.lights().iter().map(|channel| octree(channel, light)).collect()
}

/// What a cut through one octree shows.
pub fn slice(simulation: &Simulation<f32>, light: Light, layer: Layer, plane: Plane) -> Slice {
    let octrees = octrees(simulation, light);
    match layer {
        Layer::Merged if light == Light::Accumulated => Slice::of_merged(simulation, plane),
        Layer::Merged => Slice::merged(&octrees, simulation.index(), simulation.channels(), plane),
        Layer::Level(_) if simulation.sizes().count() == 1 => {
            let grids: Vec<Grid<f32>> = octrees.iter().map(|octree| octree.level(0).clone()).collect();
            flat(&grids, simulation.channels(), layer, plane)
        }
        Layer::Level(level) => {
            let level = level.min(simulation.sizes().count() - 1);
            let grids: Vec<&Grid<f32>> = octrees.iter().map(|octree| octree.level(level)).collect();
            Slice::level(&grids, simulation.channels(), level, plane)
        }
    }
}

/// A cell's red, green and blue from the channels that are carried.
pub fn mix(simulation: &Simulation<f32>, channel: impl Fn(usize) -> Sh<f32>) -> [Sh<f32>; 3] {
    simulation.channels().rgb().map(|share| channel(share.channel) * share.scale as f32)
}

#[cfg(test)]
pub(in crate::app) mod tests {
    use std::path::Path;

    use super::*;
    use crate::app::worker::look::CloudAsk;
    use crate::report::slice::Axis;
    use crate::scene::{Preset, Problem};
    use crate::simulation::Action;
    use crate::study::expectation::Expectation;

    pub fn track(preset: &str) -> Track {
        let preset = Preset::parse(preset, Path::new("test")).unwrap();
        let mut track = Track::new(Problem::build(&preset, Path::new("")).unwrap(), 1 << 20).unwrap();
        for action in [Action::Inject, Action::Downsample, Action::Propagate, Action::Propagate] {
            track.act(action);
        }
        track
    }

    pub fn look(layer: Layer, minus: Option<State>) -> Look {
        let state = State { of: Of::Track(0), iteration: None };
        let pane = Pane { light: Light::Accumulated, state, minus };
        let cloud = Some(CloudAsk { pane, threshold: 0.0 });
        Look {
            panes: vec![pane],
            layer,
            plane: Plane { axis: Axis::Z, index: 2 },
            against: Expectation::Corrected,
            brightest: Default::default(),
            cloud,
        }
    }

    fn none() -> References {
        References::default()
    }

    /// What truly arrives in a track's scene.
    fn references(track: &Track) -> References {
        let mut references = none();
        Expectation::Ballistic.prepare(track.now().problem(), &mut references, &|_| true);
        references
    }

    #[test]
    fn errors_against_a_uniform_volume_vanish_where_nothing_is_propagated() {
        let preset = Preset::parse(ONE, Path::new("test")).unwrap();
        let mut fresh = Track::new(Problem::build(&preset, Path::new("")).unwrap(), 1 << 20).unwrap();
        fresh.act(Action::Inject);
        fresh.act(Action::Downsample);
        let shown = panes(&mut [fresh], &none(), 0, &look(Layer::Level(2), None));
        assert_eq!(shown[0].errors.len(), 4);
        assert!(shown[0].errors.iter().all(|error| error.unwrap().absolute < 1e-6));
        let shown = panes(&mut [track(ONE)], &none(), 0, &look(Layer::Level(2), None));
        assert!(shown[0].errors.iter().any(|error| error.unwrap().absolute > 1e-4));
        let finest = panes(&mut [track(ONE)], &none(), 0, &look(Layer::Level(0), None));
        assert!(finest[0].errors.iter().all(Option::is_none));
    }

    pub const ONE: &str = "(version: 1, size: 8, injectors: [(kind: Single(cell: (2, 2, 2)))], \
                       occluders: [(kind: Box(from: (4, 4, 4), to: (6, 6, 6)))], occlusion: (mode: Off))";

    #[test]
    fn a_difference_from_itself_is_dark_and_from_the_past_is_what_was_added() {
        let mut tracks = [track(ONE)];
        let own = State { of: Of::Track(0), iteration: None };
        let shown = panes(&mut tracks, &none(), 0, &look(Layer::Merged, Some(own)));
        assert!(shown[0].slice.cells.iter().all(|cell| cell.light.iter().all(|sh| sh.is_zero())));
        let before = State { of: Of::Track(0), iteration: Some(1) };
        let shown = panes(&mut tracks, &none(), 0, &look(Layer::Level(0), Some(before)));
        for cell in &shown[0].slice.cells {
            let added = tracks[0].now().lights()[0].source.level(0).get(cell.cell);
            assert!((cell.light[0] - added).max_norm() < 1e-6);
        }
    }

    #[test]
    fn what_truly_arrives_is_seen_beside_the_light_and_its_difference_is_from_what_moved() {
        let mut tracks = [track(ONE)];
        let references = references(&tracks[0]);
        let truth = references.ballistic.clone().unwrap();
        let own = State { of: Of::Track(0), iteration: None };
        let arrived =
            |minus| Pane { light: Light::Accumulated, state: State { of: Of::Truth, iteration: None }, minus };
        let look = Look { panes: vec![arrived(None), arrived(Some(own))], ..look(Layer::Merged, None) };
        assert!(panes(&mut tracks, &none(), 0, &look).is_empty());
        let shown = panes(&mut tracks, &references, 0, &look);
        let moved = light::moved(tracks[0].now());
        for (is, difference) in shown[0].slice.cells.iter().zip(&shown[1].slice.cells) {
            assert_eq!(is.light[0], truth.light()[0].get(is.cell));
            assert_eq!(difference.light[0], is.light[0] - moved[0].get(is.cell));
        }
        let coarse = panes(&mut tracks, &references, 0, &Look { layer: Layer::Level(2), ..look });
        assert_eq!(coarse[0].slice.cells.len(), 4);
    }
}
