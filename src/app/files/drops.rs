//! Files of cells that become part of the scene: chosen, or dropped onto the window.

use std::path::{Path, PathBuf};

use egui::Context;

use crate::app::lab::Lab;
use crate::app::panels::closing::Next;
use crate::app::panels::controls::occluder;
use crate::scene::cell_file::Column;
use crate::scene::injector::{Injector, InjectorKind};
use crate::scene::occluder::OccluderKind;

impl Lab {
    /// Takes what was dropped onto the window: a preset is opened, a file of cells becomes an injector.
    pub(in crate::app) fn drop_files(&mut self, ctx: &Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        for file in dropped {
            let path = file.path();
            match path.extension().and_then(|ending| ending.to_str()) {
                Some("ron") => self.ask_to_lose(Next::Open(path.to_path_buf()), ctx),
                Some("csv" | "npy") => self.injector_file(self.document.preset.injectors.len(), path),
                _ => self.fail(format!("{}: drop a preset (.ron) or a file of cells (.csv, .npy)", path.display())),
            }
        }
    }

    /// Makes a file the `i`-th injector's, or a new one's.
    pub(in crate::app) fn injector_file(&mut self, i: usize, path: &Path) {
        let Some(path) = self.beside_the_preset(path) else { return };
        let injectors = &mut self.document.preset.injectors;
        let kind = InjectorKind::File { path, column: Column::default() };
        match injectors.get_mut(i) {
            // A file brings its own directions.
            Some(injector) => (injector.kind, injector.direction) = (kind, None),
            None => injectors.push(Injector::new(kind)),
        }
    }

    /// Makes a file the `i`-th occluder's, or a new one's.
    pub(in crate::app) fn occluder_file(&mut self, i: usize, path: &Path) {
        let Some(path) = self.beside_the_preset(path) else { return };
        let occluders = &mut self.document.preset.occluders;
        let kind = OccluderKind::File { path };
        match occluders.get_mut(i) {
            Some(occluder) => occluder.kind = kind,
            None => occluders.push(occluder(kind)),
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
