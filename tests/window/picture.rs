//! The Picture workspace: what a camera sees, its truth and how they differ.

use egui::Key;
use egui_kittest::kittest::Queryable;

use crate::driver::*;

/// The Cornell box in few cells; the camera looks straight along +z, past the boxes.
const CORNELL: &str = "(version: 1, title: \"Box\", size: 8, propagation: (iterations: 2), scene: (\
                       mesh: \"scenes/cornell.obj\", shadow_map: 16, \
                       lights: [(kind: Point(position: (0.278, 0.5, 0.2795)), intensity: (1, 1, 1))], \
                       camera: (from: (0.1, 0.45, -0.8), to: (0.1, 0.45, 0), fov: 30)))";

/// A window on the box, with its picture in 64 × 64 pixels and the truth at rest.
fn picture() -> Window {
    let mut harness = window(CORNELL);
    // No key yet: a picture of the usual size would take a while.
    harness.get_by_label("Picture workspace").click();
    harness.run_steps(2);
    harness.get_by_label("Refine the truth").click();
    harness.run_steps(2);
    choose(&mut harness, "Pixels of the picture", "64 × 64");
    choose(&mut harness, "Paths of the truth", "up to 64 paths");
    click(&mut harness, "Refine the truth");
    harness
}

#[test]
fn without_a_mesh_it_says_what_is_missing_and_how_to_add_it() {
    let mut harness = window(SMALL);
    harness.key_press(Key::Num3);
    settle(&mut harness);
    harness.get_by_label_contains("This preset has no mesh");
    harness.get_by_label("Open a mesh…").click();
    harness.run_steps(3);
    harness.get_by_label_contains("A mesh: .obj, .gltf or .glb");
}

#[test]
fn picture_truth_difference_and_numbers_are_side_by_side() {
    let mut harness = picture();
    for view in ["Truth", "Picture A", "Difference A", "FLIP A"] {
        harness.get_by_label(&format!("View: {view}"));
    }
    harness.get_by_label_contains("one bounce, 64 paths a pixel, ±");
    harness.get_by_label_contains(" · done");
    for number in ["FLIP", "RMSE", "relMSE", "mean ratio", "    fitted"] {
        harness.get_by_label(number);
    }
    click(&mut harness, "Add propagator or reference");
    click(&mut harness, "Run again");
    harness.get_by_label("View: Picture B");
    harness.get_by_label("View: FLIP B");
}

#[test]
fn two_of_them_lie_under_a_bar() {
    let mut harness = picture();
    harness.key_press(Key::S);
    settle(&mut harness);
    harness.get_by_label("View: Truth | Picture A");
    harness.get_by_label("Split bar");
    assert!(harness.query_by_label("View: Difference A").is_none());
    choose(&mut harness, "Right of the bar", "FLIP A");
    harness.get_by_label("View: Truth | FLIP A");
}

#[test]
fn a_click_pins_the_cell_that_the_pixel_shows() {
    let mut harness = picture();
    click(&mut harness, "View: Picture A");
    click(&mut harness, "Light workspace");
    // The ray along z at (0.1, 0.45) m meets the back wall at z = 0.5592 m. The volume has its side of 0.5592 m around
    // the box's middle (0.278, 0.2744, 0.2796) m: cells of 0.0699 m, the first from (−0.0016, −0.0052, 0) m.
    harness.get_by_label_contains("Pinned (1, 6, 7), level 0");
}

#[test]
fn the_camera_makes_no_run_stale() {
    let mut harness = picture();
    harness.get_by_label("Camera").click();
    harness.run_steps(3);
    set_number(&mut harness, "Camera field of view", 35.0);
    assert_eq!(lab(&harness).preset().scene.as_ref().unwrap().camera.unwrap().fov, 35.0);
    assert!(!lab(&harness).is_stale());
}

#[test]
fn all_of_them_are_saved_as_one_sheet() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sheet.png");
    let mut harness = picture();
    click(&mut harness, "Pictures as sheet…");
    answer(&mut harness, &path, "Save to file");
    let sheet = image::open(&path).unwrap();
    // Four pictures of 64 pixels, each three times as large, with room of 16 around them.
    assert_eq!(sheet.width(), 16 + 4 * (192 + 16));
}
