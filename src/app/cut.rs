//! Cuts what the window asks to see out of a simulation. It runs on the worker, so that the window
//! never walks a volume.

use std::collections::HashSet;
use std::sync::Arc;

use super::look::{CellError, Cloud, CloudCell, Layer, Light, Look, Pane, Pin, PinSample, Shown};
use super::track::Track;
use crate::field::{Cell, Grid, Layout, Octree, mean_of_children};
use crate::report::slice::{Plane, Slice};
use crate::sh::Sh;
use crate::simulation::Simulation;

/// The most cells that the three-dimensional view draws.
const MOST_CELLS: usize = 12_000;

/// Everything that `look` asks for. Tracks that are not there are left out.
pub fn panes(tracks: &mut [Track], look: &Look) -> Vec<Shown> {
    look.panes.iter().filter_map(|pane| cut(tracks, *pane, look)).collect()
}

fn cut(tracks: &mut [Track], pane: Pane, look: &Look) -> Option<Shown> {
    let (layer, plane) = (look.layer, look.plane);
    let other = match pane.minus {
        None => None,
        Some(state) => Some(slice(tracks.get_mut(state.track)?.at(state.iteration)?, pane.light, layer, plane)),
    };
    let track = tracks.get_mut(pane.state.track)?;
    let forgotten = track.at(pane.state.iteration).is_none();
    let state = track.at(if forgotten { None } else { pane.state.iteration })?;
    let mut slice = slice(state, pane.light, layer, plane);
    let difference = other.is_some();
    if let Some(other) = other {
        subtract(&mut slice, &other);
    }
    let errors = match pane.light {
        Light::Accumulated if !difference => {
            slice.cells.iter().map(|c| error(state, c.level, c.cell, look.uniform)).collect()
        }
        _ => Vec::new(),
    };
    let plane = slice.plane;
    let side = slice.side;
    let finest = |i: usize| plane.axis.cell(plane.index, i % side, i / side);
    let index = (0..side * side).map(|i| state.index().index(finest(i)) as u8).collect();
    let in_cut = state.scene().blockers.iter().filter(|b| b.cell[plane.axis.across()] == plane.index);
    let occupied = in_cut.map(|b| [b.cell[plane.axis.columns()], b.cell[plane.axis.rows()]]).collect();
    Some(Shown { pane, iteration: state.iteration(), forgotten, slice: Arc::new(slice), errors, index, occupied })
}

/// A channel's octree.
fn octree(light: &crate::simulation::Light<f32>, which: Light) -> &Octree<f32> {
    match which {
        Light::Source => &light.source,
        Light::Target => &light.target,
        Light::Accumulated => &light.accumulated,
    }
}

fn octrees(simulation: &Simulation<f32>, light: Light) -> Vec<&Octree<f32>> {
    simulation.lights().iter().map(|channel| octree(channel, light)).collect()
}

fn slice(simulation: &Simulation<f32>, light: Light, layer: Layer, plane: Plane) -> Slice {
    let octrees = octrees(simulation, light);
    match layer {
        Layer::Merged => Slice::merged(&octrees, simulation.index(), simulation.channels(), plane),
        Layer::Level(level) => {
            let level = level.min(simulation.sizes().count() - 1);
            let grids: Vec<&Grid<f32>> = octrees.iter().map(|octree| octree.level(level)).collect();
            Slice::level(&grids, simulation.channels(), level, plane)
        }
    }
}

/// Takes the light of `other` away, square by square, sampled at each square's lower left corner.
fn subtract(slice: &mut Slice, other: &Slice) {
    let mut light = vec![[Sh::ZERO; 3]; other.side * other.side];
    for cell in &other.cells {
        for row in cell.row..cell.row + cell.span {
            let start = row * other.side + cell.column;
            light[start..start + cell.span].fill(cell.light);
        }
    }
    for cell in &mut slice.cells {
        let taken = light.get(cell.row * other.side + cell.column).copied().unwrap_or_default();
        cell.light = std::array::from_fn(|c| cell.light[c] - taken[c]);
    }
}

/// A cell's red, green and blue from the channels that are carried.
fn mix(simulation: &Simulation<f32>, channel: impl Fn(usize) -> Sh<f32>) -> [Sh<f32>; 3] {
    simulation.channels().rgb().map(|share| channel(share.channel) * share.scale as f32)
}

