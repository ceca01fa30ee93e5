//! Reads a mesh from its files, whatever their format.
//!
//! The readers open no file: they ask [`Files`] for bytes, so that who calls says which files may be opened,
//! and built-in meshes, tests and fuzzing read through the same code.

use std::path::{Component, Path, PathBuf};

use super::texture::Textures;
use super::{Material, Mesh, gltf, obj};
use crate::system::file::FileError;

/// The longest file of a mesh, in bytes; ten million triangles as text are about as long.
pub const LONGEST: u64 = 512 << 20;

/// Where the files of a mesh come from.
pub trait Files {
    /// The bytes of a file, at most `limit` of them; `path` is the mesh's own or one beside it.
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, Unread>;
}

/// Why a file gives no bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unread {
    /// There is no such file.
    Missing,
    /// It cannot be taken.
    Refused {
        /// What is wrong.
        what: String,
        /// What would be right.
        remedy: String,
    },
}

/// A lamp that a file brings along (glTF's `KHR_lights_punctual`). Its numbers are photometric there (candela,
/// lux) and are taken as W/sr and W/m².
#[derive(Clone, Debug, PartialEq)]
pub struct Lamp {
    /// Its name in the file; empty where it has none.
    pub name: String,
    /// What it is.
    pub kind: LampKind,
    /// Where it stands, in metres; of no meaning to a sun.
    pub position: [f64; 3],
    /// The unit vector along which it shines; of no meaning to a point.
    pub direction: [f64; 3],
    /// Intensity, or for a sun irradiance, in red, green and blue.
    pub power: [f64; 3],
}

/// The kinds of lamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LampKind {
    /// Alike in all directions.
    Point,
    /// A cone: full inside the inner half angle, dark outside the outer one, in radians.
    Spot {
        /// The inner half angle.
        inner: f64,
        /// The outer half angle.
        outer: f64,
    },
    /// Parallel light from far away.
    Sun,
}

/// A mesh as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The mesh.
    pub mesh: Mesh,
    /// The lamps that the file brings along.
    pub lamps: Vec<Lamp>,
    /// What was not as it should be and could be helped, each a line: a missing material, triangles dropped.
    pub notes: Vec<String>,
}

/// The formats that are read, by the end of the file's name.
pub const FORMATS: [&str; 3] = ["obj", "gltf", "glb"];

/// Reads a mesh: `.obj` with its `.mtl`, `.gltf` with its buffers, or `.glb`. `progress` is told how much is
/// done, 0 to 1.
///
/// # Errors
/// A file that is not there or cannot be a mesh, in one line with the place.
pub fn read(path: &Path, files: &dyn Files, progress: &mut dyn FnMut(f64)) -> Result<Loaded, FileError> {
    let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).unwrap_or_default();
    let read: fn(&[u8], &mut Job) -> Result<Parts, FileError> = match ending.as_str() {
        "obj" => obj::read,
        "gltf" | "glb" => gltf::read,
        _ => {
            let what = "this program reads no such mesh";
            return Err(FileError::new(path, what, "give a file that ends in .obj, .gltf or .glb"));
        }
    };
    let bytes = files.read(path, LONGEST).map_err(|unread| refusal(path, unread))?;
    let mut job = Job { path, files, progress, notes: Vec::new(), textures: Textures::default() };
    let parts = read(&bytes, &mut job)?;
    drop(bytes);
    let mut notes = job.notes;
    let tints = if job.textures.any() { parts.tints } else { Vec::new() };
    let (mesh, dropped) = Mesh::tinted(parts.vertices, parts.triangles, parts.made_of, parts.materials, tints)
        .map_err(|what| FileError::new(path, what, "a mesh has triangles of finite corners"))?;
    if dropped > 0 {
        notes.push(format!("{}: {dropped} triangles without an area were dropped", path.display()));
    }
    progress(1.0);
    Ok(Loaded { mesh, lamps: parts.lamps, notes })
}

