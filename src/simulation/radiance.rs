//! Iterations by [discrete ordinates](crate::transport::ordinates) in place of a scheme.
//!
//! Light keeps its direction, so two bands a cell do not tell where it will go: source, target and accumulated
//! light are what people see of it, and the flux of every direction is kept beside them.
//!
//! - *Levels*: only the finest carries light. The coarser ones hold its mean, so levels agree, and the merged light is
//!   the finest level's everywhere.
//! - *Factor*: what leaves a cell is multiplied with p/4, the mean gain that `cascaded` has. At 4 nothing is
//!   lost or gained, and the sum is what truly arrives; below, the volume is a haze that takes 1 − p/4 of it
//!   in each cell.
//! - *Occluders*: in both modes a cell lets 1 − opacity of what enters it pass, whatever its normal. Nothing is
//!   sent back.
//! - *Snapshots* count as for a scheme. Clamp and policy of the levels do not matter.
//!
//! Where the propagator changes in the middle of a run to this one, the light of the source counts as injected.

use super::ceiling::limit;
use super::occlusion::accumulate;
use super::options::Work;
use super::{Divergence, Light, Simulation, memory};
use crate::field::{Channels, Grid, IndexVolume, Levels};
use crate::scene::propagation::ordinates::Setting;
use crate::scene::propagation::{Propagation, Snapshots};
use crate::scene::{Problem, Source};
use crate::sh::{K0, K1, Real, SPHERE, Sh};
use crate::transport::lattice::active::everywhere;
use crate::transport::ordinates::stepper::Stepper;
use crate::transport::ordinates::{NAME, Ordinates};
use crate::transport::transparency::Transparency;

/// The factor at which nothing is lost or gained.
const KEEPS_ALL: f64 = 4.0;

/// The light of all channels under way.
#[derive(Clone, Debug)]
pub(super) struct Radiance {
    setting: Setting,
    steppers: Vec<Stepper>,
    occluders: Option<Transparency>,
    gain: f64,
    /// What the flux under way and the accumulated coefficients cannot exceed.
    flux: f64,
    accumulated: f64,
}

impl Radiance {
    /// Dark, if the scene wants ordinates at all.
    pub(super) fn new(problem: &Problem, channels: &Channels) -> Option<Self> {
        let setting = Self::setting(&problem.propagation)?;
        let ordinates = Ordinates::of(&setting);
        Some(Radiance {
            setting,
            steppers: (0..channels.count()).map(|_| Stepper::new(ordinates.clone(), problem.size)).collect(),
            occluders: Transparency::of(problem),
            gain: problem.propagation.factor / KEEPS_ALL,
            flux: 0.0,
            accumulated: 0.0,
        })
    }

    fn setting(propagation: &Propagation) -> Option<Setting> {
        (propagation.scheme == NAME).then_some(propagation.ordinates)
    }

    /// Bytes that it will take beside what every simulation takes.
    pub(super) fn bytes(propagation: &Propagation, size: usize, channels: usize) -> u64 {
        let bytes = |setting: Setting| memory::of_grid::<f32>(size) + Stepper::bytes(setting.directions, size);
        Self::setting(propagation).map_or(0, |setting| bytes(setting) * channels as u64)
    }

    /// Sees to it that every cell is sampled at level 0.
    pub(super) fn mark(index: &mut IndexVolume) {
        let finest = index.level_mut(0);
        *finest = everywhere(finest.side());
    }

    pub(super) fn clear(&mut self) {
        self.steppers.iter_mut().for_each(Stepper::clear);
        (self.flux, self.accumulated) = (0.0, 0.0);
    }

    /// Takes light to be sent.
    pub(super) fn inject(&mut self, source: &Source, channels: &Channels) {
        for (channel, stepper) in self.steppers.iter_mut().enumerate() {
            let weight = channels.weight(channel, source.color);
            for (cell, value) in &source.light {
                stepper.inject(*cell, (*value * weight).cast());
            }
        }
    }

    /// Takes the light of the source as it stands to be sent.
    fn take_over<T: Real>(&mut self, lights: &[Light<T>]) {
        for (stepper, light) in self.steppers.iter_mut().zip(lights) {
            for (cell, value) in light.source.level(0).iter().filter(|(_, value)| !value.is_zero()) {
                stepper.inject(cell, value.cast());
            }
        }
    }

