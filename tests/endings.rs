//! How commands end when the world does not play along: nobody reads what they say, the disk is full, they are killed
//! or asked to stop, another one writes to the same folder. No panic, no torn file, one line that says what happened.
#![cfg(unix)]
#![allow(clippy::expect_used)]

use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::Duration;

use lpv_lab::system::random::Random;

const KILLS: usize = 50;

/// A volume that takes a moment.
const SMALL: &str = "(version: 1, size: 8, injectors: [(kind: Wall(side: NegX))], propagation: (iterations: 2))";

/// A folder with the preset `small.ron`, in which the program is started.
struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("small.ron"), SMALL).expect("writable");
        Place(folder)
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn lab(&self, args: &str) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("lpv-lab"));
        command.args(args.split_whitespace()).current_dir(self.0.path());
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").stdin(Stdio::null());
        command
    }

    /// The same under limits of the shell's.
    fn limited(&self, limits: &str, args: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", &format!("{limits}; exec \"$0\" \"$@\"")]).arg(assert_cmd::cargo::cargo_bin("lpv-lab"));
        command.args(args.split_whitespace()).current_dir(self.0.path());
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").stdin(Stdio::null());
        command
    }
}

/// Commands that print, with the files that they must have written.
const PRINT: [(&str, &[&str]); 9] = [
    ("run small.ron --out r", &["r/errors.csv", "r/errors.png", "r/merged.svg", "r/summary.ron"]),
    ("compare small.ron --schemes cascaded --out r", &["r/compare.csv"]),
    ("stability --sizes 2 --side 2 --iterations 20 --scenes 2 --out r", &["r/critical.csv", "r/drift.png"]),
    ("bench --only-converged --converged 8 --rounds 1 --out r", &["r/converged.csv"]),
    ("cells small.ron", &[]),
    ("schemes --long", &[]),
    ("presets --out r", &["r/two-walls.ron", "r/cells/ring.csv"]),
    ("completions bash", &[]),
    ("run --help", &[]),
];

/// Commands that write files.
const WRITE: [&str; 6] = [
    "run small.ron --out r",
    "compare small.ron --schemes cascaded --out r",
    "stability --sizes 2 --side 2 --iterations 20 --scenes 1 --out r",
    "cells small.ron --out r/cells.csv",
    "cells small.ron --out r/cells.npy",
    "presets --out r",
];

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_reader_that_goes_away_ends_the_talking_and_not_the_work() {
    for (args, files) in PRINT {
        let place = Place::new();
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = place.lab(args).stdout(writer).stderr(Stdio::piped()).output().expect("started");
        assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""), "{args}");
        files.iter().for_each(|file| check_whole(&place.at(file)));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_written_fails_in_one_line_after_the_work() {
    for (args, files) in PRINT {
        let place = Place::new();
        let full = || File::options().write(true).open("/dev/full").expect("the full device");
        let output = place.lab(args).stdout(full()).stderr(Stdio::piped()).output().expect("started");
        let said = stderr(&output);
        assert_eq!((output.status.code(), said.lines().count()), (Some(1), 1), "{args}: {said}");
        assert!(said.starts_with("lpv-lab: cannot write to standard output"), "{args}: {said}");
        files.iter().for_each(|file| check_whole(&place.at(file)));
        // Nobody can be told anything then, but the exit code is the same.
        let silent = Place::new().lab(args).stdout(full()).stderr(full()).status().expect("started");
        assert_eq!(silent.code(), Some(1), "{args}");
    }
}

/// Checks that a file which some command writes has its end.
fn check_whole(path: &Path) {
    let bytes = fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let whole = match path.extension().and_then(|e| e.to_str()) {
        Some("png") => bytes.ends_with(b"IEND\xaeB`\x82"),
        Some("svg") => bytes.ends_with(b"</svg>\n"),
        Some("ron") => bytes.trim_ascii().ends_with(b")"),
        Some("csv") => {
            let mut reader = csv::Reader::from_reader(&bytes[..]);
            bytes.ends_with(b"\n") && reader.records().all(|record| record.is_ok())
        }
        Some("obj" | "mtl") => bytes.ends_with(b"\n"),
        Some("npy") => bytes.len() == 128 + 8 * 8 * 8 * 4 * 4,
        other => panic!("{other:?}"),
    };
    assert!(whole, "{} is torn", path.display());
}

/// The files in a folder and the folders in it, without hidden ones.
fn files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let visible = entries.flatten().filter(|entry| !entry.file_name().as_encoded_bytes().starts_with(b"."));
    visible.flat_map(|entry| if entry.path().is_dir() { files(&entry.path()) } else { vec![entry.path()] }).collect()
}

