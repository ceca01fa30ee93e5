//! What the pictures are made of, each on a thread of its own: what the camera sees of every run's light; the truth,
//! batch by batch; how far they are apart.

use std::sync::Arc;

use glam::DVec3;

use crate::app::session::asides::{Very, Watch};
use crate::app::worker::rival::Rival;
use crate::render::bounce::Bounces;
use crate::render::cells::Sampling;
use crate::render::image::Image;
use crate::render::seen::Seen;
use crate::render::stage::{Received, Set};
use crate::render::truth::Truth;
use crate::render::view::View;
use crate::scene::mesh_scene::Camera;
use crate::scene::{Problem, Stage};
use crate::simulation::{Action, Simulation};
use crate::study::picture::{self, Compared, flip};

/// Places in a pixel that a picture is the mean of.
const PLACES: u64 = 4;
/// Paths a pixel in a batch of the truth: small, so that something is soon to be seen.
pub const BATCH: u64 = 8;

/// What the camera is to see, and of which light.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The problem that runs.
    pub problem: Very,
    /// What runs beside the document's own propagator.
    pub rivals: Vec<Rival>,
    /// The iteration that is seen.
    pub iteration: usize,
    /// Who looks.
    pub camera: Camera,
    /// Pixels along a side.
    pub side: usize,
    /// Where the light of cells is taken.
    pub sampling: Sampling,
}

/// What a camera sees in a square picture of so many pixels along a side; `None` where it sees nothing.
pub fn view(camera: &Camera, side: usize) -> Option<View> {
    let [from, to, up] = [camera.from, camera.to, camera.up].map(DVec3::from_array);
    View::new(from, to, up, camera.fov, [side, side])
}

/// A run and its picture.
#[derive(Debug)]
pub struct Run {
    /// Its place in the comparison.
    pub place: usize,
    simulation: Simulation<f32>,
    /// What the camera sees of it.
    pub seen: Seen,
    /// All light of that.
    pub light: Image,
}

/// The pictures of all runs.
#[derive(Debug)]
pub struct Pictures {
    /// What is seen from where.
    pub view: View,
    /// Run by run.
    pub runs: Vec<Run>,
    /// What brings the direct light onto a display. It does not depend on how the rest travels, nor on noise, so
    /// pictures of all runs and iterations can be compared.
    pub exposure: f32,
}

impl Pictures {
    /// The places of the runs.
    pub fn places(&self) -> Vec<usize> {
        self.runs.iter().map(|run| run.place).collect()
    }

    /// The run at a place.
    pub fn run(&self, place: usize) -> Option<&Run> {
        self.runs.iter().find(|run| run.place == place)
    }
}

/// Makes them; light that has gone part of its way in the `last` ones goes on from there.
pub fn pictures(request: &Request, last: Option<&(Request, Arc<Pictures>)>, watch: &Watch) -> Result<Pictures, String> {
    let Very(problem) = &request.problem;
    let stage = problem.stage.as_deref().ok_or("there is no mesh to look at")?;
    let view = view(&request.camera, request.side).ok_or("the camera sees nothing")?;
    let last = last.filter(|(of, _)| {
        of.problem == request.problem && of.rivals == request.rivals && of.iteration <= request.iteration
    });
    let (set, world) = (Set::new(stage), Set::new(stage).world());
    let problems = places(problem, &request.rivals);
    let count = problems.len() as f64;
    let mut runs = Vec::new();
    for (i, (place, problem)) in problems.into_iter().enumerate() {
        let go_on = |share: f64| watch.go_on((i as f64 + share) / count);
        let known = last.and_then(|(_, pictures)| pictures.run(place)).map(|run| run.simulation.clone());
        let simulation = lit(known, &set, problem, request.iteration, &|share| go_on(0.5 * share))?;
        let received = Received::of(&set, &simulation, None, request.sampling);
        let seen =
            Seen::new(&world, &view, PLACES, |at, normal| received.at(at, normal), &|share| go_on(0.5 + 0.5 * share));
        let seen = seen.ok_or("called off")?;
        let light = seen.total();
        runs.push(Run { place, simulation, seen, light });
    }
    let direct = runs.first().map(|run| &run.seen.direct).filter(|direct| direct.mean() != [0.0; 3]);
    let exposure = direct.or(runs.first().map(|run| &run.light)).map_or(1.0, Image::exposure);
    Ok(Pictures { view, runs, exposure })
}

