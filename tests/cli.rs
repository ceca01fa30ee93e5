//! The program from outside: what it writes, what it says, how it ends.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;

use assert_cmd::Command;
use lpv_lab::field::{Cell, Grid};
use lpv_lab::scene::cell_file;
use lpv_lab::scene::cell_file::Column;

fn lab() -> Command {
    let mut command = Command::cargo_bin("lpv-lab").unwrap();
    command.current_dir(env!("CARGO_MANIFEST_DIR")).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    command
}

fn stdout(command: &mut Command) -> String {
    String::from_utf8(command.assert().success().get_output().stdout.clone()).unwrap()
}

/// Runs a command that must end with exit code 2 and one line on standard error that holds every part.
fn refused(args: &[&str], parts: &[&str]) {
    let output = lab().args(args).assert().code(2).get_output().clone();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(said.lines().count(), 1, "{said}");
    for part in parts {
        assert!(said.contains(part), "`{said}` does not say `{part}`");
    }
}

#[test]
fn run_writes_every_file_and_a_line_an_iteration() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("deep/results");
    let said =
        stdout(lab().args(["run", "presets/one-lobe.ron", "--iterations", "3", "--level", "2", "--out"]).arg(&out));
    let iterations: Vec<&str> = said.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(iterations[..5], ["iteration", "0", "1", "2", "3"]);
    for name in ["errors", "level-2", "merged"] {
        let svg = std::fs::read_to_string(out.join(format!("{name}.svg"))).unwrap();
        assert!(svg.starts_with("<svg") || svg.starts_with("<?xml"), "{name}.svg");
        let png = std::fs::read(out.join(format!("{name}.png"))).unwrap();
        assert!(png.starts_with(b"\x89PNG"), "{name}.png");
    }
    let summary = std::fs::read_to_string(out.join("summary.ron")).unwrap();
    assert!(summary.contains("iterations: 3"), "{summary}");

    let mut errors = csv::Reader::from_path(out.join("errors.csv")).unwrap();
    let header = "iteration,metric,level,absolute_mean,absolute_max,relative_mean,relative_max,l1_ratio,undefined";
    assert_eq!(errors.headers().unwrap().iter().collect::<Vec<_>>().join(","), header);
    let rows: Vec<csv::StringRecord> = errors.records().map(Result::unwrap).collect();
    // Iterations 0 to 3; the octree goes down to 2³, so levels 1 to 4 and all of them, for every metric.
    let thesis: Vec<_> = rows.iter().filter(|row| &row[1] == "thesis").collect();
    assert_eq!(thesis.len(), 4 * 5);
    assert!(thesis.iter().filter(|row| &row[0] == "0").all(|row| row[3].parse::<f64>().unwrap() == 0.0));
    assert!(thesis.iter().any(|row| &row[0] == "3" && &row[2] == "all" && row[3].parse::<f64>().unwrap() > 0.0));
}

#[test]
fn without_a_display_a_preset_is_run_headless_and_it_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let preset = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/back-bleeding.ron");
    let output = lab().current_dir(folder.path()).arg(preset).assert().success().get_output().clone();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.contains("headless") && said.contains("lpv-lab-results"), "{said}");
    assert!(folder.path().join("lpv-lab-results/back-bleeding/errors.csv").exists());
}

/// No driver's words: one line, whatever stands in the way of a window.
#[cfg(target_os = "linux")]
#[test]
fn a_display_that_cannot_be_opened_is_told_in_one_plain_line() {
    let folder = tempfile::tempdir().unwrap();
    let preset = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/one-lobe.ron");
    let output = lab().current_dir(folder.path()).env("DISPLAY", ":4711").arg(preset).assert().success();
    let said = String::from_utf8(output.get_output().stderr.clone()).unwrap();
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.contains("headless, results in") && !said.contains(".rs:") && said.len() < 200, "{said}");
}

