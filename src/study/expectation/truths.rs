//! What light truly does to the surfaces of a scene, and to a picture of it: path traced once, and kept.
//!
//! Tracing takes seconds, and neither the transport nor the size of an octree's coarsest level changes what is found.
//! So a truth is kept for the process, and whoever asks again for one of the same mesh, volume and lights gets it.

use std::sync::Arc;

use crate::field::Grid;
use crate::render::bounce::Bounces;
use crate::render::cells::Sampling;
use crate::render::image::Image;
use crate::render::seen::Seen;
use crate::render::stage::{Received, Set};
use crate::render::surface::{Lit, Patches};
use crate::render::truth::Truth;
use crate::scene::{Problem, Stage};
use crate::sh::Real;
use crate::simulation::Simulation;
use crate::study::kept::Kept;
use crate::study::{light, picture, surface};

/// Paths that tell what a patch of the surface receives.
pub const PATHS_A_PATCH: u64 = 512;
/// Pixels across and down of the picture that light is held against.
pub const PIXELS: [usize; 2] = [128, 128];
/// Paths that tell the radiance of one of them.
pub const PATHS_A_PIXEL: u64 = 256;
/// Places in a pixel that a picture of cells is the mean of.
const PLACES: u64 = 4;
/// Of a scene with a mesh, the irradiance of its surfaces by light that was reflected once.
#[derive(Debug)]
pub struct SurfaceTruth {
    stage: Arc<Stage>,
    patches: Arc<Patches>,
    lit: Lit,
}

/// The picture that the scene's camera takes of the same light.
#[derive(Debug)]
pub struct PictureTruth {
    stage: Arc<Stage>,
    truth: Truth,
    exposure: f32,
}

static SURFACES: Kept<SurfaceTruth> = Kept::new(4);
static PICTURES: Kept<PictureTruth> = Kept::new(4);

/// Hears of the share of a computation that is done, and returns whether to go on.
pub type Progress<'a> = &'a (dyn Fn(f64) -> bool + Sync);

impl SurfaceTruth {
    /// That of a problem; `None` where it has no mesh, or where `progress` ended it.
    pub fn of(problem: &Problem, progress: Progress) -> Option<Arc<Self>> {
        let stage = problem.stage.as_ref()?;
        SURFACES.get(
            |truth| truth.is_of(problem),
            || {
                let set = Set::new(stage);
                let lit = Lit::traced(&set.world(), set.patches(), Bounces::UpTo(1), PATHS_A_PATCH, progress)?;
                Some(SurfaceTruth { stage: Arc::clone(stage), patches: Arc::clone(set.patches()), lit })
            },
        )
    }

    /// Whether it is that of a problem.
    pub fn is_of(&self, problem: &Problem) -> bool {
        problem.stage.as_ref().is_some_and(|stage| same_light(stage, &self.stage))
    }

    /// The patches of the surface.
    pub fn patches(&self) -> &Patches {
        &self.patches
    }

    /// Their irradiance.
    pub fn lit(&self) -> &Lit {
        &self.lit
    }

    /// What the present light of a run gives to the patches, as the nearest cells have it.
    pub fn found<T: Real>(&self, state: &Simulation<T>) -> Vec<crate::render::rgb::Rgb> {
        let set = Set::with_patches(&self.stage, Arc::clone(&self.patches));
        let grids = light::sampled(state);
        Received::of_merged(&set, state, &grids, Sampling::Nearest).patches()
    }

    /// How far that is from the truth.
    pub fn compare<T: Real>(&self, state: &Simulation<T>) -> surface::Surfaces {
        surface::compare(&self.patches, &self.found(state), &self.lit)
    }
}

impl PictureTruth {
    /// That of a problem; `None` where it has no mesh or its camera sees nothing, or where `progress` ended it.
    pub fn of(problem: &Problem, progress: Progress) -> Option<Arc<Self>> {
        let stage = problem.stage.as_ref()?;
        PICTURES.get(
            |truth| truth.is_of(problem),
            || {
                let set = Set::new(stage);
                let truth = Truth::traced(&set.world(), set.view(PIXELS)?, Bounces::UpTo(1), PATHS_A_PIXEL, progress)?;
                let exposure = truth.total().exposure();
                Some(PictureTruth { stage: Arc::clone(stage), truth, exposure })
            },
        )
    }

    /// Whether it is that of a problem.
    pub fn is_of(&self, problem: &Problem) -> bool {
        let same = |stage: &Arc<Stage>| stage.camera == self.stage.camera && same_light(stage, &self.stage);
        problem.stage.as_ref().is_some_and(same)
    }

    /// All its radiance.
    pub fn image(&self) -> Image {
        self.truth.total()
    }

    /// Its noise, as a share of the indirect light.
    pub fn noise(&self) -> f64 {
        self.truth.noise()
    }

    /// What the camera sees of the present light of a run, as the nearest cells have it.
    pub fn seen<T: Real>(&self, state: &Simulation<T>) -> Option<Seen> {
        let set = Set::new(&self.stage);
        let grids: Vec<Grid<T>> = light::sampled(state);
        let received = Received::of_merged(&set, state, &grids, Sampling::Nearest);
        let (world, view) = (set.world(), self.truth.view());
        Seen::new(&world, view, PLACES, |at, normal| received.at(at, normal), &|_| true)
    }

    /// How far that is from the truth.
    pub fn compare(&self, seen: &Seen) -> picture::Compared {
        picture::compare(&self.image(), seen, self.exposure)
    }
}

/// Whether light falls alike in two scenes: one mesh, one volume, the same lights.
fn same_light(a: &Arc<Stage>, b: &Arc<Stage>) -> bool {
    let mesh = Arc::ptr_eq(&a.model, &b.model) || a.model.mesh == b.model.mesh;
    Arc::ptr_eq(a, b) || (mesh && (a.placement, &a.lights) == (b.placement, &b.lights))
}
