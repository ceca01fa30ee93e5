//! Two scenes on a whole octree, with skipping and with each kind of it switched off.

use std::path::Path;
use std::time::Instant;

use super::{BenchmarkError, Sample};
use crate::scene::Problem;
use crate::scene::preset::Preset;
use crate::simulation::options::{Options, Skip, Wanted};
use crate::simulation::{Action, Simulation};

/// A scene, what is wanted of it, and what may be skipped.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its name in tables.
    pub name: &'static str,
    problem: fn(usize) -> String,
    iterations: usize,
    wanted: Wanted,
    skip: Skip,
}

/// One lobe in the middle, all levels wanted.
const LOBE: Case = Case { name: "lobe", problem: lobe, iterations: 8, wanted: Wanted::Everything, skip: ALL };
/// Two walls that face each other, only the merged light wanted.
const WALLS: Case = Case { name: "walls-merged", problem: walls, iterations: 16, wanted: Wanted::Merged, skip: ALL };

const ALL: Skip = Skip { reach: true, dark: true, unmerged: true, channels: true };
const NOTHING: Skip = Skip { channels: true, ..Skip::NOTHING };

/// The two scenes with all skipping, with each kind that matters to them off, and with none.
pub const CASES: [Case; 8] = [
    LOBE,
    Case { name: "lobe-no-reach", skip: Skip { reach: false, ..ALL }, ..LOBE },
    Case { name: "lobe-no-dark", skip: Skip { dark: false, ..ALL }, ..LOBE },
    Case { name: "lobe-no-skip", skip: NOTHING, ..LOBE },
    WALLS,
    Case { name: "walls-merged-no-reach-dark", skip: Skip { reach: false, dark: false, ..ALL }, ..WALLS },
    Case { name: "walls-merged-no-unmerged", skip: Skip { unmerged: false, ..ALL }, ..WALLS },
    Case { name: "walls-merged-no-skip", skip: NOTHING, ..WALLS },
];

fn lobe(n: usize) -> String {
    let at = n / 2;
    format!("(version: 1, size: {n}, injectors: [(kind: Single(cell: ({at}, {at}, {at})), direction: (1, 0, 0))])")
}

fn walls(n: usize) -> String {
    format!(
        "(version: 1, size: {n}, injectors: [(kind: Wall(side: NegX), direction: (1, 0, 0)), \
         (kind: Wall(side: PosX), direction: (-1, 0, 0))])"
    )
}

/// A scene written down here.
pub(super) fn problem(text: &str) -> Result<Problem, BenchmarkError> {
    let preset = Preset::parse(text, Path::new("benchmark"))?;
    Ok(Problem::build(&preset, Path::new(""))?)
}

impl Case {
    /// Times the iterations, injection and merge aside, on the current threads; and the bytes that the
    /// simulation's light takes.
    pub fn sample(&self, n: usize) -> Result<(Sample, usize), BenchmarkError> {
        let options = Options { skip: self.skip, ..Options::default() };
        let mut simulation = Simulation::<f32>::with_options(problem(&(self.problem)(n))?, options)?;
        for action in [Action::Clear, Action::Inject, Action::Downsample] {
            simulation.act(action);
        }
        let started = Instant::now();
        simulation.advance(self.iterations, self.wanted);
        let work = simulation.work();
        Ok((Sample::new(started, work.volume, work.visited), bytes(&simulation)))
    }
}

/// Bytes of a simulation's light and marks.
pub(super) fn bytes(simulation: &Simulation<f32>) -> usize {
    let octrees = simulation.lights().iter().flat_map(|light| [&light.source, &light.target, &light.accumulated]);
    octrees.map(|octree| octree.bytes()).sum::<usize>() + simulation.index().bytes()
}
