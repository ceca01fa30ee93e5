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
//! and this 5 cycles of 2.9.
//!
//! **The guarantee** is the true residual, summed over all cells: ‖S_J + P·B − B‖₂ ≤ tolerance·‖S_J‖₂.

mod cycle;
mod halves;

use super::reference;
use crate::field::Grid;
use crate::propagate::kernel::form::Form;
use crate::propagate::kernel::step::once;
use crate::propagate::levels::{self, Policy, TooLarge};
use crate::propagate::stencil::Stencil;
use crate::scene::occluder::OcclusionMode;
use crate::scene::{Propagation, Scene};
use crate::sh::Sh;
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
            if light.iter().all(|(_, light)| self.in_cone(light)) {
                return Ok((sum, light));
            }
            sum.add_grid(&light);
            light = once(&self.form, light);
        }
        Err(Refusal::Clamped { scheme: self.propagation.scheme.clone() })
    }

    fn in_cone(&self, light: Sh<f32>) -> bool {
        light.is_zero() || light.vector().length() <= self.cone * f64::from(light.0[0])
    }

    /// Cycles until the residual is small enough: the relative residual, and how many it took.
    fn run(
        &mut self,
        rest: &Grid<f32>,
        tolerance: f64,
        watch: &mut impl FnMut(f64) -> bool,
    ) -> Result<Option<(f64, usize)>, Refusal> {
        let square = |light: Sh<f32>| light.widen().dot(light.widen());
        let whole: f64 = rest.iter().map(|(_, light)| square(light)).sum();
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