/// Everything beside those: what a program left behind.
fn hidden(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let names = entries.flatten().filter_map(|entry| entry.file_name().into_string().ok());
    names.filter(|name| name.starts_with('.') && name != ".lpv-lab").collect()
}

/// A limit on the length of files stands for a disk that fills up: writes fail in their middle.
#[test]
fn a_disk_that_fills_up_leaves_whole_files_and_one_line() {
    let mut failed = 0;
    for args in WRITE {
        for blocks in [0, 1, 4, 16] {
            let place = Place::new();
            fs::create_dir(place.at("r")).expect("a folder");
            let output = place.limited(&format!("trap '' XFSZ; ulimit -f {blocks}"), args).output().expect("started");
            let said = stderr(&output);
            match output.status.code() {
                Some(0) => assert_eq!(said, "", "{args}"),
                Some(1) => {
                    failed += 1;
                    assert!(said.lines().count() == 1 && said.contains("no file may be that long here"), "{said}");
                }
                other => panic!("{args}, {blocks} blocks: {other:?} {said}"),
            }
            files(&place.at("r")).iter().for_each(|file| check_whole(file));
            assert_eq!(hidden(&place.at("r")), Vec::<String>::new(), "{args}");
        }
    }
    assert!(failed >= 2 * WRITE.len(), "{failed} of them ran out of space");
}

#[test]
fn fifty_kills_of_every_command_tear_nothing() {
    thread::scope(|scope| {
        for (i, args) in WRITE.into_iter().enumerate() {
            scope.spawn(move || {
                let place = Place::new();
                fs::create_dir(place.at("r")).expect("a folder");
                let begun = std::time::Instant::now();
                assert!(place.lab(args).stdout(Stdio::null()).status().expect("started").success());
                let whole = begun.elapsed().as_micros() as usize;
                let mut random = Random::new(i as u64);
                for _ in 0..KILLS {
                    let mut child =
                        place.lab(args).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("started");
                    thread::sleep(Duration::from_micros(random.below(whole) as u64));
                    // It may have ended already.
                    let _ = child.kill();
                    child.wait().expect("ended");
                    files(&place.at("r")).iter().for_each(|file| check_whole(file));
                }
                let output = place.lab(args).output().expect("started");
                assert!(output.status.success(), "{args}: {}", stderr(&output));
                files(&place.at("r")).iter().for_each(|file| check_whole(file));
            });
        }
    });
}

/// A run that would take hours, once it has finished two iterations.
fn long_run(place: &Place, args: &str) -> Child {
    let mut child = place.lab(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("started");
    let mut lines = BufReader::new(child.stdout.take().expect("its output"));
    for _ in 0..4 {
        lines.read_line(&mut String::new()).expect("a line");
    }
    // Its further lines go nowhere, and that must not matter.
    child
}

fn interrupt(child: &Child) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(sent.success());
}

#[test]
fn ctrl_c_keeps_the_curves_so_far_and_says_so() {
    let place = Place::new();
    let run = long_run(&place, "run small.ron --iterations 1000000 --out r");
    interrupt(&run);
    let output = run.wait_with_output().expect("ended");
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("interrupted after iteration") && said.contains("of 1000000"), "{said}");
    let last = said.split("iteration ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a number").to_owned();
    let mut errors = csv::Reader::from_path(place.at("r/errors.csv")).expect("curves");
    let iterations: Vec<String> = errors.records().map(|record| record.expect("a row")[0].to_owned()).collect();
    assert_eq!(iterations.last(), Some(&last));
    files(&place.at("r")).iter().for_each(|file| check_whole(file));
}

#[test]
fn a_second_run_into_a_folder_is_told_and_harms_nothing() {
    let place = Place::new();
    let first = long_run(&place, "run small.ron --iterations 1000000 --out r");
    let output = place.lab("compare small.ron --schemes cascaded --out r").output().expect("started");
    let said = stderr(&output);
    assert_eq!((output.status.code(), said.lines().count()), (Some(1), 1), "{said}");
    assert!(said.contains("r: another run is writing here"), "{said}");
    interrupt(&first);
    assert_eq!(first.wait_with_output().expect("ended").status.code(), Some(130));
    let output = place.lab("compare small.ron --schemes cascaded --out r").output().expect("started");
    assert!(output.status.success(), "{}", stderr(&output));
    // One run's files: the other's are gone.
    assert_eq!(files(&place.at("r")), [place.at("r/compare.csv")]);
}