#[test]
fn what_one_run_writes_another_injects_whichever_the_format() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let read = |name: &str, column| -> Vec<(Cell, [f32; 4])> {
        let cells = cell_file::read(Path::new(&at(name)), 32, Some(column)).unwrap();
        cells.into_iter().map(|(cell, light)| (cell, light.cast::<f32>().0)).collect()
    };
    let cells = ["cells", "presets/one-lobe.ron", "--iterations", "3", "--out"];
    let inject = |file: &str, column: &str| {
        let preset = format!("(version: 1, size: 32, injectors: [(kind: File(path: \"{file}\"{column}))])");
        std::fs::write(at("again.ron"), preset).unwrap();
        stdout(lab().args(["cells", &at("again.ron"), "--iterations", "0", "--out", &at("again.csv")]));
        read("again.csv", Column::Source)
    };
    stdout(lab().args(cells).arg(at("both.csv")));
    let accumulated = read("both.csv", Column::Accumulated);
    let source = read("both.csv", Column::Source);
    assert!(accumulated.len() > 20 && accumulated != source);
    for (grid, expected) in [("source", &source), ("accumulated", &accumulated)] {
        for file in ["one.csv", "one.npy"] {
            stdout(lab().args(cells).arg(at(file)).args(["--grid", grid]));
            assert_eq!(&inject(file, ""), expected, "{grid} {file}");
        }
    }
    stdout(lab().args(cells).arg(at("cells.npy")));
    assert_eq!(inject("cells.npy", ""), accumulated);
    assert_eq!(inject("both.csv", ", column: Accumulated"), accumulated);
    assert_eq!(inject("both.csv", ", column: Source"), source);
    std::fs::write(at("again.ron"), "(version: 1, injectors: [\n (kind: File(path: \"both.csv\"))])").unwrap();
    refused(&["run", &at("again.ron")], &["again.ron:2:", "two lights", "`column: Source`", "`column: Accumulated`"]);
    refused(&["cells", "one-lobe", "--level", "merged", "--grid", "source"], &["--grid source", "--level 0"]);
}

#[test]
fn a_coarser_levels_cells_are_not_taken_for_a_corner_of_a_finer_volume() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    stdout(lab().args(["cells", "one-lobe", "--iterations", "2", "--level", "2", "--out", &at("coarse.csv")]));
    let preset = |size: usize| {
        let kind = "File(path: \"coarse.csv\", column: Accumulated)";
        std::fs::write(at("p.ron"), format!("(version: 1, size: {size}, injectors: [(kind: {kind})])")).unwrap();
    };
    preset(32);
    refused(&["cells", &at("p.ron")], &["coarse.csv:2: ", "8 cells a side", "32"]);
    preset(8);
    stdout(lab().args(["cells", &at("p.ron"), "--iterations", "0"]));
}

#[test]
fn light_that_surfaces_do_not_send_is_doubted_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for (row, words) in [
        ("1,2,3,-0.886227,0,0,1.02333", Some("is negative in the mean")),
        ("1,2,3,0.1,0,0,-5", Some("has a longer lobe than a cosine's")),
        ("1,2,3,0.886227,0,0,-1.0233267", None),
        ("1,2,3,0.886227,0,0,0", None),
    ] {
        std::fs::write(at("cells.csv"), format!("x,y,z,c0,c1,c2,c3\n{row}\n")).unwrap();
        let preset =
            "(version: 1, size: 8,\n injectors: [(kind: File(path: \"cells.csv\"))], propagation: (iterations: 1))";
        std::fs::write(at("p.ron"), preset).unwrap();
        for command in [["compare", "--schemes=cascaded"], ["cells", "--level=0"]] {
            let output = lab().args(command).arg(at("p.ron")).assert().success().get_output().clone();
            let said = String::from_utf8(output.stderr).unwrap();
            match words {
                Some(words) => {
                    assert!(said.starts_with("lpv-lab: warning: ") && said.lines().count() == 1, "{said}");
                    for part in [words, "p.ron:2:", "`cells.csv`, cell (1, 2, 3)"] {
                        assert!(said.contains(part), "{said} lacks {part}");
                    }
                }
                None => assert_eq!(said, ""),
            }
        }
    }
}

