//! The lit cells in space.

use std::collections::HashSet;

use crate::app::worker::cut::{mix, octrees};
use crate::app::worker::look::{Cloud, CloudCell, Layer, Light, Look, Of, Pin};
use crate::app::worker::track::Track;
use crate::field::{Cell, Grid, Layout, Octree};
use crate::simulation::Simulation;
use crate::study::light;

/// The most cells that the three-dimensional view draws.
const MOST_CELLS: usize = 12_000;
/// Cells whose strength differs by no more than this share are equally strong: symmetric scenes are so but for rounding.
const TIE: f32 = 1e-4;

/// The lit cells of the view that `look` asks for, the strongest first.
///
/// Where there are too many, the weakest go, and never a part of those that are equally strong: half a wall would be a
/// wrong picture. Where that would leave less than a quarter of what can be drawn, a coarser level is shown.
pub fn cloud(tracks: &mut [Track], look: &Look) -> Option<Cloud> {
    let ask = look.cloud?;
    let track = match ask.pane.state.of {
        Of::Track(track) => tracks.get_mut(track)?,
        Of::Truth => return None,
    };
    let known = track.at(ask.pane.state.iteration).is_some();
    let state = track.at(if known { ask.pane.state.iteration } else { None })?;
    let blended = (state.blends_levels() && ask.pane.light == Light::Accumulated && look.layer == Layer::Merged)
        .then(|| sampled(state));
    let (octrees, layer) = match &blended {
        Some(blended) => (blended.iter().collect(), Layer::Level(0)),
        None => (octrees(state, ask.pane.light), look.layer),
    };
    let last = state.sizes().count() - 1;
    let wanted = if let Layer::Level(level) = layer { level.min(last) } else { 0 };
    let gathered = |finest: usize| gather(state, &octrees, layer, finest, ask.threshold);
    let mut level = wanted;
    let (mut cells, strongest) = gathered(level);
    let found = cells.len();
    let mut left_out = whole_ties(&mut cells);
    while cells.len() < MOST_CELLS / 4 && left_out > 0 && level < last {
        level += 1;
        cells = gathered(level).0;
        left_out = whole_ties(&mut cells);
    }
    let coarsened = (level > wanted).then_some((level, found));
    let (occupied, occupied_span) = surface(state);
    Some(Cloud { side: state.sizes().finest(), cells, occupied, occupied_span, left_out, coarsened, strongest })
}

/// The merged light in every finest cell, and means of it.
fn sampled(state: &Simulation<f32>) -> Vec<Octree<f32>> {
    let octree = |grid: Grid<f32>| {
        let mut octree = Octree::new(state.sizes());
        *octree.level_mut(0) = grid;
        octree.downsample();
        octree
    };
    light::sampled(state).into_iter().map(octree).collect()
}

/// Drops the weakest cells of too many, all of those that are equally strong; how many.
fn whole_ties(cells: &mut Vec<CloudCell>) -> usize {
    let Some(first) = cells.get(MOST_CELLS) else { return 0 };
    let weakest = strength(first) * (1.0 + TIE);
    let kept = cells.partition_point(|cell| strength(cell) > weakest);
    let left_out = cells.len() - kept;
    cells.truncate(kept);
    left_out
}

fn strength(cell: &CloudCell) -> f32 {
    cell.light.iter().fold(0.0, |most: f32, sh| most.max(sh.0[0].abs()))
}

/// The lit cells of a layer above a share of the strongest, the strongest first, and how strong that is; none finer than
/// level `finest`.
fn gather(
    state: &Simulation<f32>,
    octrees: &[&Octree<f32>],
    layer: Layer,
    finest: usize,
    threshold: f32,
) -> (Vec<CloudCell>, f32) {
    let mut cells = Vec::new();
    let mut take = |sampled: usize, level: usize, cell: Cell| {
        let source = cell.map(|c| c >> (sampled - level));
        let light = mix(state, |channel| octrees[channel].level(sampled).get(source));
        if light.iter().any(|sh| !sh.is_zero()) {
            let span = (1 << level) as f32;
            let pin = Pin { level: sampled, cell: source };
            cells.push(CloudCell { centre: cell.map(|c| (c as f32 + 0.5) * span), span, light, pin });
        }
    };
    let last = state.sizes().count() - 1;
    match layer {
        Layer::Level(_) => Layout::new(state.sizes().side(finest)).cells().for_each(|cell| take(finest, finest, cell)),
        Layer::Merged => {
            let coarsest = Layout::new(state.sizes().side(last)).cells();
            coarsest.for_each(|cell| cubes(state, last, finest, cell, &mut take));
        }
    }
    let strongest = cells.iter().map(strength).fold(0.0, f32::max);
    cells.retain(|cell| strength(cell) >= threshold * strongest);
    cells.sort_by(|a, b| strength(b).total_cmp(&strength(a)));
    (cells, strongest)
}

