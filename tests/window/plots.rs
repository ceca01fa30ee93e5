//! The plots at the foot of the window.

use std::path::Path;

use lpv_lab::scene::Scene;
use lpv_lab::simulation::Simulation;
use lpv_lab::study::ballistic::{self, Ballistic};
use lpv_lab::study::error::Metric;

use crate::driver::*;

#[test]
fn errors_against_what_truly_arrives_are_computed_once_and_for_the_past_too() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    choose(&mut harness, "Error metric", "ballistic");
    let measured = |harness: &Window| {
        let run = lab(harness).curves()[0].clone();
        (run.curve(Metric::Ballistic, None, |row| row.l1_ratio), run.fits)
    };
    let (ratios, fits) = measured(&harness);
    let iterations: Vec<f64> = ratios.iter().map(|[k, _]| *k).collect();
    assert_eq!(iterations, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    // No scalar is worse than the best one: neither 1 nor 0.
    assert!(ratios.iter().zip(&fits).all(|(raw, fitted)| fitted[1] <= raw[1] && fitted[1] <= 1.0));
    let scene = Scene::build(lab(&harness).preset(), Path::new("")).unwrap();
    let mut simulation = Simulation::<f32>::new(scene.clone()).unwrap();
    simulation.run(|_| true);
    let truth = Ballistic::new(&scene, &|_| true).unwrap().unwrap();
    assert_eq!(ratios[5][1], ballistic::error(&simulation, &truth).unwrap().l1_ratio);
    // Another factor is measured against the same light at once; other light is computed anew.
    set_number(&mut harness, "Factor p", 2.0);
    click(&mut harness, "Run again");
    assert_eq!(measured(&harness).0.len(), 6);
    assert_ne!(measured(&harness).0, ratios);
    // Cells' errors are against it as well, on level 0 too.
    assert!(lab(&harness).shown()[2].errors.iter().all(Option::is_some));
}
