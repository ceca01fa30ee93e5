//! Ordinates by the iteration: every front moves one cell a step.

use super::shares::Rule;
use super::{Group, LANES, Lanes, Octant, Ordinates};
use crate::field::{Grid, Layout};
use crate::propagate::transparency::Transparency;
use crate::sh::{K0, K1, Sh};

/// Light of one channel under way in all directions. It takes 12 bytes a cell and direction.
#[derive(Clone, Debug)]
pub struct Stepper {
    ordinates: Ordinates,
    /// For every group and cell, x fastest, what has come in by the low faces; cells in the order of the wind.
    under_way: Vec<Vec<[Lanes; 3]>>,
    /// What has not been sent yet.
    injected: Grid<f32>,
    arrived: Grid<f32>,
    accumulated: Grid<f32>,
    iteration: usize,
}

impl Stepper {
    /// A dark volume of n³ cells.
    pub fn new(ordinates: Ordinates, n: usize) -> Self {
        let groups = ordinates.octants.iter().map(|octant| octant.groups.len()).sum();
        let dark = [[0.0; LANES]; 3];
        Stepper {
            ordinates,
            under_way: vec![vec![dark; n.pow(3)]; groups],
            injected: Grid::new(n),
            arrived: Grid::new(n),
            accumulated: Grid::new(n),
            iteration: 0,
        }
    }

    /// Bytes that a stepper of so many directions and cells takes.
    pub fn bytes(directions: usize, n: usize) -> usize {
        n.pow(3) * 4 * (3 * directions + 12)
    }

    /// Adds light, to be sent by the next step, and to the sum.
    pub fn inject(&mut self, light: &Grid<f32>) {
        self.injected.add_grid(light);
        self.accumulated.add_grid(light);
    }

    /// One iteration.
    pub fn step(&mut self, occluders: Option<&Transparency>) {
        self.arrived.clear();
        let mut under_way = self.under_way.iter_mut();
        for octant in &self.ordinates.octants {
            for (group, came) in octant.groups.iter().zip(&mut under_way) {
                match self.ordinates.rule {
                    Rule::Donor => advance::<true>(octant, group, &self.injected, occluders, came, &mut self.arrived),
                    Rule::Faces => advance::<false>(octant, group, &self.injected, occluders, came, &mut self.arrived),
                }
            }
        }
        self.injected.clear();
        self.accumulated.add_grid(&self.arrived);
        self.iteration += 1;
    }

    /// What arrived in the last step, S_k.
    pub fn arrived(&self) -> &Grid<f32> {
        &self.arrived
    }

    /// The injected light and all that has arrived, S_A.
    pub fn accumulated(&self) -> &Grid<f32> {
        &self.accumulated
    }

    /// Steps taken.
    pub fn iteration(&self) -> usize {
        self.iteration
    }
}

/// Moves the light of one group by one cell, and adds what then has come into each cell to `arrived`.
fn advance<const DONOR: bool>(
    octant: &Octant,
    group: &Group,
    injected: &Grid<f32>,
    occluders: Option<&Transparency>,
    under_way: &mut Vec<[Lanes; 3]>,
    arrived: &mut Grid<f32>,
) {
    let n = injected.side();
    let turned = |i: [usize; 3]| -> [usize; 3] {
        std::array::from_fn(|a| if octant.backwards[a] { n - 1 - i[a] } else { i[a] })
    };
    let mut next = vec![[[0.0; LANES]; 3]; under_way.len()];
    for (i, (at, came)) in Layout::new(n).cells().zip(under_way.iter()).enumerate() {
        let cell = turned(at);
        let sent = group.sent(injected.get(cell));
        if sent == [0.0; LANES] && *came == [[0.0; LANES]; 3] {
            continue;
        }
        let passes = occluders.map_or(1.0, |occluders| occluders.at(cell));
        let leaves = group.cross::<DONOR>(*came, sent, passes, &mut [[0.0; LANES]; 4]);
        for (axis, step) in [1, n, n * n].into_iter().enumerate() {
            if at[axis] + 1 < n {
                next[i + step][axis] = leaves[axis];
            }
        }
    }
    for (at, came) in Layout::new(n).cells().zip(&next) {
        let mut sum = [0f32; 4];
        for (l, ((x, y), z)) in came[0].iter().zip(&came[1]).zip(&came[2]).enumerate() {
            let flux = x + y + z;
            sum[0] += K0 as f32 * flux;
            (0..3).for_each(|a| sum[1 + a] += K1 as f32 * flux * group.way[a][l]);
        }
        arrived.add(turned(at), Sh(sum));
    }
    *under_way = next;
}

#[cfg(test)]
mod tests {
    use super::super::directions::Lattice;
    use super::*;
    use crate::propagate::geometry::Blocker;
    use glam::DVec3;

    #[test]
    fn stepping_to_the_end_gives_what_one_sweep_gives() {
        let blockers = [
            Blocker { cell: [4, 3, 3], normal: DVec3::X, opacity: 1.0, albedo: [0.0; 3] },
            Blocker { cell: [2, 5, 3], normal: DVec3::X, opacity: 0.4, albedo: [0.0; 3] },
        ];
        let occluders = Transparency::new(8, &blockers);
        let mut injected = Grid::new(8);
        injected.set([2, 3, 3], Sh::lobe(DVec3::X));
        injected.set([7, 0, 5], Sh([0.3, -0.1, 0.0, 0.2]));
        for (lattice, rule) in [(Lattice::Octahedral, Rule::Faces), (Lattice::Fibonacci, Rule::Donor)] {
            let ordinates = Ordinates::new(lattice, 40, rule);
            let at_once = ordinates.solve(&injected, occluders.as_ref());
            let mut stepper = Stepper::new(ordinates, 8);
            stepper.inject(&injected);
            (0..24).for_each(|_| stepper.step(occluders.as_ref()));
            for (cell, light) in at_once.iter() {
                let stepped = stepper.accumulated().get(cell) - injected.get(cell);
                assert!((light - stepped).max_norm() < 1e-6, "{cell:?}: {light:?}, {stepped:?}");
            }
        }
    }

    #[test]
    fn the_front_moves_one_cell_a_step() {
        let mut injected = Grid::new(8);
        injected.set([3, 3, 3], Sh::lobe(DVec3::Y));
        let mut stepper = Stepper::new(Ordinates::new(Lattice::Octahedral, 32, Rule::Faces), 8);
        stepper.inject(&injected);
        for k in 1..=4 {
            stepper.step(None);
            for (cell, light) in stepper.arrived().iter() {
                let distance: usize = (0..3).map(|a| cell[a].abs_diff(3)).sum();
                assert!(distance == k || light.is_zero(), "k = {k}, {cell:?}");
            }
            assert!(!stepper.arrived().get([3, 3 + k, 3]).is_zero());
        }
    }
}
