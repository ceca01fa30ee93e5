//! What actions change: the light of every channel on every level, and where light has been.

use crate::field::{Channels, Grid, IndexVolume, Levels, Marks, Octree, mean_of_children};
use crate::scene::Problem;
use crate::scene::propagation::Snapshots;
use crate::sh::{Real, Sh};

/// Where one cell in so many is marked, or fewer, going from mark to mark is quicker than going through all.
const FEW: usize = 16;

/// One channel of light in its three octrees.
#[derive(Clone, Debug, PartialEq)]
pub struct Light<T> {
    /// What the next iteration propagates: S_k.
    pub source: Octree<T>,
    /// What the next iteration writes; until then S_{k−1}.
    pub target: Octree<T>,
    /// The running sum of the snapshots, S_A.
    pub accumulated: Octree<T>,
    /// S(x, y, z) of the accumulated octree, once merged.
    pub merged: Option<Grid<T>>,
}

/// The light of a problem after some actions.
#[derive(Clone, Debug, PartialEq)]
pub struct State<T> {
    /// The light of each channel.
    pub lights: Vec<Light<T>>,
    /// Which level to sample where.
    pub index: IndexVolume,
    /// Iterations since the last clear, k.
    pub iteration: usize,
    channels: Channels,
}

impl<T: Real> State<T> {
    /// A dark state.
    pub fn new(sizes: Levels, channels: Channels) -> Self {
        let dark = || Octree::new(sizes);
        let light = || Light { source: dark(), target: dark(), accumulated: dark(), merged: None };
        let lights = (0..channels.count()).map(|_| light()).collect();
        State { lights, index: IndexVolume::new(sizes), iteration: 0, channels }
    }

    /// The sizes of the levels.
    pub fn sizes(&self) -> Levels {
        self.index.sizes()
    }

    /// How colours come from the channels.
    pub fn channels(&self) -> &Channels {
        &self.channels
    }

    /// Makes everything dark, and forgets where light has been.
    pub fn clear(&mut self) {
        for light in &mut self.lights {
            light.source.clear();
            light.target.clear();
            light.accumulated.clear();
            light.merged = None;
        }
        self.index.clear();
        self.iteration = 0;
    }

    /// Adds the light of `problem` to level 0 of the source, and of the accumulated light where snapshots count what
    /// is injected; of that only to the given cells, if any are given. Returns what no coefficient can have grown by
    /// more than.
    pub fn inject(&mut self, problem: &Problem, accumulating: Option<&Marks>) -> f64 {
        let counts = problem.propagation.snapshots == Snapshots::Thesis;
        // Cells may hold light of several entries: nothing is brighter than all of it together.
        let mut most = vec![0.0; self.lights.len()];
        for source in &problem.sources {
            for (channel, light) in self.lights.iter_mut().enumerate() {
                let weight = self.channels.weight(channel, source.color);
                for (cell, value) in &source.light {
                    most[channel] += (*value * weight).max_norm();
                    let value = (*value * weight).cast();
                    light.source.level_mut(0).add(*cell, value);
                    if counts && accumulating.is_none_or(|cells| cells.get(*cell)) {
                        light.accumulated.level_mut(0).add(*cell, value);
                    }
                    if !value.is_zero() {
                        self.index.level_mut(0).set(*cell);
                    }
                }
            }
        }
        most.into_iter().fold(0.0, f64::max)
    }

    /// Sets every coarser level of source and accumulated light to the mean of its children.
    pub fn downsample(&mut self) {
        // Before anything has moved the index marks all cells that are lit.
        let few = self.index.level(0).count() * FEW <= self.index.sizes().finest().pow(3);
        if self.iteration == 0 && few {
            self.downsample_marked();
            return;
        }
        for light in &mut self.lights {
            light.source.downsample();
            light.accumulated.downsample();
        }
        self.mark_coarser();
    }

    /// [`Self::downsample`] of the cells that the index marks, and of those that were lit on coarser levels.
    fn downsample_marked(&mut self) {
        for i in 1..self.index.sizes().count() {
            let mut cells = self.index.level(i - 1).parents();
            let marks = self.index.level_mut(i);
            cells.words_mut().iter_mut().zip(marks.words()).for_each(|(cells, marked)| *cells |= marked);
            let octrees = self.lights.iter_mut().flat_map(|light| [&mut light.source, &mut light.accumulated]);
            for octree in octrees {
                let (finer, coarser) = octree.levels_mut().split_at_mut(i);
                for cell in cells.cells() {
                    let mean = mean_of_children(&finer[i - 1], cell);
                    coarser[0].set(cell, mean);
                    if !mean.is_zero() {
                        marks.set(cell);
                    }
                }
            }
        }
    }

