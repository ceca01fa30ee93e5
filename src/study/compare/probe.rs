//! What a scheme does to an even point light in a free volume.

use crate::scene::propagation::descent::Descent;
use crate::scene::{Occlusion, Problem, Propagation, Source};
use crate::sh::Sh;
use crate::simulation::{Refusal, Simulation};

/// The side of the free volume, in cells; the light stands in the middle.
const SIDE: usize = 32;
/// Enough for light to be on its way through the probed cells both ways.
const ITERATIONS: usize = 32;

/// Accumulated light on an axis over light on a diagonal, as far from an even point light as makes no
/// difference: (7, 0, 0) and (4, 4, 4) are 7 and 6.93 cells away. 1 if the scheme has no preferred directions.
pub(super) fn anisotropy(propagation: &Propagation) -> Result<f64, Refusal> {
    let middle = SIDE / 2;
    let problem = Problem {
        size: SIDE,
        coarsest: SIDE,
        sources: vec![Source {
            color: [1.0; 3],
            light: vec![([middle; 3], Sh([1.0, 0.0, 0.0, 0.0]))],
            ..Source::default()
        }],
        solids: Vec::new(),
        occlusion: Occlusion::default(),
        propagation: Propagation { iterations: ITERATIONS, descent: Descent::Off, ..propagation.clone() },
        ..Problem::default()
    };
    let mut simulation = Simulation::<f32>::new(problem)?;
    simulation.run(|_| true);
    let light = |cell| f64::from(simulation.lights()[0].accumulated.level(0).get(cell).0[0]);
    Ok(light([middle + 7, middle, middle]) / light([middle + 4; 3]))
}
