//! Files and arguments made to break the program: each ends with exit code 2 and one line that names the place and the
//! remedy, within seconds and within a gibibyte of memory.
#![allow(clippy::expect_used)]

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::Duration;

use assert_cmd::Command;
use lpv_lab::scene::Preset;
use lpv_lab::scene::{Problem, cell_file};
use lpv_lab::simulation::{Refusal, Simulation};
use lpv_lab::system::memory;
use tempfile::TempDir;

/// Far above what any of these may take, far below for ever.
const PATIENCE: Duration = Duration::from_secs(60);
/// The memory that a refusal may take, in KiB as the shell counts.
const MEMORY: &str = "1048576";

/// Runs the program with limited memory.
fn lab<A: AsRef<OsStr>>(args: impl IntoIterator<Item = A>) -> Output {
    let program = assert_cmd::cargo::cargo_bin("lpv-lab");
    let mut command = if cfg!(target_os = "linux") {
        let mut shell = Command::new("sh");
        shell.args(["-c", &format!("ulimit -v {MEMORY}; exec \"$0\" \"$@\"")]).arg(program);
        shell
    } else {
        Command::new(program)
    };
    command.args(args).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").timeout(PATIENCE);
    command.output().expect("started")
}

/// Checks that the program refuses these arguments in one line with all of `words`.
fn refused<A: AsRef<OsStr>>(args: impl IntoIterator<Item = A>, words: &[&str]) {
    let output = lab(args);
    let said = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.lines().count() == 1 && said.starts_with("lpv-lab: ") && said.len() < 1000, "{said}");
    assert!(words.iter().all(|word| said.contains(word)), "{said}\n  lacks one of {words:?}");
}

/// A folder in which the preset `p.ron` of side 8 reads `name`, as light or as an occluder.
fn with_file(name: &str, make: impl FnOnce(&Path)) -> (TempDir, [PathBuf; 2]) {
    let folder = tempfile::tempdir().expect("a folder");
    make(&folder.path().join(name));
    let presets = ["injectors", "occluders"].map(|list| {
        let path = folder.path().join(format!("{list}.ron"));
        let text = format!("(version: 1, size: 8, {list}: [\n (kind: File(path: \"{name}\"))])");
        fs::write(&path, text).expect("writable");
        path
    });
    (folder, presets)
}

fn cells(preset: &Path) -> [&OsStr; 4] {
    [OsStr::new("cells"), preset.as_os_str(), OsStr::new("--iterations"), OsStr::new("1")]
}

/// Writes `bytes`.
fn content(bytes: &[u8]) -> impl Fn(&Path) + '_ {
    move |path| fs::write(path, bytes).expect("writable")
}

/// A file that claims `length` bytes, begins with `start` and takes no room.
fn sparse(start: &[u8], length: u64) -> impl Fn(&Path) + '_ {
    move |path| {
        fs::write(path, start).expect("writable");
        fs::File::options().write(true).open(path).and_then(|file| file.set_len(length)).expect("a sparse file");
    }
}

#[test]
fn presets_that_are_no_presets_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let preset = folder.path().join("p.ron");
    let utf16: Vec<u8> = "(version: 1)".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let nested = "(version: 1, injectors: [".to_owned() + &"[".repeat(1_000_000);
    let long = format!("(version: 1, title: \"{}\")", "x".repeat(5 << 20));
    let cases: [(&[u8], &[&str]); 9] = [
        (b"", &["p.ron:1:1", "no preset"]),
        (b"\0\0\0\0", &["p.ron:"]),
        (b"\x7fELF\x02\x01\x01\0\xff\xfe", &["UTF-8"]),
        (&utf16, &["p.ron:"]),
        (nested.as_bytes(), &["p.ron:1:"]),
        (long.as_bytes(), &["too many", "4194304"]),
        (b"(version: 1, size: 18446744073709551616)", &["p.ron:1:"]),
        (b"(version: 1, injectors: [(kind: Wall(side: NegX), multiplier: 1e31)])", &["multiplier", "1e30"]),
        (b"(version: 1, injectors: [(kind: Wall(side: NegX), color: (0, NaN, 0))])", &["colour", "finite"]),
    ];
    for (bytes, words) in cases {
        content(bytes)(&preset);
        refused(cells(&preset), words);
    }
    sparse(b"(version: 1)", 1 << 42)(&preset);
    refused(cells(&preset), &["4398046511104 bytes are too many"]);
    refused(cells(folder.path()), &["this is a folder"]);
    refused(cells(Path::new("")), &["PRESET"]);
    refused(cells(Path::new("/dev/zero")), &["a pipe or a device"]);
}