    /// Allows the next iteration, `iteration`, if its light must stay in range. A beam crosses a cell once, so
    /// no cell ever holds more than all flux there is.
    pub(super) fn admit<T: Real>(&mut self, iteration: usize, lights: &[Light<T>]) -> Result<(), Divergence> {
        let sent = |light: Sh<f32>| {
            let light = light.widen();
            SPHERE * (K0 * light.0[0].abs() + K1 * light.vector().length())
        };
        let unsent: f64 = self.steppers.iter().flat_map(|stepper| stepper.unsent().iter()).map(|(_, c)| sent(c)).sum();
        let flux = (self.flux + unsent) * self.gain;
        let accumulated = self.accumulated + unsent + K1 * flux;
        // Not true of NaN either.
        if flux.max(accumulated) <= limit::<f32>() {
            (self.flux, self.accumulated) = (flux, accumulated);
            return Ok(());
        }
        let finest = |light: &Light<T>| [light.source.level(0).clone(), light.accumulated.level(0).clone()];
        let norms = lights
            .iter()
            .flat_map(finest)
            .map(|grid| grid.iter().map(|(_, light)| light.max_norm().to_f64()).fold(0.0, f64::max));
        let side = lights.first().map_or(0, |light| light.source.level(0).side());
        Err(Divergence { iteration, level: 0, side, largest: norms.fold(0.0, f64::max) })
    }
}

impl<T: Real> Simulation<T> {
    /// Bytes of the light that is under way in directions of its own, beside the octrees.
    pub fn bytes_under_way(&self) -> usize {
        self.radiance.iter().flat_map(|radiance| &radiance.steppers).map(Stepper::bytes_now).sum()
    }

    /// Takes the scene's ordinates, or none; light under way goes on its way if they are the same.
    pub(super) fn set_radiance(&mut self) {
        let Some(mut new) = Radiance::new(&self.problem, &self.channels) else {
            self.radiance = None;
            return;
        };
        match &mut self.radiance {
            Some(old) if old.setting == new.setting => old.gain = new.gain,
            _ => {
                new.take_over(&self.lights);
                Radiance::mark(&mut self.index);
                self.radiance = Some(new);
            }
        }
    }