/// What is simulated, each with its place in the comparison.
fn places(own: &Problem, rivals: &[Rival]) -> Vec<(usize, Problem)> {
    let others = rivals.iter().enumerate().filter_map(|(i, rival)| Some((i + 1, rival.problem(own)?)));
    std::iter::once((0, own.clone())).chain(others).collect()
}

/// A problem's light after an iteration, merged.
fn lit(
    known: Option<Simulation<f32>>,
    set: &Set,
    problem: Problem,
    iteration: usize,
    go_on: &dyn Fn(f64) -> bool,
) -> Result<Simulation<f32>, String> {
    let mut simulation = match known {
        Some(known) => known,
        None => {
            let mut fresh = Simulation::new(problem.clone()).map_err(|refusal| refusal.to_string())?;
            if fresh.received().is_some() {
                // It tells surfaces what they receive, if it knows of them.
                fresh = Simulation::new(set.prepared(problem)).map_err(|refusal| refusal.to_string())?;
            }
            for action in [Action::Clear, Action::Inject, Action::Downsample] {
                fresh.act(action);
            }
            fresh
        }
    };
    while simulation.iteration() < iteration {
        if !go_on(simulation.iteration() as f64 / iteration as f64) {
            return Err("called off".to_owned());
        }
        let before = simulation.iteration();
        simulation.act(Action::Propagate);
        // Light that diverges, or has gone all its way, stays as it is.
        if simulation.iteration() == before {
            break;
        }
    }
    simulation.act(Action::Merge);
    Ok(simulation)
}

/// Which truth is wanted, and how good.
#[derive(Clone, Debug)]
pub struct TruthRequest {
    /// The mesh and its lights.
    pub stage: Arc<Stage>,
    /// Who looks.
    pub camera: Camera,
    /// Pixels along a side.
    pub side: usize,
    /// Which light.
    pub bounces: Bounces,
    /// Paths a pixel.
    pub paths: u64,
}

impl TruthRequest {
    /// Whether both are of the same picture, however good.
    pub fn is_of_the_same(&self, other: &TruthRequest) -> bool {
        let world = Arc::ptr_eq(&self.stage.model, &other.stage.model) && self.stage.lights == other.stage.lights;
        world && (self.camera, self.side, self.bounces) == (other.camera, other.side, other.bounces)
    }
}

impl PartialEq for TruthRequest {
    fn eq(&self, other: &Self) -> bool {
        self.is_of_the_same(other) && self.paths == other.paths
    }
}

/// A truth as far as it is traced.
#[derive(Debug)]
pub struct Traced {
    /// The truth.
    pub truth: Truth,
    /// All light of it.
    pub light: Image,
    /// One standard deviation of that.
    pub deviation: Image,
    /// What its error does to what is measured against it.
    pub bars: Bars,
}

impl Traced {
    fn new(truth: Truth) -> Self {
        let (light, deviation) = (truth.total(), truth.deviation());
        let bars = Bars::of(&light, &deviation);
        Traced { truth, light, deviation, bars }
    }
}

/// Traces it; the `last` one is refined where it is of the same.
pub fn truth(
    request: &TruthRequest,
    last: Option<&(TruthRequest, Arc<Traced>)>,
    watch: &Watch,
) -> Result<Traced, String> {
    let view = view(&request.camera, request.side).ok_or("the camera sees nothing")?;
    let mut truth = match last {
        Some((of, traced)) if of.is_of_the_same(request) => traced.truth.clone(),
        _ => Truth::new(view, request.bounces),
    };
    let world = Set::new(&request.stage).world();
    while truth.samples() < request.paths {
        if !truth.add_batch(&world, BATCH, &|share| watch.go_on(share)) {
            return Err("called off".to_owned());
        }
    }
    Ok(Traced::new(truth))
}

