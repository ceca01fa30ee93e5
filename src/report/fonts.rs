//! The fonts that text is drawn in: those that the lab brings along, so that a picture looks the same on every machine,
//! and for a character that they lack the first font of the system's that has it.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use epaint_default_fonts::{HACK_REGULAR, UBUNTU_LIGHT};
use resvg::usvg::FontResolver;
use resvg::usvg::fontdb::{Database, ID, Source};
use skrifa::{FontRef, MetadataProvider};

use crate::system::file::read_bytes;

/// The longest font file that is read, in bytes: one with all of Chinese, Japanese and Korean takes a third of it.
const LONGEST: u64 = 64 << 20;
/// The most font files that are looked into.
const MOST: usize = 4000;
/// How deep folders of fonts lie in each other.
const DEPTH: usize = 6;

/// The lab's own fonts.
pub fn own() -> Arc<Database> {
    static OWN: OnceLock<Arc<Database>> = OnceLock::new();
    let fonts = OWN.get_or_init(|| {
        let mut fonts = Database::new();
        fonts.load_font_data(UBUNTU_LIGHT.to_vec());
        fonts.load_font_data(HACK_REGULAR.to_vec());
        fonts.set_sans_serif_family("Ubuntu");
        Arc::new(fonts)
    });
    Arc::clone(fonts)
}

/// Finds fonts for characters: among those that are loaded, then among the system's.
pub fn resolver() -> FontResolver<'static> {
    let among_loaded = FontResolver::default_fallback_selector();
    FontResolver {
        select_fallback: Box::new(move |c, used, fonts| {
            among_loaded(c, used, fonts).or_else(|| load_for(c, fonts).filter(|id| !used.contains(id)))
        }),
        ..FontResolver::default()
    }
}

/// The bytes of a font file of the system's that has this character, if there is one.
pub fn of_system(c: char) -> Option<Arc<Vec<u8>>> {
    static READ: Mutex<Option<HashMap<PathBuf, Arc<Vec<u8>>>>> = Mutex::new(None);
    let file = files().iter().find(|file| file.has(c))?;
    let mut read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    let read = read.get_or_insert_default();
    if let Some(bytes) = read.get(&file.path) {
        return Some(Arc::clone(bytes));
    }
    let bytes = Arc::new(read_bytes(&file.path, LONGEST).ok()?);
    read.insert(file.path.clone(), Arc::clone(&bytes));
    Some(bytes)
}

fn load_for(c: char, fonts: &mut Arc<Database>) -> Option<ID> {
    let bytes = of_system(c)?;
    let faces = Arc::make_mut(fonts).load_font_source(Source::Binary(bytes));
    let has = |id: &ID| {
        let found = fonts.with_face_data(*id, |data, index| FontRef::from_index(data, index).ok()?.charmap().map(c));
        found.flatten().is_some()
    };
    faces.iter().copied().find(has)
}

/// A font file, and the characters that it has as ranges, both ends included.
struct FontFile {
    path: PathBuf,
    ranges: Vec<(u32, u32)>,
}

impl FontFile {
    fn has(&self, c: char) -> bool {
        let c = u32::from(c);
        let after = self.ranges.partition_point(|(first, _)| *first <= c);
        after > 0 && c <= self.ranges[after - 1].1
    }
}

/// The system's font files, plain faces first. They are looked into when the first character is missing.
fn files() -> &'static [FontFile] {
    static FILES: OnceLock<Vec<FontFile>> = OnceLock::new();
    FILES.get_or_init(|| {
        let mut paths = Vec::new();
        folders().iter().for_each(|folder| list(folder, DEPTH, &mut paths));
        // Among fonts that have a character, upright ones of usual weight and short names are the likeliest to be meant.
        paths.sort_by_key(|path| {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
            let special = ["bold", "italic", "oblique", "black", "thin", "extra", "condensed", "mono", "serif"];
            (special.iter().filter(|word| name.contains(**word)).count(), name.len(), path.clone())
        });
        paths.into_iter().filter_map(|path| Some(FontFile { ranges: characters(&path)?, path })).collect()
    })
}

/// Where systems keep fonts.
fn folders() -> Vec<PathBuf> {
    let fixed = ["/usr/share/fonts", "/usr/local/share/fonts", "/System/Library/Fonts", "/Library/Fonts"];
    let of_variable = [
        ("HOME", ".fonts"),
        ("HOME", ".local/share/fonts"),
        ("HOME", "Library/Fonts"),
        ("XDG_DATA_HOME", "fonts"),
        ("SYSTEMROOT", "Fonts"),
    ];
    let named =
        of_variable.into_iter().filter_map(|(name, inside)| Some(Path::new(&std::env::var_os(name)?).join(inside)));
    fixed.into_iter().map(PathBuf::from).chain(named).collect()
}

/// Adds the font files of a folder.
fn list(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let path = entry.path();
        if path.is_dir() {
            if depth > 0 {
                list(&path, depth - 1, found);
            }
        } else if found.len() < MOST && path.extension().is_some_and(is_font) {
            found.push(path);
        }
    }
}

fn is_font(extension: &std::ffi::OsStr) -> bool {
    ["ttf", "otf", "ttc", "otc"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// The characters of all faces in a file; `None` where it is no font.
fn characters(path: &Path) -> Option<Vec<(u32, u32)>> {
    let bytes = read_bytes(path, LONGEST).ok()?;
    let mut codes: Vec<u32> = FontRef::fonts(&bytes)
        .flatten()
        .flat_map(|font| font.charmap().mappings().map(|(code, _)| code).collect::<Vec<_>>())
        .collect();
    codes.sort_unstable();
    let mut ranges: Vec<(u32, u32)> = Vec::new();
    for code in codes {
        match ranges.last_mut() {
            Some((_, last)) if code <= *last + 1 => *last = code,
            _ => ranges.push((code, code)),
        }
    }
    Some(ranges)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fonts_characters_are_known_from_its_file() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("a.ttf");
        fs::write(&path, UBUNTU_LIGHT).unwrap();
        let file = FontFile { ranges: characters(&path).unwrap(), path: path.clone() };
        assert!("Azñ×0".chars().all(|c| file.has(c)));
        assert!("\u{5e9}漢\u{10ffff}".chars().all(|c| !file.has(c)));
        fs::write(&path, "no font").unwrap();
        assert_eq!(characters(&path).map(|ranges| ranges.len()), Some(0));
        let mut found = Vec::new();
        list(place.path(), DEPTH, &mut found);
        assert_eq!(found, [path]);
    }

    #[test]
    fn a_character_is_drawn_where_any_font_of_the_system_has_it() {
        let mut fonts = own();
        for c in "שжع漢".chars() {
            let found = load_for(c, &mut fonts);
            assert_eq!(found.is_some(), files().iter().any(|file| file.has(c)), "{c}");
        }
    }
}