    /// One iteration of the finest level; the others follow.
    pub(super) fn radiate(&mut self, radiance: &mut Radiance) {
        let counts_twice = self.iteration == 0 && self.problem.propagation.snapshots == Snapshots::CopyFirst;
        let mut arrived = Grid::new(self.sizes.finest());
        for (light, stepper) in self.lights.iter_mut().zip(&mut radiance.steppers) {
            let again = counts_twice.then(|| stepper.unsent().clone());
            stepper.step(radiance.gain as f32, radiance.occluders.as_ref(), &mut arrived);
            let target = light.target.level_mut(0);
            for (to, from) in target.planes_mut().into_iter().zip(arrived.planes()) {
                to.iter_mut().zip(from).for_each(|(to, from)| *to = T::of(f64::from(*from)));
            }
            if let Some(again) = again {
                target.add_grid(light.source.level(0));
                again.iter().for_each(|(cell, value)| stepper.inject(cell, value));
            }
            light.target.downsample();
            for i in 0..self.sizes.count() {
                let cells = self.accumulating.as_ref().map(|cells| &cells[i]);
                accumulate(light.target.level(i), cells, light.accumulated.level_mut(i));
                self.index.level_mut(i).mark_lit(light.target.level(i));
            }
            std::mem::swap(&mut light.source, &mut light.target);
        }
        let volume = Levels::cells(&self.sizes) * self.lights.len();
        let finest = self.sizes.finest().pow(3) * self.lights.len();
        self.engine.work += Work { visited: finest, dark: 0, volume };
        self.iteration += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::occluder::OcclusionMode;
    use crate::scene::propagation::ordinates::Lattice;
    use crate::scene::propagation::ordinates::Rule;
    use crate::scene::{Occlusion, Solid};
    use crate::simulation::{Action, Refusal};
    use glam::DVec3;

    fn problem(factor: f64) -> Problem {
        let light = vec![([2, 3, 3], Sh::lobe(DVec3::X)), ([5, 5, 1], Sh([0.4, 0.0, -0.1, 0.2]))];
        let ordinates = Setting { directions: 40, rule: Rule::Faces, lattice: Lattice::Octahedral };
        Problem {
            size: 8,
            coarsest: 1,
            sources: vec![Source { color: [1.0, 0.5, 0.0], light, ..Source::default() }],
            solids: Vec::new(),
            occlusion: Occlusion::default(),
            propagation: Propagation {
                scheme: NAME.to_owned(),
                factor,
                iterations: 24,
                ordinates,
                ..Propagation::default()
            },
            ..Problem::default()
        }
    }

    fn run<T: Real>(problem: &Problem) -> Simulation<T> {
        let mut simulation = Simulation::new(problem.clone()).unwrap();
        simulation.run(|_| true);
        simulation
    }

    #[test]
    fn at_four_all_iterations_are_one_sweep_and_what_is_merged_is_the_finest_level() {
        for mode in [OcclusionMode::Hard, OcclusionMode::Fuzzy, OcclusionMode::Off] {
            let mut problem = problem(4.0);
            problem.occlusion.mode = mode;
            problem.solids = vec![Solid::new([4, 3, 3], DVec3::X, 0.7, [0.5; 3])];
            let simulation = run::<f32>(&problem);
            let mut injected = Grid::new(8);
            problem.sources[0].light.iter().for_each(|(cell, light)| injected.set(*cell, light.cast()));
            let occluders = Transparency::new(8, &problem.solids).filter(|_| mode != OcclusionMode::Off);
            let mut wanted = Ordinates::of(&problem.propagation.ordinates).solve(&injected, occluders.as_ref());
            wanted.add_grid(&injected);
            let light = &simulation.lights()[0];
            assert_eq!(light.merged.as_ref(), Some(light.accumulated.level(0)));
            for (cell, wanted) in wanted.iter() {
                let found = light.accumulated.level(0).get(cell);
                assert!((found - wanted).max_norm() < 1e-6, "{mode:?}, {cell:?}: {found:?}, {wanted:?}");
            }
        }
    }

    #[test]
    fn the_factor_thins_every_snapshot_and_coarser_levels_hold_means() {
        let (full, haze) = (run::<f32>(&problem(4.0)), run::<f64>(&problem(3.0)));
        let mut sum = 0.0;
        let mut stepped = Simulation::<f32>::new(problem(4.0)).unwrap();
        stepped.run(|now| {
            sum += 0.75f64.powi(now.iteration() as i32) * now.lights()[0].source.level(0).energy();
            true
        });
        assert!((haze.lights()[0].accumulated.level(0).energy() / sum - 1.0).abs() < 1e-5);
        let octree = &full.lights()[0].accumulated;
        let mut means = octree.clone();
        means.downsample();
        for i in 0..4 {
            for (cell, mean) in means.level(i).iter() {
                assert!((octree.level(i).get(cell) - mean).max_norm() < 1e-6, "level {i}, {cell:?}");
            }
        }
    }

    #[test]
    fn light_injected_on_the_way_adds_up_and_clearing_forgets_it() {
        let once = run::<f32>(&problem(4.0));
        let mut again = Simulation::<f32>::new(problem(4.0)).unwrap();
        let act = |simulation: &mut Simulation<f32>, action, times| {
            for _ in 0..times {
                simulation.act(action);
            }
        };
        act(&mut again, Action::Inject, 1);
        act(&mut again, Action::Propagate, 3);
        act(&mut again, Action::Inject, 1);
        act(&mut again, Action::Propagate, 24);
        let [once, twice] = [&once, &again].map(|s| s.lights()[0].accumulated.level(0).energy());
        assert!((twice / once - 2.0).abs() < 1e-5);
        assert!(again.bytes_under_way() > 0);
        act(&mut again, Action::Clear, 1);
        act(&mut again, Action::Propagate, 1);
        assert_eq!(again.lights()[0].accumulated.level(0).energy(), 0.0);
    }

    #[test]
    fn copying_first_sends_the_injected_light_twice() {
        let mut copied = problem(4.0);
        copied.propagation.snapshots = Snapshots::CopyFirst;
        copied.propagation.iterations = 25;
        let [plain, copied] = [problem(4.0), copied].map(|problem| {
            let simulation = run::<f32>(&problem);
            simulation.lights()[0].accumulated.level(0).energy()
        });
        let injected = problem(4.0).sources[0].light.iter().map(|(_, light)| light.0[0]).sum::<f64>();
        // S_1 + S_2 + … with S_1 = S_0 + P(S_0) is S_0 + 2·(P(S_0) + P(P(S_0)) + …).
        assert!((copied - (2.0 * plain - injected)).abs() < 1e-4 * plain, "{copied}, {plain}, {injected}");
    }

    #[test]
    fn a_scheme_can_be_left_for_ordinates_and_the_other_way_round() {
        let mut simulation = Simulation::<f32>::new(problem(4.0)).unwrap();
        let cascaded = Propagation { scheme: "cascaded".to_owned(), ..problem(4.0).propagation };
        simulation.act(Action::Inject);
        simulation.act(Action::Propagate);
        simulation.set_propagation(cascaded).unwrap();
        simulation.act(Action::Propagate);
        assert_eq!(simulation.bytes_under_way(), 0);
        let before = simulation.lights()[0].source.level(0).energy();
        simulation.set_propagation(problem(2.0).propagation).unwrap();
        simulation.act(Action::Propagate);
        let after = simulation.lights()[0].source.level(0).energy();
        assert!(0.3 * before < after && after < 0.5 * before + 1e-3, "{before}, {after}");
    }

    #[test]
    fn what_would_leave_the_range_of_numbers_or_the_memory_is_refused() {
        let mut simulation = run::<f32>(&problem(1e30));
        assert!(simulation.divergence().is_some());
        assert!(
            simulation.lights()[0].accumulated.level(0).iter().all(|(_, light)| light.0.iter().all(|c| c.is_finite()))
        );
        simulation.act(Action::Clear);
        assert!(simulation.act(Action::Propagate).target);
        let mut large = problem(4.0);
        large.size = 1024;
        large.propagation.ordinates.directions = 8192;
        assert!(matches!(Simulation::<f32>::new(large), Err(Refusal::Memory { .. })));
    }
}