/// What a reader gathers. Numbers in it are in range, and vertices finite.
#[derive(Default)]
pub(super) struct Parts {
    pub(super) vertices: Vec<glam::Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) made_of: Vec<u32>,
    pub(super) materials: Vec<Material>,
    /// By triangle its albedo, textures included.
    pub(super) tints: Vec<[f32; 3]>,
    pub(super) lamps: Vec<Lamp>,
}

/// What a reader works with.
pub(super) struct Job<'a> {
    /// The mesh's own file.
    pub(super) path: &'a Path,
    files: &'a dyn Files,
    progress: &'a mut dyn FnMut(f64),
    notes: Vec<String>,
    pub(super) textures: Textures,
}

impl Job<'_> {
    /// The bytes of a file that the mesh names; `None`, and a note that `instead` is taken, where there is none.
    pub(super) fn beside(
        &mut self,
        name: &str,
        limit: u64,
        instead: &str,
    ) -> Result<Option<(PathBuf, Vec<u8>)>, FileError> {
        let path = self.path_of(name)?;
        match self.files.read(&path, limit) {
            Ok(bytes) => Ok(Some((path, bytes))),
            Err(Unread::Missing) => {
                self.note(format!("`{name}` is not there: {instead}"));
                Ok(None)
            }
            Err(unread) => Err(refusal(&path, unread)),
        }
    }

    /// The bytes of a file that the mesh cannot do without.
    pub(super) fn needed(&self, name: &str, limit: u64) -> Result<Vec<u8>, FileError> {
        let path = self.path_of(name)?;
        self.files.read(&path, limit).map_err(|unread| refusal(&path, unread))
    }

    /// Tells something that could be helped, once.
    pub(super) fn note(&mut self, what: impl AsRef<str>) {
        const MOST: usize = 20;
        let line = format!("{}: {}", self.path.display(), what.as_ref());
        if self.notes.len() < MOST && !self.notes.contains(&line) {
            self.notes.push(line);
        }
    }

    /// Tells how much is done, 0 to 1.
    pub(super) fn progress(&mut self, done: f64) {
        (self.progress)(done);
    }

    /// A fault of the mesh's own file.
    pub(super) fn fault(&self, what: impl AsRef<str>, remedy: impl AsRef<str>) -> FileError {
        FileError::new(self.path, what, remedy)
    }

    /// Where a file lies that the mesh names. Only paths that go down or sideways from the mesh's folder are
    /// names of files: what `..` leads to is for [`Files`] to allow.
    fn path_of(&self, name: &str) -> Result<PathBuf, FileError> {
        // Some programs write `\` between folders.
        let name = name.replace('\\', "/");
        let relative = Path::new(&name);
        let rooted = relative.components().any(|c| matches!(c, Component::RootDir | Component::Prefix(_)));
        if rooted || name.contains("://") || name.contains('\0') || relative.file_name().is_none() {
            let what = format!("it names `{}`, which is not a file beside it", shortened(&name));
            return Err(self.fault(what, "name files relative to the mesh"));
        }
        Ok(self.path.parent().unwrap_or(Path::new("")).join(relative))
    }
}

fn refusal(path: &Path, unread: Unread) -> FileError {
    match unread {
        Unread::Missing => FileError::new(path, "there is no such file", "give the path of a file that is there"),
        Unread::Refused { what, remedy } => FileError::new(path, what, remedy),
    }
}

/// A fault of a line of a file, counted from 1.
pub(super) fn at_line(path: &Path, line: usize, what: impl AsRef<str>, remedy: impl AsRef<str>) -> FileError {
    FileError { line: Some(line), ..FileError::new(path, what, remedy) }
}

/// A name as a message may quote it.
pub(super) fn shortened(name: &str) -> String {
    const MOST: usize = 60;
    match name.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &name[..end]),
        None => name.to_owned(),
    }
}
