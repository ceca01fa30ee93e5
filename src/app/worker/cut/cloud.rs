//! The lit cells in space.

use std::collections::HashSet;

use crate::app::worker::cut::{mix, octrees};
use crate::app::worker::look::{Cloud, CloudCell, Layer, Look, Of};
use crate::app::worker::track::Track;
use crate::field::{Cell, Layout};
use crate::simulation::Simulation;

/// The most cells that the three-dimensional view draws.
const MOST_CELLS: usize = 12_000;

/// The lit cells of the view that `look` asks for, the strongest first.
pub fn cloud(tracks: &mut [Track], look: &Look) -> Option<Cloud> {
    let ask = look.cloud?;
    let track = match ask.pane.state.of {
        Of::Track(track) => tracks.get_mut(track)?,
        Of::Truth => return None,
    };
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
    let occupied: HashSet<Cell> = state.problem().solids.iter().map(|blocker| blocker.cell).collect();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::worker::cut::tests::{ONE, look, track};

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
}
