//! The fixed point of the uniform volume, A = S + P·A: all the light that iterating for ever would give,
//! far sooner.
//!
//! **The equation.** The accumulated light is S_0 + S_1 + … with S_{k+1} = P(S_k). P is linear except for
//! its clamps, and those act on the first steps only: light in the cone of [`crate::transport::lattice::kernel::form`]
//! is not clamped and stays in the cone. So steps are taken as they are until every cell lies in it (from
//! lobes, one step of `cascaded`), and what remains, A = head + B with B = S_J + P·B, is linear: no
//! active set is guessed, it is known. Schemes whose cone is not closed are refused, and so are occluders.
//!
//! **Half of it is enough.** Every neighbour of a cell is of the other colour of a chessboard. So half 0 has an
//! equation of its own, x = b + P·P·x, b being S_J there and what half 1 sends there; half 1 is what that
//! sends it. A *sweep*, to half 1 and back, costs what one iteration of the whole volume costs, and takes
//! light two cells further.
//!
//! **The solver.** Iterating multiplies the error by P·P a sweep. Here each sweep goes 1/(1 − λ) times as far,
//! which makes nothing of waves that P·P multiplies by λ: after some sweeps the error is multiplied by a
//! polynomial of P·P that is 1 at 1 and has the zeros λ, and those lie where the waves of P·P are
//! (`roots`). It needs no sum over the volume but the residual, no vector but x, and in the first sweeps
//! only the rows that light has reached. Of what was tried (n = 32, p = 3.8, from one wall and from one lobe;
//! in sweeps to a residual of 1e-4) plain iteration takes 115 and 105, multigrid on the octree with the operators
//! of consistent levels 17 and 17 with its transfers not counted, truncated GCR 18 and 18, each with
//! as much memory to move again, and full GCR, which no polynomial beats, 15 and 14; this takes 18 and 16. The
//! octree has little to offer here: at p = 3.8 light dies out in some three cells.
//!
//! **The guarantee** is the true residual, summed over all cells: ‖S_J + P·B − B‖₂ ≤ tolerance·‖S_J‖₂.

mod chessboard;
mod clamped_steps;
mod lit_rows;
mod roots;
mod sweep;

use std::ops::Range;

use super::kernel::form::{Form, Share};
use super::schemes;
use super::stencil::Stencil;
use crate::field::Grid;
use crate::scene::{Problem, Propagation};
use crate::transport::solve::{Found, NoFixedPoint, Solve};
use crate::transport::{known, team};
use chessboard::{Half, Shape};
use clamped_steps::ClampedSteps;
use lit_rows::LitRows;
use roots::Roots;

/// Sweeps without getting near enough, after which the solver gives up.
const MOST_SWEEPS: usize = 500;
/// A relative residual from which no sweep comes back.
const HOPELESS: f64 = 1e6;

/// Sums of squares of light that single precision holds, and those of its residuals; other light is scaled to 1.
const SQUARES: Range<f64> = 1e-12..1e12;

/// What it takes to solve for one setting and size, made once for any number of injections.
#[derive(Clone, Debug)]
pub struct Solver {
    share: Share<f32>,
    scheme: String,
    factor: f64,
    roots: Roots,
    clamped: ClampedSteps,
    tail: Tail,
}

/// The linear equation B = S_J + P·B, in halves.
#[derive(Clone, Debug)]
struct Tail {
    shape: Shape,
    /// S_J; later half 0 is where the next step goes.
    rest: [Half; 2],
    /// What half 0 is without the light of half 0 that comes back to it.
    b: Half,
    x: Half,
    /// The rows that the last injection left lit.
    stale: LitRows,
}

impl Solver {
    /// A solver for the finest level of a problem; refuses occluders that act, and all that [`Self::new`] does.
    pub fn for_problem(problem: &Problem) -> Result<Self, NoFixedPoint> {
        if problem.has_occluders() {
            return Err(NoFixedPoint::Occluders);
        }
        Solver::new(&problem.propagation, problem.size)
    }

    /// A solver for one propagation setting on an n³ grid; refuses clamps that never cease to act.
    pub fn new(propagation: &Propagation, n: usize) -> Result<Self, NoFixedPoint> {
        let name = known(&propagation.scheme)?.name;
        let scheme = schemes::find(name).ok_or(NoFixedPoint::NoScheme { name })?;
        let clamped = || NoFixedPoint::Clamped { scheme: propagation.scheme.clone() };
        let stencil = Stencil::<f32>::new(&scheme, propagation.factor, propagation.clamp);
        let form = Form::of(&stencil).ok_or_else(clamped)?;
        let cone = form.cone.ok_or_else(clamped)?;
        let shape = Shape { n };
        let half = || Half::new(shape);
        Ok(Solver {
            share: form.share,
            scheme: propagation.scheme.clone(),
            factor: propagation.factor,
            roots: Roots::new(&form.share, n),
            clamped: ClampedSteps::new(&form, cone, n),
            tail: Tail { shape, rest: [half(), half()], b: half(), x: half(), stale: LitRows::nowhere(n) },
        })
    }
}