#[test]
fn every_beginning_of_a_good_preset_is_refused_or_read() {
    let text = include_str!("../presets/from-file.ron");
    let mut refused = 0;
    for end in 0..text.len() {
        if let Some(Err(error)) = text.get(..end).map(|start| Preset::parse(start, Path::new("p.ron"))) {
            let line = error.to_string();
            assert!(line.starts_with("p.ron:") && line.lines().count() == 1 && line.contains("; "), "{line}");
            refused += 1;
        }
    }
    assert!(refused > text.len() / 2);
}

#[test]
fn cell_files_that_lie_are_refused() {
    let header = |claims: u32| [&b"\x93NUMPY\x02\x00"[..], &claims.to_le_bytes(), b"{'descr': '<f4', "].concat();
    let shape = |dictionary: &str| [b"\x93NUMPY\x01\x00\x76\x00", format!("{dictionary:118}").as_bytes()].concat();
    let eight = "{'descr': '<f4', 'fortran_order': False, 'shape': (8, 8, 8, 4), }";
    let csv = b"x,y,z,c0,c1,c2,c3\n";
    let twice = [&csv[..], b"1,1,1,1,0,0,0\n1,1,1,2,0,0,0\n"].concat();
    let nan = [&csv[..], b"1,1,1,NaN,0,0,0\n"].concat();
    let light: [(&str, Vec<u8>, u64, &[&str]); 9] = [
        ("a.npy", header(u32::MAX), 100, &["a.npy", "claims 4294967295 bytes"]),
        ("a.npy", shape(&eight.replace("(8, 8, 8, 4)", "(65536, 65536, 4)")), 128, &["shape is", "(8, 8, 8, 4)"]),
        ("a.npy", shape(eight), 128, &["128 bytes", "promises 8320"]),
        ("a.npy", shape(eight), 1 << 40, &["too many"]),
        ("a.npy", shape(&eight.replace("<f4", "<i8")), 8320, &["float32"]),
        ("a.csv", csv.to_vec(), 1 << 40, &["too many"]),
        ("a.csv", csv.to_vec(), 100_000, &["a.csv:2: ", "longer than 1024 bytes"]),
        ("a.csv", twice, 0, &["a.csv:3: ", "in line 2 already"]),
        ("a.csv", nan, 0, &["a.csv:2: ", "no finite number"]),
    ];
    for (name, start, length, words) in light {
        let length = length.max(start.len() as u64);
        let (_folder, [injected, _]) = with_file(name, sparse(&start, length));
        refused(cells(&injected), words);
    }
    let occluders: [(&[u8], &[&str]); 4] = [
        (b"x,y,z\n8,0,0\n", &["a.csv:2: ", "x is `8`"]),
        (b"x,y,z,opacity\n1,0,0,inf\n", &["a.csv:2: ", "opacity"]),
        (b"x,y,z\n1,0,0\n1,0,0\n", &["a.csv:3: ", "in line 2 already"]),
        (b"\xff\xfe\n", &["a.csv:1: ", "UTF-8"]),
    ];
    for (bytes, words) in occluders {
        let (_folder, [_, occluding]) = with_file("a.csv", content(bytes));
        refused(cells(&occluding), words);
    }
}

