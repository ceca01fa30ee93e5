//! What a scene's occluders are to its simulation: which kind of occluders, from which iteration on, and
//! whether they tint light.

use crate::field::{Grid, IndexVolume, Levels, Marks};
use crate::scene::Problem;
use crate::scene::occluder::{BlockingSign, OcclusionMode};
use crate::sh::Real;
use crate::transport::lattice::barrier::Barrier;
use crate::transport::lattice::geometry::Geometry;
use crate::transport::lattice::kernel::occluded::{Fuzzy, Hard, Mirrored, Occluders, Touched};
use crate::transport::lattice::scheme::{Scheme, Surface};

/// The occluders of a scene as a scheme sees them.
#[derive(Clone, Debug)]
pub(super) struct Obstacles<T> {
    pub(super) occluders: Occluders<T>,
    /// The first iteration in which they act, counted from 1.
    from_iteration: usize,
    /// By level, the cells whose light depends on them.
    pub(super) touched: Vec<Touched<T>>,
}

impl<T: Real> Obstacles<T> {
    /// `None` where there are none.
    pub(super) fn new(problem: &Problem, sizes: Levels, scheme: &Scheme) -> Option<Self> {
        let occlusion = problem.occlusion;
        if !problem.has_occluders() {
            return None;
        }
        // Reflection is what a mirroring scheme is; in the others it is an extra that the preset asks for.
        let mirrors = scheme.surface == Surface::Mirrored;
        let between = occlusion.mode == OcclusionMode::Fuzzy && !mirrors;
        let geometry = Geometry::new(sizes, if between { problem.blockers() } else { &problem.solids });
        let (occluders, from_iteration) = match occlusion.mode {
            OcclusionMode::Hard => {
                let injected = problem.sources.iter().flat_map(|source| &source.light);
                let barrier = Barrier::new(sizes, &problem.solids, injected.map(|(cell, _)| *cell));
                let bounce = if mirrors { 1.0 } else { occlusion.bounce };
                (Occluders::Hard(Hard { barrier, geometry, bounce: T::of(bounce) }), 0)
            }
            _ if mirrors => (Occluders::Mirrored(Mirrored { geometry }), 0),
            _ => {
                let fuzzy = Fuzzy {
                    geometry,
                    amplifier: T::of(occlusion.amplifier),
                    along_travel: occlusion.sign == BlockingSign::AlongTravel,
                    bounce: T::of(occlusion.bounce),
                };
                (Occluders::Fuzzy(fuzzy), occlusion.from_iteration)
            }
        };
        let touched = (0..sizes.count()).map(|i| occluders.touched(i, sizes.side(i))).collect();
        Some(Obstacles { occluders, from_iteration, touched })
    }

    /// Itself, if they act in an iteration, counted from 1.
    pub(super) fn acting(&self, iteration: usize) -> Option<&Self> {
        (iteration >= self.from_iteration).then_some(self)
    }
}

/// Sees to it that cells which hard occluders let no light enter are sampled at level 0.
pub(super) fn mark_shut<T: Real>(obstacles: Option<&Obstacles<T>>, index: &mut IndexVolume) {
    if let Some(Obstacles { occluders: Occluders::Hard(hard), .. }) = obstacles {
        let marks = index.level_mut(0);
        hard.barrier.shut().for_each(|cell| marks.set(cell));
    }
}

/// By level the cells that accumulate light; `None` where all do.
pub(super) fn accumulating(problem: &Problem, sizes: Levels) -> Option<Vec<Marks>> {
    (0..sizes.count()).map(|level| problem.accumulating(level)).collect()
}

/// Adds the light of an iteration to what was accumulated, in all cells or in the given ones.
pub(super) fn accumulate<T: Real>(light: &Grid<T>, cells: Option<&Marks>, accumulated: &mut Grid<T>) {
    match cells {
        None => accumulated.add_grid(light),
        Some(cells) => {
            let lit = light.iter().filter(|(cell, _)| cells.get(*cell));
            lit.for_each(|(cell, light)| accumulated.add(cell, light));
        }
    }
}
