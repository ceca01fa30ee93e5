//! Light that fades for 2000 iterations at p = 3, far below the smallest normal number were it not for the
//! floor of every loop ([`crate::transport::lattice::kernel::FLOOR`]): late iterations must not take longer.

use std::time::Instant;

use super::skipping::problem;
use super::{BenchmarkError, median};
use crate::simulation::options::{Options, Skip};
use crate::simulation::{Action, Simulation};

/// One wall, n = 32, p = 3.
const PRESET: &str = "(version: 1, size: 32, injectors: [(kind: Wall(side: NegX))])";
/// Iterations whose times are taken together.
const TOGETHER: usize = 100;
/// How often that is done: 2000 iterations.
const TIMES: usize = 20;

/// Nanoseconds for each cell of all levels and iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Fading {
    /// Median of each hundred iterations, with nothing skipped.
    pub computed: Vec<f64>,
    /// The same with all skipping.
    pub skipped: Vec<f64>,
}

impl Fading {
    /// Times 2000 iterations on the current threads, twice.
    pub fn measure() -> Result<Self, BenchmarkError> {
        Ok(Fading { computed: hundreds(Skip::NOTHING)?, skipped: hundreds(Skip::default())? })
    }
}

fn hundreds(skip: Skip) -> Result<Vec<f64>, BenchmarkError> {
    let options = Options { skip, ..Options::default() };
    let mut simulation = Simulation::<f32>::with_options(problem(PRESET)?, options)?;
    for action in [Action::Clear, Action::Inject, Action::Downsample] {
        simulation.act(action);
    }
    let cells = (simulation.sizes().cells() * simulation.lights().len()) as f64;
    let hundred = |_| {
        let mut each: Vec<f64> = (0..TOGETHER)
            .map(|_| {
                let started = Instant::now();
                simulation.act(Action::Propagate);
                1e9 * started.elapsed().as_secs_f64() / cells
            })
            .collect();
        median(&mut each)
    };
    Ok((0..TIMES).map(hundred).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_light_it_times_fades_to_nothing_and_never_gets_denormal() {
        let mut simulation = Simulation::<f32>::new(problem(PRESET).unwrap()).unwrap();
        for action in [Action::Clear, Action::Inject, Action::Downsample] {
            simulation.act(action);
        }
        let mut faintest = f32::MAX;
        for _ in 0..TOGETHER * TIMES {
            simulation.act(Action::Propagate);
            for c in simulation.lights()[0].source.level(0).planes().iter().flatten() {
                faintest = if *c == 0.0 { faintest } else { faintest.min(c.abs()) };
            }
        }
        assert!((1e-30..1e-28).contains(&faintest), "{faintest:e}");
        assert_eq!(simulation.lights()[0].source.level(0).energy(), 0.0);
    }
}
