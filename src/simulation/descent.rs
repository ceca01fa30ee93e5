//! Downsampling for levels that agree: every level takes its light over from the next finer one
//! ([`crate::transport::lattice::levels`]).

use super::occlusion::accumulate;
use super::{Light, Simulation, step};
use crate::field::{Grid, downsample_into};
use crate::scene::propagation::Snapshots;
use crate::sh::Real;
use crate::transport::lattice::kernel::occluded::Which;
use crate::transport::lattice::kernel::step::once;
use crate::transport::lattice::levels;

impl<T: Real> Simulation<T> {
    /// Sets source and accumulated of every level but the finest to what it takes over from the next finer
    /// one, whose light takes one step first.
    pub(super) fn hand_down(&mut self) {
        // The first iteration of NVIDIA's sample adds its source once more, but by then that source has
        // moved on; what has not moved is counted here.
        let source_counts_twice = self.iteration == 0 && self.problem.propagation.snapshots == Snapshots::CopyFirst;
        for (colour, Light { source, accumulated, .. }) in self.lights.iter_mut().enumerate() {
            for i in 1..self.sizes.count() {
                // Each level has gone a step further than the one before.
                let acting = self.obstacles.as_ref().and_then(|obstacles| obstacles.acting(self.iteration + i));
                let moved = match &self.engine.forms[i - 1] {
                    Some(form) if acting.is_none() => once(form, source.level(i - 1).clone()),
                    _ => {
                        let mut moved = Grid::new(self.sizes.side(i - 1));
                        let which = Which { level: i - 1, colour };
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
