//! Light that moves: what a propagator makes of it frame by frame, and how much of the change is its own.
//!
//! A coarse cell that light enters or leaves changes all at once, and a lobe that goes from one cell to the next jumps;
//! the thesis saw the flicker and found it not easily made visible in a figure (000, 6.1). Here is a number for it. With
//! S the mean (c00) of the merged light, U that of all light there would ever be in the uniform volume if the moving
//! light were split over the eight cells around its place, and ε a thousandth of U's largest, a cell flickers from one
//! frame to the next by
//!
//! ```text
//! | Δ ln(S + ε) − Δ ln(U + ε) |
//! ```
//!
//! 0 where light changes as it should, 0.1 where it changes by a tenth more or less. The mean is over the cells in which
//! any of the four is above ε: nobody sees the others.

use super::light::channel_scales;
use super::reference;
use crate::field::{Cell, Grid, Levels, Octree};
use crate::scene::Problem;
use crate::scene::path::{Keyframe, Placing};
use crate::scene::propagation::Policy;
use crate::scene::propagation::descent::Descent as Asked;
use crate::simulation::options::Wanted;
use crate::simulation::{Refusal, Simulation};
use crate::transport::descent::{Descent, Grids, Injected, of_problem};
use crate::transport::state::keep;
use crate::transport::{self, solve::NoFixedPoint};

/// Under this part of the largest light nobody sees a flicker.
const FAINT: f64 = 1e-3;
/// The relative residual of the light that is held to be right.
const TOLERANCE: f64 = 1e-4;
/// Frames after which a warm start has got where it gets: with four iterations each and `cascaded` at p = 3.8 the error
/// no longer falls from one frame to the next.
pub const SETTLING: usize = 16;

/// How a motion is run.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// How many frames.
    pub frames: usize,
    /// Frames a second.
    pub rate: f64,
    /// What becomes of fractions of a cell.
    pub placing: Placing,
    /// Whether a frame starts from what the one before has moved. Then it is the finest level that is iterated, or the
    /// finest leaves.
    pub warm: bool,
    /// Cells whose light is told frame by frame.
    pub pinned: Vec<Cell>,
}

/// Means over the frames of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Means {
    /// Over how many frames.
    pub frames: usize,
    /// Of their mean flicker; none where no frame has one.
    pub flicker: Option<f64>,
    /// Of their L1 ratio against the light that is held to be right.
    pub error: f64,
}

impl Means {
    /// Of the frames from number `settled` on. A warm start begins in the dark, and tells nothing of what it is worth
    /// before as many frames have passed as light takes to get there ([`SETTLING`]). `None` if no frame is left.
    pub fn of(frames: &[Frame], settled: usize) -> Option<Self> {
        let counted = frames.get(settled..).filter(|counted| !counted.is_empty())?;
        let mean = |sum: f64, count: usize| sum / count as f64;
        let flicker: Vec<f64> = counted.iter().filter_map(|frame| frame.flicker).map(|[mean, _]| mean).collect();
        Some(Means {
            frames: counted.len(),
            flicker: (!flicker.is_empty()).then(|| mean(flicker.iter().sum(), flicker.len())),
            error: mean(counted.iter().map(|frame| frame.error).sum(), counted.len()),
        })
    }
}

/// One frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Its number, from 0.
    pub number: usize,
    /// Seconds.
    pub time: f64,
    /// The mean flicker since the frame before, and the largest; none in the first frame.
    pub flicker: Option<[f64; 2]>,
    /// The L1 ratio against the light that is held to be right.
    pub error: f64,
    /// c00 of the merged light in the pinned cells, and of the light that is held to be right.
    pub pinned: Vec<[f64; 2]>,
}