/// What is held against what, on which display.
#[derive(Clone, Debug)]
pub struct Against {
    /// The pictures.
    pub pictures: Arc<Pictures>,
    /// Their truth.
    pub truth: Arc<Traced>,
    /// What radiance is multiplied with.
    pub exposure: f32,
}

impl PartialEq for Against {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.pictures, &other.pictures)
            && Arc::ptr_eq(&self.truth, &other.truth)
            && self.exposure == other.exposure
    }
}

/// How far a run's picture is from the truth.
#[derive(Debug)]
pub struct Apart {
    /// The run's place in the comparison.
    pub place: usize,
    /// In numbers.
    pub compared: Compared,
    /// FLIP of every pixel, 0 to 1.
    pub flip: Vec<f64>,
}

/// What the truth's own error does to the numbers that are measured against it: one standard deviation, as far as the
/// pixels' errors are unrelated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bars {
    /// The RMSE that a perfect picture would have, in radiance.
    pub rmse: f64,
    /// The relMSE that a perfect picture would have.
    pub rel_mse: f64,
    /// Of the mean ratio.
    pub mean_ratio: f64,
    /// The standard deviations of all pixels over their light.
    pub noise: f64,
}

impl Bars {
    /// Those of a picture with the standard deviation of each of its pixels.
    pub fn of(light: &Image, deviation: &Image) -> Self {
        let mean = light.mean().iter().sum::<f64>() / 3.0;
        let numbers = |image: &Image| image.pixels().iter().flatten().map(|v| f64::from(*v)).collect::<Vec<f64>>();
        let (light, deviation) = (numbers(light), numbers(deviation));
        let count = light.len().max(1) as f64;
        let squares: f64 = deviation.iter().map(|d| d * d).sum();
        let floor = picture::FLOOR * mean * mean;
        let relative = light.iter().zip(&deviation).filter(|(_, d)| **d > 0.0).map(|(r, d)| d * d / (r * r + floor));
        let whole = light.iter().sum::<f64>();
        Bars {
            rmse: (squares / count).sqrt(),
            rel_mse: relative.sum::<f64>() / count,
            mean_ratio: if whole > 0.0 { squares.sqrt() / whole } else { 0.0 },
            noise: if whole > 0.0 { deviation.iter().sum::<f64>() / whole } else { 0.0 },
        }
    }
}

/// Holds every run's picture against the truth.
pub fn apart(against: &Against, watch: &Watch) -> Result<Vec<Apart>, String> {
    let (reference, exposure) = (&against.truth.light, against.exposure);
    let count = against.pictures.runs.len() as f64;
    let one = |(i, run): (usize, &Run)| {
        if !watch.go_on(i as f64 / count) {
            return Err("called off".to_owned());
        }
        let compared = picture::compare(reference, &run.seen, exposure);
        let flip = flip::flip(reference, &run.light, exposure, flip::PIXELS_A_DEGREE);
        Ok(Apart { place: run.place, compared, flip })
    };
    against.pictures.runs.iter().enumerate().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_bars_of_an_even_truth_have_their_closed_forms() {
        let image = |v: f32| Image::from_fn([8, 8], |_, _| [v; 3]);
        let bars = Bars::of(&image(2.0), &image(0.5));
        // 192 numbers of 2 ± 0.5 each.
        assert!((bars.rmse - 0.5).abs() < 1e-12 && (bars.noise - 0.25).abs() < 1e-12);
        assert!((bars.rel_mse - 0.25 / (4.0 + 0.04)).abs() < 1e-12);
        assert!((bars.mean_ratio - 0.25 / 192f64.sqrt()).abs() < 1e-12);
        let dark = Bars::of(&image(0.0), &image(0.0));
        assert_eq!(dark, Bars { rmse: 0.0, rel_mse: 0.0, mean_ratio: 0.0, noise: 0.0 });
    }
}
