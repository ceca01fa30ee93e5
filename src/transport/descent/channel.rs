//! One channel's light in a descent: what stays where it was injected, S, and what is handed down, q, by level.
//!
//! Leaves that follow the light are finest wherever any was injected, or has moved one step. Those of nested cascades
//! follow a point: light may start in any of their grids, *beyond* the finest leaves of a stage. There S is shown where it
//! was injected, as ever, while the coarse leaf holds its mean; and q, filtered to the stage's level, is handed on from
//! level to level until it is in a leaf. No level hands anything to its cells that are split: what the filter would give
//! them stays in the parent.

use super::first_steps::FirstSteps;
use super::partition::without;
use crate::field::{Cell, CellList, Grid, Levels, Marks};
use crate::sh::{Real, Sh};
use crate::transport::lattice::exact::decay::Decay;
use crate::transport::lattice::exact::filter::{hand_over, hand_over_among};
use crate::transport::lattice::exact::leaves::Leaves;
use crate::transport::lattice::obstacles::Obstacles;

/// Light in a leaf: the level, the cell there, the light.
pub(super) type InLeaf<T> = (usize, Cell, Sh<T>);

/// One channel's light.
#[derive(Clone, Debug)]
pub(super) struct Channel<T> {
    /// S, as it was taken up.
    pub(super) taken: CellList<T>,
    /// What of S counts, and the mean of it in coarser cells, by level: where a stage that has come down to that level has
    /// leaves of it.
    pub(super) injected: Vec<CellList<T>>,
    /// What of S counts in finest cells that are never leaves.
    pub(super) elsewhere: CellList<T>,
    /// q, filtered to every level.
    pub(super) moved: Vec<CellList<T>>,
    /// What of both lies beyond the finest leaves of a stage, by the level that it has come down to.
    pub(super) beyond: Vec<Beyond<T>>,
}

/// One channel's light beyond the finest leaves of a stage.
#[derive(Clone, Debug, Default)]
pub(super) struct Beyond<T> {
    /// The mean of S, by level.
    pub(super) stays: Vec<CellList<T>>,
    /// The source q.
    pub(super) moved: Vec<InLeaf<T>>,
}

impl<T> Channel<T> {
    /// Everything of S that counts, by finest cells.
    pub(super) fn stays(&self) -> impl Iterator<Item = &(Cell, Sh<T>)> {
        self.injected[0].iter().chain(&self.elsewhere)
    }

    /// The means of S that leaves of level `i` hold in the stage that has come down to level `j`.
    pub(super) fn held(&self, j: usize, i: usize) -> &[(Cell, Sh<T>)] {
        if i == j { &self.injected[i] } else { &self.beyond[j].stays[i] }
    }
}

impl<T: Real> Channel<T> {
    /// Bytes of memory that it holds.
    pub(super) fn bytes(&self) -> usize {
        let beyond = self.beyond.iter().flat_map(|beyond| &beyond.stays);
        let lists = self.injected.iter().chain(&self.moved).chain(beyond).chain([&self.elsewhere, &self.taken]);
        let in_leaves = self.beyond.iter().map(|beyond| beyond.moved.capacity()).sum::<usize>();
        lists.map(Vec::capacity).sum::<usize>() * size_of::<(Cell, Sh<T>)>() + in_leaves * size_of::<InLeaf<T>>()
    }
}

/// What the light of a channel is sorted by.
pub(super) struct Sorter<'a, T> {
    pub(super) sizes: Levels,
    pub(super) decay: &'a Decay,
    pub(super) obstacles: Option<&'a Obstacles<T>>,
    /// The leaves of every stage, the coarsest first.
    pub(super) stages: &'a [Leaves<T>],
}