/// Why a motion is not run.
#[derive(Debug, thiserror::Error)]
pub enum MotionError {
    /// The setting itself cannot be run.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// There is nothing to hold the light against.
    #[error("what is right cannot be told: {0}")]
    NoReference(#[from] NoFixedPoint),
    /// Light among occluders grows for ever.
    #[error("what is right cannot be told: light grows for ever; use a smaller factor, or less that turns light back")]
    Grows,
    /// Only descents and a single level can start from the last frame.
    #[error("a warm start is for a descent or for levels that are alike; leave --levels out or choose a descent")]
    Cold,
}

/// Runs `problem` with each of its sources on its path, and hands every frame with its merged light to `watch`, which
/// returns whether to go on.
pub fn run(
    problem: &Problem,
    paths: &[&[Keyframe]],
    setting: &Setting,
    mut watch: impl FnMut(&Frame, &[Grid<f32>]) -> bool,
) -> Result<Vec<Frame>, MotionError> {
    let mut warm = if setting.warm { Some(Warm::new(problem)?) } else { None };
    let mut frames: Vec<Frame> = Vec::new();
    let mut before: Option<[Vec<f64>; 2]> = None;
    for number in 0..setting.frames {
        let time = number as f64 / setting.rate;
        let at = |placing| problem.at_time(paths, time, placing);
        let (light, scales) = match &mut warm {
            Some(warm) => warm.frame(&at(setting.placing))?,
            None => cold(at(setting.placing))?,
        };
        let right = right(&at(Placing::Split))?;
        let means = [&light, &right].map(|light| mean(light, &scales));
        let faint = FAINT * means[1].iter().copied().fold(0.0, f64::max);
        let flicker = before.as_ref().map(|before| flicker(before, &means, faint));
        let off: f64 = means[0].iter().zip(&means[1]).map(|(s, u)| (s - u).abs()).sum();
        let all: f64 = means[1].iter().sum();
        let n = problem.size;
        let pinned = setting.pinned.iter().map(|[x, y, z]| [0, 1].map(|i| means[i][(z * n + y) * n + x])).collect();
        let frame = Frame { number, time, flicker, error: if off == 0.0 { 0.0 } else { off / all }, pinned };
        let go_on = watch(&frame, &light);
        frames.push(frame);
        before = Some(means);
        if !go_on {
            break;
        }
    }
    Ok(frames)
}

fn cold(problem: Problem) -> Result<(Vec<Grid<f32>>, Vec<f64>), Refusal> {
    let mut simulation = Simulation::<f32>::new(problem)?;
    simulation.run_all(Wanted::Merged);
    let light = simulation.lights().iter().filter_map(|light| light.merged.clone()).collect();
    Ok((light, channel_scales(simulation.channels())))
}

/// All light there would ever be in the uniform volume; among occluders, which no solver takes, what iterating comes to.
fn right(problem: &Problem) -> Result<Vec<Grid<f32>>, MotionError> {
    let problem = reference::finest(problem);
    if problem.has_occluders() {
        return reference::all_light(&problem)?.ok_or(MotionError::Grows);
    }
    // Nobody stops it, so there is an answer.
    Ok(transport::solve(&problem, TOLERANCE, |_| true)?.map(|found| found.light).unwrap_or_default())
}

/// c00 of every cell over all channels, each at its largest multiple.
fn mean(light: &[Grid<f32>], scales: &[f64]) -> Vec<f64> {
    let n = light.first().map_or(0, Grid::side);
    let mut means = vec![0.0; n * n * n];
    for (grid, scale) in light.iter().zip(scales) {
        means
            .iter_mut()
            .zip(grid.iter())
            .for_each(|(mean, (_, light))| *mean += scale * f64::from(light.0[0].max(0.0)));
    }
    means
}

/// Mean and largest flicker between two frames, each as S and U.
fn flicker([s, u]: &[Vec<f64>; 2], [s_now, u_now]: &[Vec<f64>; 2], faint: f64) -> [f64; 2] {
    let change = |before: f64, now: f64| ((now + faint) / (before + faint)).ln();
    let (mut sum, mut seen, mut most) = (0.0, 0usize, 0.0f64);
    for i in 0..s.len() {
        if [s[i], s_now[i], u[i], u_now[i]].into_iter().fold(0.0, f64::max) <= faint {
            continue;
        }
        let off = (change(s[i], s_now[i]) - change(u[i], u_now[i])).abs();
        sum += off;
        seen += 1;
        most = most.max(off);
    }
    [sum / seen.max(1) as f64, most]
}

/// A run whose frames start from what the one before has moved: B, without the light S that stays where it is injected,
/// which has gone on.
struct Warm {
    iterations: usize,
    scales: Vec<f64>,
    descent: Descent<f32>,
    channels: Vec<Channel>,
}

struct Channel {
    /// Source, target and accumulated light.
    grids: [Octree<f32>; 3],
    /// B in every finest cell, once there was a frame.
    moved: Option<Grid<f32>>,
}

impl Channel {
    fn grids(&mut self) -> Grids<'_, f32> {
        let [source, target, accumulated] = &mut self.grids;
        Grids { source, target, accumulated }
    }
}