/// How far an accumulated cell is from the mean of its children, or of all finest cells in it, which is what a
/// uniform volume holds there; level 0 has neither.
fn error(simulation: &Simulation<f32>, level: usize, cell: Cell, uniform: bool) -> Option<CellError> {
    let finer = level.checked_sub(1)?;
    let accumulated = |channel: usize| &simulation.lights()[channel].accumulated;
    let is = mix(simulation, |channel| accumulated(channel).level(level).get(cell));
    let ought = mix(simulation, |channel| match uniform {
        false => mean_of_children(accumulated(channel).level(finer), cell),
        true => mean_within(accumulated(channel).level(0), level, cell),
    });
    let norm = |light: [Sh<f32>; 3]| light.iter().fold(0.0, |m: f32, sh| m.max(sh.max_norm()));
    let absolute = norm(std::array::from_fn(|c| is[c] - ought[c]));
    let relative = match norm(is) {
        size if size > 0.0 => Some(absolute / size),
        _ if absolute > 0.0 => None,
        _ => Some(0.0),
    };
    Some(CellError { absolute, relative })
}

/// The mean of all finest cells within a cell of `level`.
fn mean_within(finest: &Grid<f32>, level: usize, cell: Cell) -> Sh<f32> {
    let span = 1 << level;
    let [x0, y0, z0] = cell.map(|c| c * span);
    let inside = Layout::new(span).cells().map(|[x, y, z]| finest.get([x0 + x, y0 + y, z0 + z]).widen());
    let sum: Sh<f64> = inside.sum();
    (sum * (span as f64).powi(-3)).cast()
}

/// The lit cells of the view that `look` asks for, the strongest first.
pub fn cloud(tracks: &mut [Track], look: &Look) -> Option<Cloud> {
    let ask = look.cloud?;
    let track = tracks.get_mut(ask.pane.state.track)?;
    let known = track.at(ask.pane.state.iteration).is_some();
    let state = track.at(if known { ask.pane.state.iteration } else { None })?;
    let octrees = octrees(state, ask.pane.light);
    let mut cells = Vec::new();
    let mut take = |sampled: usize, level: usize, cell: Cell| {
        let source = cell.map(|c| c >> (sampled - level));
        let light = mix(state, |channel| octrees[channel].level(sampled).get(source));
        if light.iter().any(|sh| !sh.is_zero()) {
            let span = (1 << level) as f32;
            cells.push(CloudCell { centre: cell.map(|c| (c as f32 + 0.5) * span), span, light });
        }
    };
    let last = state.sizes().count() - 1;
    match look.layer {
        Layer::Level(level) => {
            let level = level.min(last);
            state.lights()[0].source.level(level).layout().cells().for_each(|cell| take(level, level, cell));
        }
        Layer::Merged => {
            let coarsest = state.lights()[0].source.level(last).layout().cells();
            coarsest.for_each(|cell| cubes(state, last, cell, &mut take));
        }
    }
    let strength = |cell: &CloudCell| cell.light.iter().fold(0.0, |m: f32, sh| m.max(sh.0[0].abs()));
    let strongest = cells.iter().map(strength).fold(0.0, f32::max);
    cells.retain(|cell| strength(cell) >= ask.threshold * strongest);
    cells.sort_by(|a, b| strength(b).total_cmp(&strength(a)));
    let left_out = cells.len().saturating_sub(MOST_CELLS);
    cells.truncate(MOST_CELLS);
    Some(Cloud { side: state.sizes().finest(), cells, occupied: surface(state), left_out, strongest })
}

/// The middles of the occupied cells that are not hidden among others.
fn surface(state: &Simulation<f32>) -> Vec<[f32; 3]> {
    let occupied: HashSet<Cell> = state.scene().blockers.iter().map(|blocker| blocker.cell).collect();
    let hidden = |cell: &Cell| {
        (0..3).all(|axis| {
            [-1, 1].into_iter().all(|step| {
                let mut next = *cell;
                let Some(at) = next[axis].checked_add_signed(step) else { return false };
                next[axis] = at;
                occupied.contains(&next)
            })
        })
    };
    let mut cells: Vec<Cell> = occupied.iter().copied().filter(|cell| !hidden(cell)).collect();
    cells.sort_unstable();
    cells.truncate(MOST_CELLS);
    cells.into_iter().map(|cell| cell.map(|c| c as f32 + 0.5)).collect()
}

/// Hands the samples within a cell to `take`, each with the level that it is sampled from and a cube as
/// large as nothing finer lies in it.
fn cubes(state: &Simulation<f32>, level: usize, cell: Cell, take: &mut impl FnMut(usize, usize, Cell)) {
    let span = 1 << level;
    let [x0, y0, z0] = cell.map(|c| c * span);
    let index = |[x, y, z]: Cell| state.index().index([x0 + x, y0 + y, z0 + z]);
    if level == 0 || Layout::new(span).cells().all(|inside| index(inside) >= level) {
        take(index([0; 3]), level, cell);
        return;
    }
    let children = Layout::new(2).cells();
    children.for_each(|[x, y, z]| cubes(state, level - 1, [2 * cell[0] + x, 2 * cell[1] + y, 2 * cell[2] + z], take));
}

