//! A descent under way: its stages, the source of each, and the iterations on them.

use std::sync::Arc;

use super::channel::{Channel, Sorter};
use super::first_steps::{self, FirstSteps, Injected, Launch};
use super::partition::{self, Tiling};
use super::sample;
use crate::field::{Cell, Grid, Levels, Marks, Octree, memory_order};
use crate::scene::propagation::Snapshots;
use crate::scene::propagation::descent::Inside;
use crate::sh::{Real, Sh};
use crate::transport::lattice::exact::decay::Decay;
use crate::transport::lattice::exact::leaves::{Leaves, Way};
use crate::transport::lattice::kernel::form::{Form, Share};
use crate::transport::lattice::obstacles::Obstacles;
use crate::transport::team;

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
    obstacles: Option<Arc<Obstacles<T>>>,
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

    /// As [`Self::new`], with occluders.
    pub fn among(
        sizes: Levels,
        tiling: Tiling,
        (form, share): (Form<T>, Share<f64>),
        snapshots: Snapshots,
        obstacles: Option<Arc<Obstacles<T>>>,
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
            obstacles,
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
        // Of a leaf that occluders touch what stays, what leaves and what enters are not of one share.
        let among = self.obstacles.as_ref().map_or(0.0, |obstacles| 4.0 * obstacles.norm());
        1.0 + 4.0 * self.residence * sent.max(among)
    }

    /// How many steps injected light takes cell by cell, at most.
    pub fn first_steps(&self) -> usize {
        first_steps::MOST_STEPS.max(self.obstacles.as_ref().map_or(0, |obstacles| obstacles.passing()))
    }

    /// Takes up each channel's injected light.
    pub fn take_up(&mut self, injected: &mut [Injected<'_, T>]) {
        let obstacles = self.obstacles.as_deref();
        let launch = Launch { form: &self.form, obstacles, snapshots: self.snapshots };
        let heads: Vec<FirstSteps<T>> =
            injected.iter_mut().enumerate().map(|(colour, light)| launch.run(colour, light)).collect();
        let mut near = Marks::new(self.sizes.finest());
        for head in &heads {
            near.words_mut().iter_mut().zip(head.lit.words()).for_each(|(near, lit)| *near |= lit);
        }
        if let Some(obstacles) = obstacles {
            near.words_mut().iter_mut().zip(obstacles.near().words()).for_each(|(near, there)| *near |= there);
        }
        let stages = partition::stages(self.sizes, self.tiling, &near);
        let leaves = |marks: &Vec<Marks>, colour: usize| match obstacles {
            None => Leaves::new(&self.share, Way::Ahead, marks.clone()),
            Some(obstacles) => Leaves::among(&self.share, Way::Ahead, marks.clone(), &*obstacles.walls(colour, true)),
        };
        let sorts = obstacles.map_or(1, |obstacles| obstacles.sorts(injected.len()));
        self.stages = (0..sorts)
            .map(|colour| team::share(stages.iter().collect(), |marks: &Vec<Marks>| leaves(marks, colour)))
            .collect();
        let sorted = |(colour, head): (usize, FirstSteps<T>)| {
            let Descent { sizes, decay, .. } = self;
            let stages = self.stages.get(colour).unwrap_or(&self.stages[0]);
            Sorter { sizes: *sizes, decay, obstacles, stages }.sort(head)
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
        stays.into_iter().flatten().for_each(|(cell, light)| merged.add(*cell, *light * T::of(-1.0)));
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

    /// Goes through all stages with `k` iterations each, every channel in its grids.
    pub fn run(&mut self, k: usize, channels: &mut [Grids<'_, T>]) {
        for stage in 0..self.sizes.count() {
            if stage > 0 {
                self.descend();
            }
            for (channel, grids) in channels.iter_mut().enumerate() {
                self.enter(channel, grids);
                (1..k).for_each(|_| self.iterate(channel, grids));
            }
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
                    for octree in [source, accumulated] {
                        light.taken.iter().for_each(|(cell, _)| octree.level_mut(0).set(*cell, Sh::ZERO));
                        octree.levels_mut().iter_mut().skip(1).for_each(Grid::clear);
                    }
                } else {
                    [source, target, accumulated].into_iter().for_each(|octree| octree.clear());
                }
            }
            Some(before) => {
                let split = self.level() + 1;
                before.clear_level(split, grids.source.level_mut(split));
                before.clear_level(split, grids.target.level_mut(split));
                self.hand_down(light, before, grids.accumulated);
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
        let held = light.beyond[self.level()].stays.iter();
        accumulated.levels_mut().iter_mut().zip(held).for_each(|(level, held)| add(held, level));
        self.begin(leaves, light, grids);
    }

    /// The first iteration of a stage, from what its leaves hold of B; coarser ones hold S already.
    fn begin(&self, leaves: &Leaves<T>, light: &Channel<T>, grids: &mut Grids<'_, T>) {
        let Grids { source, target, accumulated } = grids;
        let j = self.level();
        let coarser = j + 1..self.sizes.count();
        coarser.for_each(|i| subtract(light.held(j, i), accumulated.level_mut(i)));
        // What P makes of B, and the source, is the new B; less the old one it is the correction.
        leaves.apply(accumulated, target);
        leaves.add_source(j, &light.moved[j], target.level_mut(j));
        for (i, cell, q) in &light.beyond[j].moved {
            target.level_mut(*i).add(*cell, leaves.amounts_to(*i, *cell, *q));
        }
        leaves.levels().for_each(|i| leaves.exchange(i, target.level_mut(i), accumulated.level_mut(i)));
        std::mem::swap(*source, *target);
        (j..self.sizes.count()).for_each(|i| add(light.held(j, i), accumulated.level_mut(i)));
    }

    /// Another iteration of this stage for a channel.
    pub fn iterate(&self, channel: usize, grids: &mut Grids<'_, T>) {
        let Some(leaves) = self.leaves_of(channel, self.stage) else { return };
        leaves.advance(grids.source, grids.target, grids.accumulated);
        std::mem::swap(grids.source, grids.target);
    }

    /// Starts the leaves of this stage's level from those they were split off.
    fn hand_down(&self, light: &Channel<T>, before: &Leaves<T>, accumulated: &mut Octree<T>) {
        let j = self.level();
        let held = |i: usize| light.held(j + 1, i);
        (j + 1..self.sizes.count()).for_each(|i| subtract(held(i), accumulated.level_mut(i)));
        let split = match self.leaves() {
            Some(leaves) => partition::without(before.marks(j + 1), leaves.marks(j + 1)),
            None => before.marks(j + 1).clone(),
        };
        let (finer, coarser) = accumulated.levels_mut().split_at_mut(j + 1);
        sample::split(before, &|i, cell| coarser[i - j - 1].get(cell), (j + 1, &split), &mut finer[j]);
        (j + 1..self.sizes.count()).for_each(|i| add(held(i), accumulated.level_mut(i)));
    }

    /// Stores the accumulated light of a channel in every finest cell: B as the leaves hold it `inside`, and S where it
    /// was injected.
    pub fn sample(&self, channel: usize, inside: Inside, accumulated: &Octree<T>, merged: &mut Grid<T>) {
        let (Some(leaves), Some(found)) = (self.leaves_of(channel, self.stage), self.channels.get(channel)) else {
            merged.clear();
            return;
        };
        let j = self.level();
        // B: what was accumulated, less what of S a leaf holds.
        let mut holds = Marks::new(self.sizes.side(j));
        found.held(j, j).iter().for_each(|(cell, _)| holds.set(*cell));
        let light = |i: usize, cell: Cell| {
            let (held, accumulated) = (found.held(j, i), accumulated.level(i).get(cell));
            if i == j && !holds.get(cell) {
                return accumulated;
            }
            match held.binary_search_by_key(&memory_order(cell), |(cell, _)| memory_order(*cell)) {
                Ok(at) => accumulated - held[at].1,
                Err(_) => accumulated,
            }
        };
        sample::merge(leaves, inside, &light, merged);
        leaves.copy_level(0, accumulated.level(0), merged);
        // Leaves of the finest level hold S already.
        let finest: &[_] = if j == 0 { &[] } else { &found.injected[0] };
        add(finest, merged);
        add(&found.elsewhere, merged);
    }

    /// Bytes of memory that what stands in light's way takes, which copies share.
    pub fn shared_bytes(&self) -> usize {
        self.obstacles.as_deref().map_or(0, Obstacles::bytes)
    }

    /// Bytes of memory that it holds beside the grids.
    pub fn bytes(&self) -> usize {
        self.stages.iter().flatten().map(Leaves::bytes).sum::<usize>()
            + self.channels.iter().map(Channel::bytes).sum::<usize>()
    }
}

/// Adds light to its cells.
fn add<T: Real>(light: &[(Cell, Sh<T>)], grid: &mut Grid<T>) {
    light.iter().for_each(|(cell, light)| grid.add(*cell, *light));
}

/// Subtracts light from its cells.
fn subtract<T: Real>(light: &[(Cell, Sh<T>)], grid: &mut Grid<T>) {
    light.iter().for_each(|(cell, light)| grid.add(*cell, *light * T::of(-1.0)));
}
