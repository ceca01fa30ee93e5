//! The `stability` command from outside, and what `run` does with light that diverges.
#![allow(clippy::expect_used)]

use std::path::Path;

use assert_cmd::Command;

fn lab() -> Command {
    let mut command = Command::cargo_bin("lpv-lab").expect("the program");
    command.current_dir(env!("CARGO_MANIFEST_DIR")).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    command
}

fn rows(path: &Path) -> (Vec<String>, Vec<csv::StringRecord>) {
    let mut reader = csv::Reader::from_path(path).expect("a table");
    let header = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    (header, reader.records().map(|row| row.expect("a row")).collect())
}

#[test]
fn the_published_critical_factors_are_found_and_every_table_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let args = ["stability", "--sizes", "2,4,8", "--iterations", "20", "--side", "4", "--scenes", "5", "--out"];
    lab().args(args).arg(folder.path()).assert().success();
    let (header, critical) = rows(&folder.path().join("critical.csv"));
    let column = header.iter().position(|name| name == "critical").expect("a column");
    // MATH.md section 2.
    for (size, published) in [("2", 9.53), ("4", 5.22), ("8", 4.33)] {
        let row = critical.iter().find(|row| &row[0] == "cascaded" && &row[1] == size).expect("a row");
        let found: f64 = row[column].parse().expect("a number");
        assert!((found / published - 1.0).abs() < 0.01, "{size}³: {found}");
    }
    let (_, drift) = rows(&folder.path().join("drift.csv"));
    assert!(drift.iter().filter(|row| &row[0] == "axial").any(|row| &row[3] == "20"));
    let (_, rules) = rows(&folder.path().join("rules.csv"));
    // What is refused by name, as a factor without an operator on coarse levels, is held against no other rule.
    assert!(rules.iter().any(|row| &row[0] == "runs" && &row[1] == "5" && &row[2] == "0"));
    assert!(std::fs::read(folder.path().join("drift.png")).expect("a picture").starts_with(b"\x89PNG"));
}

#[test]
fn a_preset_is_told_which_of_its_levels_overflow_and_when() {
    let args = ["stability", "mixed", "--factor", "5", "--sizes", "2", "--iterations", "1", "--scenes", "0"];
    let output = lab().args(args).assert().success().get_output().stdout.clone();
    let said = String::from_utf8(output).expect("text");
    let level = |i: &str| {
        let row = said.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
        row.into_iter().find(|row| row.first() == Some(&i) && row.len() == 5).expect("a level")
    };
    // 5 is above the critical factor of 8³ (4.33) and below that of 4³ (5.22).
    assert_ne!(level("2")[4], "never", "{said}");
    assert_eq!(level("3")[4], "never", "{said}");
}

#[test]
fn diverging_light_is_foretold_stopped_and_what_was_good_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let args = ["run", "one-lobe", "--factor", "40", "--iterations", "5000", "--out"];
    let output = lab().args(args).arg(folder.path()).assert().code(1).get_output().stderr.clone();
    let said: Vec<String> = String::from_utf8(output).expect("text").lines().map(str::to_owned).collect();
    assert!(said[0].contains("warning") && said[0].contains("of level 0 (32³)"), "{said:?}");
    assert!(said[1].contains("the light diverges") && said[1].contains("level 0"), "{said:?}");
    let (_, errors) = rows(&folder.path().join("errors.csv"));
    assert!(errors.len() > 20 && errors.iter().all(|row| row[3].parse::<f64>().is_ok_and(f64::is_finite)));
    assert!(folder.path().join("merged.png").exists());
}
