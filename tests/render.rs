//! `render` from outside: which files it writes, what is in them, what it refuses.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;

use assert_cmd::Command;

fn lab() -> Command {
    let mut command = Command::cargo_bin("lpv-lab").unwrap();
    command.current_dir(env!("CARGO_MANIFEST_DIR")).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    command
}

/// A picture's numbers, which must be of height, width and three colours.
fn picture(path: &Path, [width, height]: [u64; 2]) -> Vec<f32> {
    let array = npyz::NpyFile::new(std::fs::File::open(path).unwrap()).unwrap();
    assert_eq!(array.shape(), [height, width, 3]);
    array.into_vec().unwrap()
}

/// Writes a small picture of the Cornell box with these arguments to a folder.
fn render(out: &Path, arguments: &[&str]) {
    let small = ["--size", "24x16", "--iterations", "4"];
    lab().args(["render", "cornell"]).args(small).args(arguments).arg("--out").arg(out).assert().success();
}

#[test]
fn a_picture_is_its_direct_and_its_indirect_light() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), &[]);
    let [all, direct, indirect] =
        ["picture", "direct", "indirect"].map(|name| picture(&folder.path().join(format!("{name}.npy")), [24, 16]));
    assert!(direct.iter().sum::<f32>() > 0.0 && indirect.iter().sum::<f32>() > 0.0);
    let sums = direct.iter().zip(&indirect).map(|(direct, indirect)| direct + indirect);
    assert!(all.iter().zip(sums).all(|(all, sum)| (all - sum).abs() <= 1e-6 * all.abs()));
    assert!(std::fs::read(folder.path().join("picture.png")).unwrap().starts_with(b"\x89PNG"));
    let pfm = std::fs::read(folder.path().join("picture.pfm")).unwrap();
    assert!(pfm.starts_with(b"PF\n24 16\n-1.0\n"));
    assert!(!folder.path().join("truth.npy").exists());
}

#[test]
fn direct_light_is_the_same_whatever_carries_the_rest() {
    let [one, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    render(one.path(), &["--scheme", "cascaded"]);
    render(other.path(), &["--scheme", "ordinates", "--directions", "32"]);
    let read = |folder: &Path, name: &str| picture(&folder.join(name), [24, 16]);
    assert_eq!(read(one.path(), "direct.npy"), read(other.path(), "direct.npy"));
    assert_ne!(read(one.path(), "indirect.npy"), read(other.path(), "indirect.npy"));
}

#[test]
fn the_truth_of_no_bounce_is_direct_light_and_has_its_table() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), &["--truth", "--bounces", "0", "--samples", "64"]);
    let [truth, direct] = ["truth", "direct"].map(|name| picture(&folder.path().join(format!("{name}.npy")), [24, 16]));
    let mean = |numbers: &[f32]| numbers.iter().sum::<f32>() / numbers.len() as f32;
    assert!((mean(&truth) / mean(&direct) - 1.0).abs() < 0.01);
    let mut table = csv::Reader::from_path(folder.path().join("picture.csv")).unwrap();
    assert_eq!(table.headers().unwrap(), vec!["metric", "raw", "fitted"]);
    let metrics: Vec<String> = table.records().map(|row| row.unwrap()[0].to_owned()).collect();
    for metric in ["rmse", "relmse", "flip", "surface_l1", "surface_mean_ratio"] {
        assert!(metrics.iter().any(|known| known == metric), "{metrics:?}");
    }
    for name in ["truth.png", "truth_error.npy", "difference.png", "flip.png", "sheet.png"] {
        assert!(folder.path().join(name).exists(), "{name}");
    }
}

#[test]
fn any_number_of_threads_writes_the_same_bytes() {
    let files = |threads: &str| {
        let folder = tempfile::tempdir().unwrap();
        let small = ["--size", "24x16", "--iterations", "4", "--truth", "--samples", "32"];
        let mut command = lab();
        command.args(["render", "cornell", "--scheme", "ordinates", "--directions", "32"]).args(small);
        command.arg("--out").arg(folder.path()).env("RAYON_NUM_THREADS", threads).assert().success();
        ["truth.npy", "truth_error.npy", "picture.npy", "picture.csv"]
            .map(|name| std::fs::read(folder.path().join(name)).unwrap())
    };
    assert_eq!(files("1"), files("3"));
}

#[test]
fn what_cannot_be_looked_at_is_refused_in_a_line() {
    for (arguments, part) in [
        (&["one-lobe"][..], "no mesh"),
        (&["cornell", "--size", "0x4"], "pixels"),
        (&["cornell", "--size", "9999999x9999999"], "pixels"),
        (&["cornell", "--size", "wide"], "512x512"),
        (&["cornell", "--bounces", "some"], "all"),
        (&["cornell", "--samples", "0"], "--samples"),
        (&["cornell", "--exposure", "-1"], "--exposure"),
        (&["cornell", "--level", "9"], "--level 9"),
    ] {
        let output = lab().arg("render").args(arguments).assert().code(2).get_output().clone();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.lines().count() == 1 && said.contains(part), "{arguments:?}: {said}");
    }
}