impl Warm {
    fn new(problem: &Problem) -> Result<Self, MotionError> {
        let propagation = &problem.propagation;
        let alike = propagation.descent == Asked::Off && propagation.levels == Policy::Same;
        if !(alike || propagation.descent.goes_down()) {
            return Err(MotionError::Cold);
        }
        let (descent, sizes) = descent_of(problem)?;
        let channels = problem.channels();
        let channel = || Channel { grids: [(); 3].map(|()| Octree::new(sizes)), moved: None };
        Ok(Warm {
            iterations: propagation.iterations.max(1),
            scales: channel_scales(&channels),
            descent,
            channels: (0..channels.count()).map(|_| channel()).collect(),
        })
    }

    fn frame(&mut self, problem: &Problem) -> Result<(Vec<Grid<f32>>, Vec<f64>), Refusal> {
        let Warm { iterations, descent, channels, .. } = self;
        if problem.has_occluders() {
            // Which cells light can get to goes by where it is.
            (*descent, _) = descent_of(problem)?;
        }
        let mut injected = problem.injected::<f32>(&problem.channels());
        let mut rooms: Vec<Grid<f32>> = injected.iter().map(|light| Grid::new(light.side())).collect();
        let both = injected.iter_mut().zip(&mut rooms);
        descent.take_up(&mut both.map(|(light, room)| Injected { light, room }).collect::<Vec<_>>());
        if channels.iter().all(|channel| channel.moved.is_some()) {
            descent.skip_to_finest();
            for (c, channel) in channels.iter_mut().enumerate() {
                if let Some(moved) = channel.moved.take() {
                    descent.resume(c, &moved, &mut channel.grids());
                }
                (1..*iterations).for_each(|_| descent.iterate(c, &mut channel.grids()));
            }
        } else {
            descent.run(*iterations, &mut channels.iter_mut().map(Channel::grids).collect::<Vec<_>>());
        }
        let accumulating = problem.accumulating(0);
        let light = channels.iter_mut().enumerate().map(|(c, channel)| {
            let mut merged = Grid::new(problem.size);
            descent.sample(c, problem.propagation.inside, channel.grids().accumulated, &mut merged);
            let mut rest = merged.clone();
            descent.leave_moved(c, &mut rest);
            channel.moved = Some(rest);
            keep(&mut merged, accumulating.as_ref());
            merged
        });
        Ok((light.collect(), self.scales.clone()))
    }
}

/// What a warm start goes on with: the problem's descent, or that of the finest level alone, which is all there is to a
/// descent without coarser ones.
fn descent_of(problem: &Problem) -> Result<(Descent<f32>, Levels), Refusal> {
    let mut problem = problem.clone();
    if problem.propagation.descent == Asked::Off {
        problem.coarsest = problem.size;
        problem.propagation.descent = Asked::Cells;
    }
    let Problem { size, coarsest, .. } = problem;
    let sizes = Levels::new(size, coarsest).ok_or(Refusal::Sizes { size, coarsest })?;
    Ok((of_problem(&problem, sizes, problem.channels().count())?, sizes))
}
