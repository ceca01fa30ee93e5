//! The window, driven by the names of its controls, without a display.
#![cfg(feature = "app")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod branches;
mod canvas;
mod compare;
mod driver;
mod drops;
mod exports;
mod fields;
mod palette;
mod picture;
mod plots;
mod recovery;
mod settings;
mod study;
mod timeline;
#[cfg(unix)]
#[path = "../unprivileged/mod.rs"]
mod unprivileged;

use driver::*;
use egui_kittest::kittest::{NodeT, Queryable};
use lpv_lab::app::{Layer, Light};
use lpv_lab::scene::Preset;
use lpv_lab::study::expectation::Expectation;

#[test]
fn a_new_window_shows_the_injected_light() {
    let harness = window(SMALL);
    let lab = lab(&harness);
    assert_eq!(lab.iteration(), 0);
    assert_eq!(lab.shown().iter().map(|shown| shown.pane.light).collect::<Vec<_>>(), Light::ALL);
    // The slice is cut where the light is.
    assert_eq!(lab.settings().view.index, 4);
    assert!((red(lab, 0, [4, 4]) - std::f32::consts::PI.sqrt() / 2.0).abs() < 1e-6);
    assert_eq!(red(lab, 1, [4, 4]), 0.0);
}

#[test]
fn every_step_has_its_button_and_its_key() {
    let mut harness = window(SMALL);
    for (name, iteration) in [("Propagate", 1), ("Propagate", 2), ("Merge", 2)] {
        click(&mut harness, name);
        assert_eq!(lab(&harness).iteration(), iteration, "{name}");
    }
    harness.key_press(egui::Key::Space);
    settle(&mut harness);
    assert_eq!(lab(&harness).iteration(), 3);
    harness.key_press(egui::Key::R);
    settle(&mut harness);
    assert_eq!(lab(&harness).iteration(), 5);
    click(&mut harness, "Clear");
    assert_eq!(lab(&harness).iteration(), 0);
    assert_eq!(red(lab(&harness), 2, [4, 4]), 0.0);
    click(&mut harness, "Inject");
    assert!(red(lab(&harness), 0, [4, 4]) > 0.0);
}

#[test]
fn errors_are_told_for_every_iteration() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    let lab = lab(&harness);
    let rows = lab.curves()[0].rows.iter().filter(|row| row.level.is_none() && row.expectation == Expectation::Thesis);
    let of_all: Vec<usize> = rows.map(|row| row.iteration).collect();
    assert_eq!(of_all, [0, 1, 2, 3, 4, 5]);
}

#[test]
fn levels_and_axes_are_chosen_by_name() {
    let mut harness = window(SMALL);
    harness.get_by_label("Level").click();
    harness.run_steps(3);
    click(&mut harness, "Level 1");
    assert_eq!(lab(&harness).settings().view.layer, Layer::Level(1));
    assert_eq!(lab(&harness).shown()[0].slice.cells.len(), 16);
    click(&mut harness, "Cut across x");
    assert_eq!(lab(&harness).shown()[0].slice.plane.axis.across(), 0);
}

#[test]
fn a_preset_is_opened_by_its_path_and_a_wrong_one_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.ron");
    std::fs::write(&path, "(version: 1, title: \"Other\", size: 4, injectors: [(kind: Wall(side: NegX))])").unwrap();
    let mut harness = window(SMALL);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::O);
    answer(&mut harness, &path, "Open");
    assert_eq!(lab(&harness).preset().title, "Other");
    assert_eq!(lab(&harness).shown()[0].slice.side, 4);
    assert_eq!(lab(&harness).settings().recent, std::slice::from_ref(&path));

    std::fs::write(&path, "(version: 1, size: 4,\n  injector: [])").unwrap();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::O);
    answer(&mut harness, &path, "Open");
    assert_eq!(lab(&harness).preset().title, "Other");
    let told = harness.get_by_label_contains("other.ron:2:");
    let told = told.accesskit_node();
    assert!(told.value().or(told.label()).is_some_and(|line| line.contains("injectors")));
}

#[test]
fn an_injector_is_added_and_the_results_go_stale_until_run_again() {
    let mut harness = window(SMALL);
    click(&mut harness, "Propagate");
    click(&mut harness, "Add wall");
    assert_eq!(lab(&harness).preset().injectors.len(), 2);
    assert!(lab(&harness).is_stale());
    let before = red(lab(&harness), 2, [0, 0]);
    click(&mut harness, "Run again");
    assert!(!lab(&harness).is_stale());
    assert_eq!(lab(&harness).iteration(), 1);
    assert!(red(lab(&harness), 2, [0, 0]) > before);
    click(&mut harness, "Delete injector 1");
    assert_eq!(lab(&harness).preset().injectors.len(), 1);
}

#[test]
fn edits_are_undone_and_redone() {
    let mut harness = window(SMALL);
    click(&mut harness, "Add single cell");
    harness.run_steps(6);
    set_number(&mut harness, "Factor p", 3.5);
    harness.run_steps(6);
    click(&mut harness, "Undo");
    assert_eq!((lab(&harness).preset().propagation.factor, lab(&harness).preset().injectors.len()), (3.0, 2));
    click(&mut harness, "Undo");
    assert_eq!(lab(&harness).preset().injectors.len(), 1);
    click(&mut harness, "Redo");
    click(&mut harness, "Redo");
    assert_eq!((lab(&harness).preset().propagation.factor, lab(&harness).preset().injectors.len()), (3.5, 2));
}

