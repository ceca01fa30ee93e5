//! The parts of a lattice, for those who carry its iterations out elsewhere: a graphics card.

use super::Lattice;
use super::kernel::form::Form;
use super::kernel::occluded::{OcclusionLaw, Touched};
use super::known::Known;
use super::stencil::Stencil;
use crate::field::Marks;
use crate::scene::propagation::Snapshots;
use crate::transport::state::State;

impl Lattice<f32> {
    /// The operator of each level in the form of the fast loops.
    pub(in crate::transport) fn forms(&self) -> &[Option<Form<f32>>] {
        &self.forms
    }

    /// The operator of each level.
    pub(in crate::transport) fn stencils(&self) -> &[Stencil<f32>] {
        &self.stencils
    }

    /// What stands in the light's way, and by level the cells that it touches.
    pub(in crate::transport) fn solids(&self) -> Option<(&OcclusionLaw<f32>, &[Touched<f32>])> {
        self.solids.as_ref().map(|solids| (&solids.occluders, solids.touched.as_slice()))
    }

    /// By level the cells that accumulate, where not all do.
    pub(in crate::transport) fn accumulating(&self) -> Option<&[Marks]> {
        self.accumulating.as_ref().map(|levels| levels.as_slice())
    }

    /// Whether solids act on light in an iteration, counted from 1.
    pub(in crate::transport) fn acts(&self, iteration: usize) -> bool {
        self.solids.as_ref().is_some_and(|solids| solids.acting(iteration).is_some())
    }

    /// Whether they stop light in an iteration, counted from 1.
    pub(in crate::transport) fn blocks(&self, iteration: usize) -> bool {
        self.solids.as_ref().is_some_and(|solids| solids.blocks(iteration))
    }

    /// Whether the iteration after so many keeps its source in the target: the first one of NVIDIA's sample.
    pub(in crate::transport) fn keeps_source(&self, iteration: usize) -> bool {
        iteration == 0 && self.problem.propagation.snapshots == Snapshots::CopyFirst
    }

    /// For each channel and level, whether the source meets no clamp, now and in all iterations to come.
    pub(in crate::transport) fn linear(&self, state: &State<f32>) -> Vec<Vec<bool>> {
        let of_light = |light| {
            let forms = self.forms.iter().enumerate();
            let known = |(i, form): (usize, &Option<Form<f32>>)| {
                Known::of(light, &state.index, i, form.as_ref(), &self.options).linear
            };
            forms.map(known).collect()
        };
        state.lights.iter().map(of_light).collect()
    }

    /// Takes note that somebody else has changed the light by iterations.
    pub(in crate::transport) fn forget(&mut self) {
        self.known = None;
    }

    /// Allows as many more iterations, up to `most`, as need no look at their light.
    pub(in crate::transport) fn admit_more(&mut self, most: usize) -> usize {
        self.ceiling.admit_more::<f32>(most)
    }
}
