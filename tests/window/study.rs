//! A port in the window: dumps dropped on the study, the verdict, the port's grid beside the right one.

use std::path::Path;
use std::sync::Arc;

use egui_kittest::kittest::Queryable;

use crate::driver::*;

/// A file in the hand.
#[derive(Debug)]
struct Held(std::path::PathBuf);

impl egui::DroppedFile for Held {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

fn drop_dump(harness: &mut Window, name: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/ports").join(name);
    harness.input_mut().dropped_files.push(Arc::new(Held(path)));
    settle(harness);
}

#[test]
fn dumps_that_are_dropped_are_looked_at() {
    let mut harness = window(SMALL);
    click(&mut harness, "Study workspace");
    for dump in ["h22_s0.npy", "h22_s1.npy", "h22_s2.npy", "h22_a4.npy"] {
        drop_dump(&mut harness, dump);
    }
    harness.get_by_label_contains("NOT RIGHT");
    assert!(harness.query_all_by_label_contains("in-place").count() >= 1);
    for view in ["As it should be", "The port's", "The difference"] {
        harness.get_by_label(&format!("View: {view}"));
    }
    click(&mut harness, "Open the corrected preset");
    assert_eq!(lab(&harness).preset().title, "Test pattern spaced8 for identify");
    assert!((lab(&harness).preset().propagation.factor - 3.0).abs() < 1e-3);
}