    /// Marks where the coarser levels hold light.
    pub fn mark_coarser(&mut self) {
        for light in &self.lights {
            for i in 1..self.index.sizes().count() {
                self.index.level_mut(i).mark_lit(light.source.level(i));
                self.index.level_mut(i).mark_lit(light.accumulated.level(i));
            }
        }
    }

    /// Stores what `sample` makes of each channel's accumulated light in every finest cell.
    pub fn merge(&mut self, sample: impl Fn(&Self, usize, &mut Grid<T>)) {
        for channel in 0..self.lights.len() {
            let merged = self.lights[channel].merged.take();
            let mut merged = merged.unwrap_or_else(|| Grid::new(self.index.sizes().finest()));
            sample(self, channel, &mut merged);
            self.lights[channel].merged = Some(merged);
        }
    }

    /// Sets `merged` to the sample S(x, y, z) of a channel's accumulated octree at every finest cell, as
    /// merging does.
    pub fn sample(&self, channel: usize, merged: &mut Grid<T>) {
        self.index.merge(&self.lights[channel].accumulated, merged);
    }

    /// Cells, over all levels, that have received light.
    pub fn lit_cells(&self) -> usize {
        (0..self.sizes().count()).map(|i| self.index.level(i).count()).sum()
    }

    /// Bytes that it takes now.
    pub fn bytes(&self) -> usize {
        let of_light = |light: &Light<T>| {
            let octrees = light.source.bytes() + light.target.bytes() + light.accumulated.bytes();
            octrees + light.merged.as_ref().map_or(0, Grid::bytes)
        };
        self.lights.iter().map(of_light).sum::<usize>() + self.index.bytes()
    }
}

/// Adds the light of an iteration to what was accumulated, in all cells or in the given ones.
pub fn accumulate<T: Real>(light: &Grid<T>, cells: Option<&Marks>, accumulated: &mut Grid<T>) {
    match cells {
        None => accumulated.add_grid(light),
        Some(cells) => {
            let lit = light.iter().filter(|(cell, _)| cells.get(*cell));
            lit.for_each(|(cell, light)| accumulated.add(cell, light));
        }
    }
}

/// Makes all cells dark but the given ones, if any are given.
pub fn keep<T: Real>(light: &mut Grid<T>, cells: Option<&Marks>) {
    if let Some(cells) = cells {
        let others = light.layout().cells().filter(|cell| !cells.get(*cell));
        others.for_each(|cell| light.set(cell, Sh::ZERO));
    }
}

/// By level the cells of a problem that accumulate light; `None` where all do.
pub fn accumulating(problem: &Problem, sizes: Levels) -> Option<Vec<Marks>> {
    (0..sizes.count()).map(|level| problem.accumulating(level)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_marked_cells_are_downsampled_to_what_going_through_all_gives() {
        let sizes = Levels::new(16, 1).unwrap();
        let mut state = State::<f32>::new(sizes, Channels::separate());
        let put = |state: &mut State<f32>, cell, value: f32| {
            state.lights[0].source.level_mut(0).set(cell, Sh([value, 0.5, -value, 0.1]));
            state.lights[1].accumulated.level_mut(0).set(cell, Sh([value, 0.0, 0.0, 0.3]));
            state.index.level_mut(0).set(cell);
        };
        // What coarser levels hold from before has to go.
        put(&mut state, [3, 9, 14], 1.0);
        state.downsample();
        state.lights.iter_mut().flat_map(|light| [&mut light.source, &mut light.accumulated]).for_each(|octree| {
            octree.level_mut(0).clear();
        });
        put(&mut state, [12, 0, 5], 2.0);
        put(&mut state, [13, 1, 5], 0.7);
        let mut all = state.clone();
        for light in &mut all.lights {
            light.source.downsample();
            light.accumulated.downsample();
        }
        all.mark_coarser();
        state.downsample();
        assert!(state == all);
        assert!(state.lights[0].source.level(4).get([0; 3]).0[0] > 0.0);
    }
}
