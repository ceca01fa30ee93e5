//! How much light gets through occluders: light behind a wall over light there without it.
//!
//! Both are sums of the accumulated light over the same cells, those that lie behind as a matter of geometry
//! ([`super::behind`]), after the same iterations of the same scene, once as it is and once with its occluders
//! switched off. So it is 1 where there is no wall or a wall that holds nothing back, 0 behind a perfect one, a
//! half behind one that lets half of it through, and above 1 where occluders send light there. How far behind
//! the wall one looks, and how much the light has faded on its way to it, cancels.
//!
//! On a level count the cells that lie behind as a whole: a level leaks if light is in them. The finest level is a
//! uniform volume: its number is the scheme's own and the same wherever the scene lies. The merged light is what is
//! sampled in the finest cells behind. Its number is another where light is sampled on coarse levels, or in a coarse
//! cell that reaches around to the lit side, and it depends on how the wall lies among the coarse cells.

use super::behind::Behind;
use super::{Region, Shares, share};
use crate::scene::Problem;
use crate::scene::occluder::{Occlusion, OcclusionMode};
use crate::simulation::options::Wanted;
use crate::simulation::{Action, Refusal, Simulation};
use crate::study::light::Brightness;
use crate::transport::kind::Precision;

/// The leak of a state that its problem's own iterations led to; `None` where nothing lies behind an occluder.
///
/// ```
/// use lpv_lab::scene::Problem;
/// use lpv_lab::simulation::Simulation;
/// use lpv_lab::study::artefacts::leak;
/// use lpv_lab::transport::preset;
///
/// let leak = |mode: &str| -> Result<f64, Box<dyn std::error::Error>> {
///     let text = format!(
///         "(version: 1, size: 8, injectors: [(kind: Wall(side: NegX))],
///           occluders: [(kind: Plane(axis: X, at: 4), normal: (-1, 0, 0))], occlusion: (mode: {mode}))"
///     );
///     let problem = Problem::build(&preset::parse(&text, "wall.ron".as_ref())?, "".as_ref())?;
///     let mut simulation = Simulation::<f32>::new(problem)?;
///     simulation.run(|_| true);
///     Ok(leak::of(&simulation)?.and_then(|leak| leak.finest()).expect("half of the volume lies behind the wall"))
/// };
/// assert_eq!((leak("Off")?, leak("Hard")?), (1.0, 0.0));
/// assert!((0.3..0.5).contains(&leak("Fuzzy")?));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Where memory is short: the same iterations are done once more without occluders.
pub fn of<T: Precision>(state: &Simulation<T>) -> Result<Option<Shares>, Refusal> {
    let problem = state.problem();
    let Some(behind) = Behind::of(problem) else { return Ok(None) };
    let region = Region::new(behind.cells, &behind.others, state.sizes().count());
    let free = without_occluders::<T>(problem, state.iteration())?;
    let brightness = [state, &free].map(|state| Brightness::new(state.channels()));
    let merged = share(region.merged(state, &brightness[0]), region.merged(&free, &brightness[1]));
    let level = |level| {
        let here = region.level(state, &brightness[0], level)?;
        share(here, region.level(&free, &brightness[1], level)?)
    };
    Ok(Some(Shares { merged, levels: (0..state.sizes().count()).map(level).collect() }))
}

/// A scene with its occluders switched off, after so many iterations.
fn without_occluders<T: Precision>(problem: &Problem, iterations: usize) -> Result<Simulation<T>, Refusal> {
    let occlusion = Occlusion { mode: OcclusionMode::Off, ..problem.occlusion };
    let mut free = Simulation::<T>::new(Problem { occlusion, ..problem.clone() })?;
    for action in [Action::Clear, Action::Inject, Action::Downsample] {
        free.act(action);
    }
    free.advance(iterations, Wanted::Everything);
    Ok(free)
}
