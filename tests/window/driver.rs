//! Drives a window by the names of its controls, without a display.

use std::path::Path;

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lpv_lab::app::{Home, Lab, Settings};
use lpv_lab::scene::Preset;

pub type Window = Harness<'static, Option<Lab>>;

/// A window on a preset, with its injected light on screen.
pub fn window(preset: &str) -> Window {
    // Edits wait until they are run, so that what is stale can be looked at.
    window_sized(preset, [1280.0, 720.0])
}

/// The same, so many points large.
pub fn window_sized(preset: &str, size: [f32; 2]) -> Window {
    start(preset, Settings { rerun: Some(false), ..Settings::default() }, None, size)
}

/// The same, with settings and unsaved work kept in `folder`.
pub fn window_in(folder: &Path, preset: &str) -> Window {
    let (home, settings) = Home::open(folder);
    start(preset, settings, Some(home), [1280.0, 720.0])
}

fn start(preset: &str, settings: Settings, mut home: Option<Home>, size: [f32; 2]) -> Window {
    let preset = Preset::parse(preset, Path::new("test")).unwrap();
    let mut harness = Harness::builder().with_size(size).with_max_steps(60).build_ui_state(
        move |ui, lab: &mut Option<Lab>| {
            let lab = lab.get_or_insert_with(|| {
                let mut lab = Lab::new(ui.ctx(), preset.clone(), None, settings.clone()).expect("a thread");
                home.take().into_iter().for_each(|home| lab.move_in(home));
                lab
            });
            lab.logic(&ui.ctx().clone());
            lab.ui(ui);
        },
        None,
    );
    settle(&mut harness);
    harness
}

pub fn lab(harness: &Window) -> &Lab {
    harness.state().as_ref().expect("a window")
}

/// Steps until nothing is being computed or waited for.
pub fn settle(harness: &mut Window) {
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

pub fn click(harness: &mut Window, name: &str) {
    harness.get_by_label(name).click();
    settle(harness);
}

pub const SMALL: &str = "(version: 1, title: \"Small\", size: 8, injectors: [(kind: Single(cell: (4, 4, 4)))], \
                     propagation: (iterations: 5))";

/// The light of a view at a finest cell, red.
pub fn red(lab: &Lab, pane: usize, at: [usize; 2]) -> f32 {
    lab.shown()[pane].slice.at(at).expect("a cell").light[0].0[0]
}

/// Sets a number field, or chooses a text for a text field.
pub fn set_number(harness: &mut Window, name: &str, value: f64) {
    harness.get_by_role_and_label(Role::SpinButton, name).set_value_accesskit(value);
    settle(harness);
}

/// Chooses from a list.
pub fn choose(harness: &mut Window, list: &str, entry: &str) {
    harness.get_by_role_and_label(Role::ComboBox, list).click();
    harness.run_steps(3);
    click(harness, entry);
}

/// Goes through a menu.
pub fn menu(harness: &mut Window, names: &[&str]) {
    for name in names {
        harness.get_by_label_contains(name).click();
        harness.run_steps(3);
    }
    settle(harness);
}

/// Types a path into the question for a file and confirms it.
pub fn answer(harness: &mut Window, path: &Path, confirm: &str) {
    harness.run_steps(2);
    let field = harness.get_by_role_and_label(Role::TextInput, "File");
    field.focus();
    field.set_text_value_accesskit("");
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::TextInput, "File").type_text(path.to_str().unwrap());
    harness.run_steps(2);
    // What the field had before would be written into the working directory.
    let typed = harness.get_by_role_and_label(Role::TextInput, "File").value();
    assert_eq!(typed.as_deref(), path.to_str());
    harness.get_by_role_and_label(Role::Button, confirm).click();
    settle(harness);
}