impl Solve for Solver {
    fn solve(
        &mut self,
        injected: &Grid<f32>,
        tolerance: f64,
        light: &mut Grid<f32>,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Option<Found>, NoFixedPoint> {
        team::stay_awake();
        if !self.clamped.run(injected, light) {
            return Err(NoFixedPoint::Clamped { scheme: self.scheme.clone() });
        }
        if self.tail.shape.n == 1 {
            // No neighbour, no way for light to come back.
            light.add_grid(self.clamped.light());
            return Ok(Some(Found { residual: 0.0, sweeps: 0 }));
        }
        let share = &self.share;
        let Tail { shape, rest, b, x, stale } = &mut self.tail;
        let shape = *shape;
        let mut lit = LitRows::rows_of(self.clamped.lit());
        // What is lit is overwritten before it is read.
        if !lit.is_everywhere() {
            [&mut *b, &mut *x].into_iter().chain(rest.iter_mut()).for_each(|half| half.clear(shape, stale));
        }
        let (mut unit, mut whole) = (1.0, chessboard::split(self.clamped.light(), 1.0, &lit, rest));
        if whole == 0.0 {
            return Ok(Some(Found { residual: 0.0, sweeps: 0 }));
        }
        if !SQUARES.contains(&whole) {
            // A power of two, so that nothing is rounded.
            unit = (-0.5 * whole.log2()).round().clamp(-126.0, 126.0).exp2() as f32;
            whole = chessboard::split(self.clamped.light(), unit, &lit, rest);
        }
        let [next, odd] = rest;
        lit = lit.grown();
        sweep::send(shape, share, 0, &lit, odd, b);
        b.add(next);
        let (mut residual, mut sweeps) = (1.0, 0);
        while residual < HOPELESS && sweeps < MOST_SWEEPS {
            sweeps += 1;
            // The first zero is 0, and the sweep from the dark to b with it done.
            let from: &Half = if sweeps == 1 { b } else { x };
            let length = 1.0 / (1.0 - self.roots.get(sweeps));
            lit = lit.grown();
            residual = (sweep::sweep(shape, share, length as f32, &lit, [b, from], next) / whole).sqrt();
            *stale = lit.grown();
            if !watch(residual) {
                return Ok(None);
            }
            if residual <= tolerance {
                sweep::send(shape, share, 1, &lit, from, next);
                chessboard::join(from, [odd, next], unit, stale, light);
                return Ok(Some(Found { residual, sweeps }));
            }
            lit.clone_from(stale);
            std::mem::swap(x, next);
        }
        Err(NoFixedPoint::Diverges { residual, sweeps, factor: self.factor })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Solid;
    use crate::scene::{Occlusion, Source};
    use crate::sh::Sh;
    use crate::transport::lattice::kernel::plain;
    use crate::transport::lattice::kernel::step::once;
    use crate::transport::solve;
    use glam::DVec3;

    fn problem(size: usize, scheme: &str, factor: f64, clamp: bool) -> Problem {
        let light = vec![([size / 2, 0, 0], Sh::lobe(DVec3::X)), ([0; 3], Sh([0.5, 0.1, 0.2, -0.1]))];
        Problem {
            size,
            coarsest: size,
            sources: vec![Source { color: [1.0, 0.5, 0.0], light, ..Source::default() }],
            solids: Vec::new(),
            occlusion: Occlusion::default(),
            propagation: Propagation { scheme: scheme.to_owned(), factor, clamp, ..Propagation::default() },
            ..Problem::default()
        }
    }

    #[test]
    fn the_fixed_point_is_what_iterating_leads_to() {
        for (size, factor, clamp) in [(1, 3.0, true), (2, 3.8, true), (8, 3.9, true), (16, 3.0, false)] {
            let problem = problem(size, "cascaded", factor, clamp);
            let found = solve(&problem, 1e-5, |_| true).unwrap().unwrap();
            assert!(found.residual <= 1e-5);
            let stencil = Stencil::new(&schemes::find("cascaded").unwrap(), factor, clamp);
            let mut source = problem.injected::<f64>(&problem.channels()).swap_remove(0);
            let (mut target, mut iterated) = (Grid::new(size), source.clone());
            for _ in 0..800 {
                plain::propagate(&stencil, &source, &mut target);
                iterated.add_grid(&target);
                std::mem::swap(&mut source, &mut target);
            }
            let most = iterated.iter().map(|(_, light)| light.max_norm()).fold(0.0, f64::max);
            for (cell, light) in iterated.iter() {
                let difference = (found.light[0].get(cell).widen() - light).max_norm();
                assert!(difference < 1e-4 * most, "n = {size}, p = {factor}, {cell:?}: {difference}");
            }
        }
    }

    #[test]
    fn the_residual_that_is_reported_is_that_of_the_equation() {
        let problem = problem(8, "cascaded", 3.8, false);
        let found = solve(&problem, 1e-3, |_| true).unwrap().unwrap();
        // Unclamped all of it is linear: A should be S + P·A, and ‖S + P·A − A‖ as small as was said.
        let source = &problem.injected::<f32>(&problem.channels())[0];
        let form = Form::of(&Stencil::new(&schemes::find("cascaded").unwrap(), 3.8, false)).unwrap();
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
    fn a_solver_forgets_what_it_solved_before() {
        let wide = problem(16, "cascaded", 3.8, true);
        let mut solver = Solver::for_problem(&wide).unwrap();
        let lobe = |cell| {
            let mut light = Grid::new(16);
            light.set(cell, Sh::lobe(DVec3::Y));
            light
        };
        let find = |solver: &mut Solver, injected: &Grid<f32>| {
            let mut light = Grid::new(16);
            let found = solver.solve(injected, 1e-4, &mut light, &mut |_| true).unwrap().unwrap();
            (light, found)
        };
        for injected in [lobe([0, 15, 0]), lobe([15, 0, 15]), Grid::new(16), lobe([8, 8, 8])] {
            let mut new = Solver::for_problem(&wide).unwrap();
            assert_eq!(find(&mut solver, &injected), find(&mut new, &injected));
        }
    }

    #[test]
    fn light_too_bright_or_too_faint_to_be_squared_is_solved_alike() {
        let of = |light: f64| {
            let mut problem = problem(8, "cascaded", 3.8, false);
            problem.sources[0].light.iter_mut().for_each(|(_, lobe)| *lobe = *lobe * light);
            solve(&problem, 1e-4, |_| true).unwrap().unwrap()
        };
        let usual = of(1.0);
        for exponent in [-90, -60, 60, 100] {
            let found = of(f64::from(exponent).exp2());
            assert_eq!(found.sweeps, usual.sweeps);
            for ((_, a), (_, b)) in found.light[0].iter().zip(usual.light[0].iter()) {
                let scaled = a.widen() * f64::from(-exponent).exp2();
                assert!((scaled - b.widen()).max_norm() < 1e-5, "2^{exponent}: {scaled:?}, {b:?}");
            }
        }
    }

    #[test]
    fn near_the_critical_factor_it_takes_longer_and_arrives() {
        // Light in 16³ grows without bound from 4.09 on.
        let sweeps = [3.0, 3.8, 4.0, 4.05].map(|factor| {
            let found = solve(&problem(16, "cascaded", factor, true), 1e-4, |_| true).unwrap().unwrap();
            assert!(found.residual <= 1e-4);
            found.sweeps
        });
        assert!(sweeps.is_sorted(), "{sweeps:?}");
    }

    #[test]
    fn what_cannot_be_solved_is_refused_with_the_reason() {
        let refused = |problem: &Problem| solve(problem, 1e-4, |_| true).unwrap_err();
        assert!(matches!(refused(&problem(8, "axial", 3.0, true)), NoFixedPoint::Clamped { .. }));
        assert!(solve(&problem(8, "axial", 3.0, false), 1e-4, |_| true).is_ok());
        let mut walled = problem(8, "cascaded", 3.0, true);
        walled.solids = vec![Solid::new([1; 3], DVec3::X, 1.0, [0.0; 3])];
        assert_eq!(refused(&walled), NoFixedPoint::Occluders);
        assert!(matches!(refused(&problem(16, "cascaded", 4.3, true)), NoFixedPoint::Diverges { .. }));
        assert!(matches!(refused(&problem(16, "nonsense", 3.0, true)), NoFixedPoint::Refused(_)));
        let stopped = solve(&problem(8, "cascaded", 3.0, true), 1e-4, |_| false);
        assert!(stopped.unwrap().is_none());
    }
}
