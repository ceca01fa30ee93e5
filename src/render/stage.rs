//! A problem's mesh, lights and camera as rays want them, and what a run's light gives to its surfaces.

use std::sync::{Arc, OnceLock};

use glam::DVec3;

use super::cells::{Cells, Sampling};
use super::lamp::Lamp;
use super::patch_light::PatchLight;
use super::rgb::Rgb;
use super::surface::{Patch, Patches};
use super::view::View;
use super::world::World;
use crate::field::{Channels, Grid, Marks, Share};
use crate::scene::mesh_scene::{Light, LightKind};
use crate::scene::receiver::Receiver;
use crate::scene::{Problem, Stage};
use crate::sh::Real;
use crate::simulation::Simulation;
use crate::transport::arrivals::Arrivals;

/// A mesh in its volume with its lights, ready for rays.
#[derive(Debug)]
pub struct Set<'a> {
    stage: &'a Stage,
    patches: OnceLock<Arc<Patches>>,
    occupied: Marks,
}

impl<'a> Set<'a> {
    /// The set of a stage.
    pub fn new(stage: &'a Stage) -> Self {
        let mut occupied = Marks::new(stage.placement.size);
        stage.voxels.solids.iter().for_each(|solid| occupied.set(solid.cell));
        Set { stage, patches: OnceLock::new(), occupied }
    }

    /// The set of a stage whose patches are there already.
    pub fn with_patches(stage: &'a Stage, patches: Arc<Patches>) -> Self {
        Set { patches: OnceLock::from(patches), ..Set::new(stage) }
    }

    /// What its camera sees in a picture of so many pixels across and down; `None` where it sees nothing.
    pub fn view(&self, size: [usize; 2]) -> Option<View> {
        let camera = &self.stage.camera;
        let [from, to, up] = [camera.from, camera.to, camera.up].map(DVec3::from_array);
        View::new(from, to, up, camera.fov, size)
    }

    /// What rays meet.
    pub fn world(&self) -> World<'a> {
        let [low, high] = self.stage.model.mesh.bounds();
        let (middle, radius) = (0.5 * (low + high), 0.5 * (high - low).length());
        let lamps = self.stage.lights.iter().filter_map(|light| lamp(light, middle, radius)).collect();
        World::new(&self.stage.model.mesh, &self.stage.model.bvh, lamps)
    }

    /// The patches of its surface, made when first asked for.
    pub fn patches(&self) -> &Arc<Patches> {
        let model = &self.stage.model;
        self.patches.get_or_init(|| Arc::new(Patches::new(&model.mesh, &model.bvh, &self.stage.placement)))
    }

    /// The problem with everything in it that tells surfaces what they receive.
    pub fn prepared(&self, problem: Problem) -> Problem {
        let receiver = |patch: &Patch| Receiver { cell: patch.cell, normal: patch.normal };
        Problem { receivers: self.patches().all().iter().map(receiver).collect(), ..problem }
    }
}

/// A document's light as rays want it; `None` where its direction is none.
fn lamp(light: &Light, middle: DVec3, radius: f64) -> Option<Lamp> {
    Some(match light.kind {
        LightKind::Point { position } => {
            Lamp::Point { position: DVec3::from_array(position), intensity: light.power() }
        }
        LightKind::Spot { position, angle, blend, .. } => Lamp::Spot {
            position: DVec3::from_array(position),
            direction: light.direction()?,
            edge: angle.to_radians().cos(),
            full: (angle * (1.0 - blend)).to_radians().cos(),
            intensity: light.power(),
        },
        LightKind::Sun { .. } => Lamp::Sun { direction: light.direction()?, irradiance: light.power(), middle, radius },
    })
}

/// What the light of a run gives to surfaces.
#[derive(Debug)]
pub struct Received<'a, T = f32> {
    set: &'a Set<'a>,
    kind: Kind<'a, T>,
}

#[derive(Debug)]
enum Kind<'a, T> {
    /// Taken from cells.
    Cells { grids: Vec<&'a Grid<T>>, arrivals: Option<Vec<Arrivals>>, channels: &'a Channels, sampling: Sampling },
    /// Known by patches.
    Patches(PatchLight<'a>),
}

impl<'a, T: Real> Received<'a, T> {
    /// The light of a level, or the merged light, of a run of this set's problem. A transport that keeps directions
    /// tells what patches receive whatever level is asked for; any sampling but the nearest is then a smooth one.
    pub fn of(set: &'a Set<'a>, simulation: &'a Simulation<T>, level: Option<usize>, sampling: Sampling) -> Self {
        let lights = simulation.lights().iter();
        let grids = lights.map(|light| match level {
            Some(i) => light.accumulated.level(i),
            None => light.merged.as_ref().unwrap_or(light.accumulated.level(0)),
        });
        Received::of_grids(set, simulation, grids.collect(), level, sampling)
    }

    /// The same of the merged light where `grids` are what each channel's is, merged or not.
    pub fn of_merged(
        set: &'a Set<'a>,
        simulation: &'a Simulation<T>,
        grids: &'a [Grid<T>],
        sampling: Sampling,
    ) -> Self {
        Received::of_grids(set, simulation, grids.iter().collect(), None, sampling)
    }

    fn of_grids(
        set: &'a Set<'a>,
        simulation: &'a Simulation<T>,
        grids: Vec<&'a Grid<T>>,
        level: Option<usize>,
        sampling: Sampling,
    ) -> Self {
        let kind = match simulation.received() {
            Some(received) => {
                let s2 = set.stage.placement.cell_side.powi(2);
                let of = |share: Share, i: usize| {
                    let channel = received[share.channel].get(i).copied().unwrap_or_default();
                    share.scale * channel / s2
                };
                let rgb = simulation.channels().rgb();
                let irradiance = (0..set.patches().all().len()).map(|i| rgb.map(|share| of(share, i))).collect();
                let smooth = sampling != Sampling::Nearest;
                Kind::Patches(PatchLight::new(set.patches(), &set.stage.placement, irradiance, smooth))
            }
            None => {
                let (arrivals, channels) = (simulation.arrivals(level), simulation.channels());
                Kind::Cells { grids, arrivals, channels, sampling }
            }
        };
        Received { set, kind }
    }

    /// The irradiance [W/m²] of a place on a surface.
    pub fn at(&self, at: DVec3, normal: DVec3) -> Rgb {
        match &self.kind {
            Kind::Patches(light) => light.at(at, normal),
            Kind::Cells { grids, arrivals, channels, sampling } => {
                let (placement, occupied) = (&self.set.stage.placement, &self.set.occupied);
                let arrivals = arrivals.as_deref();
                Cells { grids, channels, placement, occupied, arrivals, sampling: *sampling }.irradiance(at, normal)
            }
        }
    }

    /// The irradiance of every patch.
    pub fn patches(&self) -> Vec<Rgb> {
        match &self.kind {
            Kind::Patches(light) => light.patches().to_vec(),
            Kind::Cells { .. } => self.set.patches().mean(|_, at, normal| self.at(at, normal)),
        }
    }
}
