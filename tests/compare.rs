//! The comparison of schemes, against what is known of light in free space and behind walls; and the commands.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use assert_cmd::Command;
use glam::DVec3;
use lpv_lab::field::Layout;
use lpv_lab::scene::occluder::OcclusionMode;
use lpv_lab::scene::{Occlusion, Problem, Propagation, Solid, Source};
use lpv_lab::sh::Sh;
use lpv_lab::simulation::options::Device;
use lpv_lab::study::compare::{self, Finding};
use lpv_lab::study::expectation::{Expectation, References};
use lpv_lab::transport::lattice::schemes;

/// A lobe towards +X in the middle of a 32³ volume, p = 3.
fn lobe(iterations: usize) -> Problem {
    Problem {
        size: 32,
        coarsest: 1,
        sources: vec![Source {
            color: [1.0, 0.5, 0.0],
            light: vec![([16; 3], Sh::lobe(DVec3::X))],
            ..Source::default()
        }],
        solids: Vec::new(),
        occlusion: Occlusion::default(),
        propagation: Propagation { iterations, factor: 3.0, ..Propagation::default() },
        ..Problem::default()
    }
}

/// A light before a closed wall.
fn walled(mode: OcclusionMode) -> Problem {
    let wall = Layout::new(8).cells().filter(|cell| cell[0] == 4);
    let block = |cell| Solid::new(cell, DVec3::NEG_X, 1.0, [0.0; 3]);
    Problem {
        size: 8,
        sources: vec![Source { color: [1.0; 3], light: vec![([1, 3, 3], Sh::lobe(DVec3::X))], ..Source::default() }],
        solids: wall.map(block).collect(),
        occlusion: Occlusion { mode, ..Occlusion::default() },
        ..lobe(12)
    }
}

fn against_uniform(problem: &Problem, scheme: &str) -> Finding {
    compare::run(problem, scheme, Expectation::Merged, &References::default(), Device::Cpu).unwrap().unwrap()
}

#[test]
fn far_from_borders_the_energy_is_the_published_gain() {
    // The first iteration gains 13.82 % by the clamp, and each keeps three quarters (MATH.md section 2).
    let left = |k: i32| 1.1382 * 0.75f64.powi(k);
    let found = against_uniform(&lobe(8), "cascaded");
    assert!((found.energy_left / left(8) - 1.0).abs() < 1e-4, "{}", found.energy_left);
    // All light up to k is 1 + 1.1382 · (0.75 + … + 0.75^k).
    let so_far = |k: i32| 1.0 + (1..=k).map(left).sum::<f64>();
    let expected = (1..40).find(|k| left(*k) < 0.01 * so_far(*k)).map(|k| k as usize);
    assert_eq!(found.converged, expected);
    assert_eq!(found.artefacts.leak, None);
}

#[test]
fn one_iteration_moves_the_light_by_what_its_neighbours_receive() {
    // MATH.md section 2: +x gets 0.10447316, each of ±y and ±z 0.03692613, −x nothing.
    let found = against_uniform(&lobe(1), "cascaded");
    let shift = 0.104_473_16 / (0.104_473_16 + 4.0 * 0.036_926_13);
    assert!((found.shift - shift).abs() < 1e-6 && (found.centroid[0] - 16.0 - shift).abs() < 1e-6);
    assert_eq!(found.reach, 1);
}

#[test]
fn an_octree_of_one_level_has_no_error_and_more_levels_have() {
    let octree = against_uniform(&lobe(4), "axial");
    assert!(octree.error.absolute_mean > 0.0);
    let uniform = against_uniform(&Problem { coarsest: 32, ..lobe(4) }, "axial");
    assert_eq!(uniform.error.absolute_max, 0.0);
}

#[test]
fn no_scheme_comes_near_what_truly_arrives_from_one_lobe() {
    // MATH.md section 6: 0.99 to 1.04 for one lobe, n = 24, after the best scalar. No scalar gives 1.
    let problem = lobe(32);
    let mut references = References::default();
    Expectation::Ballistic.prepare(&problem, &mut references, &|_| true);
    for scheme in ["cascaded", "axial"] {
        let found = compare::run(&problem, scheme, Expectation::Ballistic, &references, Device::Cpu).unwrap().unwrap();
        assert!(found.l1_fitted > 0.9 && found.l1_fitted <= found.error.l1_ratio, "{scheme}: {}", found.l1_fitted);
    }
}

