//! Injectors: where a scene's light comes from. A wall, a rectangle or a cell of lobes, or a file of cells.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::cell_file::{self, Column};
use super::error::{Fault, SceneError};
use super::file;
use super::path::{self, Keyframe};
use super::region::{Region, check_cell};
use super::value::{not_negative, unit};
use crate::field::Cell;
use crate::sh::Sh;

/// The brightest coefficient that may be injected; beyond it volumes in single precision overflow.
pub const BRIGHTEST: f64 = 1e30;

/// A source of light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Injector {
    /// Which cells, and what light where a file says so.
    pub kind: InjectorKind,
    /// Where the light goes: any length but zero. Left out, a wall sends inwards and other kinds towards
    /// +X. A file brings its own light and takes none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// What the light is multiplied by, finite and ≥ 0; 1.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub multiplier: f64,
    /// Red, green and blue, each finite and ≥ 0; white, (1, 1, 1).
    #[serde(default = "white", skip_serializing_if = "is_white")]
    pub color: [f64; 3],
    /// Whether it injects; true. The window switches injectors off without losing them.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub enabled: bool,
    /// Where it moves, for what follows light over time; nowhere.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub path: Vec<Keyframe>,
}

/// The cells that an injector lights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum InjectorKind {
    /// All cells at one side of the volume.
    Wall {
        /// The side.
        side: Side,
    },
    /// An axis-aligned rectangle of cells, one cell thick.
    Rectangle {
        /// Its corner with the smallest x, y and z.
        from: Cell,
        /// Its corner with the largest; both ends belong to it.
        to: Cell,
    },
    /// One cell.
    Single {
        /// The cell.
        cell: Cell,
    },
    /// The cells of a file, each with its own light; see [`cell_file`].
    File {
        /// The file, relative to the preset's folder and inside it: `.npy`, anything else is read as CSV.
        path: PathBuf,
        /// Which light of a file: it must be named where the file holds two. A `.npy` file holds one and says not
        /// which.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        column: Option<Column>,
    },
}

/// A side of the volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Side {
    /// x = 0.
    NegX,
    /// x = n − 1.
    PosX,
    /// y = 0.
    NegY,
    /// y = n − 1.
    PosY,
    /// z = 0.
    NegZ,
    /// z = n − 1.
    PosZ,
}

impl Side {
    /// All six, in the order of the enum.
    pub const ALL: [Side; 6] = [Side::NegX, Side::PosX, Side::NegY, Side::PosY, Side::NegZ, Side::PosZ];

    /// The side's axis: 0, 1 or 2 for x, y or z.
    pub fn axis(self) -> usize {
        self as usize / 2
    }

    /// The unit vector from the side into the volume.
    pub fn inwards(self) -> DVec3 {
        let axis = DVec3::AXES[self.axis()];
        if self.is_low() { axis } else { -axis }
    }

    /// The side's cells in a volume of side `size`.
    fn cells(self, size: usize) -> Region {
        let at = if self.is_low() { 0 } else { size - 1 };
        Region::slab(self.axis(), at, size)
    }

    fn is_low(self) -> bool {
        matches!(self, Side::NegX | Side::NegY | Side::NegZ)
    }
}

impl Injector {
    /// An injector of white light with every other field at its default.
    pub fn new(kind: InjectorKind) -> Self {
        Injector { kind, direction: None, multiplier: one(), color: white(), enabled: yes(), path: Vec::new() }
    }

    /// Whether it can be injected into a volume of side `size`; files are not opened.
    pub(super) fn check(&self, size: usize) -> Result<(), Fault> {
        match &self.kind {
            InjectorKind::Wall { .. } => Ok(()),
            InjectorKind::Rectangle { from, to } => check_rectangle(*from, *to, size),
            InjectorKind::Single { cell } => check_cell(*cell, size).map_err(|p| p.field("cell")),
            InjectorKind::File { path, .. } => file::check_relative(path).map_err(|p| p.field("path")),
        }
        .map_err(|p| p.field("kind"))?;
        if let Some(direction) = self.direction {
            if matches!(self.kind, InjectorKind::File { .. }) {
                let what = "a file brings its own light and takes no direction";
                return Err(Fault::new(what, "leave direction out").field("direction"));
            }
            unit(direction, "direction").map_err(|p| p.field("direction"))?;
        }
        not_negative(self.multiplier, "the multiplier").map_err(|p| p.field("multiplier"))?;
        for value in self.color {
            not_negative(value, "a colour's part").map_err(|p| p.field("color"))?;
        }
        path::check(&self.path).map_err(|p| p.field("path"))?;
        self.check_brightness(1.0)
    }

