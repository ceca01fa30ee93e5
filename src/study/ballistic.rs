//! What a propagator moved against what truly arrives.
//!
//! R of [`crate::transport::ballistic`] is compared with the merged light that has moved, S_A − S_0, as it is and
//! after the one scalar that fits best, for renderers scale by taste.

mod fit;

use super::error::{self, ErrorRow, Metric};
use crate::field::Grid;
use crate::scene::propagation::Snapshots;
use crate::sh::Real;
use crate::simulation::Simulation;
use crate::transport::ballistic::Ballistic;
pub use fit::{BestFit, l1};

/// The ballistic metric on the merged light that has moved, S_A − S_0, with the injected light taken off in
/// the cells that hold any.
pub fn error<T: Real>(simulation: &Simulation<T>, truth: &Ballistic) -> ErrorRow {
    let moved = moved(simulation);
    let scales = error::channel_scales(simulation);
    let tally = error::tally(&scales, truth.side(), |channel, cell| {
        (moved[channel].get(cell), truth.light()[channel].get(cell).cast())
    });
    tally.row(simulation.iteration(), Metric::Ballistic, None)
}

/// The L1 ratio of the merged light that has moved, as it is and after the scalar that fits best.
pub fn best_fit(simulation: &Simulation<f32>, truth: &Ballistic) -> BestFit {
    l1(&error::channel_scales(simulation), &moved(simulation), truth.light())
}

/// S_A − S_0 of each channel: the merged light without the light that was injected.
pub fn moved<T: Real>(simulation: &Simulation<T>) -> Vec<Grid<T>> {
    let problem = simulation.problem();
    let mut merged = error::sampled(simulation);
    // Whether S_0 is in the sum is the snapshots' choice.
    if problem.propagation.snapshots != Snapshots::Thesis {
        return merged;
    }
    let cells = problem.accumulating(0);
    let counts = |cell| cells.as_ref().is_none_or(|cells| cells.get(cell));
    for (merged, injected) in merged.iter_mut().zip(problem.injected::<T>(simulation.channels())) {
        for (cell, value) in injected.iter().filter(|(cell, value)| !value.is_zero() && counts(*cell)) {
            merged.set(cell, merged.get(cell) - value);
        }
    }
    merged
}
