//! The window, driven by the names of its controls, without a display.
#![cfg(feature = "app")]

use std::path::Path;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lpv_lab::app::{Lab, Layer, Light, Settings};
use lpv_lab::scene::Preset;

type Window = Harness<'static, Option<Lab>>;

/// A window on a preset, with its injected light on screen.
fn window(preset: &str) -> Window {
    let preset = Preset::parse(preset, Path::new("test")).unwrap();
    let mut harness = Harness::builder().with_size([1280.0, 720.0]).with_max_steps(60).build_ui_state(
        move |ui, lab: &mut Option<Lab>| {
            let lab = lab.get_or_insert_with(|| {
                Lab::new(ui.ctx(), preset.clone(), None, Settings::default()).expect("a thread")
            });
            lab.logic(&ui.ctx().clone());
            lab.ui(ui);
        },
        None,
    );
    settle(&mut harness);
    harness
}

fn lab(harness: &Window) -> &Lab {
    harness.state().as_ref().expect("a window")
}

/// Steps until nothing is being computed or waited for.
fn settle(harness: &mut Window) {
    for _ in 0..2000 {
        harness.step();
        if lab(harness).is_idle() {
            harness.run_steps(2);
            if lab(harness).is_idle() {
                return;
            }
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    panic!("the window does not come to rest");
}

fn click(harness: &mut Window, name: &str) {
    harness.get_by_label(name).click();
    settle(harness);
}

const SMALL: &str = "(version: 1, title: \"Small\", size: 8, injectors: [(kind: Single(cell: (4, 4, 4)))], \
                     propagation: (iterations: 5))";

/// The light of a view at a finest cell, red.
fn red(lab: &Lab, pane: usize, at: [usize; 2]) -> f32 {
    lab.shown()[pane].slice.at(at).expect("a cell").light[0].0[0]
}

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
    let of_all: Vec<usize> = lab.curves()[0].rows.iter().filter(|r| r.level.is_none()).map(|r| r.iteration).collect();
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
