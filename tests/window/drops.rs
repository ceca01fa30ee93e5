//! Files dropped onto the window.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui_kittest::kittest::Queryable;
use lpv_lab::scene::injector::InjectorKind;

use crate::driver::*;

/// A file in the hand.
#[derive(Debug)]
struct Held(PathBuf);

impl egui::DroppedFile for Held {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Lets go of a file over the window.
fn drop_file(harness: &mut Window, path: &Path) {
    harness.input_mut().dropped_files.push(Arc::new(Held(path.to_path_buf())));
    settle(harness);
}

#[test]
fn a_preset_that_is_dropped_is_opened_unless_edits_would_be_lost() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dropped.ron");
    std::fs::write(&path, "(version: 1, title: \"Dropped\", size: 4, injectors: [(kind: Wall(side: NegX))])").unwrap();
    let mut harness = window(SMALL);
    drop_file(&mut harness, &path);
    assert_eq!(lab(&harness).preset().title, "Dropped");
    assert_eq!(lab(&harness).shown()[0].slice.side, 4);

    click(&mut harness, "Add wall");
    std::fs::write(&path, SMALL).unwrap();
    drop_file(&mut harness, &path);
    assert_eq!(lab(&harness).preset().title, "Dropped");
    click(&mut harness, "Discard changes");
    assert_eq!(lab(&harness).preset().title, "Small");
}

#[test]
fn a_cell_file_that_is_dropped_becomes_an_injector() {
    let folder = tempfile::tempdir().unwrap();
    let preset = folder.path().join("preset.ron");
    std::fs::write(&preset, SMALL).unwrap();
    let cells = folder.path().join("cells.csv");
    std::fs::write(&cells, "x,y,z,c0,c1,c2,c3\n2,3,4,0.5,0,0,0\n").unwrap();
    let mut harness = window(SMALL);
    drop_file(&mut harness, &preset);
    drop_file(&mut harness, &cells);
    let kind = lab(&harness).preset().injectors[1].kind.clone();
    assert!(matches!(&kind, InjectorKind::File { path, .. } if path == Path::new("cells.csv")), "{kind:?}");
    click(&mut harness, "Run again");
    assert_eq!(red(lab(&harness), 0, [2, 3]), 0.5);
}

#[test]
fn what_is_no_scene_is_refused_and_said_what_would_be_right() {
    let mut harness = window(SMALL);
    drop_file(&mut harness, Path::new("holiday.jpg"));
    harness.get_by_label_contains("holiday.jpg: drop a preset (.ron), a file of cells (.csv, .npy) or a mesh");
    assert_eq!(lab(&harness).preset().title, "Small");
}
