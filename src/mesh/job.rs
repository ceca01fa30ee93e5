//! What the readers of all formats work with: the files beside the mesh, notes, progress, textures; and what they gather.

use std::path::{Component, Path, PathBuf};

use super::Material;
use super::lamp::Lamp;
use super::texture::{self, TextureId, Textures};
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
    pub(super) files: &'a dyn Files,
    pub(super) progress: &'a mut dyn FnMut(f64),
    pub(super) notes: Vec<String>,
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

pub(super) fn refusal(path: &Path, unread: Unread) -> FileError {
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

impl Job<'_> {
    /// The texture in a file that the mesh names; `None`, with a note, where there is no such file.
    pub(super) fn texture_in_file(&mut self, name: &str) -> Result<Option<TextureId>, FileError> {
        let known = PathBuf::from(name);
        if let Some(texture) = self.textures.by_file.get(&known) {
            return Ok(*texture);
        }
        let found = match self.beside(name, texture::LONGEST, "what has this texture is grey")? {
            None => None,
            Some((path, bytes)) => Some(self.textures.add(&bytes, &path)?),
        };
        self.textures.by_file.insert(known, found);
        Ok(found)
    }
}
