//! A scene with a mesh while it is worked on: how long its solids, its shadow maps and a lamp that is moved take.
//!
//! Each time is the median of rounds in which the lamp stands somewhere else, so that nothing of the last round serves;
//! what a lamp that moves does not touch (the mesh, its solids) is there already, as it is in the window.

use std::path::Path;
use std::time::Instant;

use super::{BenchmarkError, median, pool};
use crate::render::cells::Sampling;
use crate::render::seen::Seen;
use crate::render::stage::{Received, Set};
use crate::scene::mesh_scene::{Light, LightKind};
use crate::scene::shadow_map::ShadowMap;
use crate::scene::stage::Cache;
use crate::scene::voxels::Voxels;
use crate::scene::{MOST_CELLS, Preset, Problem, Stage, builtin};
use crate::simulation::Simulation;
use crate::simulation::options::Wanted;
use crate::transport::{kinds, preset};

/// Texels along a side of a face of the atrium's map.
const TEXELS: usize = 256;
/// Iterations of the lattice.
const ITERATIONS: usize = 4;
/// Pixels across and down of the picture, and places in each.
const PIXELS: ([usize; 2], u64) = ([256, 256], 4);
/// How far the lamp goes from round to round, in metres.
const STEP: f64 = 0.002;

/// One thing that takes its time.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshSceneRow {
    /// The preset, with its size.
    pub scene: String,
    /// What is done.
    pub work: String,
    /// On how many threads.
    pub threads: usize,
    /// The median of the rounds.
    pub seconds: f64,
}

/// Measures on one thread and on the current ones.
///
/// # Errors
/// Where a scene cannot be built, or threads cannot be started.
pub fn measure(rounds: usize) -> Result<Vec<MeshSceneRow>, BenchmarkError> {
    let atrium = Scene::new("atrium")?;
    let stage = atrium.stage(0.0)?;
    let (mesh, bvh) = (&stage.model.mesh, &stage.model.bvh);
    let one = pool(1)?;
    let solids = median_of(rounds, |_| drop(one.install(|| Voxels::new(mesh, &stage.placement, MOST_CELLS))));
    let lamp = |round| Light::point([2.0 + STEP * round as f64, 4.0, 0.5], [60.0; 3]);
    let maps = median_of(rounds, |round| drop(ShadowMap::new(&lamp(round), TEXELS, mesh, bvh, mesh.bounds())));
    let threads = rayon::current_num_threads();
    let row = |scene: &Scene, work, threads, seconds| MeshSceneRow {
        scene: format!("{}, {}³", scene.name, scene.preset.size),
        work,
        threads,
        seconds,
    };
    let mut rows = vec![
        row(&atrium, "solids".to_owned(), 1, solids),
        row(&atrium, "six shadow maps of 256²".to_owned(), threads, maps),
    ];
    let mut cornell = Scene::new("cornell")?;
    cornell.preset.propagation.iterations = ITERATIONS;
    // One that sends light from cell to cell, and one that keeps its direction.
    let kinds = [true, false].map(|levels| kinds().iter().find(|kind| kind.can.levels == levels));
    for kind in kinds.into_iter().flatten() {
        cornell.preset.propagation.scheme = kind.name.to_owned();
        let way = (kind.label)(&cornell.preset.propagation);
        let way = if kind.can.levels { format!("{way}, k = {ITERATIONS}") } else { format!("{way}, all light") };
        let mut times = [Vec::new(), Vec::new()];
        for round in 0..=rounds {
            let started = Instant::now();
            let simulation = cornell.lit(round as f64 * STEP)?;
            let lit = started.elapsed().as_secs_f64();
            let stage = simulation.problem().stage.clone();
            picture(stage.as_deref(), &simulation);
            // The first round reads the mesh and makes its solids.
            if round > 0 {
                times[0].push(lit);
                times[1].push(started.elapsed().as_secs_f64());
            }
        }
        let [light, drawn] = &mut times;
        rows.push(row(&cornell, format!("lamp moved, to merged light, {way}"), threads, median(light)));
        rows.push(row(&cornell, format!("lamp moved, to a picture of 256², {way}"), threads, median(drawn)));
    }
    Ok(rows)
}

fn median_of(rounds: usize, mut work: impl FnMut(usize)) -> f64 {
    let time = |round| {
        let started = Instant::now();
        work(round);
        started.elapsed().as_secs_f64()
    };
    median(&mut (0..rounds).map(time).collect::<Vec<f64>>())
}

/// What the scene's camera sees; as long as that takes.
fn picture(stage: Option<&Stage>, simulation: &Simulation<f32>) {
    let Some(stage) = stage else { return };
    let set = Set::new(stage);
    let Some(view) = set.view(PIXELS.0) else { return };
    let received = Received::of(&set, simulation, None, Sampling::Nearest);
    let seen = Seen::new(&set.world(), &view, PIXELS.1, |at, normal| received.at(at, normal), &|_| true);
    std::hint::black_box(seen);
}

/// A built-in preset with a mesh, and what was made of it so far.
struct Scene {
    name: &'static str,
    preset: Preset,
    folder: std::path::PathBuf,
    cache: Cache,
}

impl Scene {
    fn new(name: &'static str) -> Result<Self, BenchmarkError> {
        let text = builtin::find(name).unwrap_or_default();
        let preset = preset::parse(text, Path::new(name))?;
        let folder = builtin::folder_of(text).map_err(|error| BenchmarkError::Folder(error.to_string()))?;
        Ok(Scene { name, preset, folder, cache: Cache::default() })
    }

    /// The scene with its first lamp `by` metres further along x.
    fn problem(&self, by: f64) -> Result<Problem, BenchmarkError> {
        let mut preset = self.preset.clone();
        let first = preset.scene.as_mut().and_then(|scene| scene.lights.first_mut());
        if let Some(LightKind::Point { position }) = first.map(|light| &mut light.kind) {
            position[0] += by;
        }
        Ok(Problem::build_with(&preset, &self.folder, &self.cache, &mut |_| {})?)
    }

    fn stage(&self, by: f64) -> Result<std::sync::Arc<Stage>, BenchmarkError> {
        self.problem(by)?.stage.ok_or_else(|| BenchmarkError::Folder(format!("{} has no mesh", self.name)))
    }

    /// Its merged light, with all that a picture needs to know.
    fn lit(&self, by: f64) -> Result<Simulation<f32>, BenchmarkError> {
        let problem = self.problem(by)?;
        let mut simulation = Simulation::<f32>::new(problem.clone())?;
        if let (Some(stage), Some(_)) = (problem.stage.clone(), simulation.received()) {
            simulation = Simulation::new(Set::new(&stage).prepared(problem))?;
        }
        if simulation.received().is_some() {
            simulation.settle(|_| true);
        } else {
            simulation.run_all(Wanted::Everything);
        }
        Ok(simulation)
    }
}
