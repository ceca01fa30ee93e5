//! How far light has come from where it was injected.

use crate::field::Cell;
use crate::scene::Problem;
use crate::transport::lattice::face::Direction;

/// What a scene says about its finest cells, x fastest.
pub(super) struct Places {
    n: usize,
    /// Steps to the nearest cell that light is injected into.
    steps: Vec<usize>,
}

impl Places {
    pub(super) fn of(problem: &Problem) -> Self {
        let lit = problem.sources.iter().flat_map(|source| &source.light).map(|(cell, _)| *cell);
        Places { n: problem.size, steps: steps(problem.size, lit.collect()) }
    }

    /// The fewest steps from the injected cells within which `share` of `light` lies.
    pub(super) fn reach(&self, light: &[f64], share: f64) -> usize {
        let mut shells = vec![0.0; 3 * self.n];
        self.steps.iter().zip(light).for_each(|(steps, light)| shells[*steps] += light);
        let wanted = share * shells.iter().sum::<f64>();
        let mut sum = 0.0;
        let enough = shells.iter().position(|shell| {
            sum += shell;
            sum >= wanted
        });
        enough.unwrap_or(0)
    }
}

/// Steps from face to face to the nearest of `from`, for every cell of an n³ grid; 0 where there is none.
fn steps(n: usize, from: Vec<Cell>) -> Vec<usize> {
    let index = |[x, y, z]: Cell| (z * n + y) * n + x;
    let mut steps: Vec<Option<usize>> = vec![None; n.pow(3)];
    let mut front = from;
    let mut distance = 0;
    while !front.is_empty() {
        front.retain(|cell| steps[index(*cell)].replace(distance).is_none());
        let next = front.iter().flat_map(|cell| Direction::ALL.iter().filter_map(|d| d.neighbour(*cell, n)));
        front = next.filter(|cell| steps[index(*cell)].is_none()).collect();
        distance += 1;
    }
    steps.into_iter().map(|steps| steps.unwrap_or(0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Layout;
    use crate::scene::{Occlusion, Propagation, Source};
    use crate::sh::Sh;
    use glam::DVec3;

    /// A light at (0, 0, 0) of a 4³ volume.
    fn places() -> Places {
        Places::of(&Problem {
            size: 4,
            coarsest: 1,
            sources: vec![Source { color: [1.0; 3], light: vec![([0; 3], Sh::lobe(DVec3::X))], ..Source::default() }],
            solids: Vec::new(),
            occlusion: Occlusion::default(),
            propagation: Propagation::default(),
            ..Problem::default()
        })
    }

    fn light(cells: &[(Cell, f64)]) -> Vec<f64> {
        let at = |cell: Cell| cells.iter().find(|(c, _)| *c == cell).map_or(0.0, |(_, light)| *light);
        Layout::new(4).cells().map(at).collect()
    }

    #[test]
    fn the_reach_counts_steps_that_hold_the_share() {
        let far = light(&[([1, 0, 0], 0.5), ([1, 2, 0], 0.4), ([3, 3, 3], 0.1)]);
        assert_eq!(places().reach(&far, 0.45), 1);
        assert_eq!(places().reach(&far, 0.85), 3);
        assert_eq!(places().reach(&far, 0.95), 9);
    }
}
