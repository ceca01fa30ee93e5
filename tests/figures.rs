//! The thesis's published figures, by number.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use glam::DVec3;
use lpv_lab::scene::Propagation;
use lpv_lab::scene::{Occlusion, Problem, Source};
use lpv_lab::sh::Sh;
use lpv_lab::simulation::Simulation;
use lpv_lab::study::expectation::{Expectation, References};

#[test]
fn one_lobe_gives_the_errors_of_figure_15() {
    // One lobe, n = 32, p = 3, levels down to 2³: (k, mean error, half a unit of the last digit printed).
    let relative = [(4, 0.069, 0.0005), (12, 0.59, 0.005), (20, 0.97, 0.005), (32, 0.98, 0.005)];
    let absolute = [(4, 7.8e-5, 0.05e-5), (12, 9.35e-5, 0.005e-5), (32, 9.43e-5, 0.005e-5)];
    let problem = Problem {
        size: 32,
        coarsest: 2,
        sources: vec![Source { color: [1.0; 3], light: vec![([16, 16, 16], Sh::lobe(DVec3::X))], ..Source::default() }],
        solids: Vec::new(),
        occlusion: Occlusion::default(),
        propagation: Propagation { iterations: 32, ..Propagation::default() },
        ..Problem::default()
    };
    let mut rows = Vec::new();
    let mut simulation = Simulation::<f32>::new(problem).unwrap();
    simulation.run(|s| {
        let references = References::default();
        rows.push(Expectation::Thesis.rows(s, &references)[0]);
        true
    });
    for (k, ought, digit) in relative {
        assert!((rows[k].relative_mean - ought).abs() <= digit, "k = {k}: {:?}", rows[k]);
    }
    for (k, ought, digit) in absolute {
        assert!((rows[k].absolute_mean - ought).abs() <= digit, "k = {k}: {:?}", rows[k]);
    }
}
