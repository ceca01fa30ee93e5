//! Settings outlast the window, and whatever stands in their place the window opens and loses nothing.

use std::fs;
use std::path::Path;
use std::process::Command;

use egui::Key;
use egui_kittest::kittest::Queryable;
use lpv_lab::app::{Home, Settings};

use crate::driver::*;

/// The two files that are read at the start.
const FILES: [&str; 2] = ["settings.ron", "app.ron"];

/// Puts something at a path.
type Make = Box<dyn Fn(&Path)>;

fn keep(harness: &mut Window) {
    harness.state_mut().as_mut().expect("a window").keep_settings();
}

/// What a file would be read as: its bytes, or what it is.
fn content(path: &Path) -> String {
    let data = path.symlink_metadata().unwrap();
    if data.is_file() && data.len() < 1 << 20 {
        return String::from_utf8_lossy(&fs::read(path).unwrap()).into_owned();
    }
    format!("{:?} {}", data.file_type(), data.len())
}

#[test]
fn settings_are_there_at_the_next_start() {
    let folder = tempfile::tempdir().unwrap();
    let home = folder.path().join("not/there/yet");
    let mut harness = window_in(&home, SMALL);
    set_number(&mut harness, "Memory for the past", 77.0);
    click(&mut harness, "3D");
    keep(&mut harness);
    let expected = lab(&harness).settings().clone();
    assert_eq!(expected.past_mib, 77);
    assert_eq!(lab(&window_in(&home, SMALL)).settings(), &expected);
}

#[test]
fn what_cannot_be_read_is_put_aside_and_told_of_in_a_line() {
    let text = |bytes: &'static [u8]| Box::new(move |path: &Path| fs::write(path, bytes).unwrap());
    let mut hostile: Vec<(&str, Make)> = vec![
        ("truncated", text(b"(view: (stage: Grids, ")),
        ("no RON", text(b"\0\0\0\0")),
        ("another type", text(b"[1, 2]")),
        ("no text", text(b"(pace: \xff\xfe)")),
        ("empty", text(b"")),
        ("nested", Box::new(|path| fs::write(path, "(view: ".repeat(100_000)).unwrap())),
        ("huge", Box::new(|path| fs::File::create(path).and_then(|file| file.set_len(1 << 40)).unwrap())),
        ("folder", Box::new(|path| fs::create_dir(path).unwrap())),
    ];
    if cfg!(unix) {
        let pipe = |path: &Path| assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
        hostile.push(("pipe", Box::new(pipe)));
    }
    for (what, make) in hostile {
        for file in FILES {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(file);
            make(&path);
            let before = content(&path);
            let mut harness = window_in(folder.path(), SMALL);
            let (home, _) = Home::open(folder.path());
            assert!(home.complaints().is_empty(), "it is told once: {what}");
            harness.get_by_label_contains(&format!("{file}.unreadable-1"));
            assert_eq!(lab(&harness).iteration(), 0, "{what}");
            set_number(&mut harness, "Memory for the past", 77.0);
            keep(&mut harness);
            let aside = folder.path().join(format!("{file}.unreadable-1"));
            assert_eq!(content(&aside), before, "{what}");
            assert_eq!(Home::open(folder.path()).1.past_mib, 77, "{what}");
        }
    }
}

#[test]
fn each_complaint_is_one_line_that_names_the_file() {
    let folder = tempfile::tempdir().unwrap();
    for round in 1..=2 {
        for file in FILES {
            fs::write(folder.path().join(file), "(pace: \"fast\n\")").unwrap();
        }
        let (home, settings) = Home::open(folder.path());
        assert_eq!((settings, home.complaints().len()), (Settings::default(), 2));
        for (line, file) in home.complaints().iter().zip(FILES) {
            assert_eq!(line.lines().count(), 1, "{line}");
            assert!(
                line.contains(&format!("{file}:")) && line.contains(&format!("{file}.unreadable-{round}")),
                "{line}"
            );
        }
    }
}

#[cfg(unix)]
#[test]
fn settings_without_permission_are_told_of_and_never_written_over() {
    use std::os::unix::fs::PermissionsExt;
    crate::unprivileged::check("settings::settings_without_permission_are_told_of_and_never_written_over", || {
        let mode = |path: &Path, mode| fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
        // The file is locked; the folder may not be changed, either; the folder is locked.
        for (of_file, of_folder) in [(0o000, 0o700), (0o000, 0o500), (0o600, 0o000)] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("settings.ron");
            fs::write(&path, "(past_mib: 77)").unwrap();
            mode(&path, of_file);
            mode(folder.path(), of_folder);
            let mut harness = window_in(folder.path(), SMALL);
            harness.get_by_label_contains("permission denied");
            assert_eq!(lab(&harness).settings().past_mib, Settings::default().past_mib);
            set_number(&mut harness, "Memory for the past", 78.0);
            keep(&mut harness);
            mode(folder.path(), 0o700);
            let kept = if of_folder == 0o700 { folder.path().join("settings.ron.unreadable-1") } else { path };
            mode(&kept, 0o600);
            assert_eq!(fs::read_to_string(kept).unwrap(), "(past_mib: 77)");
        }
    });
}

#[test]
fn numbers_beyond_reason_do_not_break_the_window() {
    let most = usize::MAX;
    for number in ["NaN", "inf", "-1.0", "0.0", "1e38"] {
        let folder = tempfile::tempdir().unwrap();
        let text = format!(
            "(pace: {number}, past_mib: {most}, recent: [\"\\u{{0}}\\n\"], \
             view: (stage: Compare, layer: Level({most}), across: {most}, index: {most}, fit: false, full: {number}, \
             decades: {number}, paint: {most}, hue: {most}), \
             plots: (level: Some({most}), metric: \"\", line: (at: Some({most})), format: (own: (4294967295, 0))))"
        );
        fs::write(folder.path().join("settings.ron"), text).unwrap();
        let mut harness = window_in(folder.path(), SMALL);
        assert!(harness.query_by_label_contains("unreadable").is_none(), "{number}");
        click(&mut harness, "Run all");
        for key in [Key::PageUp, Key::Plus, Key::F2, Key::F4, Key::F7, Key::F8, Key::L, Key::Minus, Key::F6] {
            harness.key_press(key);
            settle(&mut harness);
        }
        assert_eq!(lab(&harness).iteration(), 5);
    }
}