impl<T: Real> Sorter<'_, T> {
    /// Sorts light that has taken its first steps.
    pub(super) fn sort(&self, FirstSteps { taken, stays, lit, moved: first, reached }: FirstSteps<T>) -> Channel<T> {
        let count = self.sizes.count();
        let stays = means(stays, &lit, self.sizes);
        let injected = (0..count).map(|i| self.listed(i, &stays[i], true)).collect();
        let elsewhere = self.listed(0, &stays[0], false);
        let mut moved = vec![first];
        let mut reached = reached;
        let mut beyond = Vec::with_capacity(count);
        for j in 0..count {
            if j > 0 {
                let mut coarser = Grid::new(self.sizes.side(j));
                hand_over(self.decay, 1 << j, moved[j - 1].iter().copied(), &mut coarser);
                self.darken(j, &mut coarser);
                reached = lit_in(&coarser);
                moved.push(reached.light_in(&coarser).collect());
            }
            let held = |i: usize| if i > j { self.in_leaves(j, i, &stays[i]) } else { Vec::new() };
            let stays = (0..count).map(held).collect();
            beyond.push(Beyond { stays, moved: self.coarser(j, &moved[j], &reached) });
        }
        Channel { taken, injected, elsewhere, moved, beyond }
    }

    /// The leaves of the stage that has come down to level `j`.
    fn leaves(&self, j: usize) -> &Leaves<T> {
        &self.stages[self.stages.len() - 1 - j]
    }

    /// Those cells of level `i` that are leaves once a stage has come down to it, or those that are not.
    fn listed(&self, i: usize, light: &CellList<T>, leaves: bool) -> CellList<T> {
        let there = self.leaves(i).marks(i);
        light.iter().filter(|(cell, _)| there.get(*cell) == leaves).copied().collect()
    }

    /// Those cells of level `i` that are leaves in the stage of level `j`.
    fn in_leaves(&self, j: usize, i: usize, light: &CellList<T>) -> CellList<T> {
        let there = self.leaves(j).marks(i);
        light.iter().filter(|(cell, _)| there.get(*cell)).copied().collect()
    }

    /// What of q, filtered to level `j` where `reached` marks it, lies in coarser leaves than those of level j.
    pub(super) fn coarser(&self, j: usize, q: &CellList<T>, reached: &Marks) -> Vec<InLeaf<T>> {
        let leaves = self.leaves(j);
        let mut found = Vec::new();
        let mut left = without(reached, leaves.marks(j));
        let mut handed: Option<CellList<T>> = None;
        for i in j + 1..self.sizes.count() {
            if left.count() == 0 {
                break;
            }
            let mut coarser = Grid::new(self.sizes.side(i));
            let finer = handed.as_ref().unwrap_or(q).iter().filter(|(cell, _)| left.get(*cell)).copied();
            hand_over_among(self.decay, 1 << i, finer, &mut coarser, |cell| leaves.is_whole(i, cell));
            self.darken(i, &mut coarser);
            let lit = lit_in(&coarser);
            let light = lit.light_in(&coarser).collect();
            found.extend(self.in_leaves(j, i, &light).into_iter().map(|(cell, light)| (i, cell, light)));
            left = without(&lit, leaves.marks(i));
            handed = Some(light);
        }
        found
    }

    fn darken(&self, i: usize, light: &mut Grid<T>) {
        if let Some(obstacles) = self.obstacles {
            obstacles.darken(i, light);
        }
    }
}

/// The means of light on every level; `lit` marks its cells on the finest.
fn means<T: Real>(finest: CellList<T>, lit: &Marks, sizes: Levels) -> Vec<CellList<T>> {
    let (mut means, mut lit) = (vec![finest], lit.clone());
    for i in 1..sizes.count() {
        let mut coarser = Grid::new(sizes.side(i));
        for (cell, light) in &means[i - 1] {
            coarser.add(cell.map(|c| c / 2), *light * T::of(0.125));
        }
        lit = lit.parents();
        means.push(lit.light_in(&coarser).collect());
    }
    means
}

fn lit_in<T: Real>(grid: &Grid<T>) -> Marks {
    let mut lit = Marks::new(grid.side());
    lit.mark_lit(grid);
    lit
}
