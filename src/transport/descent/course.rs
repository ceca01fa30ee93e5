//! A descent under way: its stages, the source of each, and the iterations on them.

use std::sync::Arc;

use super::channel::{Channel, Sorter};
use super::first_steps::{FirstSteps, Launch};
use super::partition::{self, Tiling};
use super::sample;
use super::solids::Solids;
use crate::field::{Cell, Grid, Levels, Marks, Octree};
use crate::scene::propagation::Snapshots;
use crate::scene::propagation::descent::Inside;
use crate::sh::{Real, Sh};
use crate::transport::lattice::exact::decay::Decay;
use crate::transport::lattice::exact::filter;
use crate::transport::lattice::exact::leaves::{Leaves, Way};
use crate::transport::lattice::exact::walls::Solid;
use crate::transport::lattice::kernel::form::{Form, Share};

/// A descent under way.
#[derive(Clone, Debug)]
pub struct Descent<T> {
    sizes: Levels,
    tiling: Tiling,
    form: Form<T>,
    share: Share<f64>,
    decay: Decay,
    snapshots: Snapshots,
    /// The longest that light resides in a leaf.
    residence: f64,
    /// What stands in light's way.
    solids: Option<Arc<Solids<T>>>,
    /// The leaves of every stage, the coarsest first; none before light was taken up. By colour, if walls mirror them
    /// differently.
    stages: Vec<Vec<Leaves<T>>>,
    stage: usize,
    channels: Vec<Channel<T>>,
    /// Whether grids hold nothing but injected light and means of it when they are entered first.
    clean: bool,
}

/// One channel's grids, as a descent fills them.
#[derive(Debug)]
pub struct Grids<'a, T> {
    /// The last correction of B.
    pub source: &'a mut Octree<T>,
    /// The one before it.
    pub target: &'a mut Octree<T>,
    /// S + B.
    pub accumulated: &'a mut Octree<T>,
}

impl<T: Real> Descent<T> {
    /// A descent over the levels of `sizes` by a scheme in both its forms: `form` takes the first step, `share` is what
    /// one finest step sends to a neighbour after that. Of the `snapshots` it is the sum of all that counts: S + B, or
    /// S + 2·B where the first iteration sends the light twice, or B alone.
    pub fn new(sizes: Levels, tiling: Tiling, form: Form<T>, share: Share<f64>, snapshots: Snapshots) -> Self {
        Self::among(sizes, tiling, (form, share), snapshots, None)
    }

    /// As [`Self::new`], with hard occluders.
    pub fn among(
        sizes: Levels,
        tiling: Tiling,
        (form, share): (Form<T>, Share<f64>),
        snapshots: Snapshots,
        solids: Option<Arc<Solids<T>>>,
    ) -> Self {
        let decay = Decay::of(&share);
        let stay = |i: usize| 6.0 * share.alpha * (1.0 - decay.even(f64::from(1u32 << i)));
        let residence = (0..sizes.count()).map(|i| 1.0 / (1.0 - stay(i))).fold(1.0, f64::max);
        Descent {
            sizes,
            tiling,
            form,
            share,
            decay,
            snapshots,
            residence,
            solids,
            stages: Vec::new(),
            stage: 0,
            channels: Vec::new(),
            clean: false,
        }
    }

    /// What an iteration of any stage multiplies the largest coefficient by, at most.
    pub fn norm(&self) -> f64 {
        let Share { alpha, beta, gamma, delta, epsilon } = self.share;
        let sent = 6.0 * [alpha, beta, gamma, delta, 2.0 * epsilon].iter().map(|c| c.abs()).sum::<f64>();
        1.0 + 4.0 * self.residence * sent
    }

    /// Takes up the light that level 0 of each channel holds, as injected.
    pub fn take_up(&mut self, injected: &[&Grid<T>]) {
        let launch =
            Launch { form: &self.form, solids: self.solids.as_deref(), snapshots: self.snapshots, tiling: self.tiling };
        let heads: Vec<FirstSteps<T>> =
            injected.iter().enumerate().map(|(colour, light)| launch.run(colour, light)).collect();
        let mut near = Marks::new(self.sizes.finest());
        for head in &heads {
            near.words_mut().iter_mut().zip(head.lit.words()).for_each(|(near, lit)| *near |= lit);
        }
        if let Some(solids) = &self.solids {
            near.words_mut().iter_mut().zip(solids.occupied.words()).for_each(|(near, solid)| *near |= solid);
        }
        let stages = partition::stages(self.sizes, self.tiling, &near);
        let leaves = |marks: &Vec<Marks>, colour: usize| match self.solids.as_deref() {
            None => Leaves::new(&self.share, Way::Ahead, marks.clone()),
            Some(Solids { hard, .. }) => Leaves::among(&self.share, Way::Ahead, marks.clone(), &Solid { hard, colour }),
        };
        let colours = if self.solids.is_some() { injected.len() } else { 1 };
        self.stages = (0..colours).map(|colour| stages.iter().map(|marks| leaves(marks, colour)).collect()).collect();
        let sorted = |(colour, head): (usize, FirstSteps<T>)| {
            let Descent { sizes, decay, .. } = self;
            let stages = self.stages.get(colour).unwrap_or(&self.stages[0]);
            Sorter { sizes: *sizes, decay, solids: self.solids.as_deref(), colour, stages }.sort(head)
        };
        self.channels = heads.into_iter().enumerate().map(sorted).collect();
        (self.stage, self.clean) = (0, false);
    }

