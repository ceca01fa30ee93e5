//! Unsaved work survives whatever ends a window.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use egui_kittest::kittest::Queryable;

use crate::driver::*;

/// Names the folder in which [`victim`] keeps its unsaved work.
const FOLDER: &str = "LPV_LAB_TEST_KEEPS_IN";

/// What is kept of unsaved work in a folder.
fn kept(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path());
    entries.filter(|path| path.extension().is_some_and(|end| end == "ron")).collect()
}

/// Steps until `done`; disks may take their time.
fn until(harness: &mut Window, done: impl Fn() -> bool) {
    for _ in 0..5000 {
        harness.step();
        if done() {
            return;
        }
        sleep(Duration::from_millis(2));
    }
    panic!("it does not come about");
}

/// A window with an edit that was kept.
fn edited(folder: &Path) -> Window {
    let before = kept(folder).len();
    let mut harness = window_in(folder, SMALL);
    click(&mut harness, "Add wall");
    until(&mut harness, || kept(folder).len() == before + 1);
    harness
}

/// Edits and waits to be killed.
#[test]
fn victim() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let _harness = edited(Path::new(&folder));
    loop {
        sleep(Duration::from_secs(1));
    }
}

#[test]
fn work_of_a_killed_window_is_offered_and_recovered() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", "recovery::victim"]).env(FOLDER, folder.path());
    let mut victim = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while kept(folder.path()).is_empty() {
        assert!(victim.try_wait().unwrap().is_none(), "the window must live until it is killed");
        sleep(Duration::from_millis(5));
    }
    // As long as it lives its work is not for others.
    assert!(window_in(folder.path(), SMALL).query_by_label("Recover").is_none());
    victim.kill().unwrap();
    victim.wait().unwrap();

    let mut harness = window_in(folder.path(), "(version: 1, title: \"Other\", size: 4)");
    harness.get_by_label_contains("Unsaved changes of Small from less than a minute ago");
    assert!(window_in(folder.path(), SMALL).query_by_label("Recover").is_none(), "one window offers it");
    click(&mut harness, "Recover");
    assert_eq!((lab(&harness).preset().title.as_str(), lab(&harness).preset().injectors.len()), ("Small", 2));
    assert!(harness.query_by_label("Recover").is_none());
    assert_eq!(kept(folder.path()).len(), 1, "it is still not saved");

    let saves = tempfile::tempdir().unwrap();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
    answer(&mut harness, &saves.path().join("mine.ron"), "Save to file");
    assert_eq!(kept(folder.path()), Vec::<PathBuf>::new());
}

#[test]
fn edits_of_the_present_window_are_not_lost_to_a_recovery() {
    let folder = tempfile::tempdir().unwrap();
    drop(edited(folder.path()));
    let mut harness = edited(folder.path());
    click(&mut harness, "Recover");
    click(&mut harness, "Cancel");
    assert_eq!(kept(folder.path()).len(), 2);
    click(&mut harness, "Recover");
    click(&mut harness, "Discard changes");
    assert_eq!(kept(folder.path()).len(), 1);
    assert_eq!(lab(&harness).preset().injectors.len(), 2);
}

#[test]
fn what_is_discarded_is_gone() {
    let folder = tempfile::tempdir().unwrap();
    drop(edited(folder.path()));
    let mut harness = window_in(folder.path(), SMALL);
    click(&mut harness, "Discard");
    assert!(harness.query_by_label("Recover").is_none());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    assert_eq!(lab(&harness).preset().injectors.len(), 1);
}

#[test]
fn discarding_changes_gives_up_what_was_kept_of_them() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = edited(folder.path());
    menu(&mut harness, &["File", "Built-in presets", "mixed"]);
    click(&mut harness, "Discard changes");
    assert_eq!(kept(folder.path()), Vec::<PathBuf>::new());
    // Undoing everything leaves nothing unsaved, either.
    click(&mut harness, "Add wall");
    until(&mut harness, || !kept(folder.path()).is_empty());
    harness.run_steps(6);
    click(&mut harness, "Undo");
    assert_eq!(kept(folder.path()), Vec::<PathBuf>::new());
}

#[test]
fn work_that_cannot_be_read_is_told_of_and_blocks_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let at = |number: usize| folder.path().join(format!("unsaved-{number}-0.ron"));
    drop(edited(folder.path()));
    fs::write(at(1), "(name: \"x\", preset: (version: 1, ").unwrap();
    fs::write(at(2), b"\xff\xfe\0").unwrap();
    fs::write(at(3), "(name: \"x\", path: None, preset: (version: 99))").unwrap();
    fs::File::create(at(4)).and_then(|file| file.set_len(1 << 40)).unwrap();
    fs::create_dir(at(5)).unwrap();
    fs::write(at(6), "(name: \"x\", preset: ".to_owned() + &"(".repeat(1_000_000)).unwrap();
    let mut harness = window_in(folder.path(), SMALL);
    harness.get_by_label_contains("cannot be recovered");
    click(&mut harness, "Recover");
    assert_eq!(lab(&harness).preset().injectors.len(), 2);
    for number in 1..=6 {
        assert!(!at(number).exists());
        assert!(folder.path().join(format!("unsaved-{number}-0.ron.unreadable-1")).exists(), "{number}");
    }
}
