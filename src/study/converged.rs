//! The fixed point of the uniform volume, A = S + P·A: all the light that iterating for ever would give,
//! far sooner.
//!
//! **The equation.** The accumulated light is S_0 + S_1 + … with S_{k+1} = P(S_k). P is linear except for
//! its clamps, and those act on the first steps only: light in the cone of [`crate::propagate::kernel::form`]
//! is not clamped and stays in the cone. So steps are taken as they are until every cell lies in it (from
//! lobes, one step of `cascaded`), and what remains, A = head + B with B = S_J + P·B, is linear: no
//! active set is guessed, it is known. Schemes whose cone is not closed are refused, and so are occluders.
//!
//! **The solver** is multigrid with the octree as its hierarchy. Every neighbour of a cell is of the other
//! colour of a chessboard, so a sweep that relaxes one colour, then the other, halves rough error; what
//! is left is smooth, and the next coarser level takes it over. The operators of [`Policy::Consistent`] are
//! just those it needs: they are the Galerkin products of P with the mean over children and its transpose,
//! so that the correction is the best that is constant on each coarse cell, and never overshoots. Of
//! what was measured (n = 64, p = 3.8, one wall; in sweeps of the finest level, to a residual of 1e-4) plain
//! iteration takes 112, Chebyshev steps about 30, over-relaxation diverges (the spectrum is not real),
//! and this 5 cycles of about 3.
//!
//! **The guarantee** is the true residual, summed over all cells: ‖S_J + P·B − B‖₂ ≤ tolerance·‖S_J‖₂.

mod cycle;
mod halves;

use rayon::prelude::*;

use super::reference;
use crate::field::Grid;
use crate::propagate::active::everywhere;
use crate::propagate::kernel::form::Form;
use crate::propagate::kernel::lies_in_cone;
use crate::propagate::kernel::step::once;
use crate::propagate::levels::{self, Policy, TooLarge};
use crate::propagate::stencil::Stencil;
use crate::scene::occluder::OcclusionMode;
use crate::scene::{Propagation, Scene};
use crate::simulation::{SimulationError, known_scheme};
use cycle::Level;

/// The most steps taken until light is in the cone.
const MOST_STEPS: usize = 16;
/// Cycles without getting near enough, after which the solver gives up.
const MOST_CYCLES: usize = 100;

/// A scene whose fixed point is not found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The setting itself cannot be run.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// Occluders are no part of the linear equation that is solved.
    #[error("the fixed point is solved for without occluders; iterate, or set occlusion to Off")]
    Occluders,
    /// The clamp acts in every iteration.
    #[error(
        "scheme \"{scheme}\" clamps light in every iteration, so its fixed point solves no linear equation; iterate, or switch the clamp off"
    )]
    Clamped {
        /// The scheme.
        scheme: String,
    },
    /// The fixed point does not exist, or is too far.
    #[error(
        "no fixed point was found: the relative residual is {residual:.1e} after {MOST_CYCLES} cycles; use a factor below {factor}"
    )]
    Diverges {
        /// What was reached.
        residual: f64,
        /// The factor asked for.
        factor: f64,
    },
}

impl From<TooLarge> for Refusal {
    fn from(error: TooLarge) -> Self {
        Refusal::Simulation(error.into())
    }
}

/// The fixed point of a scene.
#[derive(Clone, Debug)]
pub struct Converged {
    /// A of each channel: what accumulates under the thesis's snapshots.
    pub light: Vec<Grid<f32>>,
    /// The relative residual of the channel that has the largest.
    pub residual: f64,
    /// Cycles taken, over all channels.
    pub cycles: usize,
}

