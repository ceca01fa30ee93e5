//! Occluders: what stands in light's way. Boxes, planes and files of cells, and how they act on light.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::error::{Fault, SceneError};
use super::file;
use super::injector::{is_one, is_yes, yes};
use super::occluder_file;
use super::region::Region;
use super::value::{check_share, not_negative, unit};
use crate::field::Cell;

/// A set of occupied cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Occluder {
    /// Which cells.
    pub kind: OccluderKind,
    /// The surface's normal, any length but zero. Left out, each cell's comes from the gradient of the
    /// scene's occupied cells, or from a file that has normals (which then takes none here).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<[f64; 3]>,
    /// How much of each cell is blocked, 0 to 1; 1. It multiplies a file's own. With 0 it clears cells that
    /// an earlier occluder filled: a window in a wall.
    #[serde(default = "opaque", skip_serializing_if = "is_one")]
    pub opacity: f64,
    /// The share of red, green and blue light that is sent back, each 0 to 1; black.
    #[serde(default, skip_serializing_if = "is_black")]
    pub albedo: [f64; 3],
    /// Whether it stands in the scene; true.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub enabled: bool,
}

/// The cells that an occluder fills.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum OccluderKind {
    /// A block of cells.
    Box {
        /// Its corner with the smallest x, y and z.
        from: Cell,
        /// Its corner with the largest; both ends belong to it.
        to: Cell,
    },
    /// All cells with one coordinate: a wall one cell thick through the volume.
    Plane {
        /// The axis it stands across.
        axis: Axis,
        /// Its coordinate on that axis.
        at: usize,
    },
    /// The cells of a CSV file with the header `x,y,z`, which `nx,ny,nz` (normals), `opacity` or both may follow.
    File {
        /// The file, relative to the preset's folder and inside it.
        path: PathBuf,
    },
}

/// An axis of the volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Axis {
    /// The x axis.
    X,
    /// The y axis.
    Y,
    /// The z axis.
    Z,
}

/// How occluders act on light (000, 6.2).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Occlusion {
    /// Whether, and how, they block; `Fuzzy`.
    pub mode: OcclusionMode,
    /// What fuzzy blocking is multiplied by, finite and ≥ 0; 0.8.
    pub amplifier: f64,
    /// Which way a surface must face to block; `AgainstTravel`.
    pub sign: BlockingSign,
    /// The first iteration that fuzzy occlusion acts in; 2, so that light gets away from its own surface.
    pub from_iteration: usize,
    /// What reflected light is multiplied by, finite and ≥ 0; 0, no reflection. It acts from the first iteration on.
    /// `Fuzzy`: 1 is NVIDIA's reflection, its 4.8 inside, without the factor p. `Hard`: the share of what would have
    /// entered, p and all, that is mirrored back. The reflective scheme mirrors by opacity and albedo alone,
    /// whatever this is.
    pub bounce: f64,
    /// Where light is accumulated; `Everywhere`.
    #[serde(skip_serializing_if = "is_everywhere")]
    pub accumulate: Accumulate,
}

/// The cells whose light is accumulated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Accumulate {
    /// All of them.
    #[default]
    Everywhere,
    /// Occupied ones alone, on every level: what arrives at surfaces (001, 3, which reads nowhere else).
    Occupied,
}

fn is_everywhere(accumulate: &Accumulate) -> bool {
    *accumulate == Accumulate::Everywhere
}

/// Whether and how occluders block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum OcclusionMode {
    /// Not at all.
    Off,
    /// By the geometry volume, half a cell off the light, as in NVIDIA's sample.
    #[default]
    Fuzzy,
    /// An occupied cell passes nothing.
    Hard,
}

/// Which way a surface must face to block light, an open quarrel among ports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum BlockingSign {
    /// Light that meets the surface's front is blocked.
    #[default]
    AgainstTravel,
    /// Light that meets the surface's back is blocked, as in NVIDIA's sample.
    AlongTravel,
}

impl Default for Occlusion {
    fn default() -> Self {
        Occlusion {
            mode: OcclusionMode::Fuzzy,
            amplifier: 0.8,
            sign: BlockingSign::AgainstTravel,
            from_iteration: 2,
            bounce: 0.0,
            accumulate: Accumulate::Everywhere,
        }
    }
}

