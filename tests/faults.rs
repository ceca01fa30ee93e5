//! Faults while saving: programs that are killed and programs that save at the same time. Whatever happens, the
//! file is one that somebody meant to save, whole.
//!
//! The program that is killed is this test program itself: [`saver`] does nothing unless a variable names
//! the file that it is to save again and again.
#![allow(clippy::expect_used)]

#[cfg(unix)]
mod unprivileged;

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, SystemTime};

use lpv_lab::scene::Preset;
use lpv_lab::scene::injector::{Injector, InjectorKind};
use lpv_lab::system::random::Random;

/// Names the preset that [`saver`] saves.
const FILE: &str = "LPV_LAB_TEST_SAVES_TO";
/// Names the version that it begins with.
const FIRST: &str = "LPV_LAB_TEST_SAVES_FIRST";
const KILLS: usize = 200;

/// A preset large enough that writing it takes a while; every version has its own title and length.
fn version(number: usize) -> Preset {
    let injector = |i: usize| Injector {
        multiplier: number as f64,
        ..Injector::new(InjectorKind::Single { cell: [i % 32, 1, 2] })
    };
    let injectors = (0..2000 + 100 * (number % 7)).map(injector).collect();
    Preset { title: format!("version {number}"), injectors, ..Preset::default() }
}

/// Checks that a file holds a version, whole.
fn check(path: &Path) {
    let preset = Preset::load(path).unwrap_or_else(|error| panic!("{error}"));
    let number = preset.title.strip_prefix("version ").and_then(|number| number.parse().ok());
    assert!(preset == version(number.expect("a version's title")), "{} is a mixture", preset.title);
}

/// Saves versions until it is killed.
#[test]
fn saver() {
    let (Some(file), Ok(first)) = (std::env::var_os(FILE), std::env::var(FIRST)) else { return };
    for number in first.parse().expect("a number").. {
        version(number).save(Path::new(&file)).expect("saved");
    }
}

fn start_saver(file: &Path, first: usize) -> Child {
    let program = std::env::current_exe().expect("this program");
    let mut command = Command::new(program);
    command.args(["--exact", "saver"]).env(FILE, file).env(FIRST, first.to_string());
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("started")
}

fn kill(mut saver: Child) {
    assert!(saver.try_wait().expect("known").is_none(), "the saver must be alive until it is killed");
    saver.kill().expect("killed");
    saver.wait().expect("ended");
}

/// The files beside a preset that were never finished.
fn unfinished(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    entries.filter(|path| path.extension().is_some_and(|extension| extension == "new")).collect()
}

#[test]
fn two_hundred_kills_during_a_save_lose_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("preset.ron");
    version(0).save(&file).expect("saved");
    let mut random = Random::new(6);
    let mut versions = std::collections::BTreeSet::new();
    for i in 0..KILLS {
        let saver = start_saver(&file, 1000 * i);
        thread::sleep(Duration::from_micros(2000 + random.below(20_000) as u64));
        kill(saver);
        check(&file);
        versions.insert(Preset::load(&file).expect("good").title);
    }
    // Kills that hit nothing would prove nothing: some savers must have got through, some not.
    let left = unfinished(folder.path());
    println!(
        "{KILLS} kills, {} of them in the middle of a save; {} versions seen, none lost",
        left.len(),
        versions.len()
    );
    assert!(!left.is_empty() && versions.len() > 1);
    let old = SystemTime::now() - Duration::from_secs(3600);
    for path in &left {
        fs::File::options().write(true).open(path).and_then(|file| file.set_modified(old)).expect("set back");
    }
    version(1).save(&file).expect("saved");
    assert_eq!(unfinished(folder.path()), Vec::<std::path::PathBuf>::new(), "the next save clears up");
    check(&file);
}

#[test]
fn two_programs_that_save_one_preset_leave_it_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("preset.ron");
    version(0).save(&file).expect("saved");
    let savers = [start_saver(&file, 0), start_saver(&file, 1_000_000)];
    for _ in 0..100 {
        thread::sleep(Duration::from_millis(5));
        check(&file);
    }
    savers.into_iter().for_each(kill);
    check(&file);
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_keeps_the_old_file_and_says_so() {
    use std::os::unix::fs::PermissionsExt;
    unprivileged::check("a_folder_that_cannot_be_written_keeps_the_old_file_and_says_so", || {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("preset.ron");
        version(3).save(&file).expect("saved");
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o500)).expect("changeable");
        let line = version(4).save(&file).expect_err("no permission").to_string();
        assert!(line.contains("cannot be saved: permission denied"), "{line}");
        assert_eq!(Preset::load(&file).expect("whole").title, "version 3");
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o700)).expect("changeable");
    });
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_fails_the_run_in_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let csv = folder.path().join("full.csv");
    std::os::unix::fs::symlink("/dev/full", &csv).expect("a link");
    let mut lab = assert_cmd::Command::cargo_bin("lpv-lab").expect("the program");
    let output = lab.args(["cells", "one-lobe", "--iterations", "1", "--out"]).arg(&csv).assert().code(1);
    let said = String::from_utf8_lossy(&output.get_output().stderr).into_owned();
    assert!(said.lines().count() == 1 && said.contains("cannot be saved: the disk is full"), "{said}");
}
