//! Iterations by [discrete ordinates](crate::transport::ordinates).
//!
//! Light keeps its direction, so two bands a cell do not tell where it will go: source, target and accumulated
//! light are what people see of it, and the flux of every direction is kept beside them.
//!
//! - *Levels*: only the finest carries light. The coarser ones hold its mean, so levels agree, and the merged light is
//!   the finest level's everywhere.
//! - *Factor*: what leaves a cell is multiplied with p/4, the mean gain that `cascaded` has. At 4 nothing is
//!   lost or gained, and the sum is what truly arrives; below, the volume is a haze that takes 1 − p/4 of it
//!   in each cell.
//! - *Occluders*: in both modes a cell lets 1 − opacity of what enters it pass, by the axis of the face it enters by. Of
//!   the rest it sends back its albedo times `bounce` ([`reflect`](super::reflect)).
//! - *Snapshots* count as for a scheme. Clamp and policy of the levels do not matter.

use std::sync::Arc;

use super::Ordinates;
use super::receive::Facing;
use super::reflect::Reflectors;
use super::stepper::Stepper;
use crate::field::{Channels, Grid, Levels, Marks, memory};
use crate::scene::Problem;
use crate::scene::propagation::Snapshots;
use crate::sh::{K0, K1, Real, SPHERE, Sh};
use crate::transport::divergence::{Divergence, limit};
use crate::transport::kind::{Setup, Transport};
use crate::transport::options::Work;
use crate::transport::refusal::Refusal;
use crate::transport::state::{Light, State, accumulate, accumulating};
use crate::transport::transmittance::{Transmittance, Ways};

/// The factor at which nothing is lost or gained.
const KEEPS_ALL: f64 = 4.0;

/// The light of all channels under way.
#[derive(Clone, Debug)]
pub(super) struct Beams<T> {
    problem: Arc<Problem>,
    channels: Channels,
    steppers: Vec<Stepper<T>>,
    transparency: Option<Arc<Transmittance>>,
    reflectors: Option<Arc<Reflectors>>,
    /// By level the cells that accumulate, where not all do.
    accumulating: Option<Arc<Vec<Marks>>>,
    gain: f64,
    /// What the flux under way and the accumulated coefficients cannot exceed.
    flux: f64,
    accumulated: f64,
    /// Of light that surfaces have yet to send, what it adds to that.
    of_surfaces: f64,
    receivers: Arc<Facing>,
    /// By channel, what each receiver of the problem has received, times a cell's side squared.
    received: Vec<Vec<f64>>,
}

/// Bytes that the light under way will take: what comes in by three faces, for each direction and cell.
pub(super) fn bytes(problem: &Problem, sizes: Levels, channels: usize, number: usize) -> u64 {
    let lanes = Ordinates::<f32>::of(&problem.propagation.ordinates).lanes() as u64;
    let cells = (sizes.finest() as u64).pow(3);
    let unsent = memory::of_grid::<f32>(sizes.finest()) * number as u64 / size_of::<f32>() as u64;
    let transparency = if problem.has_occluders() { cells * size_of::<Ways>() as u64 } else { 0 };
    let of_mesh = problem.stage.as_ref().map_or(0, |stage| stage.voxels.solids.len()) as u64;
    let sheets = if problem.has_occluders() {
        let numbers = cells * size_of::<u32>() as u64 + of_mesh * (size_of::<(usize, Ways)>() + 3) as u64;
        numbers + 3 * lanes * of_mesh * (number * channels) as u64
    } else {
        0
    };
    let received = (problem.receivers.len() * size_of::<f64>()) as u64;
    (3 * lanes * cells * number as u64 + unsent + received) * channels as u64
        + transparency
        + sheets
        + Facing::bytes_of(sizes.finest(), problem.receivers.len())
        + channels as u64 * Reflectors::bytes_of(problem, number)
}

impl<T: Real> Beams<T> {
    /// Dark.
    pub(super) fn new(setup: &Setup) -> Self {
        let Setup { problem, sizes, channels, .. } = setup;
        let ordinates = Ordinates::of(&problem.propagation.ordinates);
        let transparency = Transmittance::of(problem).map(Arc::new);
        Beams {
            steppers: (0..channels.count()).map(|_| Stepper::new(ordinates.clone(), problem.size)).collect(),
            reflectors: Reflectors::of(problem, transparency.as_deref()).map(Arc::new),
            receivers: Arc::new(Facing::new(problem.size, &problem.receivers, transparency.as_deref())),
            transparency,
            accumulating: accumulating(problem, *sizes).map(Arc::new),
            gain: problem.propagation.factor / KEEPS_ALL,
            flux: 0.0,
            accumulated: 0.0,
            of_surfaces: 0.0,
            received: vec![vec![0.0; problem.receivers.len()]; channels.count()],
            channels: channels.clone(),
            problem: Arc::clone(problem),
        }
    }

    pub(super) fn build(setup: &Setup) -> Result<Box<dyn Transport<T>>, Refusal> {
        Ok(Box::new(Beams::new(setup)))
    }
}

impl<T: Real> Transport<T> for Beams<T> {
    /// Every cell is sampled at level 0.
    fn start(&mut self, state: &mut State<T>) {
        self.steppers.iter_mut().for_each(Stepper::clear);
        (self.flux, self.accumulated, self.of_surfaces) = (0.0, 0.0, 0.0);
        self.received.iter_mut().for_each(|received| received.fill(0.0));
        state.index.level_mut(0).fill();
    }

