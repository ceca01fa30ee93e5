//! The lattice's light on a graphics card: a [`Transport`] that lets the processor inject, downsample and admit, and
//! the card iterate.
//!
//! Light is loaded onto the card when it is to be iterated and something else has changed it since, and read back after
//! the last of the iterations that nobody looks into. The card takes the same decisions as the processor: which levels'
//! light needs no clamp any more is decided there, from the light itself.

use std::sync::{Arc, Mutex, PoisonError};

use super::device::{Device, DeviceError};
use super::text::{Constants, Solids};
use super::volume::{Masks, Mode, TouchedCell, Volume};
use crate::field::{Levels, Marks, Octree};
use crate::scene::Problem;
use crate::scene::propagation::descent::Descent;
use crate::scene::propagation::{Index, Policy};
use crate::transport::arrivals::Arrivals;
use crate::transport::divergence::Divergence;
use crate::transport::kind::{Setup, Transport};
use crate::transport::lattice::Lattice;
use crate::transport::lattice::kernel::occluded::OcclusionLaw;
use crate::transport::options::{Kernel, Wanted, Work};
use crate::transport::refusal::Refusal;
use crate::transport::state::State;

/// Light of one problem on its way under a scheme, on a graphics card.
#[derive(Debug)]
pub struct OnCard {
    lattice: Lattice<f32>,
    sizes: Levels,
    channels: usize,
    constants: Arc<Constants>,
    masks: Arc<Masks>,
    /// The light on the card; a copy has none until it iterates. Locked, as a copy of the box may look at it.
    volume: Mutex<Option<Volume>>,
    /// Whether the volume holds what the state does.
    loaded: bool,
    /// Why the card gave up, if it did: the processor goes on.
    failed: Option<DeviceError>,
}

impl OnCard {
    /// For the scheme of a problem; refused where there is no card, or it cannot do what is asked for.
    pub fn build(setup: &Setup) -> Result<Box<dyn Transport<f32>>, Refusal> {
        let no = |what: String| Refusal::Device { what };
        if setup.options.tolerance.is_some() {
            return Err(no(
                "a graphics card does not stop early; leave the tolerance out, or compute with --device cpu".into(),
            ));
        }
        if setup.options.kernel == Kernel::Plain {
            return Err(no("the definition is computed by the processor alone".into()));
        }
        let constants = constants_of(&setup.problem, setup.sizes)?;
        let lattice = Lattice::<f32>::new(setup)?;
        let channels = setup.channels.count();
        let masks = masks(&lattice, setup.sizes, channels);
        let card = Device::shared().map_err(|error| no(error.to_string()))?;
        let volume =
            Volume::new(card, setup.sizes, channels, &constants, &masks).map_err(|error| no(error.to_string()))?;
        Ok(Box::new(OnCard {
            lattice,
            sizes: setup.sizes,
            channels,
            constants: Arc::new(constants),
            masks: Arc::new(masks),
            volume: Mutex::new(Some(volume)),
            loaded: false,
            failed: None,
        }))
    }

    /// How the iteration after so many is done.
    fn mode(&self, iteration: usize) -> Mode {
        let keep = self.lattice.keeps_source(iteration);
        let solids = self.lattice.acts(iteration + 1);
        let cone = self.lattice.forms()[0].and_then(|form| form.cone);
        Mode {
            linear: !keep && !solids,
            decide: self.lattice.solids().is_none() && cone.is_some_and(f64::is_finite),
            keep,
            plain: keep,
            solids,
            masked: !self.masks.accumulating.is_empty(),
            occlude: self.lattice.blocks(iteration + 1),
        }
    }

    /// Takes the state through so many iterations.
    fn iterate(&mut self, state: &mut State<f32>, iterations: usize) -> Result<(), DeviceError> {
        let mut volume = self.volume.lock().unwrap_or_else(PoisonError::into_inner);
        if volume.is_none() {
            *volume = Some(Volume::new(Device::shared()?, self.sizes, self.channels, &self.constants, &self.masks)?);
            self.loaded = false;
        }
        let Some(volume) = volume.as_mut() else { return Ok(()) };
        if !self.loaded {
            let light: Vec<[&Octree<f32>; 2]> =
                state.lights.iter().map(|light| [&light.source, &light.accumulated]).collect();
            volume.load(&light, &state.index, &self.lattice.linear(state));
        }
        let modes: Vec<Mode> = (state.iteration..state.iteration + iterations).map(|k| self.mode(k)).collect();
        volume.iterate(&modes);
        let mut light: Vec<[&mut Octree<f32>; 3]> = state
            .lights
            .iter_mut()
            .map(|light| [&mut light.source, &mut light.target, &mut light.accumulated])
            .collect();
        volume.store(&mut light, &mut state.index)?;
        // After the first iteration of NVIDIA's sample the processor looks at its light anew.
        self.loaded = !modes.iter().any(|mode| mode.keep);
        state.iteration += iterations;
        Ok(())
    }

