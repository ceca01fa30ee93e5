//! The light of a state as studies look at it: sampled in the finest cells, without what was injected, as one
//! number a cell.

use crate::field::{Channels, Grid, Layout};
use crate::scene::propagation::Snapshots;
use crate::sh::{Real, Sh};
use crate::simulation::Simulation;

/// What merging would store now, for each channel.
pub fn sampled<T: Real>(state: &Simulation<T>) -> Vec<Grid<T>> {
    let sample = |channel| {
        let mut grid = Grid::new(state.sizes().finest());
        state.sample(channel, &mut grid);
        grid
    };
    (0..state.lights().len()).map(sample).collect()
}

/// S_A − S_0 of each channel: the merged light without the light that was injected.
pub fn moved<T: Real>(state: &Simulation<T>) -> Vec<Grid<T>> {
    let problem = state.problem();
    let mut merged = sampled(state);
    // Whether S_0 is in the sum is the snapshots' choice.
    if problem.propagation.snapshots != Snapshots::Thesis {
        return merged;
    }
    let cells = problem.accumulating(0);
    let counts = |cell| cells.as_ref().is_none_or(|cells| cells.get(cell));
    for (merged, injected) in merged.iter_mut().zip(problem.injected::<T>(state.channels())) {
        for (cell, value) in injected.iter().filter(|(cell, value)| !value.is_zero() && counts(*cell)) {
            merged.set(cell, merged.get(cell) - value);
        }
    }
    merged
}

/// The largest multiple of each channel among the three colours: what a channel's norm counts with.
pub fn channel_scales(channels: &Channels) -> Vec<f64> {
    let scale = |c| channels.rgb().iter().filter(|s| s.channel == c).map(|s| s.scale).fold(0.0, f64::max);
    (0..channels.count()).map(scale).collect()
}

/// Light as one number: c00, the mean over all directions, summed over red, green and blue.
#[derive(Clone, Debug, PartialEq)]
pub struct Brightness {
    /// How often each channel counts in red, green and blue together.
    weights: Vec<f64>,
}

impl Brightness {
    /// Of light in these channels.
    pub fn new(channels: &Channels) -> Self {
        let mut weights = vec![0.0; channels.count()];
        for share in channels.rgb() {
            weights[share.channel] += share.scale;
        }
        Brightness { weights }
    }

    /// The brightness of what each channel holds in one place.
    pub fn of<T: Real>(&self, light: impl Fn(usize) -> Sh<T>) -> f64 {
        self.weights.iter().enumerate().map(|(channel, weight)| weight * light(channel).0[0].to_f64()).sum()
    }

    /// The brightness of every cell of one grid a channel, x fastest.
    pub fn of_grids<'a, T: Real>(&self, grids: impl IntoIterator<Item = &'a Grid<T>>) -> Vec<f64> {
        let mut sums = Vec::new();
        for (weight, grid) in self.weights.iter().zip(grids) {
            sums.resize(grid.side().pow(3), 0.0);
            sums.iter_mut().zip(grid.iter()).for_each(|(sum, (_, light))| *sum += weight * light.0[0].to_f64());
        }
        sums
    }

    /// The brightness of the merged light in every finest cell, merged or not yet, x fastest.
    pub fn merged<T: Real>(&self, state: &Simulation<T>) -> Vec<f64> {
        self.of_grids(&sampled(state))
    }
}

/// The mean place of the light of an n³ volume, in cells (x, y, z), `light` being one number a cell, x fastest; the
/// middle of the volume where there is none.
///
/// ```
/// use lpv_lab::study::light::centroid;
///
/// // A 2³ volume, all its light in the cells (0, 0, 0) and (1, 0, 0).
/// assert_eq!(centroid(2, &[1.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), [0.75, 0.0, 0.0]);
/// ```
pub fn centroid(n: usize, light: &[f64]) -> [f64; 3] {
    let sum: f64 = light.iter().sum();
    if sum == 0.0 {
        return [(n as f64 - 1.0) / 2.0; 3];
    }
    let mut moment = [0.0; 3];
    for (cell, light) in Layout::new(n).cells().zip(light) {
        moment.iter_mut().zip(cell).for_each(|(m, c)| *m += light * c as f64);
    }
    moment.map(|m| m / sum)
}

/// The share of the injected light that is still under way: the brightness of the newest snapshot S_k over that of
/// S_0, on the finest level. 1 where none is lost, 0 where none was injected.
pub fn energy_left<T: Real>(state: &Simulation<T>) -> f64 {
    let brightness = Brightness::new(state.channels());
    let injected = state.problem().injected::<f64>(state.channels());
    let sum = |energy: f64| Sh([energy, 0.0, 0.0, 0.0]);
    let injected: f64 = brightness.of(|channel| sum(injected[channel].energy()));
    let left: f64 = brightness.of(|channel| sum(state.lights()[channel].source.level(0).energy()));
    if left == 0.0 { 0.0 } else { left / injected }
}

/// The light of a cell in red, green and blue, from what its channels hold.
pub fn in_colours<T: Real>(channels: &Channels, light: impl Fn(usize) -> Sh<T>) -> [Sh<f64>; 3] {
    channels.rgb().map(|share| light(share.channel).widen() * share.scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Cell;

    #[test]
    fn the_centroid_is_the_weighted_mean() {
        let at = |cell: Cell| match cell {
            [0, 2, 1] => 1.0,
            [3, 2, 1] => 2.0,
            _ => 0.0,
        };
        let light: Vec<f64> = Layout::new(4).cells().map(at).collect();
        assert_eq!(centroid(4, &light), [2.0, 2.0, 1.0]);
        assert_eq!(centroid(2, &[0.0; 8]), [0.5; 3]);
    }
}