    fn inject(&mut self, state: &mut State<T>) {
        state.inject(&self.problem, self.accumulating.as_ref().map(|cells| &cells[0]));
        for source in &self.problem.sources {
            for (channel, stepper) in self.steppers.iter_mut().enumerate() {
                let weight = self.channels.weight(channel, source.color);
                // Light that leaves surfaces is known better than by its lobes.
                for surface in &source.cosines {
                    stepper.inject_surface(surface.cell, surface.normal, surface.flux * weight);
                    self.of_surfaces += surface.flux * weight;
                }
                for (cell, value) in source.light.iter().filter(|_| source.cosines.is_empty()) {
                    stepper.inject(*cell, (*value * weight).cast());
                }
            }
        }
    }

    fn downsample(&mut self, state: &mut State<T>) {
        state.downsample();
    }

    /// A beam crosses a cell once, so no cell ever holds more than all flux there is; reflection gives back what ended.
    fn admit(&mut self, state: &State<T>) -> Result<(), Divergence> {
        let sent = |light: Sh<T>| {
            let light = light.widen();
            SPHERE * (K0 * light.0[0].abs() + K1 * light.vector().length())
        };
        let unsent: f64 = self.steppers.iter().flat_map(|stepper| stepper.unsent().iter()).map(|(_, c)| sent(c)).sum();
        let unsent = unsent + std::mem::take(&mut self.of_surfaces);
        let kept = self.reflectors.as_ref().map_or(1.0, |reflectors| reflectors.most().max(1.0));
        let flux = (self.flux * kept + unsent) * self.gain;
        let accumulated = self.accumulated + unsent + K1 * flux;
        // Not true of NaN either.
        if flux.max(accumulated) <= limit::<T>() {
            (self.flux, self.accumulated) = (flux, accumulated);
            return Ok(());
        }
        let finest = |light: &Light<T>| [light.source.level(0).clone(), light.accumulated.level(0).clone()];
        let norms = state
            .lights
            .iter()
            .flat_map(finest)
            .map(|grid| grid.iter().map(|(_, light)| light.max_norm().to_f64()).fold(0.0, f64::max));
        let largest = norms.fold(0.0, f64::max);
        Err(Divergence { iteration: state.iteration + 1, level: 0, side: self.problem.size, largest })
    }

    /// One iteration of the finest level; the others follow.
    fn step(&mut self, state: &mut State<T>) -> Work {
        let counts_twice = state.iteration == 0 && self.problem.propagation.snapshots == Snapshots::CopyFirst;
        let sizes = state.sizes();
        let mut arrived = Grid::new(sizes.finest());
        let channels = self.steppers.iter_mut().zip(&mut self.received);
        for (channel, (light, (stepper, received))) in state.lights.iter_mut().zip(channels).enumerate() {
            if let Some(reflectors) = &self.reflectors {
                stepper.reflect(reflectors, &self.channels, channel);
            }
            let again = counts_twice.then(|| stepper.unsent().clone());
            stepper.step(T::of(self.gain), self.transparency.as_deref(), &mut arrived);
            stepper.receive(&self.receivers, received);
            let target = light.target.level_mut(0);
            target.copy_from(&arrived);
            if let Some(again) = again {
                target.add_grid(light.source.level(0));
                again.iter().for_each(|(cell, value)| stepper.inject(cell, value));
            }
            light.target.downsample();
            for i in 0..sizes.count() {
                let cells = self.accumulating.as_ref().map(|cells| &cells[i]);
                accumulate(light.target.level(i), cells, light.accumulated.level_mut(i));
                state.index.level_mut(i).mark_lit(light.target.level(i));
            }
            std::mem::swap(&mut light.source, &mut light.target);
        }
        state.iteration += 1;
        let channels = state.lights.len();
        Work { visited: sizes.finest().pow(3) * channels, dark: 0, volume: Levels::cells(&sizes) * channels }
    }

    /// One sweep in the order of the wind, where no light is lost or sent back on its way.
    fn settle(&mut self, state: &mut State<T>) -> bool {
        if self.gain != 1.0 || self.reflectors.is_some() {
            return false;
        }
        let sizes = state.sizes();
        let mut arrived = Grid::new(sizes.finest());
        let channels = self.steppers.iter_mut().zip(&mut self.received);
        for (light, (stepper, received)) in state.lights.iter_mut().zip(channels) {
            stepper.settle(self.transparency.as_deref(), &self.receivers, received, &mut arrived);
            light.source.clear();
            light.target.level_mut(0).copy_from(&arrived);
            light.target.downsample();
            for i in 0..sizes.count() {
                let cells = self.accumulating.as_ref().map(|cells| &cells[i]);
                accumulate(light.target.level(i), cells, light.accumulated.level_mut(i));
                state.index.level_mut(i).mark_lit(light.target.level(i));
            }
            light.target.clear();
        }
        true
    }

    fn bytes(&self) -> usize {
        let received: usize = self.received.iter().map(|received| size_of_val(received.as_slice())).sum();
        self.steppers.iter().map(Stepper::bytes_now).sum::<usize>() + received
    }

    fn received(&self) -> Option<&[Vec<f64>]> {
        Some(&self.received)
    }

    fn shared_bytes(&self) -> usize {
        let marks = self.accumulating.iter().flat_map(|cells| cells.iter());
        let marks: usize = marks.map(|cells| size_of_val(cells.words())).sum();
        let reflectors = self.reflectors.as_ref().map_or(0, |reflectors| reflectors.bytes());
        marks
            + reflectors
            + self.receivers.bytes()
            + self.transparency.as_ref().map_or(0, |transparency| transparency.bytes())
    }

    fn boxed_clone(&self) -> Box<dyn Transport<T>> {
        Box::new(self.clone())
    }
}
