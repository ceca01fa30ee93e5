//! Light along a line of cells: the merged light of each policy for levels beside the uniform volume.
//!
//! Where the sample goes over from one level to the next the merged light jumps (000, figure 14). Along a line of
//! cells the jumps are seen as steps, and beside the uniform volume, which has none, it is seen whether
//! levels that agree ([`crate::transport::lattice::levels`]) make them smaller.

use crate::field::{Cell, Grid};
use crate::scene::propagation::Policy;
use crate::scene::{Problem, Propagation};
use crate::sh::Sh;
use crate::simulation::{Action, Refusal, Simulation};

/// A straight line of finest cells along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// The axis that it runs along: 0, 1 or 2.
    pub along: usize,
    /// A cell that it runs through.
    pub through: Cell,
}

impl Line {
    /// Its `i`-th cell.
    pub fn cell(&self, i: usize) -> Cell {
        let mut cell = self.through;
        cell[self.along] = i;
        cell
    }
}

/// A scene under every policy for its levels, after the same iterations.
#[derive(Clone, Debug)]
pub struct Policies {
    /// Their finest levels are alike: each is the uniform volume.
    runs: Vec<(Policy, Simulation<f32>)>,
}

impl Policies {
    /// The scene with its light injected, and nothing propagated yet. A policy that the factor is too large for is
    /// left out.
    pub fn new(problem: &Problem) -> Result<Self, Refusal> {
        let mut runs = Vec::new();
        for levels in Policy::ALL {
            let propagation = Propagation { levels, ..problem.propagation.clone() };
            let mut run = match Simulation::new(Problem { propagation, ..problem.clone() }) {
                // What is wrong with the thesis's own policy is wrong with the problem.
                Err(_) if levels != Policy::Same => continue,
                run => run?,
            };
            for action in [Action::Clear, Action::Inject, Action::Downsample] {
                run.act(action);
            }
            runs.push((levels, run));
        }
        Ok(Policies { runs })
    }

    fn first(&self) -> Option<&Simulation<f32>> {
        self.runs.first().map(|(_, run)| run)
    }

    /// Iterations done.
    pub fn iteration(&self) -> usize {
        self.first().map_or(0, Simulation::iteration)
    }

    /// Goes on until so many iterations are done, or until the light of one of the runs diverges. `watch` hears of
    /// each and returns whether to go on.
    pub fn advance(&mut self, iterations: usize, mut watch: impl FnMut(usize) -> bool) {
        while self.iteration() < iterations && watch(self.iteration()) {
            for (_, run) in &mut self.runs {
                run.act(Action::Propagate);
            }
            if self.runs.iter().any(|(_, run)| run.divergence().is_some()) {
                break;
            }
        }
    }

    /// The merged light along a line under a policy, red, green and blue; empty where that is left out.
    pub fn merged(&self, policy: Policy, line: Line) -> Vec<[Sh<f32>; 3]> {
        let run = self.runs.iter().find(|(known, _)| *known == policy);
        run.map_or_else(Vec::new, |(_, run)| {
            along(run, line, |channel, cell| {
                let level = run.index().index(cell);
                run.lights()[channel].accumulated.level(level).get(cell.map(|c| c >> level))
            })
        })
    }

    /// The light of the uniform volume along a line, red, green and blue.
    pub fn uniform(&self, line: Line) -> Vec<[Sh<f32>; 3]> {
        self.first().map_or_else(Vec::new, |run| {
            let finest: Vec<&Grid<f32>> = run.lights().iter().map(|light| light.accumulated.level(0)).collect();
            along(run, line, |channel, cell| finest[channel].get(cell))
        })
    }

    /// The level that each cell of a line is sampled from.
    pub fn levels(&self, line: Line) -> Vec<usize> {
        self.first()
            .map_or_else(Vec::new, |run| (0..run.sizes().finest()).map(|i| run.index().index(line.cell(i))).collect())
    }
}

fn along(run: &Simulation<f32>, line: Line, light: impl Fn(usize, Cell) -> Sh<f32>) -> Vec<[Sh<f32>; 3]> {
    let mixed = |cell| run.channels().rgb().map(|share| light(share.channel, cell) * share.scale as f32);
    (0..run.sizes().finest()).map(|i| mixed(line.cell(i))).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::Preset;

    fn policies(iterations: usize) -> Policies {
        let text = "(version: 1, size: 16, injectors: [(kind: Wall(side: NegX), color: (1, 0.5, 0))])";
        let preset = Preset::parse(text, Path::new("test")).unwrap();
        let mut policies = Policies::new(&Problem::build(&preset, Path::new("")).unwrap()).unwrap();
        policies.advance(iterations, |_| true);
        policies
    }

    const LINE: Line = Line { along: 0, through: [0, 5, 9] };

    #[test]
    fn where_the_finest_level_is_lit_the_merged_light_is_the_uniform_volume() {
        let policies = policies(4);
        assert_eq!(policies.iteration(), 4);
        let (levels, uniform) = (policies.levels(LINE), policies.uniform(LINE));
        assert_eq!(levels[..5], [0; 5]);
        assert!(levels[5..].iter().all(|level| *level > 0));
        for policy in Policy::ALL {
            let merged = policies.merged(policy, LINE);
            assert_eq!(merged[..5], uniform[..5]);
            assert!(merged[5..].iter().all(|light| light[0].0[0] > 0.0));
            assert!(merged.iter().all(|[red, green, blue]| *green == *red * 0.5 && blue.is_zero()));
        }
        assert!(uniform[5..].iter().all(|light| light[0].is_zero()));
    }

    #[test]
    fn consistent_levels_jump_less() {
        let policies = policies(4);
        let jump = |policy: Policy| {
            let merged = policies.merged(policy, LINE);
            let uniform = policies.uniform(LINE);
            // The light of the uniform volume falls by an even ratio; the merged light ought to go on so.
            let ought = uniform[4][0].0[0] * uniform[4][0].0[0] / uniform[3][0].0[0];
            (merged[5][0].0[0] / ought).ln().abs()
        };
        assert!(jump(Policy::Consistent) < jump(Policy::Same));
    }

    #[test]
    fn a_policy_that_the_factor_is_too_large_for_is_left_out() {
        let text = "(version: 1, size: 16, injectors: [(kind: Wall(side: NegX))], propagation: (factor: 9.0))";
        let preset = Preset::parse(text, Path::new("test")).unwrap();
        let policies = Policies::new(&Problem::build(&preset, Path::new("")).unwrap()).unwrap();
        assert_eq!(policies.merged(Policy::Same, LINE).len(), 16);
        assert!(policies.merged(Policy::Consistent, LINE).is_empty());
    }

    #[test]
    fn who_does_not_want_to_go_on_is_left_where_he_is() {
        let mut policies = policies(2);
        policies.advance(9, |k| k < 5);
        assert_eq!(policies.iteration(), 5);
    }
}
