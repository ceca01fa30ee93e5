//! Numbers that are typed, and windows that are small.

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;

use crate::driver::*;

/// Types over a number and leaves its field.
fn type_over(harness: &mut Window, field: &str, text: &str) {
    harness.get_by_role_and_label(Role::SpinButton, field).click();
    harness.run_steps(3);
    harness.input_mut().events.push(egui::Event::Text(text.to_owned()));
    harness.run_steps(2);
    harness.key_press(egui::Key::Enter);
    settle(harness);
}

#[test]
fn what_is_no_number_is_told_and_a_decimal_comma_is_read() {
    let mut harness = window(SMALL);
    type_over(&mut harness, "Factor p", "2,5");
    assert_eq!(lab(&harness).preset().propagation.factor, 2.5);
    assert!(harness.query_by_label_contains("is no number").is_none());
    type_over(&mut harness, "Factor p", "two");
    assert_eq!(lab(&harness).preset().propagation.factor, 2.5);
    harness.get_by_label_contains("“two” is no number");
}

#[test]
fn small_windows_fold_panels_to_strips_that_open() {
    let mut harness = window_sized(SMALL, [640.0, 400.0]);
    click(&mut harness, "Run all");
    assert_eq!(lab(&harness).iteration(), 5);
    assert!(harness.query_by_label("Factor p").is_none() && harness.query_by_label("L1 ratio").is_none());
    // The views have the room.
    let view = harness.get_by_label_contains("View: Accumulated").rect();
    assert!(view.width() > 60.0 && view.right() <= 640.0, "{view:?}");
    click(&mut harness, "Fold the scene");
    harness.get_by_role_and_label(Role::SpinButton, "Factor p");
    click(&mut harness, "Fold the plots");
    harness.get_by_label("L1 ratio");
}
