//! `pattern` and `identify` as they are called: the dumps of four ports, the patterns to the digit, broken files.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use tempfile::TempDir;

const PORTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/ports");

fn lab() -> Command {
    Command::new(env!("CARGO_BIN_EXE_lpv-lab"))
}

fn dump(port: &str, which: &str) -> String {
    format!("{PORTS}/{port}_{which}.npy")
}

/// `identify` on the dumps of a port of the golden data.
fn identify(port: &str, out: &Path) -> Command {
    let source = format!("1={},2={},4={}", dump(port, "s1"), dump(port, "s2"), dump(port, "s4"));
    let mut command = lab();
    command.args(["identify", "--pattern", "spaced", "--injected", &dump(port, "s0"), "--source", &source]);
    command.args(["--accumulated", &format!("4={}", dump(port, "a4")), "--out"]).arg(out);
    command
}

fn rows(out: &Path) -> Vec<(String, String, String)> {
    let mut reader = csv::Reader::from_path(out.join("identify.csv")).unwrap();
    assert_eq!(reader.headers().unwrap(), vec!["item", "value", "uncertainty"]);
    reader.records().map(|r| r.unwrap()).map(|r| (r[0].to_owned(), r[1].to_owned(), r[2].to_owned())).collect()
}

#[test]
fn the_golden_ports_are_what_their_manifest_says() {
    for (port, verdict, mistakes, factor, coefficients, axes, storage) in [
        ("h03", "correct", vec![], 3.8, "c0 X Y Z", "x -y z", "f16"),
        ("h09", "mistakes", vec!["componentwise-sides"], 4.0, "c0 -Y Z -X", "x y z", "f16"),
        ("h22", "mistakes", vec!["in-place"], 3.0, "c0 -Y Z -X", "x y z", "f32"),
        ("i03", "mistakes", vec!["injection-shifted"], 3.0, "c0 -Y Z -X", "x y z", "f32"),
    ] {
        let folder = TempDir::new().unwrap();
        identify(port, folder.path()).assert().success();
        let rows = rows(folder.path());
        let value = |item: &str| rows.iter().find(|r| r.0 == item).map(|r| r.1.clone()).unwrap();
        let found: Vec<_> = rows.iter().filter(|r| r.0 == "mistake").map(|r| r.1.as_str()).collect();
        assert_eq!((value("verdict").as_str(), found), (verdict, mistakes), "{port}");
        assert_eq!((value("coefficients"), value("axes")), (coefficients.to_owned(), axes.to_owned()), "{port}");
        assert_eq!((value("storage").as_str(), value("scheme").as_str()), (storage, "cascaded"), "{port}");
        let found: f64 = value("factor").parse().unwrap();
        let uncertainty: f64 = rows.iter().find(|r| r.0 == "factor").unwrap().2.parse().unwrap();
        assert!((found - factor).abs() <= uncertainty && uncertainty < 1e-3, "{port}: {found} {uncertainty}");
        let first = fs::read_to_string(folder.path().join("verdict.txt")).unwrap();
        assert!(first.starts_with(if verdict == "correct" { "RIGHT" } else { "NOT RIGHT" }), "{first}");
        assert_eq!(folder.path().join("first-wrong-cell.png").exists(), verdict != "correct", "{port}");
    }
}

#[test]
fn an_expectation_that_is_not_met_is_exit_code_1() {
    let folder = TempDir::new().unwrap();
    identify("h03", folder.path()).args(["--expect", "cascaded"]).assert().success();
    identify("h03", folder.path()).args(["--expect", "blog"]).assert().code(1);
    identify("h22", folder.path()).args(["--expect", "cascaded"]).assert().code(1);
    identify("h03", folder.path()).args(["--expect", "cascade"]).assert().code(2);
}

#[test]
fn the_labs_own_cells_are_recognised_through_their_files() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| -> PathBuf { folder.path().join(name) };
    lab().args(["pattern", "spaced", "--out"]).arg(path("spaced.ron")).assert().success();
    lab().args(["pattern", "spaced", "--out"]).arg(path("injected.npy")).assert().success();
    for (scheme, factor) in [("cascaded", 3.3), ("blog", 1.5), ("axial", 2.0), ("cone", 3.0), ("reflective", 3.0)] {
        for k in ["1", "2"] {
            let out = path(&format!("s{k}.csv"));
            let mut cells = lab();
            cells.args(["cells"]).arg(path("spaced.ron")).args(["--scheme", scheme, "--factor", &factor.to_string()]);
            cells.args(["--iterations", k, "--level", "0", "--out"]).arg(&out).assert().success();
        }
        let source = format!("1={},2={}", path("s1.csv").display(), path("s2.csv").display());
        let accumulated = format!("2={}", path("s2.csv").display());
        let mut command = lab();
        command.args(["identify", "--injected"]).arg(path("injected.npy")).args(["--source", &source]);
        command.args(["--accumulated", &accumulated, "--out"]).arg(path("verdict")).assert().success();
        let rows = rows(&path("verdict"));
        let value = |item: &str| rows.iter().find(|r| r.0 == item).map(|r| r.1.clone()).unwrap();
        assert_eq!(value("verdict"), "correct", "{scheme}");
        // Without occluders the reflective scheme is the cone scheme.
        assert_eq!(value("scheme"), if scheme == "reflective" { "cone" } else { scheme });
        let found: f64 = value("factor").parse().unwrap();
        assert!((found - factor).abs() < 1e-5, "{scheme}: {found}");
    }
}