    /// Takes note that the grids hold nothing but the injected light that was taken up, and the means of it: then little
    /// is to be cleared.
    pub fn starts_clean(&mut self) {
        self.clean = true;
    }

    /// Adds to `light` what was taken up from a channel.
    pub fn put_back(&self, channel: usize, light: &mut Grid<T>) {
        let taken = self.channels.get(channel).map(|channel| channel.taken.iter());
        taken.into_iter().flatten().for_each(|(cell, value)| light.add(*cell, *value));
    }

    /// Takes from the merged light of a channel what stays where it is, so that B is left.
    pub fn leave_moved(&self, channel: usize, merged: &mut Grid<T>) {
        let stays = self.channels.get(channel).map(Channel::stays);
        let mut planes = merged.planes_mut();
        for (at, light) in stays.into_iter().flatten() {
            planes.iter_mut().zip(light.0).for_each(|(plane, c)| plane[*at] += -c);
        }
    }

    /// Whether light was taken up.
    pub fn is_under_way(&self) -> bool {
        !self.stages.is_empty()
    }

    /// Forgets all light.
    pub fn clear(&mut self) {
        (self.stages, self.channels, self.stage) = (Vec::new(), Vec::new(), 0);
    }

    /// The largest magnitude among the coefficients of all leaves of this stage; 0 before light was taken up.
    pub fn largest(&self, channel: usize, light: &Octree<T>) -> f64 {
        self.leaves_of(channel, self.stage).map_or(0.0, |leaves| leaves.largest(light))
    }

    /// The stage it is at, from 0 for the coarsest level.
    pub fn stage(&self) -> usize {
        self.stage
    }

    /// The level of the finest leaves of this stage.
    pub fn level(&self) -> usize {
        self.sizes.count() - 1 - self.stage
    }

    /// The leaves of this stage; `None` before light was taken up.
    pub fn leaves(&self) -> Option<&Leaves<T>> {
        self.leaves_of(0, self.stage)
    }

    fn leaves_of(&self, channel: usize, stage: usize) -> Option<&Leaves<T>> {
        self.stages.get(channel).or(self.stages.first())?.get(stage)
    }

    /// Goes through all stages with `k` iterations each, for a descent of one channel.
    pub fn run(&mut self, k: usize, grids: &mut Grids<'_, T>) {
        for stage in 0..self.sizes.count() {
            if stage > 0 {
                self.descend();
            }
            self.enter(0, grids);
            (1..k).for_each(|_| self.iterate(0, grids));
        }
    }

    /// Goes on to the finest level at once. [`Self::resume`] follows, for every channel.
    pub fn skip_to_finest(&mut self) {
        self.stage = self.sizes.count() - 1;
    }

    /// Goes on to the next finer level, if there is one. [`Self::enter`] follows, for every channel.
    pub fn descend(&mut self) {
        self.stage = (self.stage + 1).min(self.sizes.count() - 1);
    }

    /// The first iteration of this stage for a channel: starts from what the stage before has found.
    pub fn enter(&self, channel: usize, grids: &mut Grids<'_, T>) {
        let (Some(leaves), Some(light)) = (self.leaves_of(channel, self.stage), self.channels.get(channel)) else {
            return;
        };
        match self.stage.checked_sub(1).and_then(|before| self.leaves_of(channel, before)) {
            None => {
                let Grids { source, target, accumulated } = grids;
                if self.clean {
                    for (cell, _) in &light.taken {
                        for i in 0..self.sizes.count() {
                            let at = cell.map(|c| c >> i);
                            source.level_mut(i).set(at, Sh::ZERO);
                            accumulated.level_mut(i).set(at, Sh::ZERO);
                        }
                    }
                } else {
                    [source, target, accumulated].into_iter().for_each(|octree| octree.clear());
                }
            }
            Some(before) => {
                before.clear(grids.source);
                before.clear(grids.target);
                self.hand_down(channel, before, grids.accumulated);
            }
        }
        self.begin(leaves, light, grids);
    }

