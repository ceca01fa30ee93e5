//! What has arrived at the solids of a lattice so far: what they stopped at the border of their cells, and what would
//! leave the cells behind them.
//!
//! Both follow from sums of snapshots. What was stopped is the share of what the neighbours sent, of all snapshots but
//! the newest; where snapshots leave out what was injected, with that. What leaves is sent by the cell's own light. The
//! clamps act on the sums then and not on each snapshot, which is the same for light within its cone.

use std::f64::consts::PI;

use super::Lattice;
use super::face::Direction;
use super::kernel::occluded::OcclusionLaw;
use crate::field::{Cell, Octree};
use crate::scene::Problem;
use crate::scene::propagation::Snapshots;
use crate::sh::{Real, Sh};
use crate::transport::arrivals::Arrivals;
use crate::transport::state::{Light, State};

impl<T: Real> Lattice<T> {
    /// That of each channel, in the cells of a level or in the finest cells as they are sampled; `None` where solids do
    /// not stop light at the border of their cells, or not all cells accumulate.
    pub(super) fn arrivals_at_solids(&self, state: &State<T>, level: Option<usize>) -> Option<Vec<Arrivals>> {
        let solids = self.solids.as_deref().filter(|_| self.accumulating.is_none())?;
        if matches!(solids.occluders, OcclusionLaw::Fuzzy(_)) {
            return None;
        }
        let arrived = (0..state.lights.len()).map(|channel| {
            let propagated = Propagated::new(state, channel, &self.problem);
            let mut arrivals = Arrivals::new(state.sizes().side(level.unwrap_or(0)));
            for &cell in &solids.touched[level.unwrap_or(0)].cells {
                let at = level.unwrap_or_else(|| state.index.index(cell));
                let held = if level.is_some() { cell } else { cell.map(|c| c >> at) };
                if let Some(flux) = self.arrived(&solids.occluders, &propagated, at, held) {
                    arrivals.set(cell, flux);
                }
            }
            arrivals
        });
        Some(arrived.collect())
    }

    /// The flux that arrived at the solids of a cell along each way; `None` where there are none.
    fn arrived(&self, law: &OcclusionLaw<T>, light: &Propagated<T>, level: usize, cell: Cell) -> Option<[f32; 6]> {
        // Exact levels have a stencil for the finest alone.
        let stencil = self.stencils.get(level)?;
        let stops = |axis| match law {
            OcclusionLaw::Hard(hard) => T::of(1.0) - hard.hard_solids.passes(level, cell, axis),
            OcclusionLaw::Mirrored(mirrored) => mirrored.geometry.opacity(level, cell, axis),
            OcclusionLaw::Fuzzy(_) => T::ZERO,
        };
        let stops = [0, 1, 2].map(stops);
        if stops.iter().all(|share| *share == T::ZERO) {
            return None;
        }
        let own = light.held(level, cell);
        Some(std::array::from_fn(|d| {
            let direction = Direction::ALL[d];
            let sender = direction.opposite().neighbour(cell, light.side(level));
            let sent = sender.map_or(Sh::ZERO, |sender| stencil.send(d, light.sent(level, sender)));
            let arrived = sent * stops[direction.axis()] + stencil.send(d, own);
            // A lobe of flux Φ has c00 = Φ/(2√π).
            (2.0 * PI.sqrt() * arrived.0[0].to_f64()) as f32
        }))
    }
}

/// The light of a channel that was sent: Σ S_i to k−1.
struct Propagated<'a, T> {
    light: &'a Light<T>,
    /// What was injected, where it is not in the sum.
    injected: Option<Octree<T>>,
}

impl<'a, T: Real> Propagated<'a, T> {
    fn new(state: &'a State<T>, channel: usize, problem: &Problem) -> Self {
        let is_left_out = problem.propagation.snapshots != Snapshots::Thesis && state.iteration > 0;
        let injected = is_left_out.then(|| {
            let mut injected = Octree::new(state.sizes());
            injected.level_mut(0).copy_from(&problem.injected(state.channels())[channel]);
            injected.downsample();
            injected
        });
        Propagated { light: &state.lights[channel], injected }
    }

    fn side(&self, level: usize) -> usize {
        self.light.source.level(level).side()
    }

    /// What was accumulated in a cell.
    fn held(&self, level: usize, cell: Cell) -> Sh<T> {
        self.light.accumulated.level(level).get(cell)
    }

    /// What a cell has sent of.
    fn sent(&self, level: usize, cell: Cell) -> Sh<T> {
        let injected = self.injected.as_ref().map_or(Sh::ZERO, |injected| injected.level(level).get(cell));
        self.held(level, cell) - self.light.source.level(level).get(cell) + injected
    }
}
