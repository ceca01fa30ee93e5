//! The thesis's setting (000, table 1): n = 32, three colours, four iterations, from clearing to merging.

use std::time::Instant;

use super::skipping::{bytes, problem};
use super::{BenchmarkError, median};
use crate::simulation::{Action, Simulation};

/// Two walls and a lobe whose colours are no multiples of each other.
const PRESET: &str = "(version: 1, size: 32, injectors: [\
    (kind: Wall(side: NegX), direction: (1, 0, 0), color: (1, 0.2, 0.1)), \
    (kind: Wall(side: PosX), direction: (-1, 0, 0), color: (0.1, 1, 0.3)), \
    (kind: Single(cell: (16, 16, 16)), direction: (0, 1, 0), color: (0.2, 0.1, 1))])";

/// Iterations of the thesis's frame.
const ITERATIONS: usize = 4;

/// Milliseconds of the propagation on the thesis's GTX 480 (000, table 1).
pub const THESIS_MILLISECONDS: f64 = 7.6;

/// Seconds of each stage of a frame, medians over many frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Pipeline {
    /// Threads that it ran on.
    pub threads: usize,
    /// Channels that were carried.
    pub channels: usize,
    /// The stages with their seconds; propagation is all iterations.
    pub stages: Vec<(&'static str, f64)>,
    /// Bytes of light and marks.
    pub bytes: usize,
}

impl Pipeline {
    /// Times so many frames on the current threads.
    pub fn measure(frames: usize) -> Result<Self, BenchmarkError> {
        let threads = rayon::current_num_threads();
        let mut simulation = Simulation::<f32>::new(problem(PRESET)?)?;
        let stages: [(&str, &[Action]); 5] = [
            ("clear", &[Action::Clear]),
            ("inject", &[Action::Inject]),
            ("downsample", &[Action::Downsample]),
            ("propagate", &[Action::Propagate; ITERATIONS]),
            ("merge", &[Action::Merge]),
        ];
        let mut seconds: [Vec<f64>; 5] = Default::default();
        for _ in 0..frames {
            for ((_, actions), seconds) in stages.iter().zip(&mut seconds) {
                let started = Instant::now();
                actions.iter().for_each(|action| {
                    simulation.act(*action);
                });
                seconds.push(started.elapsed().as_secs_f64());
            }
        }
        let stages = stages.iter().zip(&mut seconds).map(|((name, _), seconds)| (*name, median(seconds))).collect();
        Ok(Pipeline { threads, channels: simulation.lights().len(), stages, bytes: bytes(&simulation) })
    }

    /// Seconds of the propagation.
    pub fn propagation(&self) -> f64 {
        self.stages.iter().filter(|(name, _)| *name == "propagate").map(|(_, seconds)| seconds).sum()
    }
}