#[test]
fn patterns_come_in_every_form() {
    let folder = TempDir::new().unwrap();
    for (name, size) in [("spaced", 8), ("spaced", 16), ("dense", 8)] {
        let wanted =
            fs::read_to_string(format!("{}/presets/patterns/{name}{size}.csv", env!("CARGO_MANIFEST_DIR"))).unwrap();
        for form in ["csv", "ron", "npy", "h"] {
            let out = folder.path().join(format!("{name}{size}.{form}"));
            lab().args(["pattern", name, "--size", &size.to_string(), "--out"]).arg(&out).assert().success();
            let bytes = fs::read(&out).unwrap();
            match form {
                "csv" => assert_eq!(String::from_utf8(bytes).unwrap(), wanted),
                "npy" => assert_eq!(bytes.len() % 128, (size * size * size * 16) % 128),
                "h" => assert!(String::from_utf8(bytes).unwrap().contains(&format!("lpv_pattern_{name}{size}"))),
                _ => assert_eq!(
                    String::from_utf8(bytes).unwrap().matches("kind: Single").count() + 1,
                    wanted.lines().count()
                ),
            }
        }
        // The preset injects what the array holds.
        let (a, b) = (folder.path().join("a.npy"), folder.path().join(format!("{name}{size}.npy")));
        let mut cells = lab();
        cells.arg("cells").arg(folder.path().join(format!("{name}{size}.ron"))).args(["--iterations", "0", "--out"]);
        cells.arg(&a).assert().success();
        let numbers = |path: &Path| -> Vec<f32> {
            let bytes = fs::read(path).unwrap();
            let data = &bytes[bytes.len() - size * size * size * 16..];
            data.as_chunks::<4>().0.iter().map(|c| f32::from_le_bytes(*c)).collect()
        };
        for (a, b) in numbers(&a).into_iter().zip(numbers(&b)) {
            assert!((a - b).abs() < 1e-6, "{name}{size}: {a} {b}");
        }
    }
    lab().args(["pattern", "spaced", "--size", "9"]).assert().code(2);
    lab().args(["pattern", "spaced", "--out", "pattern.txt"]).assert().code(2);
}

#[test]
fn broken_dumps_are_one_line_and_exit_code_2() {
    let folder = TempDir::new().unwrap();
    let good = fs::read(dump("h22", "s1")).unwrap();
    let mut infinite = good.clone();
    let at = infinite.len() - 64;
    infinite[at..at + 4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let mut claims = good.clone();
    let header = String::from_utf8_lossy(&claims[10..128]).replace("(8, 8, 8, 4)", "(99999999999, 8, 8, 4)");
    claims.splice(10..128, header.bytes().take(118));
    let cases: [(&str, Vec<u8>); 9] = [
        ("empty.npy", Vec::new()),
        ("cut.npy", good[..good.len() - 7].to_vec()),
        ("header.npy", good[..60].to_vec()),
        ("infinite.npy", infinite),
        ("claims.npy", claims),
        ("text.npy", b"not an array".to_vec()),
        ("empty.csv", Vec::new()),
        ("header.csv", b"x,y\n1,2\n".to_vec()),
        ("far.csv", b"x,y,z,c0,c1,c2,c3\n500,0,0,1,0,0,0\n".to_vec()),
    ];
    for (name, bytes) in cases {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        let output = lab()
            .args(["identify", "--injected", &dump("h22", "s0"), "--source"])
            .arg(format!("1={}", path.display()))
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{name}: {said}");
        assert_eq!(said.trim_end().lines().count(), 1, "{name}: {said}");
    }
    let other = |args: &[&str]| {
        let output = lab().arg("identify").args(args).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), said.trim_end().lines().count()), (Some(2), 1), "{args:?}: {said}");
    };
    let (s0, s1, s2) = (dump("h22", "s0"), dump("h22", "s1"), dump("h22", "s2"));
    other(&["--injected", &s0, "--source", &s1]);
    other(&["--injected", &s0, "--source", &format!("2={s2}")]);
    other(&["--injected", &s0, "--source", &format!("1={s1},1={s2}")]);
    other(&["--injected", &s0, "--source", &format!("1={s1}"), "--pattern", "sparse"]);
    other(&["--injected", &s0, "--source", &format!("1={s1}"), "--scale", "0"]);
    other(&["--injected", "nowhere.npy", "--source", &format!("1={s1}")]);
}
