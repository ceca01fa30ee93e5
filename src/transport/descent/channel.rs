//! One channel's light in a descent: what stays where it was injected, S, and what is handed down, q, by level.
//!
//! Leaves that follow the light are finest wherever any was injected, or has moved one step. Those of nested cascades
//! follow a point: light may start in any of their grids, *beyond* the finest leaves of a stage. There S is shown where it
//! was injected, as ever, while the coarse leaf holds its mean; and q, filtered to the stage's level, is handed on from
//! level to level until it is in a leaf. No level hands anything to its cells that are split: what the filter would give
//! them stays in the parent.

use super::first_steps::FirstSteps;
use super::partition::without;
use super::solids::Solids;
use crate::field::{Cell, Grid, Levels, Marks, Octree};
use crate::sh::{Real, Sh};
use crate::transport::lattice::exact::decay::Decay;
use crate::transport::lattice::exact::filter::{cells, hand_over, hand_over_among};
use crate::transport::lattice::exact::leaves::Leaves;
use crate::transport::lattice::exact::walls::Solid;

/// Cells of a level, by their number in its planes, with their light.
pub(super) type Listed<T> = Vec<(usize, Sh<T>)>;

/// Light in a leaf: the level, the cell there, the light.
pub(super) type InLeaf<T> = (usize, Cell, Sh<T>);

/// One channel's light.
#[derive(Clone, Debug)]
pub(super) struct Channel<T> {
    /// S, as it was taken up.
    pub(super) taken: Vec<(Cell, Sh<T>)>,
    /// What of S counts, and the mean of it in coarser cells, by level and in the order of memory: where a stage that has
    /// come down to that level has leaves of it.
    pub(super) injected: Vec<Listed<T>>,
    /// What of S counts in finest cells that are never leaves.
    pub(super) elsewhere: Listed<T>,
    /// q, filtered to every level.
    pub(super) moved: Octree<T>,
    /// What of both lies beyond the finest leaves of a stage, by the level that it has come down to.
    pub(super) beyond: Vec<Beyond<T>>,
}

/// One channel's light beyond the finest leaves of a stage.
#[derive(Clone, Debug, Default)]
pub(super) struct Beyond<T> {
    /// The mean of S.
    pub(super) stays: Vec<InLeaf<T>>,
    /// The source q.
    pub(super) moved: Vec<InLeaf<T>>,
}

impl<T> Channel<T> {
    /// Everything of S that counts, by finest cells.
    pub(super) fn stays(&self) -> impl Iterator<Item = &(usize, Sh<T>)> {
        self.injected[0].iter().chain(&self.elsewhere)
    }
}

impl<T: Real> Channel<T> {
    /// Bytes of memory that it holds.
    pub(super) fn bytes(&self) -> usize {
        let listed: usize = self.injected.iter().chain([&self.elsewhere]).map(Vec::capacity).sum();
        let beyond = self.beyond.iter().map(|beyond| beyond.stays.capacity() + beyond.moved.capacity()).sum::<usize>();
        self.moved.bytes()
            + listed * size_of::<(usize, Sh<T>)>()
            + self.taken.capacity() * size_of::<(Cell, Sh<T>)>()
            + beyond * size_of::<InLeaf<T>>()
    }
}

/// What the light of a channel is sorted by.
pub(super) struct Sorter<'a, T> {
    pub(super) sizes: Levels,
    pub(super) decay: &'a Decay,
    pub(super) solids: Option<&'a Solids<T>>,
    /// The channel's colour, 0 red, 1 green, 2 blue.
    pub(super) colour: usize,
    /// The leaves of every stage, the coarsest first.
    pub(super) stages: &'a [Leaves<T>],
}

