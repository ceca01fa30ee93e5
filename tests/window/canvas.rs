//! Objects on the views: tools add them, handles change them.

use egui_kittest::kittest::Queryable;
use lpv_lab::scene::injector::InjectorKind;
use lpv_lab::scene::occluder::OccluderKind;

use crate::driver::*;

/// Where the middle of a finest cell of eight is on screen, in the view of accumulated light.
fn cell(harness: &Window, column: f32, row: f32) -> egui::Pos2 {
    let view = harness.get_by_label_contains("View: Accumulated").rect();
    view.left_bottom() + egui::vec2(column + 0.5, -row - 0.5) * view.width() / 8.0
}

fn click_at(harness: &mut Window, at: egui::Pos2) {
    harness.hover_at(at);
    harness.drag_at(at);
    harness.drop_at(at);
    settle(harness);
}

/// Drags a handle of the view of accumulated light, the last of those with its name.
fn drag(harness: &mut Window, handle: &str, to: egui::Pos2) {
    let from = harness.get_all_by_label(handle).last().expect("a handle").rect().center();
    harness.hover_at(from);
    harness.drag_at(from);
    harness.hover_at(from.lerp(to, 0.5));
    harness.hover_at(to);
    harness.drop_at(to);
    settle(harness);
}

#[test]
fn lights_and_occluders_are_added_by_a_click_and_changed_by_their_handles() {
    let mut harness = window(SMALL);
    click(&mut harness, "Add light");
    let at = cell(&harness, 2.0, 6.0);
    click_at(&mut harness, at);
    assert_eq!(lab(&harness).preset().injectors[1].kind, InjectorKind::Single { cell: [2, 6, 4] });
    assert!(lab(&harness).is_stale());
    click(&mut harness, "Add occluder");
    let at = cell(&harness, 6.0, 1.0);
    click_at(&mut harness, at);
    let block = |harness: &Window| lab(harness).preset().occluders[0].kind.clone();
    assert_eq!(block(&harness), OccluderKind::Box { from: [6, 1, 4], to: [6, 1, 4] });

    let to = cell(&harness, 7.0, 3.0);
    drag(&mut harness, "Size of occluder 1", to);
    assert_eq!(block(&harness), OccluderKind::Box { from: [6, 1, 4], to: [7, 3, 4] });

    click(&mut harness, "Select");
    let at = cell(&harness, 2.0, 6.0);
    click_at(&mut harness, at);
    let to = cell(&harness, 2.0, 3.0);
    drag(&mut harness, "Direction of injector 2", to);
    assert_eq!(lab(&harness).preset().injectors[1].direction, Some([0.0, -1.0, 0.0]));
    let to = cell(&harness, 5.0, 5.0);
    drag(&mut harness, "Position of injector 2", to);
    assert_eq!(lab(&harness).preset().injectors[1].kind, InjectorKind::Single { cell: [5, 5, 4] });
}

#[test]
fn the_line_is_laid_through_a_cell() {
    let mut harness = window(SMALL);
    click(&mut harness, "Run all");
    click(&mut harness, "Probe");
    let at = cell(&harness, 3.0, 6.0);
    click_at(&mut harness, at);
    let course = lab(&harness).course().unwrap();
    assert_eq!(course.curves[1].1[3][1] as f32, red(lab(&harness), 2, [3, 6]));
}

#[test]
fn small_volumes_run_again_after_every_edit_unless_that_is_switched_off() {
    let folder = tempfile::tempdir().unwrap();
    let mut harness = window_in(folder.path(), SMALL);
    click(&mut harness, "Propagate");
    let before = red(lab(&harness), 2, [0, 0]);
    click(&mut harness, "Add wall");
    settle(&mut harness);
    assert!(!lab(&harness).is_stale() && red(lab(&harness), 2, [0, 0]) > before);
    click(&mut harness, "Run again after every edit");
    click(&mut harness, "Delete injector 2");
    assert!(lab(&harness).is_stale());
}

#[test]
fn a_rectangle_of_light_and_a_block_are_dragged_out() {
    let mut harness = window(SMALL);
    let drag_out = |harness: &mut Window, from: egui::Pos2, to: egui::Pos2| {
        harness.hover_at(from);
        harness.drag_at(from);
        harness.hover_at(from.lerp(to, 0.5));
        harness.hover_at(to);
        harness.run_steps(2);
        harness.drop_at(to);
        settle(harness);
    };
    click(&mut harness, "Add light");
    let [from, to] = [cell(&harness, 5.0, 6.0), cell(&harness, 1.0, 2.0)];
    drag_out(&mut harness, from, to);
    let rectangle = InjectorKind::Rectangle { from: [1, 2, 4], to: [5, 6, 4] };
    assert_eq!(lab(&harness).preset().injectors[1].kind, rectangle);
    click(&mut harness, "Add occluder");
    // Beyond the view's edge its last cells are meant.
    let [from, to] = [cell(&harness, 6.0, 1.0), cell(&harness, 7.0, -3.0)];
    drag_out(&mut harness, from, to);
    let block = OccluderKind::Box { from: [6, 0, 4], to: [7, 1, 4] };
    assert_eq!(lab(&harness).preset().occluders.iter().map(|one| &one.kind).collect::<Vec<_>>(), [&block]);
    assert_eq!(lab(&harness).preset().injectors.len(), 2);
}

#[test]
fn the_steps_of_an_iteration_are_told_between_the_views_and_doubts_at_the_foot() {
    let mut harness = window(SMALL);
    harness.get_by_label_contains("Source to target: ");
    harness.get_by_label_contains("Plus accumulated: ");
    assert!(harness.query_by_label_contains("⚠").is_none());
    click(&mut harness, "Delete injector 1");
    click(&mut harness, "Run again");
    harness.get_by_label_contains("there is no light");
}
