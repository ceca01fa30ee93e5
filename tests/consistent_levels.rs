//! Levels that agree: the corrected and the merged error of consistent levels against those of the same
//! factor on all levels.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;

use lpv_lab::scene::Problem;
use lpv_lab::scene::propagation::Policy;
use lpv_lab::simulation::Simulation;
use lpv_lab::study::error::ErrorRow;
use lpv_lab::study::expectation::{Expectation, References};
use lpv_lab::transport::preset;

fn preset(name: &str) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets").join(name);
    preset::load(&path).unwrap().1
}

fn run(mut problem: Problem, levels: Policy, factor: f64, iterations: usize) -> Simulation<f32> {
    problem.coarsest = 1;
    problem.propagation.levels = levels;
    problem.propagation.factor = factor;
    problem.propagation.iterations = iterations;
    let mut simulation = Simulation::new(problem).unwrap();
    simulation.run(|_| true);
    simulation
}

/// The L1 ratio of level `level` by the corrected metric.
fn corrected(simulation: &Simulation<f32>, level: usize) -> f64 {
    let rows = Expectation::Corrected.rows(simulation, &References::default());
    let of_level = |row: &&ErrorRow| row.level == Some(level);
    rows.iter().find(of_level).unwrap().l1_ratio
}

/// Enough iterations that what is left to come is nothing, and the uniform volume that of the fixed point.
fn until_converged(factor: f64) -> usize {
    if factor > 3.5 { 200 } else { 48 }
}

#[test]
fn consistent_levels_keep_under_their_share_of_the_error_at_factor_3() {
    for (name, share) in [("two-walls.ron", 0.2), ("mixed.ron", 1.0 / 3.0), ("one-lobe.ron", 0.5)] {
        let [same, consistent] =
            [Policy::Same, Policy::Consistent].map(|p| run(preset(name), p, 3.0, until_converged(3.0)));
        for level in 1..=3 {
            let (before, after) = (corrected(&same, level), corrected(&consistent, level));
            assert!(after <= share * before, "{name}, level {level}: {after} against {before}");
        }
    }
}

#[test]
fn consistent_levels_keep_under_their_share_of_the_error_at_factor_3_8() {
    for (name, share) in [("two-walls.ron", 0.5), ("mixed.ron", 0.5), ("one-lobe.ron", 1.0)] {
        let [same, consistent] =
            [Policy::Same, Policy::Consistent].map(|p| run(preset(name), p, 3.8, until_converged(3.8)));
        for level in 1..=3 {
            let (before, after) = (corrected(&same, level), corrected(&consistent, level));
            assert!(after < share * before, "{name}, level {level}: {after} against {before}");
        }
    }
}

#[test]
fn merged_light_has_at_most_half_the_error_in_the_setting_of_the_thesis() {
    for name in ["two-walls.ron", "mixed.ron", "one-lobe.ron"] {
        let [same, consistent] = [Policy::Same, Policy::Consistent].map(|p| {
            let simulation = run(preset(name), p, 3.0, 4);
            Expectation::Merged.rows(&simulation, &References::default())[0].l1_ratio
        });
        assert!(consistent <= 0.5 * same, "{name}: {consistent} against {same}");
    }
}

/// Scenes that the operator was not derived with: other sizes, factors, places, and a wall in the way.
const OTHERS: [(&str, &str, f64); 5] = [
    ("off-centre lobes, n = 64", include_str!("levels/off-centre.ron"), 1.0),
    ("oblique floor, n = 16", include_str!("levels/oblique-floor.ron"), 2.2),
    ("corner, n = 32", include_str!("levels/corner.ron"), 3.4),
    ("rectangles, n = 64", include_str!("levels/rectangles.ron"), 3.9),
    ("behind a wall, n = 32", include_str!("levels/behind-a-wall.ron"), 3.0),
];

#[test]
fn consistent_levels_are_better_on_scenes_that_they_were_not_made_for() {
    for (name, text, factor) in OTHERS {
        let preset = lpv_lab::scene::Preset::parse(text, Path::new(name)).unwrap();
        let problem = Problem::build(&preset, Path::new("")).unwrap();
        let [same, consistent] =
            [Policy::Same, Policy::Consistent].map(|p| run(problem.clone(), p, factor, until_converged(factor)));
        for level in 1..=3 {
            let (before, after) = (corrected(&same, level), corrected(&consistent, level));
            assert!(after < before, "{name}, level {level}: {after} against {before}");
        }
    }
}

#[test]
fn both_snapshot_modes_agree_on_what_coarser_levels_hold() {
    // All modes sum the same light with other weights: copy first = thesis + without injected.
    use lpv_lab::scene::propagation::Snapshots::{CopyFirst, Thesis, WithoutInjected};
    let [copy, thesis, without] = [CopyFirst, Thesis, WithoutInjected].map(|snapshots| {
        let mut problem = preset("corner-lobe.ron");
        problem.propagation.snapshots = snapshots;
        problem.propagation.clamp = false;
        run(problem, Policy::Consistent, 3.0, 60)
    });
    for level in 0..copy.sizes().count() {
        let of = |s: &Simulation<f32>| s.lights()[0].accumulated.level(level).clone();
        let (copy, mut sum) = (of(&copy), of(&thesis));
        sum.add_grid(&of(&without));
        for (cell, found) in copy.iter() {
            assert!((found - sum.get(cell)).max_norm() < 1e-5, "level {level}, {cell:?}");
        }
    }
}
