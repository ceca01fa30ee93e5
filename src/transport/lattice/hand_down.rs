//! Downsampling for levels that agree: every level takes its light over from the next finer one
//! ([`levels`]).

use super::kernel::occluded::Which;
use super::kernel::step::once;
use super::{Lattice, levels, step};
use crate::field::{Grid, downsample_into};
use crate::sh::Real;
use crate::transport::state::{Light, State, accumulate};

impl<T: Real> Lattice<T> {
    /// Sets source and accumulated of every level but the finest to what it takes over from the next finer
    /// one, whose light takes one step first.
    pub(super) fn hand_down(&self, state: &mut State<T>) {
        // The first iteration of NVIDIA's sample adds its source once more, but by then that source has
        // moved on; what has not moved is counted here.
        let source_counts_twice = self.counts_twice(state);
        let (iteration, sizes) = (state.iteration, state.sizes());
        for (colour, Light { source, accumulated, .. }) in state.lights.iter_mut().enumerate() {
            for i in 1..sizes.count() {
                // Each level has gone a step further than the one before.
                let acting = self.solids.as_deref().and_then(|solids| solids.acting(iteration + i));
                let moved = match &self.forms[i - 1] {
                    Some(form) if acting.is_none() => once(form, source.level(i - 1).clone()),
                    _ => {
                        let mut moved = Grid::new(sizes.side(i - 1));
                        let blocks = acting.is_some_and(|solids| solids.blocks(iteration + i));
                        let which = Which { level: i - 1, colour, blocks };
                        step(acting, &self.stencils[i - 1], which, source.level(i - 1), &mut moved);
                        moved
                    }
                };
                levels::hand_down(self.residences[i - 1], self.residences[i], &moved, source.level_mut(i));

                let mut rested = accumulated.level(i - 1).clone();
                if source_counts_twice {
                    rested.add_grid(source.level(i - 1));
                }
                downsample_into(&rested, accumulated.level_mut(i));
                let cells = self.accumulating.as_ref().map(|cells| &cells[i]);
                accumulate(source.level(i), cells, accumulated.level_mut(i));
            }
        }
    }
}
