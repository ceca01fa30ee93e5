//! The rules that need the scene to be run again: in one go, turned, or for longer.

use super::{Broken, Case, Invariant};
use crate::field::Grid;
use crate::simulation::{Action, Simulation};
use crate::study::laws::{self, Symmetry};
use crate::study::stability;
use crate::system::random::Random;

/// The largest side whose light is followed until it has settled.
const LARGEST_SETTLED: usize = 4;
/// Energies below this are so near the kernels' floor that what is set to zero there counts.
const FAINT: f64 = 1e-20;
/// What double precision leaves of a law, as a part of the brightest light of a level.
const SLACK: f64 = 1e-11;
/// The same for what single precision solves for and iterates to.
const SOLVED: f64 = 1e-4;
/// Iterations after which light that still moves is left alone.
const PATIENCE: usize = 100;
/// How near the critical factor light still settles soon.
const NEAR: f64 = 0.98;

/// Holds what came of a scene against those of `rules` that need another run.
pub fn check(case: &Case, rules: &[Invariant], narrow: &Simulation<f32>, wide: &Simulation<f64>) -> Result<(), Broken> {
    let hold = |invariant, verdict: Result<(), String>| verdict.map_err(|how| Broken { invariant, how });
    hold(Invariant::Again, laws::again(narrow))?;
    if narrow.divergence().is_none() {
        if rules.contains(&Invariant::Symmetry) {
            hold(Invariant::Symmetry, turned(case, wide))?;
        }
        if rules.contains(&Invariant::Superposition) {
            hold(Invariant::Superposition, laws::superposition(wide, SLACK))?;
        }
        if rules.contains(&Invariant::FixedPoint) {
            hold(Invariant::FixedPoint, laws::fixed_point(&case.problem, SOLVED, PATIENCE))?;
        }
    }
    if rules.contains(&Invariant::Converges) {
        converges(case)?;
    }
    Ok(())
}

/// By a symmetry that follows from the scene's own numbers, so that the same scene is turned the same way.
fn turned(case: &Case, straight: &Simulation<f64>) -> Result<(), String> {
    let propagation = &case.problem.propagation;
    let mut random = Random::new(propagation.factor.to_bits() ^ case.problem.size as u64);
    Symmetry::all().nth(random.below(48)).map_or(Ok(()), |by| laws::symmetry(straight, by, SLACK))
}

/// Whether light can be followed until it settles: a small volume below its critical factor.
pub fn settles(case: &Case) -> bool {
    let size = case.problem.size;
    if !case.clamped || !case.free || !(2..=LARGEST_SETTLED).contains(&size) {
        return false;
    }
    let Some(scheme) = &case.scheme else { return false };
    let (_, critical) = stability::of_scheme(scheme, &[size]).critical[0];
    case.problem.propagation.factor < NEAR * critical
}

/// Light of all but the slowest mode dies out in some n² iterations; from then on two iterations always
/// leave less than there was.
fn converges(case: &Case) -> Result<(), Broken> {
    let broken = |how: String| Broken { invariant: Invariant::Converges, how };
    let mut simulation = Simulation::<f64>::new(case.problem.clone()).map_err(|error| broken(error.to_string()))?;
    simulation.act(Action::Inject);
    let energy = |s: &Simulation<f64>| s.lights().iter().map(|l| Grid::energy(l.source.level(0))).sum::<f64>();
    for _ in 0..20 * case.problem.size.pow(2) {
        simulation.act(Action::Propagate);
    }
    for _ in 0..10 {
        let before = energy(&simulation);
        simulation.act(Action::Propagate);
        simulation.act(Action::Propagate);
        let after = energy(&simulation);
        if before > FAINT && !(0.0..=before).contains(&after) {
            return Err(broken(format!("iteration {}: {before} became {after}", simulation.iteration())));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Preset;

    #[test]
    fn light_above_the_critical_factor_does_not_converge() {
        let lamp = "(kind: Single(cell: (0, 1, 2)), direction: (1, 2, 3))";
        let text = format!("(version: 1, size: 4, injectors: [{lamp}], propagation: (iterations: 6))");
        let mut growing = Case::new(&Preset::parse(&text, std::path::Path::new("p.ron")).unwrap()).unwrap();
        assert!(settles(&growing) && converges(&growing).is_ok());
        growing.problem.propagation.factor = 5.5; // 5.22 is critical for 4³, MATH.md section 2.
        assert!(!settles(&growing) && converges(&growing).is_err());
    }
}
