//! The preset: a RON document that says all there is to say about a run. The window edits and saves
//! it, the command line runs it.

use std::path::Path;

use ron::extensions::Extensions;
use ron::ser::PrettyConfig;
use serde::{Deserialize, Deserializer, Serialize};

use super::error::{Fault, SceneError, Step};
use super::injector::Injector;
use super::mesh_scene::MeshScene;
use super::occluder::{Occluder, Occlusion};
use super::propagation::Propagation;
use super::{file, place, syntax};
use crate::system::file::write_whole;

/// The version of the document that this library reads and writes.
pub const VERSION: u32 = 1;
/// The largest side of a volume: its cells alone take 16 GiB a grid.
pub const LARGEST: usize = 1024;
/// The longest preset file, in bytes.
pub const LONGEST: u64 = 4 << 20;

/// A preset. Fields left out take the defaults given here, which are also those of [`Preset::default`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// The document's version, 1. It must be given.
    #[serde(deserialize_with = "known_version")]
    pub version: u32,
    /// What people see; empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub title: String,
    /// Cells along a side of the volume, n: a power of two up to [`LARGEST`]; 32.
    #[serde(default = "default_size")]
    pub size: usize,
    /// The side of the coarsest level: a power of two up to `size`; 1. The thesis's GPU version had 2.
    #[serde(default = "one", skip_serializing_if = "is_one_cell")]
    pub coarsest: usize,
    /// Where light comes from. Several may meet in a cell: they add.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub injectors: Vec<Injector>,
    /// What stands in light's way. Where they overlap the later one counts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub occluders: Vec<Occluder>,
    /// How occluders act.
    #[serde(default, skip_serializing_if = "is_default")]
    pub occlusion: Occlusion,
    /// How light is propagated.
    #[serde(default, skip_serializing_if = "is_default")]
    pub propagation: Propagation,
    /// A mesh with its lights; none, injectors and occluders alone. Both may be given: light adds, and an occluder
    /// counts before the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene: Option<MeshScene>,
}

impl Default for Preset {
    fn default() -> Self {
        Preset {
            version: VERSION,
            title: String::new(),
            size: default_size(),
            coarsest: one(),
            injectors: Vec::new(),
            occluders: Vec::new(),
            occlusion: Occlusion::default(),
            propagation: Propagation::default(),
            scene: None,
        }
    }
}

impl Preset {
    /// Reads a preset's text; `name` is the file that errors name.
    pub fn parse(text: &str, name: &Path) -> Result<Self, SceneError> {
        // Some editors begin a text with a byte order mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let preset: Preset = dialect().from_str(text).map_err(|error| syntax::error(error, text, name))?;
        preset.check().map_err(|fault| place::at_its_place(fault, text, name))?;
        Ok(preset)
    }

    /// Reads a preset from a file of at most [`LONGEST`] bytes.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        Self::parse(&file::read_text(path, LONGEST)?, path)
    }

    /// The preset as text that [`Preset::parse`] reads back equal. Fields that hold their defaults are left
    /// out, and the same preset always gives the same text.
    pub fn to_ron(&self) -> String {
        let layout = PrettyConfig::new().new_line("\n").depth_limit(2);
        // Writing numbers and strings to a String has no way to fail.
        let body = dialect().to_string_pretty(self, layout).unwrap_or_default();
        body + "\n"
    }

    /// Writes the preset to a file, all or nothing: whatever happens, the file holds the old text or the new.
    pub fn save(&self, path: &Path) -> Result<(), SceneError> {
        Ok(write_whole(path, self.to_ron().as_bytes())?)
    }

    /// How often a whole run propagates ([`Propagation::actions`]).
    pub fn actions(&self) -> usize {
        self.propagation.actions(self.size, self.coarsest)
    }

    /// Whether every value is one that can be run; [`Preset::parse`] applies the same rules.
    pub fn check(&self) -> Result<(), Fault> {
        if self.version != VERSION {
            return Err(wrong_version(self.version).field("version"));
        }
        check_size(self.size).map_err(|p| p.field("size"))?;
        if !self.coarsest.is_power_of_two() || self.coarsest > self.size {
            let what = format!("the coarsest level cannot have side {}", self.coarsest);
            let remedy = format!("it is a power of two from 1 to {}", self.size);
            return Err(Fault::new(what, remedy).field("coarsest"));
        }
        for (i, injector) in self.injectors.iter().enumerate() {
            injector.check(self.size).map_err(|p| p.within(Step::Item(i)).field("injectors"))?;
        }
        for (i, occluder) in self.occluders.iter().enumerate() {
            occluder.check(self.size).map_err(|p| p.within(Step::Item(i)).field("occluders"))?;
        }
        self.occlusion.check().map_err(|p| p.field("occlusion"))?;
        self.propagation.check(self.size).map_err(|p| p.field("propagation"))?;
        self.scene.iter().try_for_each(|scene| scene.check(self.size)).map_err(|p| p.field("scene"))
    }
}

/// RON with `direction: (1, 0, 0)` for a direction that may be left out.
fn dialect() -> ron::Options {
    // A preset is six brackets deep at most; the limit keeps a hostile one off the stack.
    ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME).with_recursion_limit(32)
}

/// Refuses another version while reading, before any field that only that version knows.
fn known_version<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    let version = u32::deserialize(deserializer)?;
    if version == VERSION { Ok(version) } else { Err(serde::de::Error::custom(wrong_version(version))) }
}

fn wrong_version(version: u32) -> Fault {
    Fault::new(format!("version {version} is not known here"), format!("this program reads `version: {VERSION}`"))
}

fn check_size(size: usize) -> Result<(), Fault> {
    if size.is_power_of_two() && size <= LARGEST {
        return Ok(());
    }
    let inside = size.clamp(1, LARGEST);
    let above = inside.next_power_of_two();
    let nearest = if inside - above / 2 < above - inside { above / 2 } else { above };
    let remedy = format!("it is a power of two from 1 to {LARGEST}; the nearest is {nearest}");
    Err(Fault::new(format!("the size cannot be {size}"), remedy))
}

fn default_size() -> usize {
    32
}

fn one() -> usize {
    1
}

fn is_one_cell(n: &usize) -> bool {
    *n == 1
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
