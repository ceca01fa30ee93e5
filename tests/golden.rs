//! The `cells` command against vectors that other programs made: one written in float64 from the
//! published formulas, and a published shader executed by a software rasteriser (tests/golden/README.md).
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::collections::BTreeMap;
use std::path::Path;

use assert_cmd::Command;

/// The coefficients of every cell that is not dark: s0 to s3, then a0 to a3.
type Cells = BTreeMap<[usize; 3], [f64; 8]>;

fn read(csv: &str) -> Cells {
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("x,y,z,s0,s1,s2,s3,a0,a1,a2,a3"));
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        let cell = std::array::from_fn(|i| fields[i].parse().unwrap());
        (cell, std::array::from_fn(|i| fields[i + 3].parse().unwrap()))
    };
    lines.map(row).collect()
}

/// A lobe of amplitude 1 towards +X in the middle of an n³ volume.
fn preset(n: usize, propagation: &str) -> String {
    let middle = n / 2;
    format!(
        "(version: 1, size: {n}, injectors: [(kind: Single(cell: ({middle}, {middle}, {middle})), direction: (1, 0, 0))],
          propagation: ({propagation}))"
    )
}

/// The same among a wall of geometry cells at x = 9 that faces the light, occluded as the shader does it.
fn occluded_preset(propagation: &str) -> String {
    let wall = "occluders: [(kind: Plane(axis: X, at: 9), normal: (-1, 0, 0))],
          occlusion: (mode: Fuzzy, amplifier: 0.8, sign: AlongTravel, from_iteration: 2)";
    preset(16, propagation).replace("propagation:", &format!("{wall}, propagation:"))
}

/// Runs `cells` on the preset for k iterations and compares every cell, found or expected, with the file.
fn assert_equal_to(golden: &str, preset: &str, k: usize) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("golden.ron");
    std::fs::write(&path, preset).unwrap();
    let output = Command::cargo_bin("lpv-lab")
        .unwrap()
        .args(["cells", path.to_str().unwrap(), "--iterations", &k.to_string()])
        .assert()
        .success();
    let found = read(std::str::from_utf8(&output.get_output().stdout).unwrap());
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{golden}_k{k}.csv"));
    let expected = read(&std::fs::read_to_string(file).unwrap());
    for cell in found.keys().chain(expected.keys()) {
        let values = |cells: &Cells| cells.get(cell).copied().unwrap_or_default();
        for (column, (is, ought)) in values(&found).iter().zip(values(&expected)).enumerate() {
            assert!((is - ought).abs() <= 2e-6, "{golden}, k = {k}, {cell:?}, column {column}: {is}, not {ought}");
        }
    }
}

#[test]
fn the_thesis_scheme_equals_the_float64_program() {
    for k in [1, 2, 4] {
        assert_equal_to("oracle_ref64_exact_pi_16c", &preset(16, "factor: 4.0"), k);
        assert_equal_to("oracle_ref64_exact_pi_8c", &preset(8, "factor: 4.0"), k);
    }
}

#[test]
fn without_clamp_it_equals_the_float64_program() {
    for k in [1, 2, 4] {
        assert_equal_to("oracle_ref64_exact_pi_noclamp_8c", &preset(8, "factor: 4.0, clamp: false"), k);
    }
}

#[test]
fn it_equals_the_published_shader() {
    for k in [1, 2, 4] {
        let pure = preset(16, "factor: 1.0, snapshots: WithoutInjected");
        assert_equal_to("oracle_nvidia_llvmpipe_p1_pure", &pure, k);
        let copy_first = preset(16, "factor: 3.0, snapshots: CopyFirst");
        assert_equal_to("oracle_nvidia_llvmpipe_p3_copyfirst", &copy_first, k);
    }
}

#[test]
fn occluded_it_equals_the_published_shader() {
    for k in [1, 2, 4] {
        let occluded = occluded_preset("factor: 3.0, snapshots: WithoutInjected");
        assert_equal_to("oracle_nvidia_llvmpipe_occ_p3", &occluded, k);
    }
}

#[test]
fn reflected_it_equals_the_published_shader() {
    for k in [1, 2] {
        let wall = "occluders: [(kind: Plane(axis: X, at: 9), normal: (-1, 0, 0), albedo: (0.5, 0.5, 0.5))],
          occlusion: (mode: Fuzzy, amplifier: 0.0, bounce: 1.0)";
        let reflected = preset(16, "factor: 3.0, snapshots: WithoutInjected")
            .replace("propagation:", &format!("{wall}, propagation:"));
        assert_equal_to("oracle_nvidia_llvmpipe_bounce_p3", &reflected, k);
    }
}

#[test]
fn the_blog_scheme_equals_the_float64_program() {
    for k in [1, 2, 4] {
        assert_equal_to("oracle_ref64_seed003_blog_16c", &preset(16, "scheme: \"blog\", factor: 1.0"), k);
    }
}