/// The middles of the occupied cells that are not hidden among others, and their side, in finest cells: where there are
/// too many, those of larger cells that hold any.
fn surface(state: &Simulation<f32>) -> (Vec<[f32; 3]>, f32) {
    let mut occupied: HashSet<Cell> = state.problem().solids.iter().map(|solid| solid.cell).collect();
    let mut span = 1.0;
    loop {
        let mut cells: Vec<Cell> = occupied.iter().copied().filter(|cell| !hidden(&occupied, *cell)).collect();
        if cells.len() <= MOST_CELLS {
            cells.sort_unstable();
            return (cells.into_iter().map(|cell| cell.map(|c| (c as f32 + 0.5) * span)).collect(), span);
        }
        occupied = occupied.into_iter().map(|cell| cell.map(|c| c / 2)).collect();
        span *= 2.0;
    }
}

/// Whether all six neighbours of a cell are occupied.
fn hidden(occupied: &HashSet<Cell>, cell: Cell) -> bool {
    (0..3).all(|axis| {
        [-1, 1].into_iter().all(|step| {
            let mut next = cell;
            let Some(at) = next[axis].checked_add_signed(step) else { return false };
            next[axis] = at;
            occupied.contains(&next)
        })
    })
}

/// Hands the samples within a cell to `take`, each with the level that it is sampled from and a cube as large as
/// nothing finer lies in it, but none finer than level `finest`: what is finer there is seen as its mean.
fn cubes(state: &Simulation<f32>, level: usize, finest: usize, cell: Cell, take: &mut impl FnMut(usize, usize, Cell)) {
    let span = 1 << level;
    let [x0, y0, z0] = cell.map(|c| c * span);
    let index = |[x, y, z]: Cell| state.index().index([x0 + x, y0 + y, z0 + z]);
    if level == finest || Layout::new(span).cells().all(|inside| index(inside) >= level) {
        take(index([0; 3]).max(level), level, cell);
        return;
    }
    let children = Layout::new(2).cells();
    children.for_each(|[x, y, z]| {
        cubes(state, level - 1, finest, [2 * cell[0] + x, 2 * cell[1] + y, 2 * cell[2] + z], take);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    use crate::app::worker::cut::tests::{ONE, look, track};
    use crate::scene::{Preset, Problem};
    use crate::simulation::Action;

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
    fn a_wall_is_whole_or_shown_by_a_coarser_level() {
        // Two walls of 32² cells each fit; of 128² they do not, and no part of them is as good as none.
        for (size, level) in [(32, None), (128, Some((1, 2 * 128 * 128)))] {
            let walls = "injectors: [(kind: Wall(side: NegX)), (kind: Wall(side: PosX))]";
            let preset = Preset::parse(&format!("(version: 1, size: {size}, {walls})"), Path::new("test")).unwrap();
            let mut track = Track::new(Problem::build(&preset, Path::new("")).unwrap(), 0).unwrap();
            track.act(Action::Inject);
            track.act(Action::Downsample);
            let asked = look(Layer::Level(0), None);
            let found = cloud(&mut [track], &asked).unwrap();
            assert_eq!((found.coarsened, found.left_out), (level, 0));
            let side = size >> level.map_or(0, |(level, _)| level);
            assert_eq!(found.cells.len(), 2 * side * side);
        }
    }

    #[test]
    fn equally_strong_cells_stay_or_go_together() {
        let cell = |c00: f32| CloudCell {
            centre: [0.0; 3],
            span: 1.0,
            light: [crate::sh::Sh([c00, 0.0, 0.0, 0.0]); 3],
            pin: Pin { level: 0, cell: [0; 3] },
        };
        let mut cells: Vec<CloudCell> = (0..MOST_CELLS - 10).map(|_| cell(2.0)).collect();
        cells.extend((0..20).map(|_| cell(1.0)));
        assert_eq!((whole_ties(&mut cells), cells.len()), (20, MOST_CELLS - 10));
    }
}
