//! The rules that every single step is held against.

use glam::DVec3;

use super::{Broken, Case, Invariant};
use crate::field::Grid;
use crate::scene::propagation::Snapshots;
use crate::sh::Sh;
use crate::simulation::Simulation;
use crate::study::laws::Reach;
use crate::study::stability::drift::rounding;
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::stencil::Stencil;

/// Rounding aside, in single precision and a few dozen terms a cell.
const SLACK: f64 = 1e-4;
/// Energies below this are so near the smallest numbers of f32 that relative bounds mean nothing.
const FAINT: f64 = 1e-20;

/// What is remembered from step to step.
pub struct Watch {
    /// Where light can be.
    reach: Reach,
    /// Σ c00 of the source, channel by channel, level by level.
    energy: Vec<Vec<f64>>,
    /// The accumulated light of the last step.
    accumulated: Vec<Vec<Grid<f32>>>,
    /// The most that an iteration multiplies energy by, level by level.
    gain: Vec<f64>,
    /// What rounding may change energy by in an iteration, level by level.
    rounding: Vec<f64>,
    copies_first: bool,
    /// What is fainter than a floor is set to zero.
    has_floor: bool,
    /// A cell gets back what a surface beside it reflects, in the same iteration.
    reflects: bool,
}

impl Watch {
    /// Before the first iteration.
    pub fn new(case: &Case, stencils: &[Stencil<f64>], simulation: &Simulation<f32>) -> Self {
        Watch {
            reach: Reach::new(simulation),
            energy: Vec::new(),
            accumulated: Vec::new(),
            gain: stencils.iter().map(greatest_gain).collect(),
            rounding: stencils.iter().map(rounding).collect(),
            has_floor: case.scheme.is_some(),
            copies_first: case.problem.propagation.snapshots == Snapshots::CopyFirst,
            reflects: !case.free && !case.reflects_nothing(),
        }
    }

    /// Holds the present state against those of `rules` that are about single steps.
    pub fn check(
        &mut self,
        rules: &[Invariant],
        narrow: &Simulation<f32>,
        wide: &Simulation<f64>,
    ) -> Result<(), Broken> {
        let k = narrow.iteration();
        if k > 0 {
            let stays = self.reflects || (self.copies_first && k == 1);
            self.reach.step(stays);
        }
        if rules.contains(&Invariant::Reach) {
            self.reach.check(narrow).map_err(|how| Broken { invariant: Invariant::Reach, how })?;
        }
        for (channel, light) in narrow.lights().iter().enumerate() {
            for (level, source) in light.source.levels().iter().enumerate() {
                let sum = light.accumulated.level(level);
                let broken = |invariant, how: String| {
                    let how = format!("iteration {k}, level {level}, channel {channel}: {how}");
                    Err(Broken { invariant, how })
                };
                for (cell, value) in source.iter() {
                    let total = sum.get(cell);
                    if !value.0.iter().chain(&total.0).all(|c| c.is_finite()) {
                        return broken(Invariant::Finite, format!("{cell:?} holds {value:?}, in all {total:?}"));
                    }
                    // Injected light is as it was asked for; after an iteration the lattice's floor holds.
                    if self.has_floor && k > usize::from(self.copies_first) && value.0.iter().any(|c| c.is_subnormal())
                    {
                        return broken(Invariant::Finite, format!("{cell:?} holds the denormal {value:?}"));
                    }
                    if rules.contains(&Invariant::NonNegative) && value.0[0].min(total.0[0]) < 0.0 {
                        return broken(Invariant::NonNegative, format!("{cell:?} holds {value:?}, in all {total:?}"));
                    }
                    let before = self.accumulated.get(channel).map(|grids| grids[level].get(cell));
                    if rules.contains(&Invariant::Accumulates) && before.is_some_and(|b| total.0[0] < b.0[0]) {
                        return broken(Invariant::Accumulates, format!("{cell:?} held {before:?}, now {total:?}"));
                    }
                }
                let energy = source.energy();
                // What follows is about the operators of a lattice.
                let Some((most, rounding)) = self.gain.get(level).zip(self.rounding.get(level)) else { continue };
                let before = self.energy.get(channel).map(|energies| energies[level]);
                let gain = most + if self.copies_first && k == 1 { 1.0 } else { 0.0 };
                let tiny = f64::from(f32::MIN_POSITIVE) * gain.max(1.0) * energy_cells(source);
                let too_much = |before: f64| energy > gain * before * (1.0 + SLACK) + tiny;
                if rules.contains(&Invariant::Energy) && before.is_some_and(too_much) {
                    return broken(Invariant::Energy, format!("{before:?} became {energy}, gain at most {gain}"));
                }
                let expected = wide.lights()[channel].source.level(level).energy();
                // Consistent levels begin a step further for every level they are handed down.
                let bound = (k + level + 2) as f64 * rounding * expected;
                if rules.contains(&Invariant::Precision) && expected > FAINT && (energy - expected).abs() > bound {
                    return broken(Invariant::Precision, format!("{energy} is not {expected} within {bound}"));
                }
            }
        }
        self.energy = narrow.lights().iter().map(|l| l.source.levels().iter().map(Grid::energy).collect()).collect();
        self.accumulated = narrow.lights().iter().map(|l| l.accumulated.levels().to_vec()).collect();
        Ok(())
    }
}