#[test]
fn light_that_is_not_there_or_cannot_get_out_is_doubted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.ron");
    let lamp = "injectors: [\n(kind: Single(cell: (4, 4, 4)))]";
    let hard = |to: usize| {
        format!("{lamp}, occluders: [(kind: Box(from: (3, 3, 3), to: (5, 5, {to})))], occlusion: (mode: Hard)")
    };
    for (lists, words) in [
        ("injectors: []".to_owned(), Some("p.ron:1:34: there is no light")),
        ("injectors: [(kind: Wall(side: NegX), enabled: false)]".to_owned(), Some("there is no light")),
        ("injectors: [(kind: Wall(side: NegX), color: (0, 0, 0))]".to_owned(), Some("there is no light")),
        (hard(5), Some("p.ron:2:1: 1 of 1 lit cells are shut in by opaque ones, such as (4, 4, 4)")),
        // The light's own cell may be opaque, as long as one beside it is not.
        (hard(4), None),
        (hard(5).replace("Hard", "Fuzzy"), None),
        (lamp.to_owned(), None),
    ] {
        let text = format!(
            "(version: 1, size: 8, injectors: {}, propagation: (iterations: 1))",
            &lists["injectors: ".len()..]
        );
        std::fs::write(&path, text).unwrap();
        let output = lab().arg("cells").arg(&path).assert().success().get_output().clone();
        let said = String::from_utf8(output.stderr).unwrap();
        match words {
            Some(words) => {
                assert!(said.lines().count() == 1 && said.contains("warning: ") && said.contains(words), "{said}")
            }
            None => assert_eq!(said, "", "{lists}"),
        }
    }
}

#[test]
fn nothing_in_a_title_or_a_name_steers_the_terminal_or_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let injectors = "injectors: [(kind: Wall(side: NegX))], propagation: (iterations: 1)";
    for (name, title) in [
        ("ctl", "a\\u{7}\\u{1b}[31mred\\u{0}x\\nline2"),
        ("rtl\u{202e}nor", "\\u{202e}abc \\u{5e9}\\u{5dc}"),
        ("long", &"WM-CM-6rter ".repeat(300)),
    ] {
        let preset = folder.path().join(format!("{name}.ron"));
        std::fs::write(&preset, format!("(version: 1, title: \"{title}\", size: 8, {injectors})")).unwrap();
        let out = folder.path().join("results");
        let steers = |text: &str| text.chars().any(|c| lpv_lab::system::text::is_unfit(c) && c != '\n');
        for command in [["run"].as_slice(), &["compare", "--schemes", "cascaded"]] {
            let output =
                lab().args(command).arg(&preset).arg("--out").arg(&out).assert().success().get_output().clone();
            for said in [output.stdout, output.stderr] {
                let said = String::from_utf8(said).unwrap();
                assert!(!steers(&said), "{said:?}");
                assert!(said.lines().all(|line| line.chars().count() < 400), "{said}");
            }
            for entry in
                std::fs::read_dir(&out).unwrap().flatten().filter(|e| e.path().extension().is_some_and(|e| e == "svg"))
            {
                assert!(!steers(&std::fs::read_to_string(entry.path()).unwrap()), "{}", entry.path().display());
            }
        }
    }
}

#[test]
fn every_level_and_the_merged_grid_can_be_printed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("merged.npy");
    stdout(lab().args(["cells", "mixed", "--iterations", "2", "--level", "merged", "--out"]).arg(&path));
    let mut lit = Grid::<f32>::new(32);
    for (cell, light) in cell_file::read(&path, 32, None).unwrap() {
        lit.set(cell, light.cast());
    }
    assert!(lit.iter().all(|(_, light)| !light.is_zero()), "after merging, a coarser level lights every cell");
    let said = stdout(lab().args(["cells", "mixed", "--iterations", "2", "--level", "5"]));
    assert_eq!(said.lines().count(), 2, "the 1³ level has one cell: {said}");
    let blue = stdout(lab().args(["cells", "colours", "--iterations", "1", "--channel", "b"]));
    let red = stdout(lab().args(["cells", "colours", "--iterations", "1", "--channel", "r"]));
    assert_ne!(blue, red);
}

#[test]
fn presets_lists_and_writes_what_the_folder_holds() {
    let said = stdout(lab().arg("presets"));
    let folder = tempfile::tempdir().unwrap();
    stdout(lab().args(["presets", "--out"]).arg(folder.path()));
    for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("presets")).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            assert!(said.contains(path.file_stem().unwrap().to_str().unwrap()), "{}", path.display());
            let written = std::fs::read(folder.path().join(path.file_name().unwrap())).unwrap();
            assert_eq!(written, std::fs::read(&path).unwrap());
        }
    }
    let again = stdout(lab().args(["presets", "--out"]).arg(folder.path()));
    assert!(again.lines().all(|line| line.ends_with("kept")), "{again}");
    stdout(lab().args(["cells", "from-file", "--iterations", "0"]).current_dir(folder.path()));
}

