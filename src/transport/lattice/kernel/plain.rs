//! The definition: one iteration, line by line as MATH.md section 2 has it, in either precision.
//!
//! Fast kernels are tested against this one, and the benchmark measures them against it.

use super::super::face::Direction;
use super::super::stencil::Stencil;
use super::settle;
use crate::field::Grid;
use crate::sh::{Real, Sh};

/// Sets `target` to what all cells of `source` send to their neighbours. Outside the grid is dark, and so
/// is what is too faint to count ([`super::FLOOR`]).
pub fn propagate<T: Real>(stencil: &Stencil<T>, source: &Grid<T>, target: &mut Grid<T>) {
    let layout = source.layout();
    let steps = layout.steps();
    for cell in layout.cells() {
        let here = layout.index(cell);
        let mut received = Sh::ZERO;
        for (d, direction) in Direction::ALL.iter().enumerate() {
            let step = steps[direction.axis()];
            let sender = if direction.is_positive() { here - step } else { here + step };
            received += stencil.send(d, source.at(sender));
        }
        target.set(cell, settle(received));
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::schemes::cascaded;
    use super::*;
    use glam::DVec3;

    fn grid_with(n: usize, lights: &[([usize; 3], Sh<f64>)]) -> Grid<f64> {
        let mut grid = Grid::new(n);
        for (cell, light) in lights {
            grid.add(*cell, *light);
        }
        grid
    }

    fn step(stencil: &Stencil<f64>, source: &Grid<f64>) -> Grid<f64> {
        let mut target = Grid::new(source.side());
        propagate(stencil, source, &mut target);
        target
    }

    #[test]
    fn at_four_without_clamp_no_energy_is_lost_inside() {
        let stencil = Stencil::new(&cascaded::scheme(), 4.0, false);
        let mut grid = grid_with(16, &[([8, 7, 8], Sh::lobe(DVec3::X)), ([7, 8, 8], Sh([0.4, 0.1, -0.3, 0.2]))]);
        let before = grid.energy();
        for k in 1..=6 {
            grid = step(&stencil, &grid);
            assert!((grid.energy() - before).abs() < 1e-6 * before, "k = {k}: {}", grid.energy());
        }
    }

    #[test]
    fn a_raw_lobe_gains_13_82_percent_by_the_clamp_once() {
        let stencil = Stencil::new(&cascaded::scheme(), 4.0, true);
        let lobe = grid_with(16, &[([8, 8, 8], Sh::lobe(DVec3::X))]);
        let first = step(&stencil, &lobe);
        assert!((first.energy() / lobe.energy() - 1.1382).abs() < 5e-5);
        let second = step(&stencil, &first);
        assert!((second.energy() / first.energy() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn light_keeps_to_its_reach_and_parity() {
        let stencil = Stencil::new(&cascaded::scheme(), 3.0, true);
        let from = [3usize, 4, 2];
        let mut grid = grid_with(8, &[(from, Sh::lobe(DVec3::new(0.6, 0.0, -0.8)))]);
        for k in 1..=6 {
            grid = step(&stencil, &grid);
            for (cell, light) in grid.iter() {
                let distance: usize = (0..3).map(|a| cell[a].abs_diff(from[a])).sum();
                if distance > k || (distance + k) % 2 == 1 {
                    assert!(light.is_zero(), "k = {k}, {cell:?}");
                }
            }
        }
    }
}