#[test]
fn what_goes_wrong_with_light_is_told_of_every_scheme() {
    for scheme in schemes::names() {
        let leak = |mode| against_uniform(&walled(mode), scheme).artefacts.leak.unwrap().finest().unwrap();
        assert_eq!(leak(OcclusionMode::Hard), 0.0, "{scheme}");
        assert_eq!(leak(OcclusionMode::Off), 1.0, "{scheme}");
        assert!(leak(OcclusionMode::Fuzzy) < 1.0, "{scheme}");
    }
}

#[test]
fn axial_prefers_the_axes_more_than_five_faces_do() {
    let anisotropy = |scheme| against_uniform(&lobe(1), scheme).anisotropy;
    assert!(anisotropy("axial") > 1.5 * anisotropy("cascaded"));
}

fn lab(arguments: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("lpv-lab").unwrap().args(arguments).assert()
}

#[test]
fn the_command_writes_a_row_for_every_preset_and_scheme() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    lab(&["compare", "back-bleeding", "thin-wall-bleeding", "--schemes", "cascaded,axial", "--out", out]).success();
    let csv = std::fs::read_to_string(folder.path().join("compare.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let columns = reader.headers().unwrap().clone();
    let of = |name: &str| columns.iter().position(|column| column == name).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let keys: Vec<(&str, &str)> = rows.iter().map(|row| (&row[of("preset")], &row[of("scheme")])).collect();
    let expected = [
        ("back-bleeding", "cascaded"),
        ("back-bleeding", "axial"),
        ("thin-wall-bleeding", "cascaded"),
        ("thin-wall-bleeding", "axial"),
    ];
    assert_eq!(keys, expected);
    assert_eq!(&rows[0][of("leak")], "");
    assert!(rows[2][of("leak")].parse::<f64>().unwrap() > 0.0);
}

#[test]
fn unknown_schemes_are_refused_with_the_nearest_name() {
    let refused = lab(&["compare", "one-lobe", "--schemes", "cascaded,axail"]).code(2);
    let error = String::from_utf8(refused.get_output().stderr.clone()).unwrap();
    assert_eq!(error.lines().count(), 1);
    assert!(error.contains("\"axail\"") && error.contains("did you mean \"axial\"?"), "{error}");
}

#[test]
fn the_schemes_are_listed_with_what_is_computed_of_them() {
    let listed = lab(&["schemes"]).success();
    let text = String::from_utf8(listed.get_output().stdout.clone()).unwrap();
    let row: Vec<&str> = text.lines().find(|line| line.starts_with("blog")).unwrap().split_whitespace().collect();
    // 003's weights: 6 · (far / (2π) + 4 · side / (3π)) · Y_0 · L_0, with Y_0 · L_0 = 1/4.
    let gain = 1.5 * (0.400_669_684_6 / 2.0 + 4.0 * 0.423_441_354_4 / 3.0) / std::f64::consts::PI;
    assert!((row[1].parse::<f64>().unwrap() - gain).abs() < 1e-4);
}

#[test]
fn one_run_is_put_against_another() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, x: usize| {
        let path = folder.path().join(name);
        let text = format!(
            "(version: 1, size: 32, injectors: [(kind: Single(cell: ({x}, 16, 16)), direction: (0, 1, 0))],
              propagation: (factor: 3.0, iterations: 4))"
        );
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let (here, there, out) = (write("a.ron", 15), write("b.ron", 16), folder.path().join("out"));
    let told = lab(&["compare", &here, &there, "--difference", "--out", out.to_str().unwrap()]).success();
    let text = String::from_utf8(told.get_output().stdout.clone()).unwrap();
    assert!(text.contains("moves by 2.65") && text.contains("the injected light's by 1 cells"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 120), "{text}");
    for file in ["difference.csv", "difference-cascaded.svg", "difference-cascaded.png"] {
        assert!(out.join(file).exists(), "{file}");
    }
    lab(&["compare", &here, "--difference"]).code(2);
    lab(&["compare", &here, "back-bleeding", "--difference"]).code(2);
}

#[test]
fn tables_fit_a_terminal_even_where_light_diverges() {
    for arguments in [
        &["compare", "two-walls", "thin-wall-bleeding"][..],
        &["compare", "back-bleeding", "--factor", "60", "--iterations", "30"],
        &["schemes"],
    ] {
        let told = lab(arguments).get_output().stdout.clone();
        let text = String::from_utf8(told).unwrap();
        let long: Vec<&str> = text.lines().filter(|line| line.chars().count() > 80).collect();
        assert!(long.is_empty() && text.lines().count() > 5, "{long:?}");
    }
}
