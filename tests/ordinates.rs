//! Discrete ordinates as a preset and the command line ask for them, and the measurements that go with them.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};

use assert_cmd::Command;

fn lab(args: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("lpv-lab").unwrap().args(args).assert()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Writes a preset of a lone lobe in 8³ with more fields of its propagation.
fn preset(folder: &Path, propagation: &str) -> PathBuf {
    let path = folder.join("lobe.ron");
    let injectors = "injectors: [(kind: Single(cell: (2, 3, 3)), direction: (1, 0, 0))]";
    std::fs::write(&path, format!("(\n    version: 1,\n    size: 8,\n    {injectors},\n    {propagation},\n)\n"))
        .unwrap();
    path
}

/// The records of a CSV, with its header first.
fn records(csv: &str) -> Vec<Vec<String>> {
    csv.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

#[test]
fn a_preset_chooses_its_directions_and_light_goes_straight_on() {
    let folder = tempfile::tempdir().unwrap();
    let setting = "propagation: (scheme: \"ordinates\", factor: 4, ordinates: (directions: 200, rule: Faces))";
    let path = preset(folder.path(), setting);
    let printed = |more: &[&str]| {
        let args = [&["cells", path.to_str().unwrap(), "--iterations", "5", "--level", "0"], more].concat();
        records(&text(&lab(&args).success().get_output().stdout))
    };
    let cells = printed(&[]);
    // In the fifth snapshot light has gone five cells and no further, most of it forwards.
    let place = |cell: &[String]| [0, 1, 2].map(|axis| cell[axis].parse::<i32>().unwrap());
    let source = |cell: &[String]| cell[3].parse::<f64>().unwrap();
    let newest: Vec<_> = cells[1..].iter().filter(|cell| source(cell) != 0.0).collect();
    for cell in &newest {
        let [x, y, z] = place(cell);
        assert_eq!((x - 2).abs() + (y - 3).abs() + (z - 3).abs(), 5, "{cell:?}");
    }
    let sum =
        |forwards: bool| -> f64 { newest.iter().filter(|c| (place(c)[0] > 2) == forwards).map(|c| source(c)).sum() };
    assert!(sum(true) > 3.0 * sum(false));
    assert_ne!(printed(&["--rule", "donor"]), cells);
    assert_ne!(printed(&["--directions", "32"]), cells);
}

#[test]
fn directions_that_cannot_be_are_refused_at_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |propagation: &str, part: &str| {
        let path = preset(folder.path(), propagation);
        let said = text(&lab(&["run", path.to_str().unwrap()]).code(2).get_output().stderr);
        assert!(said.lines().count() == 1 && said.contains(part), "{said}");
    };
    refused("propagation: (scheme: \"ordinates\", ordinates: (directions: 0))", "lobe.ron:5:");
    refused("propagation: (scheme: \"ordinates\", ordinates: (directions: 0))", "from 1 to 8192");
    refused("propagation: (scheme: \"ordinates\", ordinates: (rule: Upwind))", "Faces");
    refused("propagation: (scheme: \"ordinate\")", "did you mean `ordinates`?");
}

#[test]
fn bench_measures_the_solver_and_the_presets_it_is_given() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let out = out.to_str().unwrap();
    lab(&["bench", "--only-converged", "--converged", "8", "--rounds", "1", "--out", out]).success();
    let rows = records(&std::fs::read_to_string(Path::new(out).join("converged.csv")).unwrap());
    let header = "scene,size,factor,iterations,iterating_ms,sweeps,solving_ms,ratio,residual";
    assert_eq!((rows[0].join(",").as_str(), rows.len()), (header, 7));
    assert!(rows[1..].iter().all(|row| row[8].parse::<f64>().unwrap() <= 1e-4));

    let path = preset(folder.path(), "propagation: (factor: 3.5)");
    lab(&["bench", "--only-pareto", "--presets", path.to_str().unwrap(), "--rounds", "1", "--out", out]).success();
    let rows = records(&std::fs::read_to_string(Path::new(out).join("pareto.csv")).unwrap());
    assert_eq!(rows[0].join(","), "preset,scheme,levels,size,iterations,seconds,reference,l1,l1_best_fit");
    assert!(rows.len() > 100 && rows[1..].iter().all(|row| (row[0].as_str(), row[3].as_str()) == ("lobe", "8")));
}
