//! What a problem's occluders are to a scheme: which kind of occluders, and from which iteration on.

use super::geometry_volume::GeometryVolume;
use super::hard_solids::HardSolids;
use super::kernel::occluded::{Fuzzy, Hard, Mirrored, OcclusionLaw, Touched};
use super::reach::grown;
use super::scheme::{Scheme, Surface};
use crate::field::{IndexVolume, Layout, Levels, Marks, memory};
use crate::scene::Problem;
use crate::scene::occluder::{BlockingSign, OcclusionMode};
use crate::sh::Real;

/// The occluders of a scene as a scheme sees them.
#[derive(Clone, Debug)]
pub(super) struct LatticeSolids<T> {
    pub(super) occluders: OcclusionLaw<T>,
    /// The first iteration in which they stop light, counted from 1.
    from_iteration: usize,
    /// Whether they reflect light before that.
    reflects: bool,
    /// By level, the cells whose light depends on them.
    pub(super) touched: Vec<Touched<T>>,
}

/// How occluders act under a scheme, and from which iteration on, counted from 1.
pub(super) struct Acting<T> {
    pub(super) law: OcclusionLaw<T>,
    pub(super) from_iteration: usize,
}

impl<T: Real> Acting<T> {
    /// `None` where there are none.
    pub(super) fn new(problem: &Problem, sizes: Levels, scheme: &Scheme) -> Option<Self> {
        let occlusion = problem.occlusion;
        if !problem.has_occluders() {
            return None;
        }
        // Reflection is what a mirroring scheme is; in the others it is an extra that the preset asks for.
        let mirrors = scheme.surface == Surface::Mirrored;
        let between = occlusion.mode == OcclusionMode::Fuzzy && !mirrors;
        let geometry = GeometryVolume::new(sizes, if between { problem.blockers() } else { &problem.solids });
        let (law, from_iteration) = match occlusion.mode {
            OcclusionMode::Hard => {
                let injected = problem.sources.iter().flat_map(|source| &source.light);
                let hard_solids = HardSolids::new(sizes, &problem.solids, injected.map(|(cell, _)| *cell));
                let bounce = if mirrors { 1.0 } else { occlusion.bounce };
                (OcclusionLaw::Hard(Hard { hard_solids, geometry, bounce: T::of(bounce) }), 0)
            }
            _ if mirrors => (OcclusionLaw::Mirrored(Mirrored { geometry }), 0),
            _ => {
                let fuzzy = Fuzzy {
                    geometry,
                    amplifier: T::of(occlusion.amplifier),
                    along_travel: occlusion.sign == BlockingSign::AlongTravel,
                    bounce: T::of(occlusion.bounce),
                };
                (OcclusionLaw::Fuzzy(fuzzy), occlusion.from_iteration)
            }
        };
        Some(Acting { law, from_iteration })
    }
}

impl<T: Real> LatticeSolids<T> {
    /// `None` where there are none.
    pub(super) fn new(problem: &Problem, sizes: Levels, scheme: &Scheme) -> Option<Self> {
        let Acting { law: occluders, from_iteration } = Acting::new(problem, sizes, scheme)?;
        let touched = (0..sizes.count()).map(|i| occluders.touched(i, sizes.side(i))).collect();
        let reflects = matches!(&occluders, OcclusionLaw::Fuzzy(fuzzy) if fuzzy.bounce != T::ZERO);
        Some(LatticeSolids { occluders, from_iteration, reflects, touched })
    }

    /// Itself, if they act in an iteration, counted from 1.
    pub(super) fn acting(&self, iteration: usize) -> Option<&Self> {
        (self.reflects || self.blocks(iteration)).then_some(self)
    }

    /// Whether they stop light in an iteration, counted from 1.
    pub(super) fn blocks(&self, iteration: usize) -> bool {
        iteration >= self.from_iteration
    }

    /// Sees to it that cells which hard occluders let no light enter are sampled at level 0.
    pub(super) fn mark_shut(&self, index: &mut IndexVolume) {
        if let OcclusionLaw::Hard(hard) = &self.occluders {
            let marks = index.level_mut(0);
            hard.hard_solids.shut().for_each(|cell| marks.set(cell));
        }
    }

    /// Bytes that they take.
    pub(super) fn bytes(&self) -> usize {
        self.occluders.bytes() + self.touched.iter().map(Touched::bytes).sum::<usize>()
    }
}

/// Bytes that the occluders of a problem will take on levels of these sizes, in numbers of so many bytes. On other
/// levels than the problem's own the cells beside a surface count as so many times fewer or more.
pub(super) fn bytes(problem: &Problem, scheme: &Scheme, sizes: Levels, number: usize) -> u64 {
    if !problem.has_occluders() {
        return 0;
    }
    let acts = Acts::of(problem, scheme);
    let scale = number as u64 / size_of::<f32>() as u64;
    let geometry = 3 * scale * sizes.sides().map(memory::of_grid::<f32>).sum::<u64>();
    let touched: f64 = (0..sizes.count()).map(|level| acts.touched(problem, sizes, level)).sum();
    let passages = if acts == Acts::Hard { sizes.cells() as u64 * 3 * number as u64 } else { 0 };
    let around = if acts == Acts::Fuzzy { scale as usize * Touched::<f32>::AROUND } else { 0 };
    let of_each = Touched::<f32>::CELL + around;
    geometry + passages + (touched * of_each as f64) as u64
}

/// How occluders act, as far as it matters to memory.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Acts {
    Hard,
    Mirrored,
    Fuzzy,
}

impl Acts {
    /// How those of a problem do under a scheme.
    pub(super) fn of(problem: &Problem, scheme: &Scheme) -> Self {
        match (problem.occlusion.mode, scheme.surface) {
            (OcclusionMode::Hard, _) => Acts::Hard,
            (_, Surface::Mirrored) => Acts::Mirrored,
            _ => Acts::Fuzzy,
        }
    }

    /// How many cells of a level they touch, about.
    pub(super) fn touched(self, problem: &Problem, sizes: Levels, level: usize) -> f64 {
        if level > problem.size.ilog2() as usize {
            return 0.0;
        }
        let shrunk = (sizes.finest() as f64 / problem.size as f64).powi(2);
        touched_cells(problem, self, level) as f64 * shrunk
    }
}

/// How many cells of a level are occupied, have an occupied cell at one of their corners, or beside them.
fn touched_cells(problem: &Problem, acts: Acts, level: usize) -> usize {
    let side = problem.size >> level;
    let mut occupied = Marks::new(side);
    let solids = if acts == Acts::Fuzzy { problem.blockers() } else { &problem.solids };
    solids.iter().for_each(|solid| occupied.set(solid.cell.map(|c| c >> level)));
    match acts {
        Acts::Hard => return grown(&occupied).count(),
        Acts::Mirrored => return occupied.count(),
        Acts::Fuzzy => {}
    }
    // Corner g is shared by the cells g to g + (1, 1, 1).
    let mut touched = Marks::new(side);
    for cell in Layout::new(side).cells().filter(|cell| occupied.get(*cell)) {
        for corner in 0..8 {
            let [x, y, z] = [cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2)];
            if x < side && y < side && z < side {
                touched.set([x, y, z]);
            }
        }
    }
    touched.count()
}
