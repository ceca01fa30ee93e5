//! Light on surfaces against its truth: null tests of the measure, and what ordinates make of a room.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;

use lpv_lab::scene::Problem;
use lpv_lab::scene::mesh_scene::Volume;
use lpv_lab::simulation::Simulation;
use lpv_lab::study::expectation::truths::SurfaceTruth;
use lpv_lab::study::expectation::{Expectation, References};
use lpv_lab::study::pareto;
use lpv_lab::study::surface::{self, Surfaces};
use lpv_lab::transport::preset;

/// The room with a crate, 4 m wide, in the middle of a volume of 32 cells of half a metre, moved by so many of them.
fn room(cells: f64, scheme: &str) -> Problem {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets");
    let mut preset = preset::read(&folder.join("cube-room.ron")).unwrap();
    preset.size = 32;
    preset.propagation.scheme = scheme.to_owned();
    let scene = preset.scene.as_mut().unwrap();
    scene.volume = Volume::Cube { center: [2.0 + 0.5 * cells, 2.0, 2.0 - 0.5 * cells], side: 16.0 };
    Expectation::Surface.prepared(Problem::build(&preset, &folder).unwrap())
}

fn truth(problem: &Problem) -> std::sync::Arc<SurfaceTruth> {
    SurfaceTruth::of(problem, &|_| true).unwrap()
}

/// What comes of all light under a problem's scheme.
fn settled(problem: Problem) -> Surfaces {
    let truth = truth(&problem);
    let mut simulation = Simulation::<f32>::new(problem).unwrap();
    assert!(simulation.settle(|_| true));
    truth.compare(&simulation)
}

#[test]
fn the_truth_is_no_error_and_no_light_is_all_of_it() {
    let truth = truth(&room(0.0, "ordinates"));
    let patches = truth.patches();
    let exact: Vec<_> = (0..patches.all().len()).map(|i| truth.lit().indirect(i)).collect();
    let same = surface::compare(patches, &exact, truth.lit());
    assert_eq!((same.l1, same.mean_ratio, same.scale), (0.0, 1.0, 1.0));
    assert!((same.correlation - 1.0).abs() < 1e-12);
    let dark = surface::compare(patches, &vec![[0.0; 3]; exact.len()], truth.lit());
    assert_eq!((dark.l1, dark.l1_fitted, dark.mean_ratio), (1.0, 1.0, 0.0));
}

#[test]
fn a_scene_moved_by_whole_cells_is_measured_alike() {
    for scheme in ["ordinates", "cascaded"] {
        let [here, there] = [0.0, 2.0].map(|cells| settled(room(cells, scheme)));
        for (a, b) in [
            (here.l1, there.l1),
            (here.mean_ratio, there.mean_ratio),
            (here.correlation, there.correlation),
            (here.noise, there.noise),
        ] {
            assert!((a - b).abs() < 1e-3, "{scheme}: {here:?}, {there:?}");
        }
    }
}

#[test]
fn time_is_set_against_what_reaches_surfaces() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets");
    let mut preset = preset::read(&folder.join("cube-room.ron")).unwrap();
    preset.size = 8;
    preset.scene.as_mut().unwrap().shadow_map = 32;
    let problem = Problem::build(&preset, &folder).unwrap();
    let rows = pareto::measure("room", &problem, 1, &|_| true).unwrap().unwrap();
    let errors = |scheme: &str, k: usize| -> Vec<f64> {
        let ours = rows.iter().filter(|row| row.expectation == Expectation::Surface && row.scheme == scheme);
        ours.filter(|row| k == 0 || row.iterations == k).map(|row| row.l1.fitted).collect()
    };
    let worst = errors("ordinates", 0).into_iter().fold(0.0, f64::max);
    assert!(worst > 0.0 && errors("cascaded", 32).iter().all(|error| *error > worst), "{worst}");
}

#[test]
fn ordinates_get_the_place_right_and_all_of_the_light() {
    let found = settled(room(0.0, "ordinates"));
    assert!((found.mean_ratio - 1.0).abs() < 0.05 && found.correlation > 0.9, "{found:?}");
}

#[test]
fn a_truth_is_kept_and_belongs_to_its_scene() {
    let (here, moved) = (room(0.0, "ordinates"), room(2.0, "ordinates"));
    let kept = truth(&here);
    assert!(std::sync::Arc::ptr_eq(&kept, &truth(&room(0.0, "cascaded"))));
    assert!(kept.is_of(&here) && !kept.is_of(&moved));
    let mut references = References { surface: Some(kept), ..References::default() };
    assert!(Expectation::Surface.is_ready(&references));
    references.turn_to(&moved);
    assert!(!Expectation::Surface.is_ready(&references));
}

#[test]
fn rows_tell_what_a_truth_knows_beside_the_error() {
    let problem = room(0.0, "cascaded");
    let mut references = References::default();
    assert!(Expectation::Picture.rows(&Simulation::<f32>::new(problem.clone()).unwrap(), &references).is_empty());
    Expectation::Surface.prepare(&problem, &mut references, &|_| true);
    let mut simulation = Simulation::<f32>::new(problem).unwrap();
    let dark = Expectation::Surface.rows(&simulation, &references)[0];
    assert_eq!((dark.l1_ratio, dark.traced.unwrap().mean_ratio), (1.0, 0.0));
    simulation.run(|_| true);
    let row = Expectation::Surface.rows(&simulation, &references)[0];
    let traced = row.traced.unwrap();
    assert!(row.l1_best_fit.unwrap() <= row.l1_ratio && traced.noise > 0.0 && traced.correlation.is_some());
}
