//! Iterating and solving side by side: how long each takes to the same residual.
//!
//! Both start from the injected light of the finest level alone. Iterating uses the fastest loops there are:
//! all cores, several iterations a pass, with what light cannot have reached left out. What it has not
//! accumulated after k iterations is S_(k+1) and all that comes of it, so ‖S_(k+1)‖₂ is its residual. Both take
//! turns, round by round, and the medians are reported. The memory of both is made before.

use std::time::Instant;

use crate::field::Grid;
use crate::scene::Problem;
use crate::simulation::options::Wanted;
use crate::simulation::{Action, Simulation};
use crate::study::pareto::synthetic;
use crate::study::reference;
use crate::transport::lattice::fixed_point::Solver;
use crate::transport::solve::{Found, NoFixedPoint, Solve};

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Sides of the volumes, powers of two.
    pub sizes: Vec<usize>,
    /// Propagation factors of `cascaded`.
    pub factors: Vec<f64>,
    /// The relative residual to reach.
    pub tolerance: f64,
    /// Rounds; medians are reported.
    pub rounds: usize,
}

/// One scene, as `converged.csv` has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// one-wall, two-walls or one-lobe.
    pub scene: &'static str,
    /// The side of the volume.
    pub size: usize,
    /// The propagation factor.
    pub factor: f64,
    /// Iterations to the residual.
    pub iterations: usize,
    /// Seconds that they take.
    pub iterating: f64,
    /// Seconds that solving takes.
    pub solving: f64,
    /// What solving did.
    pub found: Found,
}

/// Runs the race; `watch` hears what is measured.
pub fn run(plan: &Plan, mut watch: impl FnMut(&str)) -> Result<Vec<Row>, NoFixedPoint> {
    let mut rows = Vec::new();
    for &size in &plan.sizes {
        for &factor in &plan.factors {
            for (name, problem) in synthetic::scenes(size, factor) {
                watch(&format!("{name}, n = {size}, p = {factor}"));
                rows.extend(row(name, &problem, plan)?);
            }
        }
    }
    Ok(rows)
}

/// `None` where there is no light.
fn row(name: &'static str, problem: &Problem, plan: &Plan) -> Result<Option<Row>, NoFixedPoint> {
    let mut solver = Solver::new(&problem.propagation, problem.size)?;
    let mut simulation = reference::injected::<f32>(problem)?;
    let Some(light) = simulation.lights().first() else { return Ok(None) };
    let injected = light.source.level(0).clone();
    let mut light = Grid::new(problem.size);
    // Refuses what does not converge, before anything is iterated.
    let Some(found) = solver.solve(&injected, plan.tolerance, &mut light, &mut |_| true)? else { return Ok(None) };
    let iterations = iterations(&mut simulation, plan.tolerance);
    let (mut iterating, mut solving) = (Vec::new(), Vec::new());
    for _ in 0..plan.rounds {
        simulation.act(Action::Clear);
        simulation.act(Action::Inject);
        let started = Instant::now();
        simulation.advance(iterations, Wanted::Everything);
        iterating.push(started.elapsed().as_secs_f64());
        let started = Instant::now();
        solver.solve(&injected, plan.tolerance, &mut light, &mut |_| true)?;
        solving.push(started.elapsed().as_secs_f64());
    }
    let Problem { size, propagation, .. } = problem;
    let [iterating, solving] = [iterating, solving].map(median);
    Ok(Some(Row { scene: name, size: *size, factor: propagation.factor, iterations, iterating, solving, found }))
}

/// How many iterations bring the residual down to the tolerance, relative to the first snapshot that is not
/// clamped any more: from lobes along the axes under `cascaded`, S_1.
fn iterations(simulation: &mut Simulation<f32>, tolerance: f64) -> usize {
    let norm = |simulation: &Simulation<f32>| {
        let planes = simulation.lights().iter().flat_map(|light| light.source.level(0).planes());
        planes.flatten().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt()
    };
    simulation.act(Action::Propagate);
    let whole = norm(simulation);
    let mut iterations = 0;
    while norm(simulation) > tolerance * whole {
        simulation.act(Action::Propagate);
        iterations += 1;
    }
    iterations
}

/// The middle one, the later of two; 0 of nothing.
fn median(mut seconds: Vec<f64>) -> f64 {
    seconds.sort_by(f64::total_cmp);
    seconds.get(seconds.len() / 2).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_reach_the_residual_and_solving_takes_fewer_sweeps_than_iterations() {
        let plan = Plan { sizes: vec![8], factors: vec![3.0, 3.8], tolerance: 1e-4, rounds: 1 };
        let rows = run(&plan, |_| ()).unwrap();
        assert_eq!(rows.len(), 6);
        for row in rows {
            assert!(row.found.residual <= 1e-4 && row.iterating > 0.0 && row.solving > 0.0, "{row:?}");
            assert!(2 * row.found.sweeps < row.iterations, "{row:?}");
        }
    }
}
