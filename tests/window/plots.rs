//! The plots at the foot of the window.

use std::path::Path;

use egui_kittest::kittest::{NodeT, Queryable};
use lpv_lab::scene::Problem;
use lpv_lab::scene::propagation::Policy;
use lpv_lab::simulation::Simulation;
use lpv_lab::study::expectation::{Expectation, References};
use lpv_lab::study::pareto::Treatment;
use lpv_lab::transport::lattice::schemes;

use crate::driver::*;

#[test]
fn errors_against_what_truly_arrives_are_computed_once_and_for_the_past_too() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    choose(&mut harness, "Error metric", "ballistic");
    let measured = |harness: &Window| {
        let run = lab(harness).curves()[0].clone();
        (
            run.curve(Expectation::Ballistic, None, |row| row.l1_ratio),
            run.curve(Expectation::Ballistic, None, |row| row.l1_best_fit.unwrap()),
        )
    };
    let (ratios, fits) = measured(&harness);
    let iterations: Vec<f64> = ratios.iter().map(|[k, _]| *k).collect();
    assert_eq!(iterations, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    // No scalar is worse than the best one: neither 1 nor 0.
    assert!(ratios.iter().zip(&fits).all(|(raw, fitted)| fitted[1] <= raw[1] && fitted[1] <= 1.0));
    let problem = Problem::build(lab(&harness).preset(), Path::new("")).unwrap();
    let mut simulation = Simulation::<f32>::new(problem.clone()).unwrap();
    simulation.run(|_| true);
    let mut references = References::default();
    Expectation::Ballistic.prepare(&problem, &mut references, &|_| true);
    assert_eq!(ratios[5][1], Expectation::Ballistic.rows(&simulation, &references)[0].l1_ratio);
    // Another factor is measured against the same light at once; other light is computed anew.
    set_number(&mut harness, "Factor p", 2.0);
    click(&mut harness, "Run again");
    assert_eq!(measured(&harness).0.len(), 6);
    assert_ne!(measured(&harness).0, ratios);
    // Cells' errors are against it as well, on level 0 too.
    assert!(lab(&harness).shown()[2].errors.iter().all(Option::is_some));
}

#[test]
fn a_factor_that_a_level_does_not_bear_is_warned_of_at_its_field() {
    let mut harness = window(SMALL);
    assert!(harness.query_by_label_contains("critical factor of level").is_none());
    set_number(&mut harness, "Factor p", 5.5);
    // MATH.md section 2: 4.33 at 8³.
    harness.get_by_label_contains("above 4.33, the critical factor of level 0 (8³)");
    set_number(&mut harness, "Factor p", 3.0);
    assert!(harness.query_by_label_contains("critical factor of level").is_none());
}