    /// The number of cells it lights in a volume of side `size`; none for a file, which knows by itself.
    pub(super) fn cell_count(&self, size: usize) -> usize {
        self.region(size).map_or(0, |region| region.len())
    }

    /// The light it injects into a volume of side `size`, multiplied but not coloured. A file is looked
    /// for in `folder` and may hold `most` cells.
    pub(super) fn light(&self, size: usize, folder: &Path, most: usize) -> Result<Vec<(Cell, Sh<f64>)>, SceneError> {
        if let InjectorKind::File { path, column } = &self.kind {
            let found = file::inside(folder, path).map_err(|p| p.field("path").field("kind"))?;
            let mut light = cell_file::read_at_most(&found, size, *column, most)?;
            let brightest = light.iter().fold(0.0, |m: f64, (_, sh)| m.max(sh.max_norm()));
            self.check_brightness(brightest)?;
            for (_, sh) in &mut light {
                *sh = *sh * self.multiplier;
            }
            return Ok(light);
        }
        let lobe = Sh::lobe(self.heading()) * self.multiplier;
        Ok(self.region(size).into_iter().flat_map(Region::cells).map(|cell| (cell, lobe)).collect())
    }

    /// The unit direction that its light takes, where a file does not say otherwise.
    pub fn heading(&self) -> DVec3 {
        let without = if let InjectorKind::Wall { side } = self.kind { side.inwards() } else { DVec3::X };
        self.direction.and_then(|d| unit(d, "direction").ok()).unwrap_or(without)
    }

    /// The block of cells it lights in a volume of side `size`; `None` for a file.
    fn region(&self, size: usize) -> Option<Region> {
        match &self.kind {
            InjectorKind::Wall { side } => Some(side.cells(size)),
            InjectorKind::Rectangle { from, to } => Some(Region { from: *from, to: *to }),
            InjectorKind::Single { cell } => Some(Region { from: *cell, to: *cell }),
            InjectorKind::File { .. } => None,
        }
    }

    /// Whether light whose largest coefficient is `brightest` stays within [`BRIGHTEST`].
    fn check_brightness(&self, brightest: f64) -> Result<(), Fault> {
        let color = self.color.iter().fold(0.0, |m: f64, c| m.max(*c));
        if brightest * self.multiplier * color.max(1.0) <= BRIGHTEST {
            return Ok(());
        }
        let what = "the light is brighter than volumes in single precision can hold";
        let remedy = format!("keep light × multiplier × colour at {BRIGHTEST:e} or below");
        Err(Fault::new(what, remedy).field("multiplier"))
    }
}

fn check_rectangle(from: Cell, to: Cell, size: usize) -> Result<(), Fault> {
    let region = Region::checked(from, to, size)?;
    if region.thinnest() > 1 {
        let what = format!("the rectangle is {} cells thick", region.thinnest());
        return Err(Fault::new(what, "give `from` and `to` the same x, y or z").field("to"));
    }
    Ok(())
}

fn one() -> f64 {
    1.0
}

/// Whether a factor is the default.
pub(super) fn is_one(factor: &f64) -> bool {
    *factor == one()
}

fn white() -> [f64; 3] {
    [1.0; 3]
}

fn is_white(color: &[f64; 3]) -> bool {
    *color == white()
}

/// What `enabled` is when left out.
pub(super) fn yes() -> bool {
    true
}

/// Whether something is enabled, as it is by default.
pub(super) fn is_yes(enabled: &bool) -> bool {
    *enabled
}
