//! Reads a mesh from its files, whatever their format.
//!
//! The readers open no file: they ask [`Files`] for bytes, so that who calls says which files may be opened,
//! and built-in meshes, tests and fuzzing read through the same code.

use std::path::Path;

pub use super::job::{Files, LONGEST, Unread};
pub use super::lamp::{Lamp, LampKind};

use super::job::{Job, Parts, refusal};
use super::texture::Textures;
use super::{Mesh, gltf, obj};
use crate::system::file::FileError;

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
