//! The presets that the program brings along, so that it can show something wherever it is started.

use std::io;
use std::path::PathBuf;

use crate::system::file::write_whole;

macro_rules! presets {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../presets/", $name, ".ron")))),*]
    };
}

macro_rules! files_beside {
    ($($path:literal),* $(,)?) => {
        &[$(($path, include_str!(concat!("../../presets/", $path)))),*]
    };
}

/// Every built-in preset: its name and its text. The first is the one the program opens by itself.
pub const PRESETS: &[(&str, &str)] = presets![
    "two-walls",
    "mixed",
    "one-lobe",
    "opposite-lobes",
    "corner-lobe",
    "level-jump",
    "back-bleeding",
    "colours",
    "from-file",
    "thin-wall-bleeding",
    "wall-with-gap",
    "pillar",
    "room-with-window",
    "mirrored-room",
    "cornell",
    "cube-room",
    "room-with-windows",
    "atrium",
    "descent",
    "nested-cascades",
    "moving-lobe",
];

/// Files beside the presets that some of them read, by their path from the presets' folder.
const BESIDE: &[(&str, &str)] = files_beside![
    "cells/ring.csv",
    "scenes/atrium.mtl",
    "scenes/atrium.obj",
    "scenes/cornell.mtl",
    "scenes/cornell.obj",
    "scenes/cube-room.mtl",
    "scenes/cube-room.obj",
    "scenes/room-with-windows.mtl",
    "scenes/room-with-windows.obj",
];

/// The text of the built-in preset called `name`.
pub fn find(name: &str) -> Option<&'static str> {
    PRESETS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// A folder that holds the files which built-in presets read. It is made when first asked for, among the
/// system's temporary files.
///
/// # Errors
/// Where they cannot be written.
pub fn folder() -> io::Result<PathBuf> {
    folder_with(|_| true)
}

/// The same, with the files that the preset `text` names: most name none, and need no place to put them.
///
/// # Errors
/// Where they cannot be written.
pub fn folder_of(text: &str) -> io::Result<PathBuf> {
    // A mesh names its library of materials, which the preset does not.
    folder_with(|path| text.contains(path) || text.contains(&path.replace(".mtl", ".obj")))
}

fn folder_with(needed: impl Fn(&str) -> bool) -> io::Result<PathBuf> {
    let folder = std::env::temp_dir().join(concat!("lpv-lab-presets-", env!("CARGO_PKG_VERSION")));
    for (path, content) in BESIDE.iter().filter(|(path, _)| needed(path)) {
        let path = folder.join(path);
        if std::fs::read_to_string(&path).is_ok_and(|there| there == *content) {
            continue;
        }
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent)?;
        }
        // Whole or not at all: other programs of the lab may be reading it.
        write_whole(&path, content.as_bytes()).map_err(io::Error::other)?;
    }
    Ok(folder)
}

/// Every file that belongs to the presets, by its path from their folder, with its text.
pub fn files() -> impl Iterator<Item = (String, &'static str)> {
    let presets = PRESETS.iter().map(|(name, text)| (format!("{name}.ron"), *text));
    presets.chain(BESIDE.iter().map(|(path, text)| ((*path).to_owned(), *text)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::preset::Preset;
    use std::path::Path;

    #[test]
    fn every_preset_of_the_folder_is_built_in_loads_and_says_what_to_look_for() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets");
        let mut in_folder: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter_map(|name| name.strip_suffix(".ron").map(str::to_owned))
            .collect();
        in_folder.sort();
        let mut built_in: Vec<String> = PRESETS.iter().map(|(name, _)| (*name).to_owned()).collect();
        built_in.sort();
        assert_eq!(built_in, in_folder);
        for (name, text) in PRESETS {
            let preset = Preset::parse(text, Path::new(name)).unwrap();
            assert!(!preset.title.is_empty() && text.starts_with("// "), "{name}");
        }
    }
}