#[cfg(unix)]
#[test]
fn what_is_no_file_is_refused_and_never_waited_for() {
    let pipe = |path: &Path| {
        let made = std::process::Command::new("mkfifo").arg(path).status().expect("mkfifo");
        assert!(made.success());
    };
    let device = |path: &Path| std::os::unix::fs::symlink("/dev/zero", path).expect("a link");
    let itself = |path: &Path| std::os::unix::fs::symlink(path, path).expect("a link");
    let folder = |path: &Path| fs::create_dir(path).expect("a folder");
    let check = |make: &dyn Fn(&Path), word| {
        let (_folder, presets) = with_file("a.csv", make);
        for preset in presets {
            refused(cells(&preset), &[word, ".ron:2:"]);
        }
    };
    check(&pipe, "a pipe or a device");
    check(&device, "a pipe or a device");
    check(&itself, "a.csv");
    check(&folder, "this is a folder");
    let (_folder, [outside, _]) = with_file("../a.csv", |_| ());
    refused(cells(&outside), &["out of the preset's folder"]);
}

#[test]
fn arguments_beyond_reason_are_refused() {
    let too_large = "99999999999999999999";
    for (args, words) in [
        (["--iterations", too_large], ["--iterations", too_large]),
        (["--iterations", "2000000"], ["2000000", "at most 1000000"]),
        (["--iterations", "-1"], ["--iterations", "-1"]),
        (["--factor", "1e400"], ["inf", "finite"]),
        (["--factor", "-0.5"], ["factor", "-0.5"]),
        (["--coarsest", "0"], ["coarsest", "power of two"]),
        (["--level", too_large], ["level", "merged"]),
        (["--scheme", "\u{1b}[2J"], ["scheme", "cascaded"]),
    ] {
        let [option, value] = args;
        refused(["cells", "one-lobe", &format!("{option}={value}")], &words);
    }
    refused(["stability", "--sizes", "1024"], &["1024", "2 to 64"]);
    refused(["stability", "--sizes", "3"], &["power of two"]);
}

#[cfg(unix)]
#[test]
fn a_path_that_is_no_text_is_refused() {
    use std::os::unix::ffi::OsStrExt;
    refused(cells(Path::new(OsStr::from_bytes(b"\xff\xfe\n.ron"))), &["no such file"]);
}

#[test]
fn more_light_than_memory_is_refused_before_it_is_allocated() {
    let preset = Preset::parse("(version: 1, size: 1024)", Path::new("p.ron")).expect("a preset");
    let problem = Problem::build(&preset, Path::new("")).expect("a scene");
    let free = memory::free();
    match Simulation::<f64>::new(problem) {
        Err(Refusal::Memory { size: 1024, needed, free, largest }) => {
            assert!(needed > free && needed > 100 << 30 && largest < 1024);
            let line = Refusal::Memory { size: 1024, needed, free, largest }.to_string();
            assert!(line.contains("GiB") && line.contains(&format!("fits is {largest}")), "{line}");
        }
        // A machine that does not tell, or one that has it all.
        other => assert!(free.is_none_or(|free| free > 100 << 30), "{other:?}"),
    }
}

#[test]
fn extreme_light_runs_to_its_end_or_is_stopped_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let preset = folder.path().join("p.ron");
    let walls = ["NegX", "PosX", "NegY", "PosY", "NegZ", "PosZ"];
    for multiplier in ["1e-30", "1e-45", "0", "1e30"] {
        let injectors = walls.map(|side| format!("(kind: Wall(side: {side}), multiplier: {multiplier}),")).concat();
        for (size, factor) in [(1, "3"), (2, "9.5"), (8, "4"), (8, "1e30"), (8, "1e300"), (4, "0")] {
            let text = format!(
                "(version: 1, size: {size}, injectors: [{injectors}], propagation: (factor: {factor}, iterations: 40))"
            );
            fs::write(&preset, text).expect("writable");
            let out = folder.path().join("cells.npy");
            let args = [OsStr::new("cells"), preset.as_os_str(), OsStr::new("--out"), out.as_os_str()];
            let output = lab(args);
            let said = String::from_utf8_lossy(&output.stderr);
            match output.status.code() {
                // The reader refuses what is not finite.
                Some(0) => drop(cell_file::read(&out, size, None).expect("finite light")),
                // Dark scenes are doubted first.
                Some(1) => {
                    let lines = said.lines().filter(|line| !line.starts_with("lpv-lab: warning: ")).count();
                    assert!(said.contains("diverges") && lines == 1, "{said}");
                }
                other => panic!("{other:?}: {said}"),
            }
        }
    }
}