#[test]
fn light_that_will_diverge_is_foretold() {
    let mut harness = window(SMALL);
    set_number(&mut harness, "Factor p", 50.0);
    click(&mut harness, "Run again");
    for _ in 0..2000 {
        harness.step();
        if harness.query_by_label_contains("will overflow about iteration").is_some() {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    panic!("it is not foretold");
}

#[test]
fn light_along_a_line_is_drawn_under_both_policies_beside_the_uniform_volume() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    harness.key_press(egui::Key::F7);
    settle(&mut harness);
    harness.get_by_label("Light along the line");
    let course = lab(&harness).course().unwrap();
    let names: Vec<&str> = course.curves.iter().map(|(name, _)| *name).collect();
    let policies = [
        "merged, one factor for all levels",
        "merged, consistent levels",
        "merged, exact levels",
        "merged, exact levels ahead",
    ];
    assert_eq!((names[0], &names[1..]), ("uniform volume", &policies[..]));
    // The line runs through the injector; the preset's own merged light is what the view shows.
    for [x, c00] in &course.curves[1].1 {
        assert_eq!(*c00 as f32, red(lab(&harness), 2, [*x as usize, 4]));
    }
    click(&mut harness, "Line along y");
    set_number(&mut harness, "Line at", 6.0);
    let course = lab(&harness).course().unwrap();
    assert_eq!(course.curves[1].1[3][1] as f32, red(lab(&harness), 2, [6, 3]));
    // Another iteration is computed when it is looked at.
    set_number(&mut harness, "Iteration shown", 2.0);
    let earlier = lab(&harness).course().unwrap();
    assert_eq!(earlier.curves[1].1[3][1] as f32, red(lab(&harness), 2, [6, 3]));
    assert_ne!(earlier, course);

    menu(&mut harness, &["File", "Curves as CSV…"]);
    answer(&mut harness, &folder.path().join("line.csv"), "Save to file");
    let rows: Vec<Vec<f64>> = csv::Reader::from_path(folder.path().join("line.csv"))
        .unwrap()
        .into_records()
        .map(|row| row.unwrap().iter().map(|cell| cell.parse().unwrap()).collect())
        .collect();
    for (i, row) in rows.iter().enumerate() {
        assert_eq!(row[0], i as f64);
        assert_eq!(row[1..], [0, 1, 2].map(|curve: usize| earlier.curves[curve].1[i][1]));
    }
}

#[test]
fn run_time_is_set_against_error_and_can_be_called_off() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(SMALL);
    harness.key_press(egui::Key::F8);
    settle(&mut harness);
    click(&mut harness, "Measure");
    harness.get_by_label("Run time against error");
    let rows = lab(&harness).pareto_rows().to_vec();
    for scheme in schemes::names() {
        let treatments = [Policy::Same, Policy::Consistent].map(Treatment::Octree).into_iter();
        let treatments = treatments.chain([Treatment::Uniform]);
        for (treatment, expectation) in
            treatments.flat_map(|one| [(one, Expectation::Merged), (one, Expectation::Ballistic)])
        {
            let ours = rows.iter().filter(|row| row.scheme == scheme);
            let ours = ours.filter(|row| row.treatment == treatment && row.expectation == expectation);
            let mut iterations: Vec<usize> = ours.map(|row| row.iterations).collect();
            iterations.sort_unstable();
            assert_eq!(iterations, [1, 2, 4, 8, 16, 32], "{scheme}, {treatment:?}, {expectation}");
        }
    }
    // The preset asks for no descent.
    assert!(rows.iter().all(|row| row.treatment != Treatment::Descent));
    // At p = 3 blog's light grows without bound (critical factor 2.99 at 8³): there is nothing to solve for.
    let solved = |scheme: &str| rows.iter().any(|row| row.scheme == scheme && row.treatment == Treatment::Converged);
    assert!(solved("cascaded") && !solved("blog"));
    assert!(rows.iter().any(|row| row.name().contains("faces")));
    assert!(rows.iter().all(|row| row.size == 8 && row.preset == "Small"));
    choose(&mut harness, "Error against", "Against the uniform fixed point");
    harness.get_by_label("Run time against error");
    menu(&mut harness, &["File", "Plots as SVG…"]);
    answer(&mut harness, &folder.path().join("pareto.svg"), "Save to file");
    let text = std::fs::read_to_string(folder.path().join("pareto.svg")).unwrap();
    resvg::usvg::Tree::from_str(&text, &resvg::usvg::Options::default()).unwrap();
    assert!(schemes::names().iter().all(|name| text.contains(name)) && text.contains("what nothing beats"));

    harness.get_by_label("Measure").click();
    harness.step();
    harness.step();
    harness.get_by_label("Cancel the measurement").click();
    settle(&mut harness);
    assert!(lab(&harness).pareto_rows().is_empty());
}

#[test]
fn what_was_skipped_is_told() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    let told = harness.get_by_label_contains("% visited");
    let text = told.accesskit_node().value().unwrap_or_default().to_owned();
    let share: f64 = text.trim_start_matches("·  ").trim_end_matches(" % visited").parse().unwrap();
    // Five iterations from one cell of 8³ do not reach all of it.
    assert!(share > 0.0 && share < 100.0, "{text}");
    told.hover();
    harness.run_steps(90);
    assert!(harness.query_by_label_contains("not reached yet").is_some());
}

#[test]
fn the_legend_switches_curves() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    // One plot at first, of what the light is off in all; others are a click away.
    harness.get_by_label("L1 ratio");
    assert!(harness.query_by_label("Absolute error").is_none());
    for entry in ["Curves", "Absolute error", "Relative error"] {
        click(&mut harness, entry);
    }
    let drawn = |harness: &Window| {
        let entries = harness.get_all_by_role_and_label(egui::accesskit::Role::CheckBox, "largest");
        entries.map(|entry| entry.accesskit_node().toggled()).collect::<Vec<_>>()
    };
    let (on, off) = (Some(egui::accesskit::Toggled::True), Some(egui::accesskit::Toggled::False));
    assert_eq!(drawn(&harness), [on, on]);
    harness.get_all_by_role_and_label(egui::accesskit::Role::CheckBox, "largest").next().unwrap().click();
    settle(&mut harness);
    assert_eq!(drawn(&harness), [off, on]);
}
