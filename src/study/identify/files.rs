//! Dumps in files, and what they are dumps of.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::Dumps;
use super::layout::Dump;
use super::light::Storage;
use crate::scene::SceneError;
use crate::scene::cell_file::Column;
use crate::scene::dump_file::{self, LARGEST_SIDE, Numbers};

/// The latest iteration that is looked at.
pub const LATEST: usize = 64;

/// What a file is a dump of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// The grid after injection.
    Injected,
    /// The source grid after so many iterations, one or more.
    Source(usize),
    /// The accumulated grid after so many iterations.
    Accumulated(usize),
}

impl Role {
    /// What a file most likely is by its name: `s0`, `source_2`, `accumulated4`, `injected`.
    ///
    /// ```
    /// use std::path::Path;
    /// use lpv_lab::study::identify::Role;
    ///
    /// assert_eq!(Role::guess(Path::new("dumps/port_s2.npy")), Role::Source(2));
    /// assert_eq!(Role::guess(Path::new("A4.npy")), Role::Accumulated(4));
    /// assert_eq!(Role::guess(Path::new("s0.npy")), Role::Injected);
    /// ```
    pub fn guess(path: &Path) -> Role {
        let name = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().to_lowercase());
        let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let iteration = name[letters.len()..].parse().ok().filter(|k| *k <= LATEST);
        let last = letters.rsplit(|c: char| !c.is_alphabetic()).find(|word| !word.is_empty()).unwrap_or_default();
        match iteration {
            Some(k) if k > 0 && last.starts_with('a') => Role::Accumulated(k),
            Some(k) if k > 0 => Role::Source(k),
            _ => Role::Injected,
        }
    }
}

/// Dumps in files.
#[derive(Clone, Debug, PartialEq)]
pub struct Files {
    /// The files, each with what it is.
    pub files: Vec<(PathBuf, Role)>,
    /// What fixed-point numbers were multiplied by, above 0.
    pub scale: f64,
    /// Cells along a side, where CSV files of few cells do not tell.
    pub size: Option<usize>,
}

/// Why there are no dumps.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoDumps {
    /// A file cannot be read.
    #[error(transparent)]
    File(#[from] SceneError),
    /// Files that do not go together.
    #[error("{0}")]
    Together(String),
}

impl Files {
    /// Reads all of them.
    pub fn read(&self) -> Result<Dumps, NoDumps> {
        let mut all = Vec::new();
        for (path, role) in &self.files {
            let column = if matches!(role, Role::Accumulated(_)) { Column::Accumulated } else { Column::Source };
            all.push((path, *role, dump_file::read(path, column)?));
        }
        let side = self.side(all.iter().map(|(_, _, numbers)| numbers));
        let (mut injected, mut source, mut accumulated) = (None, BTreeMap::new(), BTreeMap::new());
        for (path, role, numbers) in all {
            let has = numbers.least_side();
            let Some(mut numbers) = numbers.array(side) else {
                let path = path.display();
                let what =
                    format!("{path}: the dump has {has}³ cells, the others have {side}³; dump one grid throughout");
                return Err(NoDumps::Together(what));
            };
            numbers.iter_mut().flatten().for_each(|c| *c /= self.scale);
            let storage = Storage::of(numbers.iter().flatten(), self.scale);
            let dump = Dump { side, numbers, storage };
            let (twice, what) = match role {
                Role::Injected => (injected.replace(dump), "the injected grid".to_owned()),
                Role::Source(k) => (source.insert(k, dump), format!("the source grid of iteration {k}")),
                Role::Accumulated(k) => (accumulated.insert(k, dump), format!("the accumulated grid of iteration {k}")),
            };
            if twice.is_some() {
                return Err(NoDumps::Together(format!("{what} is given twice; give each grid once")));
            }
        }
        let none = "no file is the injected grid; give the grid after injection, before the first iteration";
        let injected = injected.ok_or_else(|| NoDumps::Together(none.to_owned()))?;
        Ok(Dumps { injected, source, accumulated })
    }

    /// Cells along a side: what was asked for, what an array has, or the least power of two that holds all cells.
    fn side<'a>(&self, all: impl Iterator<Item = &'a Numbers> + Clone) -> usize {
        let array = all.clone().find_map(|numbers| match numbers {
            Numbers::Array { side, .. } => Some(*side),
            Numbers::Cells(_) => None,
        });
        let least = all.map(Numbers::least_side).max().unwrap_or(1);
        let size = self.size.filter(|size| (least..=LARGEST_SIDE).contains(size));
        size.or(array).unwrap_or_else(|| least.next_power_of_two().max(8))
    }
}
