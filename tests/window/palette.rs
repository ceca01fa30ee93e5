//! The command palette and the gallery.

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;

use crate::driver::*;

/// Opens the palette, types and confirms.
fn find(harness: &mut Window, text: &str) {
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::P);
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::TextInput, "Command palette").type_text(text);
    harness.run_steps(2);
    harness.key_press(egui::Key::Enter);
    settle(harness);
}

#[test]
fn commands_presets_and_settings_are_found_by_a_few_letters() {
    let mut harness = window(SMALL);
    find(&mut harness, "run all");
    assert_eq!(lab(&harness).iteration(), 5);
    find(&mut harness, "scheme axi");
    assert_eq!(lab(&harness).preset().propagation.scheme, "axial");
    click(&mut harness, "Undo");
    find(&mut harness, "level 1");
    assert_eq!(lab(&harness).settings().view.layer, lpv_lab::app::Layer::Level(1));
    find(&mut harness, "preset one-lobe");
    assert_ne!(lab(&harness).preset().title, "Small");
    // What is typed is no shortcut.
    assert_eq!(lab(&harness).iteration(), 0);
}

#[test]
fn a_preset_is_opened_from_the_gallery_and_says_what_to_look_for() {
    let mut harness = window(SMALL);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::G);
    harness.run_steps(3);
    harness.get_by_label("Open level-jump").click();
    settle(&mut harness);
    harness.get_by_label_contains("the merged grid jumps from level 0 to level 3");
    click(&mut harness, "Dismiss what to look for");
    assert!(harness.query_by_label_contains("the merged grid jumps").is_none());
}
