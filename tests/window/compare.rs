//! Views side by side.

use egui_kittest::kittest::Queryable;
use lpv_lab::study::expectation::Expectation;

use crate::driver::*;

/// A small scene that was run, with its views side by side.
fn comparing() -> Window {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    harness.key_press(egui::Key::F3);
    settle(&mut harness);
    harness
}

#[test]
fn propagators_are_compared_and_their_difference_is_shown() {
    let mut harness = comparing();
    choose(&mut harness, "Propagator B scheme", "cascaded");
    set_number(&mut harness, "Propagator B factor", 2.0);
    click(&mut harness, "Run again");
    let lab = lab(&harness);
    assert_eq!((lab.iteration(), lab.shown().len()), (5, 3));
    let [a, b, difference] = [0, 1, 2].map(|pane| red(lab, pane, [4, 5]));
    assert!(a > b && b > 0.0);
    assert!((difference - (b - a)).abs() < 1e-6);
    assert_eq!(
        lab.curves().iter().map(|run| run.name.as_str()).collect::<Vec<_>>(),
        ["cascaded, p = 3", "cascaded, p = 2"]
    );
}

#[test]
fn two_iterations_are_compared() {
    let mut harness = comparing();
    click(&mut harness, "Two iterations");
    set_number(&mut harness, "Compared iteration", 2.0);
    let lab = lab(&harness);
    assert_eq!(lab.shown().iter().map(|shown| shown.iteration).collect::<Vec<_>>(), [5, 2, 2]);
    assert!((red(lab, 2, [4, 5]) - (red(lab, 1, [4, 5]) - red(lab, 0, [4, 5]))).abs() < 1e-6);
}

#[test]
fn references_are_compared_and_their_differences_are_true() {
    let mut harness = comparing();
    choose(&mut harness, "Propagator B scheme", "Uniform volume");
    click(&mut harness, "Add propagator or reference");
    choose(&mut harness, "Propagator C scheme", "What truly arrives");
    click(&mut harness, "Run again");
    {
        let lab = lab(&harness);
        assert_eq!((lab.iteration(), lab.shown().len()), (5, 5));
        let [own, uniform, arrived, from_uniform, from_arrived] = std::array::from_fn(|pane| red(lab, pane, [4, 5]));
        // In the injector's neighbour the merged light is the finest level's, which is the uniform volume.
        assert_eq!((own, from_uniform), (uniform, 0.0));
        assert!(arrived > 0.0);
        assert!((from_arrived - (arrived - own)).abs() < 1e-6);
        // The difference at the injector is without what was injected there: nothing arrives, something moved back.
        assert!(red(lab, 4, [4, 4]).abs() < 0.1 * red(lab, 0, [4, 4]));
        let names: Vec<&str> = lab.curves().iter().map(|run| run.name.as_str()).collect();
        assert_eq!(names, ["cascaded, p = 3", "uniform volume of A"]);
    }
    // Against what truly arrives both have a curve, and the past is measured as well.
    choose(&mut harness, "Error metric", "ballistic");
    for run in lab(&harness).curves() {
        assert_eq!(run.curve(Expectation::Ballistic, None, |row| row.l1_ratio).len(), 6, "{}", run.name);
    }
}

#[test]
fn differences_are_those_of_the_views_on_every_level_and_of_every_light() {
    let mut harness = comparing();
    choose(&mut harness, "Propagator B scheme", "axial");
    click(&mut harness, "Add propagator or reference");
    choose(&mut harness, "Propagator C scheme", "Uniform volume");
    click(&mut harness, "Run again");
    for (light, levels) in [
        ("Source", ["Merged", "Level 0 (finest)", "Level 1", "Level 2"]),
        ("Accumulated", ["Level 3", "Level 1", "Level 0 (finest)", "Merged"]),
    ] {
        choose(&mut harness, "Compared light", light);
        for level in levels {
            choose(&mut harness, "Level", level);
            let lab = lab(&harness);
            assert_eq!(lab.shown().len(), 5, "{light}, {level}");
            for (rival, difference) in [(1, 3), (2, 4)] {
                for cell in &lab.shown()[difference].slice.cells {
                    // Where the other view's cells are smaller, the one in the lower left corner counts.
                    let at = |pane| red(lab, pane, [cell.column, cell.row]);
                    assert_eq!(at(difference), at(rival) - at(0), "{light}, {level}, {}, {}", cell.column, cell.row);
                }
            }
        }
    }
}

#[test]
fn the_others_are_held_against_the_run_with_the_star_also_a_reference() {
    let mut harness = comparing();
    // The first run beside the preset's own cannot grow without bound: its uniform volume.
    assert_eq!(lab(&harness).curves()[1].name, "uniform volume of A");
    click(&mut harness, "Add propagator or reference");
    choose(&mut harness, "Propagator C scheme", "What truly arrives");
    click(&mut harness, "Run again");
    click(&mut harness, "Star C");
    let [own, uniform, arrived, own_less, uniform_less] = std::array::from_fn(|pane| red(lab(&harness), pane, [4, 5]));
    assert!((own_less - (own - arrived)).abs() < 1e-6 && (uniform_less - (uniform - arrived)).abs() < 1e-6);
    click(&mut harness, "Remove propagator C");
    click(&mut harness, "Run again");
    let [own, uniform, difference] = std::array::from_fn(|pane| red(lab(&harness), pane, [4, 5]));
    assert_eq!(difference, uniform - own);
}