/// Solves for the fixed point of the scene's finest level to a relative residual of `tolerance`, which
/// single precision bounds at about 1e-6. `watch` hears of the residual after every cycle and returns
/// whether to go on; `None` if it did not want to.
pub fn solve(scene: &Scene, tolerance: f64, mut watch: impl FnMut(f64) -> bool) -> Result<Option<Converged>, Refusal> {
    if !scene.blockers.is_empty() && scene.occlusion.mode != OcclusionMode::Off {
        return Err(Refusal::Occluders);
    }
    let injected = reference::injected::<f32>(scene)?;
    let mut solver = Solver::new(scene)?;
    let mut converged = Converged { light: Vec::new(), residual: 0.0, cycles: 0 };
    for light in injected.lights() {
        let (mut sum, rest) = solver.until_in_cone(light.source.level(0))?;
        let Some((residual, cycles)) = solver.run(&rest, tolerance, &mut watch)? else {
            return Ok(None);
        };
        if let Some(finest) = solver.levels.first() {
            halves::join(finest.solution(), &mut sum);
        }
        converged.residual = converged.residual.max(residual);
        converged.cycles += cycles;
        converged.light.push(sum);
    }
    Ok(Some(converged))
}

/// The levels of a scene's octree, down to 2³, as equations.
struct Solver {
    form: Form<f32>,
    cone: f64,
    propagation: Propagation,
    levels: Vec<Level>,
}

impl Solver {
    fn new(scene: &Scene) -> Result<Self, Refusal> {
        let propagation = scene.propagation.clone();
        let scheme = known_scheme(&propagation.scheme)?;
        let clamped = || Refusal::Clamped { scheme: propagation.scheme.clone() };
        let stencil = Stencil::<f32>::new(&scheme, propagation.factor, propagation.clamp);
        let form = Form::of(&stencil).ok_or_else(clamped)?;
        let cone = form.cone.ok_or_else(clamped)?;
        // 1³ has no neighbours to send to: its light is its own.
        let count = scene.size.ilog2() as usize;
        let operators = levels::operators(&scheme, propagation.factor, false, Policy::Consistent, count)?;
        let level = |(i, operator): (usize, &levels::LevelOperator<f32>)| {
            let form = Form::of(&operator.stencil)?;
            Some(Level::new(scene.size >> i, form.share, operator.residence))
        };
        let levels = operators.iter().enumerate().map(level).collect::<Option<_>>().ok_or_else(clamped)?;
        Ok(Solver { form, cone, propagation, levels })
    }

    /// The sum of the first snapshots, and the first one that is not clamped any more.
    fn until_in_cone(&self, injected: &Grid<f32>) -> Result<(Grid<f32>, Grid<f32>), Refusal> {
        let mut sum = Grid::new(injected.side());
        let mut light = injected.clone();
        for _ in 0..=MOST_STEPS {
            if self.cone.is_infinite() || lies_in_cone(&light, &everywhere(light.side()), self.cone) {
                return Ok((sum, light));
            }
            sum.add_grid(&light);
            light = once(&self.form, light);
        }
        Err(Refusal::Clamped { scheme: self.propagation.scheme.clone() })
    }

