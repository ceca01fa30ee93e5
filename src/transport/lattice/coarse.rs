//! The coarser levels of an octree under exact levels ([`super::exact`]), in step with the finest or ahead of it.
//!
//! The finest level is propagated as ever. In the first iteration after a downsampling its injected light S takes its
//! first step there, clamps and all; what has moved is handed from level to level by the filter, and that is the first
//! snapshot of each. From then on every level takes one finest step an iteration, by its own operator. So after k
//! iterations each of them ought to hold the mean of what a uniform volume holds after k.
//!
//! Ahead, each sums up at once what stays in a cell ([`Way::Ahead`]): of what was handed to it, and of every step.

use std::sync::Arc;

use super::exact::decay::Decay;
use super::exact::filter;
use super::exact::leaves::{Leaves, Way};
use super::exact::walls::Open;
use super::kernel::form::Share;
use super::obstacles::Obstacles;
use crate::field::{Cell, Grid, Levels, Marks};
use crate::sh::{Real, Sh};
use crate::transport::options::Work;
use crate::transport::state::{State, accumulate};

/// The operators of the coarser levels, and whether their light has still to move for the first time.
#[derive(Clone, Debug)]
pub(super) struct Coarse<T> {
    decay: Decay,
    /// By colour, if walls mirror them differently; each from level 1 on.
    colours: Vec<Vec<Leaves<T>>>,
    /// The same for iterations before occluders stop light, if there are such.
    earlier: Vec<Vec<Leaves<T>>>,
    obstacles: Option<Arc<Obstacles<T>>>,
    /// Whether the coarser levels hold means of injected light, which has not moved yet.
    at_rest: bool,
}

impl<T: Real> Coarse<T> {
    /// For levels of these sizes, and so many colours; `share` is what one finest step sends to a neighbour, `obstacles`
    /// what stands in its way.
    pub(super) fn new(
        share: &Share<f64>,
        way: Way,
        sizes: Levels,
        colours: usize,
        obstacles: Option<Arc<Obstacles<T>>>,
    ) -> Self {
        let level = |i: usize, colour: usize, block: bool| match &obstacles {
            None => Leaves::uniform(share, way, i, sizes.side(i), &Open(None)),
            Some(obstacles) => Leaves::uniform(share, way, i, sizes.side(i), &*obstacles.walls(colour, block)),
        };
        let levels = |colour, block| (1..sizes.count()).map(|i| level(i, colour, block)).collect();
        let sorts = obstacles.as_ref().map_or(1, |obstacles| obstacles.sorts(colours));
        let all = |block| (0..sorts).map(|colour| levels(colour, block)).collect();
        let come_late = obstacles.as_deref().is_some_and(Obstacles::come_late);
        let earlier = if come_late { all(false) } else { Vec::new() };
        Coarse { decay: Decay::of(share), colours: all(true), earlier, obstacles, at_rest: true }
    }

    /// Takes note that the coarser levels were filled with means of the finest.
    pub(super) fn rest(&mut self) {
        self.at_rest = true;
    }

    /// One iteration of the coarser levels, after that of the finest, whose new light is in the source. `accumulating` has
    /// by level the cells that accumulate, where not all do.
    pub(super) fn step(&mut self, state: &mut State<T>, accumulating: Option<&[Marks]>) -> Work {
        let volume = state.sizes().cells() * state.lights.len();
        let finest = state.sizes().finest().pow(3) * state.lights.len();
        let State { lights, index, iteration, .. } = state;
        let block = self.obstacles.as_ref().is_none_or(|obstacles| *iteration > obstacles.passing());
        let colours = if block || self.earlier.is_empty() { &self.colours } else { &self.earlier };
        for (colour, light) in lights.iter_mut().enumerate() {
            let levels = colours.get(colour).or(colours.first());
            let mut handed = self.at_rest.then(|| light.source.level(0).clone());
            for (i, leaves) in (1..).zip(levels.into_iter().flatten()) {
                if let Some(finer) = &mut handed {
                    *finer = self.hand_over(i, finer);
                    let target = light.target.level_mut(i);
                    target.clear();
                    let mut lit = Marks::new(finer.side());
                    lit.mark_lit(finer);
                    let source: Vec<(Cell, Sh<T>)> = lit.light_in(finer).collect();
                    leaves.add_source(i, &source, target);
                } else {
                    leaves.apply_level(i, |level| light.source.level(level), light.target.level_mut(i), None);
                }
                std::mem::swap(light.source.level_mut(i), light.target.level_mut(i));
                let cells = accumulating.map(|cells| &cells[i]);
                accumulate(light.source.level(i), cells, light.accumulated.level_mut(i));
                index.level_mut(i).mark_lit(light.source.level(i));
            }
        }
        self.at_rest = false;
        Work { visited: volume - finest, dark: 0, volume }
    }

    /// What level `i` is handed of the light that the next finer level has moved.
    fn hand_over(&self, i: usize, finer: &Grid<T>) -> Grid<T> {
        let mut lit = Marks::new(finer.side());
        lit.mark_lit(finer);
        let mut coarser = Grid::new(finer.side() / 2);
        filter::hand_over(&self.decay, 1 << i, lit.light_in(finer), &mut coarser);
        if let Some(obstacles) = &self.obstacles {
            obstacles.darken(i, &mut coarser);
        }
        coarser
    }

    /// Bytes of memory it holds.
    pub(super) fn bytes(&self) -> usize {
        self.colours.iter().chain(&self.earlier).flatten().map(Leaves::bytes).sum()
    }

    /// Bytes of memory that what stands in light's way takes, which copies share.
    pub(super) fn shared_bytes(&self) -> usize {
        self.obstacles.as_deref().map_or(0, Obstacles::bytes)
    }
}
