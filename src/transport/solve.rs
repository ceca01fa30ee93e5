//! All the light of the finest level at once: what iterating for ever would give, found sooner.

use super::{Refusal, known};
use crate::field::Grid;
use crate::scene::Problem;

/// What finds all the light of one problem at once, made once for any number of injections.
pub trait Solve: Send {
    /// Sets `light` to the fixed point A = S + P·A of the `injected` light S, both of the problem's size, to a relative
    /// residual of `tolerance`; single precision bounds that at about 1e-6. `watch` hears of the residual after every
    /// sweep and returns whether to go on; `None` if it did not want to.
    fn solve(
        &mut self,
        injected: &Grid<f32>,
        tolerance: f64,
        light: &mut Grid<f32>,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Option<Found>, NoFixedPoint>;
}

/// How near to the fixed point one channel was brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The relative residual.
    pub residual: f64,
    /// Sweeps taken, each as much work as one iteration.
    pub sweeps: usize,
}

/// Why a fixed point is not found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoFixedPoint {
    /// The setting itself cannot be run.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// An equation of cells belongs to a scheme of the lattice.
    #[error("\"{name}\" solves no linear equation of cells; a fixed point is solved for under a scheme")]
    NoScheme {
        /// What was to propagate the light.
        name: &'static str,
    },
    /// Occluders are no part of the linear equation that is solved.
    #[error("the fixed point is solved for without occluders; iterate, or set occlusion to Off")]
    Occluders,
    /// Every snapshot is thinned, which a sweep does not do.
    #[error(
        "one sweep finds all light at factor {conserving} alone, not at {factor}; iterate, or use --factor {conserving}"
    )]
    Thinned {
        /// The factor asked for.
        factor: f64,
        /// The factor at which nothing is thinned.
        conserving: f64,
    },
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
        "no fixed point was found: the relative residual is {residual:.1e} after {sweeps} sweeps; use a factor below {factor}"
    )]
    Diverges {
        /// What was reached.
        residual: f64,
        /// After how many sweeps.
        sweeps: usize,
        /// The factor asked for.
        factor: f64,
    },
}

/// The fixed point of a problem.
#[derive(Clone, Debug)]
pub struct Converged {
    /// A of each channel: what accumulates under the thesis's snapshots.
    pub light: Vec<Grid<f32>>,
    /// The relative residual of the channel that has the largest.
    pub residual: f64,
    /// Sweeps taken, over all channels.
    pub sweeps: usize,
}

/// Solves for the fixed point of a problem's finest level under its own transport, channel by channel; see
/// [`Solve::solve`].
///
/// ```
/// use std::path::Path;
///
/// use lpv_lab::scene::{Problem, builtin};
/// use lpv_lab::transport::{self, preset};
///
/// let lobe = preset::parse(builtin::find("one-lobe").unwrap(), Path::new("one-lobe")).unwrap();
/// let problem = Problem::build(&lobe, Path::new("")).unwrap();
/// let all = transport::solve(&problem, 1e-4, |_| true).unwrap().unwrap();
/// assert!(all.residual <= 1e-4 && all.sweeps > 0);
/// ```
pub fn solve(
    problem: &Problem,
    tolerance: f64,
    mut watch: impl FnMut(f64) -> bool,
) -> Result<Option<Converged>, NoFixedPoint> {
    let mut solver = (known(&problem.propagation.scheme)?.solver)(problem)?;
    let mut converged = Converged { light: Vec::new(), residual: 0.0, sweeps: 0 };
    for injected in problem.injected::<f32>(&problem.channels()) {
        let mut light = Grid::new(problem.size);
        let Some(found) = solver.solve(&injected, tolerance, &mut light, &mut watch)? else {
            return Ok(None);
        };
        converged.residual = converged.residual.max(found.residual);
        converged.sweeps += found.sweeps;
        converged.light.push(light);
    }
    Ok(Some(converged))
}