    /// So many iterations on the card, or on the processor where the card has given up.
    fn run(&mut self, state: &mut State<f32>, iterations: usize) -> Work {
        if self.failed.is_none() {
            match self.iterate(state, iterations) {
                Ok(()) => {
                    let volume = self.sizes.cells() * self.channels * iterations;
                    self.lattice.forget();
                    return Work { visited: volume, dark: 0, volume };
                }
                Err(error) => {
                    log::warn!("{error}; the processor goes on");
                    self.failed = Some(error);
                }
            }
        }
        let mut work = Work::default();
        for _ in 0..iterations {
            work += self.lattice.step(state);
        }
        work
    }
}

impl Transport<f32> for OnCard {
    fn start(&mut self, state: &mut State<f32>) {
        self.loaded = false;
        self.lattice.start(state);
    }

    fn inject(&mut self, state: &mut State<f32>) {
        self.loaded = false;
        self.lattice.inject(state);
    }

    fn downsample(&mut self, state: &mut State<f32>) {
        self.loaded = false;
        self.lattice.downsample(state);
    }

    fn admit(&mut self, state: &State<f32>) -> Result<(), Divergence> {
        self.lattice.admit(state)
    }

    fn arrivals(&self, state: &State<f32>, level: Option<usize>) -> Option<Vec<Arrivals>> {
        self.lattice.arrivals(state, level)
    }

    fn step(&mut self, state: &mut State<f32>) -> Work {
        self.run(state, 1)
    }

    fn advance(
        &mut self,
        state: &mut State<f32>,
        iterations: usize,
        _: Wanted,
        work: &mut Work,
    ) -> Result<(), Divergence> {
        let end = state.iteration + iterations;
        while state.iteration < end {
            self.admit(state)?;
            // The first iteration of NVIDIA's sample goes alone.
            let alone = self.lattice.keeps_source(state.iteration);
            let more = if alone { 0 } else { self.lattice.admit_more(end - state.iteration - 1) };
            *work += self.run(state, 1 + more);
        }
        Ok(())
    }

    fn bytes(&self) -> usize {
        self.lattice.bytes()
    }

    fn shared_bytes(&self) -> usize {
        self.lattice.shared_bytes() + size_of_val(self.masks.around.as_slice())
    }

    fn boxed_clone(&self) -> Box<dyn Transport<f32>> {
        Box::new(OnCard {
            lattice: self.lattice.clone(),
            sizes: self.sizes,
            channels: self.channels,
            constants: Arc::clone(&self.constants),
            masks: Arc::clone(&self.masks),
            volume: Mutex::new(None),
            loaded: false,
            failed: self.failed.clone(),
        })
    }
}

/// What is constant in the kernels of a problem on levels of these sizes.
///
/// # Errors
/// Where the card has no kernels for its scheme, its levels or its descent.
pub fn constants_of(problem: &Problem, sizes: Levels) -> Result<Constants, Refusal> {
    let no = |what: &str| Refusal::Device { what: what.to_owned() };
    let propagation = &problem.propagation;
    if propagation.descent != Descent::Off
        || !matches!(propagation.levels, Policy::Same | Policy::Consistent)
        || propagation.index != Index::Thesis
    {
        return Err(no(
            "a graphics card computes the levels `same` and `consistent`, no descent and no radial index; for \
                       others use --device cpu",
        ));
    }
    let setup =
        Setup { problem: Arc::new(problem.clone()), sizes, channels: problem.channels(), options: Default::default() };
    let shape = "this scheme has another shape than the card's kernels; use --device cpu";
    constants(&Lattice::new(&setup)?).ok_or_else(|| no(shape))
}

/// What is constant in the kernels of a lattice; `None` where its stencils have another shape.
fn constants(lattice: &Lattice<f32>) -> Option<Constants> {
    let forms = lattice.forms().iter().copied().collect::<Option<Vec<_>>>()?;
    let levels = forms.into_iter().zip(lattice.stencils().iter().cloned()).collect();
    let solids = lattice.solids().map(|(occluders, _)| match occluders {
        OcclusionLaw::Fuzzy(fuzzy) => Solids::Fuzzy {
            amplifier: fuzzy.amplifier,
            bounce: fuzzy.bounce,
            reflection: crate::transport::lattice::kernel::occluded::REFLECTION as f32,
        },
        OcclusionLaw::Hard(_) => Solids::Hard,
        OcclusionLaw::Mirrored(_) => Solids::Mirrored,
    });
    Some(Constants { levels, plain: lattice.keeps_source(0), solids })
}

/// Which cells of a lattice are not like others.
fn masks(lattice: &Lattice<f32>, sizes: Levels, channels: usize) -> Masks {
    let mut masks = Masks::default();
    if let Some((occluders, touched)) = lattice.solids() {
        for (level, touched) in touched.iter().enumerate() {
            let n = sizes.side(level);
            for (cell, table) in occluders.tables(level, n, touched) {
                let [x, y, z] = cell;
                let around_at = masks.around.len();
                masks.around.extend(table);
                // Where albedos have colours each channel is one; where not, any colour will do.
                masks.touched.extend((0..channels).map(|channel| TouchedCell {
                    channel,
                    colour: channel,
                    level,
                    cell: (z * n + y) * n + x,
                    around_at,
                }));
            }
        }
    }
    if let Some(accumulating) = lattice.accumulating() {
        masks.accumulating = accumulating.iter().map(|marks: &Marks| marks.words().to_vec()).collect();
    }
    masks
}