#[test]
fn results_of_before_this_run_are_named() {
    let place = Place::new();
    fs::create_dir(place.at("r")).expect("a folder");
    fs::write(place.at("r/level-3.csv"), "x\n").expect("writable");
    let output = place.lab("compare small.ron --schemes cascaded --out r").output().expect("started");
    assert!(stderr(&output).contains("also holds level-3.csv"), "{}", stderr(&output));
}

#[test]
fn presets_of_one_name_do_not_share_a_folder() {
    let place = Place::new();
    for folder in ["a", "b"] {
        fs::create_dir(place.at(folder)).expect("a folder");
        fs::write(place.at(folder).join("room.ron"), SMALL).expect("writable");
    }
    for (preset, folder) in [("a/room.ron", "room"), ("b/room.ron", "room-2"), ("a/../a/room.ron", "room")] {
        let output = place.lab(&format!("run {preset}")).output().expect("started");
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(said.lines().any(|line| line.ends_with(&format!("lpv-lab-results/{folder}"))), "{preset}: {said}");
    }
}

#[test]
fn a_folder_named_like_a_built_in_preset_does_not_hide_it() {
    let place = Place::new();
    fs::create_dir(place.at("one-lobe")).expect("a folder");
    let output = place.lab("cells one-lobe --iterations 0").output().expect("started");
    assert!(output.status.success(), "{}", stderr(&output));
}

#[test]
fn what_cannot_be_written_is_told_before_the_work() {
    let place = Place::new();
    fs::write(place.at("file"), "").expect("writable");
    for args in [
        "run small.ron --iterations 1000000 --out file",
        "run small.ron --iterations 1000000 --out file/r",
        "compare small.ron --iterations 1000000 --out file",
        "cells small.ron --iterations 1000000 --out no/such/folder/cells.csv",
        "stability --iterations 1000000 --out file",
        "bench --out file",
    ] {
        let output = place.lab(args).output().expect("started");
        let said = stderr(&output);
        assert_eq!((output.status.code(), said.lines().count()), (Some(1), 1), "{args}: {said}");
        assert!(said.contains("cannot"), "{args}: {said}");
        assert_eq!(output.stdout, b"", "{args}: nothing is worked on");
    }
}

/// From too little to start with to more than enough.
#[cfg(target_os = "linux")]
#[test]
fn limits_of_memory_end_in_one_line() {
    let place = Place::new();
    let text = SMALL.replace("size: 8", "size: 128");
    fs::write(place.at("large.ron"), text).expect("writable");
    let (mut done, mut refused) = (0, 0);
    for kibibytes in (64_000..=448_000).step_by(16_000) {
        for args in ["cells large.ron --out c.npy", "run small.ron --out r", "run large.ron --out r"] {
            let output = place.limited(&format!("ulimit -v {kibibytes}"), args).output().expect("started");
            let said = stderr(&output);
            match output.status.code() {
                Some(0) => done += 1,
                Some(1 | 2) => {
                    refused += 1;
                    assert!(said.lines().count() == 1 && said.contains("memory"), "{kibibytes} {args}: {said}");
                }
                other => panic!("{kibibytes} {args}: {other:?} {said}"),
            }
        }
    }
    assert!(done > 10 && refused > 10, "{done} done, {refused} refused");
}

/// The superuser may start as many threads as he likes, so the program is started as nobody.
#[cfg(target_os = "linux")]
#[test]
fn a_limit_of_threads_makes_it_slower_and_says_so() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    use std::os::unix::process::CommandExt;
    const NOBODY: u32 = 65534;
    let place = Place::new();
    // A copy, because the program may lie in a folder that nobody may enter.
    fs::copy(assert_cmd::cargo::cargo_bin("lpv-lab"), place.at("lab")).expect("copied");
    fs::set_permissions(place.0.path(), fs::Permissions::from_mode(0o777)).expect("changeable");
    let mut command = Command::new("bash");
    command.args(["-c", "ulimit -u 1; exec ./lab run small.ron --out r"]).current_dir(place.0.path());
    command.env("RAYON_NUM_THREADS", "3").env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    if fs::metadata(place.0.path()).expect("a folder").uid() == 0 {
        command.uid(NOBODY).gid(NOBODY);
    }
    let output = command.output().expect("started");
    let said = stderr(&output);
    assert_eq!((output.status.code(), said.lines().count()), (Some(0), 1), "{said}");
    assert!(said.contains("0 of 3 threads can be started"), "{said}");
    check_whole(&place.at("r/errors.csv"));
}