#[test]
fn the_past_is_scrubbed_and_gone_on_from() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    let last = red(lab(&harness), 2, [5, 4]);
    set_number(&mut harness, "Iteration shown", 2.0);
    assert_eq!((lab(&harness).seen(), lab(&harness).iteration()), (2, 5));
    assert!(lab(&harness).shown().iter().all(|shown| shown.iteration == 2));
    let then = red(lab(&harness), 2, [5, 4]);
    assert!(then < last);
    harness.key_press(egui::Key::End);
    settle(&mut harness);
    assert_eq!(red(lab(&harness), 2, [5, 4]), last);
    for _ in 0..3 {
        harness.key_press(egui::Key::ArrowLeft);
        settle(&mut harness);
    }
    click(&mut harness, "Go on from here");
    assert_eq!(lab(&harness).iteration(), 2);
    assert_eq!(lab(&harness).curves()[0].rows.iter().map(|row| row.iteration).max(), Some(2));
    for _ in 0..3 {
        click(&mut harness, "Propagate");
    }
    assert_eq!(red(lab(&harness), 2, [5, 4]), last);
}

#[test]
fn a_scheme_is_chosen_by_its_name() {
    let mut harness = window(SMALL);
    choose(&mut harness, "Scheme", "axial");
    assert_eq!(lab(&harness).preset().propagation.scheme, "axial");
    click(&mut harness, "Run all");
    assert_eq!(lab(&harness).curves()[0].name, "axial, p = 3");
}

#[test]
fn curves_and_pictures_are_exported_and_hold_the_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    for (entry, file) in [
        ("Curves as CSV…", "curves.csv"),
        ("Plots as SVG…", "plots.svg"),
        ("Plots as PNG…", "plots.png"),
        ("Grids as SVG or PNG…", "grids.svg"),
    ] {
        menu(&mut harness, &["File", entry]);
        answer(&mut harness, &folder.path().join(file), "Save to file");
    }
    let rows: Vec<csv::StringRecord> =
        csv::Reader::from_path(folder.path().join("curves.csv")).unwrap().into_records().map(Result::unwrap).collect();
    let known = &lab(&harness).curves()[0].rows;
    assert_eq!(rows.len(), known.len());
    for (row, known) in rows.iter().zip(known) {
        assert_eq!(row[0].parse::<usize>().unwrap(), known.iteration);
        assert_eq!(row[3].parse::<f64>().unwrap(), known.absolute_mean);
        assert_eq!(row[6].parse::<f64>().unwrap(), known.relative_max);
    }
    for file in ["plots.svg", "grids.svg"] {
        let text = std::fs::read_to_string(folder.path().join(file)).unwrap();
        resvg::usvg::Tree::from_str(&text, &resvg::usvg::Options::default()).unwrap();
    }
    let png = resvg::tiny_skia::Pixmap::load_png(folder.path().join("plots.png")).unwrap();
    assert!(png.width() > 800 && png.height() > 500);
}

#[test]
fn nothing_unsaved_is_lost_without_a_question() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window(SMALL);
    click(&mut harness, "Add wall");
    menu(&mut harness, &["File", "Built-in presets", "mixed"]);
    assert_eq!(lab(&harness).preset().title, "Small");
    click(&mut harness, "Cancel");
    assert_eq!(lab(&harness).preset().injectors.len(), 2);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
    let path = folder.path().join("mine.ron");
    answer(&mut harness, &path, "Save to file");
    assert_eq!(&Preset::load(&path).unwrap(), lab(&harness).preset());
    menu(&mut harness, &["File", "Built-in presets", "mixed"]);
    assert_eq!(lab(&harness).preset().size, 32);
}

#[test]
fn a_cell_is_pinned_by_a_click_and_keeps_its_course() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    let view = harness.get_by_label_contains("View: Accumulated").rect();
    // The cell (4, 4) of eight, from below.
    let cell = view.left_bottom() + egui::vec2(4.5, -4.5) * view.width() / 8.0;
    harness.hover_at(cell);
    harness.run_steps(2);
    harness.get_by_label_contains("(4, 4, 4), level 0");
    harness.drag_at(cell);
    harness.drop_at(cell);
    settle(&mut harness);
    harness.remove_cursor();
    settle(&mut harness);
    harness.get_by_label_contains("Pinned (4, 4, 4), level 0");
}

#[test]
fn the_light_is_shown_in_space() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    click(&mut harness, "3D");
    harness.get_by_label("View: the light in space");
    let strongest = lab(&harness).cloud().unwrap().strongest;
    set_number(&mut harness, "Threshold", 0.5);
    let cloud = lab(&harness).cloud().unwrap();
    assert!(cloud.cells.iter().all(|cell| cell.light[0].0[0].abs() >= 0.5 * strongest));
    assert!(!cloud.cells.is_empty());
}

#[test]
fn a_run_is_stopped_and_the_window_is_not_held_up() {
    let mut harness =
        window("(version: 1, size: 32, injectors: [(kind: Wall(side: NegX))], propagation: (iterations: 100000))");
    harness.key_press(egui::Key::R);
    for _ in 0..4000 {
        harness.step();
        if lab(&harness).iteration() > 2 {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    harness.key_press(egui::Key::Escape);
    settle(&mut harness);
    assert!(lab(&harness).iteration() > 2 && lab(&harness).iteration() < 100_000);
}

#[test]
fn kept_curves_stay_beside_those_of_the_next_run() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    click(&mut harness, "Keep curves");
    set_number(&mut harness, "Factor p", 2.0);
    click(&mut harness, "Run all");
    let curves: Vec<_> = lab(&harness).curves().into_iter().map(|run| (run.name.clone(), run.rows.clone())).collect();
    assert_eq!(
        curves.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
        ["cascaded, p = 2", "cascaded, p = 3"]
    );
    assert_ne!(curves[0].1, curves[1].1);
}
