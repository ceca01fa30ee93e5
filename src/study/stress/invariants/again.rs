//! The rules that need the scene to be run again: in one go, turned, or for longer.

use super::{Broken, Case, Invariant};
use crate::field::{Cell, Grid};
use crate::scene::Problem;
use crate::sh::Sh;
use crate::simulation::{Action, Simulation};
use crate::study::random::Random;
use crate::study::stability;

/// The largest side whose light is followed until it has settled.
const LARGEST_SETTLED: usize = 4;
/// Energies below this are so near the kernels' floor that what is set to zero there counts.
const FAINT: f64 = 1e-20;
/// How near the critical factor light still settles soon.
const NEAR: f64 = 0.98;

/// Holds what came of a scene against those of `rules` that need another run.
pub fn check(case: &Case, rules: &[Invariant], narrow: &Simulation<f32>, wide: &Simulation<f64>) -> Result<(), Broken> {
    runs_again(case, narrow)?;
    if rules.contains(&Invariant::Symmetry) && narrow.divergence().is_none() {
        turned(case, wide)?;
    }
    if rules.contains(&Invariant::Converges) {
        converges(case)?;
    }
    Ok(())
}

fn runs_again(case: &Case, stepped: &Simulation<f32>) -> Result<(), Broken> {
    let broken = |how: String| Broken { invariant: Invariant::Again, how };
    let mut whole = Simulation::<f32>::new(case.problem.clone()).map_err(|error| broken(error.to_string()))?;
    whole.run(|_| true);
    if whole.iteration() != stepped.iteration() {
        return Err(broken(format!("{} iterations, then {}", stepped.iteration(), whole.iteration())));
    }
    for (channel, (a, b)) in stepped.lights().iter().zip(whole.lights()).enumerate() {
        if a.source != b.source || a.accumulated != b.accumulated {
            return Err(broken(format!("channel {channel} differs")));
        }
    }
    Ok(())
}

/// One of the 48 symmetries of the cube: coordinate a of the image is coordinate `order[a]`, flipped or not.
#[derive(Clone, Copy, Debug)]
struct Symmetry {
    order: [usize; 3],
    flip: [bool; 3],
}

impl Symmetry {
    fn random(random: &mut Random) -> Self {
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        Symmetry { order: orders[random.below(6)], flip: std::array::from_fn(|_| random.once_in(2)) }
    }

    fn cell(self, n: usize, cell: Cell) -> Cell {
        std::array::from_fn(|a| if self.flip[a] { n - 1 - cell[self.order[a]] } else { cell[self.order[a]] })
    }

    fn light(self, light: Sh<f64>) -> Sh<f64> {
        let v = light.vector().to_array();
        let turned = |a: usize| if self.flip[a] { -v[self.order[a]] } else { v[self.order[a]] };
        Sh([light.0[0], turned(0), turned(1), turned(2)])
    }

    fn problem(self, problem: &Problem) -> Problem {
        let mut turned = problem.clone();
        for (cell, light) in turned.sources.iter_mut().flat_map(|source| &mut source.light) {
            (*cell, *light) = (self.cell(problem.size, *cell), self.light(*light));
        }
        turned
    }
}

/// Turns the scene by a symmetry that follows from its own numbers, so that the same scene is turned the
/// same way.
fn turned(case: &Case, straight: &Simulation<f64>) -> Result<(), Broken> {
    let propagation = &case.problem.propagation;
    let symmetry = Symmetry::random(&mut Random::new(propagation.factor.to_bits() ^ case.problem.size as u64));
    let broken = |how: String| Broken { invariant: Invariant::Symmetry, how };
    let mut turned =
        Simulation::<f64>::new(symmetry.problem(&case.problem)).map_err(|error| broken(error.to_string()))?;
    turned.run(|_| true);
    for (channel, (a, b)) in straight.lights().iter().zip(turned.lights()).enumerate() {
        for (level, (a, b)) in a.accumulated.levels().iter().zip(b.accumulated.levels()).enumerate() {
            let scale = a.iter().map(|(_, light)| light.max_norm()).fold(0.0, f64::max);
            let off = |(cell, light): (Cell, Sh<f64>)| {
                let image = b.get(symmetry.cell(a.side(), cell));
                (image - symmetry.light(light)).max_norm() > 1e-11 * scale.max(FAINT)
            };
            if let Some((cell, light)) = a.iter().find(|found| off(*found)) {
                let image = b.get(symmetry.cell(a.side(), cell));
                return Err(broken(format!(
                    "level {level}, channel {channel}, {symmetry:?}: {cell:?} holds {light:?}, its image {image:?}"
                )));
            }
        }
    }
    Ok(())
}

/// Whether light can be followed until it settles: a small volume below its critical factor.
pub fn settles(case: &Case) -> bool {
    let size = case.problem.size;
    if !case.clamped || !case.free || !(2..=LARGEST_SETTLED).contains(&size) {
        return false;
    }
    let (_, critical) = stability::of_scheme(&case.scheme, &[size]).critical[0];
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

    fn case(cell: &str, iterations: usize) -> Case {
        let lamp = format!("(kind: Single(cell: {cell}), direction: (1, 2, 3))");
        let text = format!("(version: 1, size: 4, injectors: [{lamp}], propagation: (iterations: {iterations}))");
        Case::new(&Preset::parse(&text, std::path::Path::new("p.ron")).unwrap()).unwrap()
    }

    fn run<T: crate::transport::kind::Precision>(case: &Case) -> Simulation<T> {
        let mut simulation = Simulation::new(case.problem.clone()).unwrap();
        simulation.run(|_| true);
        simulation
    }

    #[test]
    fn another_run_or_another_scene_is_found_out() {
        let (here, there, longer) = (case("(0, 1, 2)", 6), case("(0, 1, 3)", 6), case("(0, 1, 2)", 7));
        assert_eq!(runs_again(&here, &run(&here)), Ok(()));
        assert!(runs_again(&here, &run(&longer)).is_err() && runs_again(&here, &run(&there)).is_err());
        assert_eq!(turned(&here, &run(&here)), Ok(()));
        assert!(turned(&here, &run(&there)).is_err());
    }

    #[test]
    fn light_above_the_critical_factor_does_not_converge() {
        let mut growing = case("(0, 1, 2)", 6);
        assert!(settles(&growing) && converges(&growing).is_ok());
        growing.problem.propagation.factor = 5.5; // 5.22 is critical for 4³, MATH.md section 2.
        assert!(!settles(&growing) && converges(&growing).is_err());
    }
}