#[test]
fn wrong_arguments_and_files_are_refused_in_one_line() {
    refused(&["run", "no-such.ron"], &["no-such.ron", "no such file"]);
    refused(&["run", "mixed", "--scheme", "casaded"], &["casaded", "cascaded"]);
    refused(&["run", "mixed", "--factor", "nan"], &["factor", "finite"]);
    refused(&["run", "mixed", "--coarsest", "3"], &["coarsest", "power of two"]);
    refused(&["run", "mixed", "--level", "6"], &["--level 6", "0 to 5"]);
    refused(&["run", "mixed", "--slice", "z=32"], &["z=32", "0 to 31"]);
    refused(&["run", "mixed", "--slice", "w=3"], &["--slice", "z=16"]);
    refused(&["run", "mixed", "--factor", "-3"], &["propagation.factor", "-3", "zero or more"]);
    refused(&["run", "mixed", "--factor", "3,5"], &["--factor", "write 3.5"]);
    refused(&["run", "mixed", "--cascade-side", "8"], &["--cascade-side", "--descent cascades"]);
    refused(
        &["run", "mixed", "--descent", "cascades", "--leaf-distance", "3"],
        &["--leaf-distance", "--descent leaves"],
    );
    refused(
        &["run", "mixed", "--descent", "cascades", "--cascade-side", "12"],
        &["descent.side", "12", "power of two"],
    );
    refused(&["octree", "--cascade-side", "4"], &["--cascade-side", "power of two", "from 8"]);
    refused(&["compare", "mixed", "--factor", "-3"], &["propagation.factor", "-3", "zero or more"]);
    refused(&["stability", "mixed", "--factor", "-3"], &["propagation.factor", "-3", "zero or more"]);
    refused(&["run", "mixed", "--iterations", "-1"], &["--iterations", "-1", "whole number"]);
    refused(&["run"], &["PRESET", "--help"]);
    refused(&["run", "mixed", "--itrations", "3"], &["--itrations", "did you mean `--iterations`", "--help"]);
    refused(&["runn"], &["no command `runn`", "did you mean `run`"]);
    refused(&["runn", "mixed"], &["no command `runn`", "did you mean `run`"]);
    refused(&["compair", "mixed"], &["no command `compair`", "did you mean `compare`"]);
    refused(&["one-lob"], &["one-lob", "no built-in preset", "did you mean `one-lobe`"]);
    refused(&["run", "one-lob"], &["one-lob", "no built-in preset", "did you mean `one-lobe`"]);
    refused(&["cells", "mixed", "--out", "cells.txt"], &["cells.txt", ".csv or .npy"]);

    let folder = tempfile::tempdir().unwrap();
    let preset = folder.path().join("wrong.ron");
    let path = preset.to_str().unwrap();
    std::fs::write(&preset, "(\n    version: 1,\n    sise: 32,\n)").unwrap();
    refused(&["run", path], &["wrong.ron:3:5", "sise", "size"]);
    std::fs::write(&preset, "(\n    version: 1,\n    injectors: [(kind: File(path: \"gone.csv\"))],\n)").unwrap();
    refused(&["run", path], &["wrong.ron:3:", "gone.csv"]);
}

#[test]
fn every_command_shows_an_example() {
    let help = stdout(lab().arg("--help"));
    let commands = help.lines().skip_while(|line| !line.starts_with("Commands:")).skip(1);
    let names: Vec<&str> =
        commands.map_while(|line| line.split_whitespace().next()).filter(|name| *name != "help").collect();
    assert!(names.contains(&"run") && names.contains(&"cells"), "{names:?}");
    for name in names {
        let help = stdout(lab().args([name, "--help"]));
        assert!(help.contains("Example"), "{name}");
    }
    let completions = stdout(lab().args(["completions", "bash"]));
    assert!(completions.contains("--iterations"));
}