fn energy_cells(grid: &Grid<f32>) -> f64 {
    grid.side().pow(3) as f64
}

/// The most that an iteration multiplies energy by where all faces are clamped. A clamped iteration is
/// sublinear and light a sum of lobes with weights of zero or more, so no light gains more than the lobe
/// that gains most. Lobes are tried in a thousand directions; between them the gain varies by less than is
/// added.
fn greatest_gain(stencil: &Stencil<f64>) -> f64 {
    let gain = |n: DVec3| (0..6).map(|d| stencil.send(d, Sh::lobe(n)).0[0]).sum::<f64>() / Sh::<f64>::lobe(n).0[0];
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let count = 1000;
    let directions = (0..count).map(|i| {
        let (z, angle) = (1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count), golden * f64::from(i));
        let r = (1.0 - z * z).sqrt();
        DVec3::new(angle.cos() * r, angle.sin() * r, z)
    });
    directions.chain(Direction::ALL.map(Direction::vector)).map(gain).fold(0.0, f64::max) * 1.01
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Preset;
    use crate::simulation::Action;

    /// A lamp of this strength in 4³, and what is known of it.
    fn case(strength: f64) -> (Case, Vec<Stencil<f64>>) {
        let lamp = format!("(kind: Single(cell: (1, 2, 0)), multiplier: {strength})");
        let text = format!("(version: 1, size: 4, injectors: [{lamp}], propagation: (factor: 4))");
        let case = Case::new(&Preset::parse(&text, std::path::Path::new("p.ron")).unwrap()).unwrap();
        let stencils = case.stencils().unwrap();
        (case, stencils)
    }

    fn simulation<T: crate::transport::kind::Precision>(case: &Case, actions: &[Action]) -> Simulation<T> {
        let mut simulation = Simulation::new(case.problem.clone()).unwrap();
        for action in actions {
            simulation.act(*action);
        }
        simulation
    }

    #[test]
    fn light_that_breaks_a_rule_is_found_out() {
        let (bright, stencils) = case(1.0);
        let start = [Action::Inject, Action::Downsample];
        let on = [Action::Inject, Action::Downsample, Action::Propagate];
        let broken = |watch: &mut Watch, narrow: &Simulation<f32>, wide: &Simulation<f64>| {
            watch.check(&Invariant::ALL, narrow, wide).err().map(|broken| broken.invariant)
        };
        let (narrow, wide) = (simulation(&bright, &on), simulation(&bright, &on));
        let watch = || {
            let mut watch = Watch::new(&bright, &stencils, &simulation(&bright, &start));
            let first = broken(&mut watch, &simulation(&bright, &start), &simulation(&bright, &start));
            assert_eq!(first, None);
            watch
        };
        assert_eq!(broken(&mut watch(), &narrow, &wide), None);
        // Light of twice the strength in double precision; an operator of a smaller factor; nothing injected.
        let brighter = simulation(&case(2.0).0, &on);
        assert_eq!(broken(&mut watch(), &narrow, &brighter), Some(Invariant::Precision));
        let mut strict = watch();
        strict.gain.fill(0.5);
        assert_eq!(broken(&mut strict, &narrow, &wide), Some(Invariant::Energy));
        let mut dark = Watch::new(&bright, &stencils, &simulation(&bright, &[]));
        assert_eq!(broken(&mut dark, &narrow, &wide), Some(Invariant::Reach));
        // Accumulated light that was brighter before.
        let mut fading = watch();
        fading.accumulated =
            simulation::<f32>(&case(9.0).0, &on).lights().iter().map(|l| l.accumulated.levels().to_vec()).collect();
        assert_eq!(broken(&mut fading, &narrow, &wide), Some(Invariant::Accumulates));
    }

    #[test]
    fn a_lone_lobe_gains_most_as_published() {
        // MATH.md section 2: from a raw lobe along an axis the clamp makes the iteration gain 13.82 % at p = 4.
        let stencil = Stencil::new(&crate::transport::lattice::schemes::cascaded::scheme(), 4.0, true);
        let found = greatest_gain(&stencil);
        assert!(found > 1.1382 && found < 1.25, "{found}");
    }
}