impl Occlusion {
    pub(super) fn check(&self) -> Result<(), Fault> {
        not_negative(self.amplifier, "the amplifier").map_err(|p| p.field("amplifier"))?;
        not_negative(self.bounce, "the bounce").map_err(|p| p.field("bounce"))
    }
}

/// A cell that an occluder fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Filled {
    /// The cell.
    pub(super) cell: Cell,
    /// The surface's unit normal; `None` where the gradient shall give it.
    pub(super) normal: Option<DVec3>,
    /// How much of it is blocked, 0 to 1.
    pub(super) opacity: f64,
    /// The share of each colour that is sent back.
    pub(super) albedo: [f64; 3],
}

impl Occluder {
    /// An occluder with every other field at its default.
    pub fn new(kind: OccluderKind) -> Self {
        Occluder { kind, normal: None, opacity: opaque(), albedo: [0.0; 3], enabled: yes() }
    }

    /// Whether it can stand in a volume of side `size`; files are not opened.
    pub(super) fn check(&self, size: usize) -> Result<(), Fault> {
        match &self.kind {
            OccluderKind::Box { from, to } => Region::checked(*from, *to, size).map(|_| ()),
            OccluderKind::Plane { at, .. } => check_plane(*at, size).map_err(|p| p.field("at")),
            OccluderKind::File { path } => file::check_relative(path).map_err(|p| p.field("path")),
        }
        .map_err(|p| p.field("kind"))?;
        if let Some(normal) = self.normal {
            unit(normal, "normal").map_err(|p| p.field("normal"))?;
        }
        check_share(self.opacity, "the opacity").map_err(|p| p.field("opacity"))?;
        self.albedo.iter().try_for_each(|a| check_share(*a, "a part of the albedo")).map_err(|p| p.field("albedo"))
    }

    /// The number of cells it fills in a volume of side `size`; none for a file, which knows by itself.
    pub(super) fn cell_count(&self, size: usize) -> usize {
        self.region(size).map_or(0, |region| region.len())
    }

    /// The cells it fills in a volume of side `size`. A file is looked for in `folder` and may hold `most` cells.
    pub(super) fn cells(&self, size: usize, folder: &Path, most: usize) -> Result<Vec<Filled>, SceneError> {
        let normal = self.normal.and_then(|n| unit(n, "normal").ok());
        let fill = |cell| Filled { cell, normal, opacity: self.opacity, albedo: self.albedo };
        let OccluderKind::File { path } = &self.kind else {
            return Ok(self.region(size).into_iter().flat_map(Region::cells).map(fill).collect());
        };
        let found = file::inside(folder, path).map_err(|p| p.field("path").field("kind"))?;
        let rows = occluder_file::read(&found, size, most)?;
        if normal.is_some() && rows.iter().any(|row| row.normal.is_some()) {
            let what = "the file brings its own normals";
            return Err(Fault::new(what, "leave normal out here, or nx,ny,nz there").field("normal").into());
        }
        let filled = |row: occluder_file::Row| Filled {
            normal: row.normal.or(normal),
            opacity: row.opacity * self.opacity,
            ..fill(row.cell)
        };
        Ok(rows.into_iter().map(filled).collect())
    }

    /// The block of cells it fills in a volume of side `size`; `None` for a file.
    fn region(&self, size: usize) -> Option<Region> {
        match &self.kind {
            OccluderKind::Box { from, to } => Some(Region { from: *from, to: *to }),
            OccluderKind::Plane { axis, at } => Some(Region::slab(*axis as usize, *at, size)),
            OccluderKind::File { .. } => None,
        }
    }
}

fn check_plane(at: usize, size: usize) -> Result<(), Fault> {
    if at < size {
        return Ok(());
    }
    Err(Fault::new(format!("the plane at {at} lies outside the volume"), format!("write 0 to {}", size - 1)))
}

fn opaque() -> f64 {
    1.0
}

fn is_black(albedo: &[f64; 3]) -> bool {
    *albedo == [0.0; 3]
}