    /// The first iteration at the finest level for a channel that starts from light that has moved already, cell by
    /// cell: what another descent left there, for other injected light.
    pub fn resume(&self, channel: usize, moved_before: &Grid<T>, grids: &mut Grids<'_, T>) {
        let (Some(leaves), Some(light)) = (self.leaves_of(channel, self.stage), self.channels.get(channel)) else {
            return;
        };
        let Grids { source, target, accumulated } = grids;
        [source, target].into_iter().for_each(|octree| octree.clear());
        accumulated.level_mut(0).copy_from(moved_before);
        accumulated.downsample();
        for (i, cell, mean) in &light.beyond[self.level()].stays {
            accumulated.level_mut(*i).add(*cell, *mean);
        }
        self.begin(leaves, light, grids);
    }

    /// The first iteration of a stage, from what its leaves hold of B; coarser ones hold S already.
    fn begin(&self, leaves: &Leaves<T>, light: &Channel<T>, grids: &mut Grids<'_, T>) {
        let j = self.level();
        let Channel { injected, moved, beyond, .. } = light;
        // What P makes of B, and the source, less B itself is the correction.
        leaves.copy(grids.accumulated, grids.source);
        for (i, cell, mean) in &beyond[j].stays {
            grids.source.level_mut(*i).add(*cell, *mean * T::of(-1.0));
        }
        leaves.apply(grids.source, grids.target);
        leaves.add_source(j, moved.level(j), grids.target.level_mut(j));
        for (i, cell, q) in &beyond[j].moved {
            grids.target.level_mut(*i).add(*cell, leaves.amounts_to(*i, *cell, *q));
        }
        leaves.subtract(grids.source, grids.target);
        self.take(leaves, grids);
        let level = grids.accumulated.level_mut(j);
        let mut planes = level.planes_mut();
        for (at, light) in &injected[j] {
            planes.iter_mut().zip(light.0).for_each(|(plane, c)| plane[*at] += c);
        }
    }

    /// Another iteration of this stage for a channel.
    pub fn iterate(&self, channel: usize, grids: &mut Grids<'_, T>) {
        let Some(leaves) = self.leaves_of(channel, self.stage) else { return };
        leaves.apply(grids.source, grids.target);
        self.take(leaves, grids);
    }

    fn take(&self, leaves: &Leaves<T>, grids: &mut Grids<'_, T>) {
        leaves.add(grids.target, grids.accumulated);
        std::mem::swap(grids.source, grids.target);
    }

    /// Starts the leaves of this stage's level from those they were split off.
    fn hand_down(&self, channel: usize, before: &Leaves<T>, accumulated: &mut Octree<T>) {
        let j = self.level();
        let split = before.marks(j + 1);
        let (finer, coarser) = accumulated.levels_mut().split_at_mut(j + 1);
        let light = |i: usize, cell: Cell| self.moved_light(channel, &coarser[i - j - 1], i, cell);
        let stays = self.leaves().map(|leaves| leaves.marks(j + 1));
        for cell in filter::cells(split).filter(|cell| stays.is_none_or(|stays| !stays.get(*cell))) {
            let value = light(j + 1, cell);
            for (child, weight) in sample::children(before, &light, (j + 1, cell)) {
                finer[j].set(child, value * T::of(weight));
            }
        }
    }

    /// B in a leaf: what was accumulated there, less what was injected.
    fn moved_light(&self, channel: usize, accumulated: &Grid<T>, i: usize, cell: Cell) -> Sh<T> {
        let at = accumulated.layout().index(cell);
        let injected = &self.channels[channel].injected[i];
        match injected.binary_search_by_key(&at, |(at, _)| *at) {
            Ok(found) => accumulated.at(at) - injected[found].1,
            Err(_) => accumulated.at(at),
        }
    }

    /// Stores the accumulated light of a channel in every finest cell: B as the leaves hold it `inside`, and S where it
    /// was injected.
    pub fn sample(&self, channel: usize, inside: Inside, accumulated: &Octree<T>, merged: &mut Grid<T>) {
        let (Some(leaves), Some(found)) = (self.leaves_of(channel, self.stage), self.channels.get(channel)) else {
            merged.clear();
            return;
        };
        let light = |i: usize, cell: Cell| self.moved_light(channel, accumulated.level(i), i, cell);
        sample::merge(leaves, inside, &light, merged);
        leaves.copy_level(0, accumulated.level(0), merged);
        // Leaves of the finest level hold S already.
        let finest: &[_] = if self.level() == 0 { &[] } else { &found.injected[0] };
        let mut planes = merged.planes_mut();
        for (at, light) in finest.iter().chain(&found.elsewhere) {
            planes.iter_mut().zip(light.0).for_each(|(plane, c)| plane[*at] += c);
        }
    }

    /// Bytes of memory that it holds beside the grids.
    pub fn bytes(&self) -> usize {
        self.stages.iter().flatten().map(Leaves::bytes).sum::<usize>()
            + self.channels.iter().map(Channel::bytes).sum::<usize>()
    }
}