#[test]
fn runs_are_ranked_beside_their_curves_by_what_is_drawn() {
    let mut harness = comparing();
    choose(&mut harness, "Propagator B scheme", "axial");
    click(&mut harness, "Run again");
    choose(&mut harness, "Error metric", "ballistic");
    let l1 = |run: &lpv_lab::app::Curves| run.last(Expectation::Ballistic, None, 5).expect("an error").l1_ratio;
    let mut runs = lab(&harness).curves();
    runs.sort_by(|a, b| l1(a).total_cmp(&l1(b)));
    assert_eq!(runs.len(), 2);
    for (place, run) in runs.iter().enumerate() {
        harness.get_by_label(&format!("Rank {}: {}", place + 1, run.name));
    }
}

#[test]
fn errors_are_against_the_run_with_the_star_and_follow_it() {
    let mut harness = comparing();
    choose(&mut harness, "Propagator B scheme", "axial");
    click(&mut harness, "Add propagator or reference");
    choose(&mut harness, "Propagator C scheme", "What truly arrives");
    click(&mut harness, "Run again");
    let l1 = |harness: &Window, metric| {
        let curves = lab(harness).curves();
        [0, 1].map(|run: usize| curves[run].curve(metric, None, |row| row.l1_ratio))
    };
    let sum = |curve: &[[f64; 2]]| curve.iter().map(|[_, error]| error).sum::<f64>();
    let [own, axial] = l1(&harness, Expectation::Run);
    assert_eq!((own.len(), axial.len(), sum(&own)), (6, 6, 0.0));
    assert!(sum(&axial) > 0.0);
    harness.get_by_label("Star: cascaded, p = 3");
    harness.get_by_label("Rank 1: axial, p = 3");
    click(&mut harness, "Star B");
    let [own, axial] = l1(&harness, Expectation::Run);
    assert_eq!((own.len(), axial.len(), sum(&axial)), (6, 6, 0.0));
    assert!(sum(&own) > 0.0);
    harness.get_by_label("Star: axial, p = 3");
    click(&mut harness, "Star C");
    let [own, axial] = l1(&harness, Expectation::Ballistic);
    assert!(own.len() == 6 && sum(&own) > 0.0 && sum(&axial) > 0.0);
    let nearest = if own[5][1] < axial[5][1] { "Rank 1: cascaded, p = 3" } else { "Rank 1: axial, p = 3" };
    harness.get_by_label(nearest);
}

#[test]
fn leaving_a_comparison_leaves_nothing_behind_but_what_was_chosen_by_hand() {
    let mut harness = comparing();
    let own = lab(&harness).curves()[0].clone();
    assert_eq!((lab(&harness).curves().len(), lab(&harness).shown().len()), (2, 3));
    harness.key_press(egui::Key::F2);
    settle(&mut harness);
    assert!(harness.query_by_label("Remove propagator B").is_none() && !lab(&harness).is_stale());
    assert_eq!((lab(&harness).curves().len(), lab(&harness).iteration()), (1, 5));
    assert_eq!(lab(&harness).curves()[0].name, own.name);
    harness.key_press(egui::Key::Space);
    settle(&mut harness);
    assert_eq!(lab(&harness).iteration(), 6);

    harness.key_press(egui::Key::F3);
    settle(&mut harness);
    choose(&mut harness, "Propagator B scheme", "axial");
    click(&mut harness, "Run again");
    harness.key_press(egui::Key::F2);
    settle(&mut harness);
    assert_eq!(lab(&harness).curves()[1].name, "axial, p = 3");
}

#[test]
fn the_table_tells_leaks_and_jumps() {
    let wall = "(version: 1, size: 8, injectors: [(kind: Wall(side: NegX))], occluders: [(kind: Plane(axis: X, at: 4), \
                normal: (-1, 0, 0))], occlusion: (mode: Off), propagation: (iterations: 6))";
    let mut harness = window(wall);
    click(&mut harness, "Run all");
    harness.key_press(egui::Key::F3);
    settle(&mut harness);
    for _ in 0..1000 {
        harness.step();
        if harness.query_by_label("leak of cascaded, p = 3: 1.000").is_some() {
            // A wall that is switched off holds nothing back, and one level has no border to jump at.
            harness.get_by_label("leak of uniform volume of A: 1.000");
            harness.get_by_label("jump of uniform volume of A: –");
            harness.get_by_label("jump").hover();
            harness.run_steps(90);
            harness.get_by_label_contains("Where levels meet");
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    panic!("no leak is told");
}
