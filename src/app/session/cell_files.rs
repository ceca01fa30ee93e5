//! Files of cells and meshes that become part of the scene: chosen, or dropped onto the window.

use std::path::{Path, PathBuf};

use super::Session;
use crate::scene::cell_file::{self, Column};
use crate::scene::injector::{Injector, InjectorKind};
use crate::scene::mesh_scene::MeshScene;
use crate::scene::occluder::{Occluder, OccluderKind};

/// An opaque black occluder.
pub fn opaque(kind: OccluderKind) -> Occluder {
    Occluder { kind, normal: None, opacity: 1.0, albedo: [0.0; 3], enabled: true }
}

impl Session {
    /// Makes a file the `i`-th injector's, or a new one's.
    pub fn injector_file(&mut self, i: usize, path: &Path) {
        let Some(path) = self.beside_the_preset(path) else { return };
        // Of a file that holds two lights, the one that .npy files hold.
        let two = cell_file::holds_two(&self.document.folder().join(&path));
        let column = two.then_some(Column::Accumulated);
        let injectors = &mut self.document.preset.injectors;
        let kind = InjectorKind::File { path, column };
        match injectors.get_mut(i) {
            // A file brings its own directions.
            Some(injector) => (injector.kind, injector.direction) = (kind, None),
            None => injectors.push(Injector::new(kind)),
        }
    }

    /// Makes a file the `i`-th occluder's, or a new one's.
    pub fn occluder_file(&mut self, i: usize, path: &Path) {
        let Some(path) = self.beside_the_preset(path) else { return };
        let occluders = &mut self.document.preset.occluders;
        let kind = OccluderKind::File { path };
        match occluders.get_mut(i) {
            Some(occluder) => occluder.kind = kind,
            None => occluders.push(opaque(kind)),
        }
    }

    /// Makes a file the scene's mesh; lights and camera of the mesh before it stay.
    pub fn mesh_file(&mut self, path: &Path) {
        let Some(path) = self.beside_the_preset(path) else { return };
        match &mut self.document.preset.scene {
            Some(scene) => scene.mesh = path,
            none => *none = Some(MeshScene::new(path)),
        }
    }

    /// A file's path from the preset's folder; one that lies elsewhere is refused.
    fn beside_the_preset(&mut self, path: &Path) -> Option<PathBuf> {
        if path.is_relative() {
            return Some(path.to_path_buf());
        }
        let folder = self.document.folder();
        let whole = |path: &Path| std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder.as_path() };
        let inside = whole(path).strip_prefix(whole(here)).map(Path::to_path_buf).ok();
        if inside.is_none() {
            let what = "lies outside the preset's folder; save the preset beside it, then choose it again";
            self.fail(format!("{}: {what}", path.display()));
        }
        inside
    }
}