    /// Cycles until the residual is small enough: the relative residual, and how many it took.
    fn run(
        &mut self,
        rest: &Grid<f32>,
        tolerance: f64,
        watch: &mut impl FnMut(f64) -> bool,
    ) -> Result<Option<(f64, usize)>, Refusal> {
        let square = |plane: &Vec<f32>| plane.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>();
        let whole: f64 = rest.planes().par_iter().map(square).collect::<Vec<f64>>().iter().sum();
        let Some(finest) = self.levels.first_mut() else {
            return Ok(Some((0.0, 0)));
        };
        finest.set(halves::split(rest));
        if whole == 0.0 {
            return Ok(Some((0.0, 0)));
        }
        let mut residual = f64::INFINITY;
        for cycles in 1..=MOST_CYCLES {
            residual = (cycle::cycle(&mut self.levels, tolerance * tolerance * whole) / whole).sqrt();
            if !watch(residual) {
                return Ok(None);
            }
            if residual <= tolerance {
                return Ok(Some((residual, cycles)));
            }
        }
        Err(Refusal::Diverges { residual, factor: self.propagation.factor })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::propagate::geometry::Blocker;
    use crate::scene::{Occlusion, Source};
    use crate::sh::Sh;
    use crate::simulation::Action;
    use glam::DVec3;

    fn scene(size: usize, scheme: &str, factor: f64, clamp: bool) -> Scene {
        let light = vec![([size / 2, 0, 0], Sh::lobe(DVec3::X)), ([0; 3], Sh([0.5, 0.1, 0.2, -0.1]))];
        Scene {
            size,
            coarsest: size,
            sources: vec![Source { color: [1.0, 0.5, 0.0], light }],
            blockers: Vec::new(),
            occlusion: Occlusion::default(),
            propagation: Propagation { scheme: scheme.to_owned(), factor, clamp, ..Propagation::default() },
        }
    }

    #[test]
    fn the_fixed_point_is_what_iterating_leads_to() {
        for (size, factor, clamp) in [(1, 3.0, true), (2, 3.8, true), (8, 3.9, true), (16, 3.0, false)] {
            let scene = scene(size, "cascaded", factor, clamp);
            let found = solve(&scene, 1e-5, |_| true).unwrap().unwrap();
            assert!(found.residual <= 1e-5);
            let mut simulation = reference::injected::<f64>(&scene).unwrap();
            for _ in 0..800 {
                simulation.act(Action::Propagate);
            }
            let iterated = simulation.lights()[0].accumulated.level(0);
            let most = iterated.iter().map(|(_, light)| light.max_norm()).fold(0.0, f64::max);
            for (cell, light) in iterated.iter() {
                let difference = (found.light[0].get(cell).widen() - light).max_norm();
                assert!(difference < 1e-4 * most, "n = {size}, p = {factor}, {cell:?}: {difference}");
            }
        }
    }

    #[test]
    fn the_residual_that_is_reported_is_that_of_the_equation() {
        let scene = scene(8, "cascaded", 3.8, false);
        let found = solve(&scene, 1e-3, |_| true).unwrap().unwrap();
        // Unclamped all of it is linear: A should be S + P·A, and ‖S + P·A − A‖ as small as was said.
        let injected = reference::injected::<f32>(&scene).unwrap();
        let source = injected.lights()[0].source.level(0);
        let form = Form::of(&Stencil::new(&known_scheme("cascaded").unwrap(), 3.8, false)).unwrap();
        let moved = once(&form, found.light[0].clone());
        let square = |grid: &Grid<f32>| -> f64 { grid.iter().map(|(_, l)| l.widen().dot(l.widen())).sum() };
        let mut rest = source.clone();
        rest.add_grid(&moved);
        for (cell, light) in found.light[0].iter() {
            rest.add(cell, light * -1.0);
        }
        assert!((square(&rest) / square(source)).sqrt() < 1.1e-3);
    }

    #[test]
    fn what_cannot_be_solved_is_refused_with_the_reason() {
        let refused = |scene: &Scene| solve(scene, 1e-4, |_| true).unwrap_err();
        assert!(matches!(refused(&scene(8, "axial", 3.0, true)), Refusal::Clamped { .. }));
        assert!(solve(&scene(8, "axial", 3.0, false), 1e-4, |_| true).is_ok());
        let mut walled = scene(8, "cascaded", 3.0, true);
        walled.blockers = vec![Blocker { cell: [1; 3], normal: DVec3::X, opacity: 1.0, albedo: [0.0; 3] }];
        assert_eq!(refused(&walled), Refusal::Occluders);
        assert!(matches!(refused(&scene(16, "cascaded", 4.3, true)), Refusal::Diverges { .. }));
        assert!(matches!(refused(&scene(16, "nonsense", 3.0, true)), Refusal::Simulation(_)));
        let stopped = solve(&scene(8, "cascaded", 3.0, true), 1e-4, |_| false);
        assert!(stopped.unwrap().is_none());
    }
}