/// What a pinned cell holds in a state.
pub fn sample(state: &Simulation<f32>, pin: Pin) -> Option<PinSample> {
    let side = state.sizes().side(pin.level);
    if pin.level >= state.sizes().count() || pin.cell.iter().any(|c| *c >= side) {
        return None;
    }
    let of =
        |which: Light| mix(state, |channel| octree(&state.lights()[channel], which).level(pin.level).get(pin.cell));
    Some(PinSample { iteration: state.iteration(), source: of(Light::Source), accumulated: of(Light::Accumulated) })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::app::look::{CloudAsk, State};
    use crate::report::slice::Axis;
    use crate::scene::{Preset, Scene};
    use crate::simulation::Action;

    fn track(preset: &str) -> Track {
        let preset = Preset::parse(preset, Path::new("test")).unwrap();
        let mut track = Track::new(Scene::build(&preset, Path::new("")).unwrap(), 1 << 20).unwrap();
        for action in [Action::Inject, Action::Downsample, Action::Propagate, Action::Propagate] {
            track.act(action);
        }
        track
    }

    fn look(layer: Layer, minus: Option<State>) -> Look {
        let state = State { track: 0, iteration: None };
        let pane = Pane { light: Light::Accumulated, state, minus };
        let cloud = Some(CloudAsk { pane, threshold: 0.0 });
        Look { panes: vec![pane], layer, plane: Plane { axis: Axis::Z, index: 2 }, uniform: true, cloud }
    }

    const ONE: &str = "(version: 1, size: 8, injectors: [(kind: Single(cell: (2, 2, 2)))], \
                       occluders: [(kind: Box(from: (4, 4, 4), to: (6, 6, 6)))], occlusion: (mode: Off))";

    #[test]
    fn a_difference_from_itself_is_dark_and_from_the_past_is_what_was_added() {
        let mut tracks = [track(ONE)];
        let own = State { track: 0, iteration: None };
        let shown = panes(&mut tracks, &look(Layer::Merged, Some(own)));
        assert!(shown[0].slice.cells.iter().all(|cell| cell.light.iter().all(|sh| sh.is_zero())));
        let before = State { track: 0, iteration: Some(1) };
        let shown = panes(&mut tracks, &look(Layer::Level(0), Some(before)));
        for cell in &shown[0].slice.cells {
            let added = tracks[0].now().lights()[0].source.level(0).get(cell.cell);
            assert!((cell.light[0] - added).max_norm() < 1e-6);
        }
    }

    #[test]
    fn the_cloud_holds_each_finest_cell_at_most_once_with_its_sample() {
        let mut tracks = [track(ONE)];
        let found = cloud(&mut tracks, &look(Layer::Merged, None)).unwrap();
        let state = tracks[0].now();
        let mut seen = HashSet::new();
        for cell in &found.cells {
            let low = cell.centre.map(|c| (c - cell.span / 2.0) as usize);
            for [x, y, z] in Layout::new(cell.span as usize).cells() {
                let finest = [low[0] + x, low[1] + y, low[2] + z];
                assert!(seen.insert(finest), "{finest:?} twice");
                let level = state.index().index(finest);
                let sample = state.lights()[0].accumulated.level(level).get(finest.map(|c| c >> level));
                assert_eq!(cell.light[0], sample);
            }
        }
        // A box of 3³ hides one cell.
        assert_eq!(found.occupied.len(), 26);
    }

    #[test]
    fn errors_against_a_uniform_volume_vanish_where_nothing_is_propagated() {
        let preset = Preset::parse(ONE, Path::new("test")).unwrap();
        let mut fresh = Track::new(Scene::build(&preset, Path::new("")).unwrap(), 1 << 20).unwrap();
        fresh.act(Action::Inject);
        fresh.act(Action::Downsample);
        let shown = panes(&mut [fresh], &look(Layer::Level(2), None));
        assert_eq!(shown[0].errors.len(), 4);
        assert!(shown[0].errors.iter().all(|error| error.unwrap().absolute < 1e-6));
        let shown = panes(&mut [track(ONE)], &look(Layer::Level(2), None));
        assert!(shown[0].errors.iter().any(|error| error.unwrap().absolute > 1e-4));
        assert!(panes(&mut [track(ONE)], &look(Layer::Level(0), None))[0].errors.iter().all(Option::is_none));
    }
}