impl<T: Real> Sorter<'_, T> {
    /// Sorts light that has taken its first steps.
    pub(super) fn sort(
        &self,
        FirstSteps { taken, stays, lit, moved: first, mut reached }: FirstSteps<T>,
    ) -> Channel<T> {
        let mut moved = Octree::new(self.sizes);
        // The octree of q serves for the means of S before q is there.
        let marks = means(&stays, lit, &mut moved);
        let means = |i: usize| if i == 0 { &stays } else { moved.level(i) };
        let injected = (0..self.sizes.count()).map(|i| self.listed(i, means(i), &marks[i], true)).collect();
        let elsewhere = self.listed(0, &stays, &marks[0], false);
        let beyond = |j: usize| {
            let coarser = |i: usize| self.in_leaves(j, i, means(i), &marks[i]);
            Beyond { stays: (j + 1..self.sizes.count()).flat_map(coarser).collect(), moved: Vec::new() }
        };
        let mut beyond: Vec<Beyond<T>> = (0..self.sizes.count()).map(beyond).collect();
        for (grid, marks) in moved.levels_mut().iter_mut().zip(&marks).skip(1) {
            cells(marks).for_each(|cell| grid.set(cell, Sh::ZERO));
        }
        *moved.level_mut(0) = first;
        for i in 0..self.sizes.count() {
            if i > 0 {
                let (finer, coarser) = moved.levels_mut().split_at_mut(i);
                hand_over(self.decay, 1 << i, &finer[i - 1], &reached, &mut coarser[0]);
                self.darken(i, &mut coarser[0]);
                reached = lit_in(&coarser[0]);
            }
            beyond[i].moved = self.coarser(i, moved.level(i), &reached);
        }
        Channel { taken, injected, elsewhere, moved, beyond }
    }

    /// The leaves of the stage that has come down to level `j`.
    fn leaves(&self, j: usize) -> &Leaves<T> {
        &self.stages[self.stages.len() - 1 - j]
    }

    /// The marked cells of level `i` that are leaves once a stage has come down to it, or those that are not.
    fn listed(&self, i: usize, light: &Grid<T>, marks: &Marks, leaves: bool) -> Listed<T> {
        let (layout, there) = (light.layout(), self.leaves(i).marks(i));
        let chosen = cells(marks).filter(|cell| there.get(*cell) == leaves);
        chosen.map(|cell| (layout.index(cell), light.get(cell))).collect()
    }

    /// The marked cells of level `i` that are leaves in the stage of level `j`.
    fn in_leaves(&self, j: usize, i: usize, light: &Grid<T>, marks: &Marks) -> Vec<InLeaf<T>> {
        let there = self.leaves(j).marks(i);
        cells(marks).filter(|cell| there.get(*cell)).map(|cell| (i, cell, light.get(cell))).collect()
    }

    /// What of q, filtered to level `j` where `reached` marks it, lies in coarser leaves than those of level j.
    pub(super) fn coarser(&self, j: usize, q: &Grid<T>, reached: &Marks) -> Vec<InLeaf<T>> {
        let leaves = self.leaves(j);
        let mut found = Vec::new();
        let mut left = without(reached, leaves.marks(j));
        let mut handed: Option<Grid<T>> = None;
        for i in j + 1..self.sizes.count() {
            if left.count() == 0 {
                break;
            }
            let mut coarser = Grid::new(self.sizes.side(i));
            let finer = handed.as_ref().unwrap_or(q);
            hand_over_among(self.decay, 1 << i, finer, &left, &mut coarser, |cell| leaves.is_whole(i, cell));
            self.darken(i, &mut coarser);
            let lit = lit_in(&coarser);
            found.extend(self.in_leaves(j, i, &coarser, &lit));
            left = without(&lit, leaves.marks(i));
            handed = Some(coarser);
        }
        found
    }

    fn darken(&self, i: usize, light: &mut Grid<T>) {
        if let Some(Solids { hard, .. }) = self.solids {
            Solid { hard, colour: self.colour }.darken(i, light);
        }
    }
}

/// Sets the coarser levels of `light` to the means of the marked cells of level 0; returns where, by level.
fn means<T: Real>(finest: &Grid<T>, lit: Marks, light: &mut Octree<T>) -> Vec<Marks> {
    let mut marks = vec![lit];
    for i in 1..light.levels().len() {
        let (finer, coarser) = light.levels_mut().split_at_mut(i);
        let from = if i == 1 { finest } else { &finer[i - 1] };
        for cell in cells(&marks[i - 1]) {
            coarser[0].add(cell.map(|c| c / 2), from.get(cell) * T::of(0.125));
        }
        marks.push(marks[i - 1].parents());
    }
    marks
}

fn lit_in<T: Real>(grid: &Grid<T>) -> Marks {
    let mut lit = Marks::new(grid.side());
    lit.mark_lit(grid);
    lit
}
