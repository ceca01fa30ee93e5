//! Where light is in a scene: its centroid, how far it has come, how much lies behind closed occluders.

use super::ratio;
use crate::field::{Cell, Layout, Levels};
use crate::scene::Problem;
use crate::transport::lattice::barrier::Barrier;
use crate::transport::lattice::face::Direction;

/// What a scene says about its finest cells, x fastest.
pub(super) struct Places {
    n: usize,
    /// Steps to the nearest cell that light is injected into.
    steps: Vec<usize>,
    /// Which free cells light can get to through free cells (before), and which it cannot (behind).
    before: Vec<bool>,
    behind: Vec<bool>,
}

impl Places {
    pub(super) fn of(problem: &Problem) -> Self {
        let n = problem.size;
        let index = |[x, y, z]: Cell| (z * n + y) * n + x;
        let lit = || problem.sources.iter().flat_map(|source| &source.light).map(|(cell, _)| *cell);
        let mut behind = vec![false; n.pow(3)];
        // One level is enough to tell what light can reach; a size that makes none has no cells either.
        if let Some(finest) = Levels::new(n, n) {
            Barrier::<f32>::new(finest, &problem.solids, lit()).shut().for_each(|cell| behind[index(cell)] = true);
        }
        let mut before: Vec<bool> = behind.iter().map(|shut| !shut).collect();
        for blocker in &problem.solids {
            (before[index(blocker.cell)], behind[index(blocker.cell)]) = (false, false);
        }
        Places { n, steps: steps(n, lit().collect()), before, behind }
    }

    /// The mean place of `light`, in cells; the middle of the volume where there is none.
    pub(super) fn centroid(&self, light: &[f64]) -> [f64; 3] {
        let sum: f64 = light.iter().sum();
        if sum == 0.0 {
            return [(self.n as f64 - 1.0) / 2.0; 3];
        }
        let mut moment = [0.0; 3];
        for (cell, light) in Layout::new(self.n).cells().zip(light) {
            moment.iter_mut().zip(cell).for_each(|(m, c)| *m += light * c as f64);
        }
        moment.map(|m| m / sum)
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

    /// The mean of `light` behind closed occluders over that before them; `None` if nothing lies behind.
    pub(super) fn leak(&self, light: &[f64]) -> Option<f64> {
        let mean = |cells: &[bool]| {
            let sum: f64 = light.iter().zip(cells).filter(|(_, here)| **here).map(|(light, _)| light).sum();
            let count = cells.iter().filter(|here| **here).count();
            (count > 0).then(|| sum / count as f64)
        };
        let (behind, before) = (mean(&self.behind)?, mean(&self.before)?);
        Some(ratio(behind, before))
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
    use crate::scene::Solid;
    use crate::scene::{Occlusion, Propagation, Source};
    use crate::sh::Sh;
    use glam::DVec3;

    /// A light at (0, 0, 0) of a 4³ volume, and an opaque wall at x = 1 with a hole or without.
    fn places(closed: bool) -> Places {
        let wall = Layout::new(4).cells().filter(|c| c[0] == 1 && (closed || *c != [1, 3, 3]));
        let block = |cell| Solid::new(cell, DVec3::NEG_X, 1.0, [0.0; 3]);
        Places::of(&Problem {
            size: 4,
            coarsest: 1,
            sources: vec![Source { color: [1.0; 3], light: vec![([0; 3], Sh::lobe(DVec3::X))], ..Source::default() }],
            solids: wall.map(block).collect(),
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
    fn the_centroid_is_the_weighted_mean() {
        let two = light(&[([0, 2, 1], 1.0), ([3, 2, 1], 2.0)]);
        assert_eq!(places(false).centroid(&two), [2.0, 2.0, 1.0]);
    }

    #[test]
    fn the_reach_counts_steps_that_hold_the_share() {
        let far = light(&[([1, 0, 0], 0.5), ([1, 2, 0], 0.4), ([3, 3, 3], 0.1)]);
        assert_eq!(places(false).reach(&far, 0.45), 1);
        assert_eq!(places(false).reach(&far, 0.85), 3);
        assert_eq!(places(false).reach(&far, 0.95), 9);
    }

    #[test]
    fn light_leaks_only_behind_what_is_closed() {
        // 16 cells before the wall, 32 behind; light in the wall is neither.
        let some = light(&[([0, 1, 1], 8.0), ([1, 1, 1], 5.0), ([3, 2, 2], 4.0)]);
        assert_eq!(places(true).leak(&some), Some((4.0 / 32.0) / (8.0 / 16.0)));
        assert_eq!(places(false).leak(&some), None);
    }
}
