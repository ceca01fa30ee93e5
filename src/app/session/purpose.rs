//! What files are asked for.

use super::command::Command;
use crate::mesh::read::FORMATS;

/// What a file is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Open a preset.
    Open,
    /// Save the preset.
    SaveAs,
    /// The cells of the preset's injector of this number, or of a new one.
    Injector(usize),
    /// The cells of the preset's occluder of this number, or of a new one.
    Occluder(usize),
    /// The mesh of the scene.
    Mesh,
    /// A dump of a port.
    Dump,
    /// Save what an export command says.
    Export(Command),
}

impl Purpose {
    /// What is asked.
    pub fn title(self) -> &'static str {
        match self {
            Purpose::Open => "Open a preset",
            Purpose::SaveAs => "Save the preset as",
            Purpose::Injector(_) => "A file of light: CSV or .npy, beside the preset",
            Purpose::Occluder(_) => "A file of occupied cells: CSV, beside the preset",
            Purpose::Mesh => "A mesh: .obj, .gltf or .glb, beside the preset",
            Purpose::Dump => "A dump of a port's grid: .npy of shape (n, n, n, 4), or CSV",
            Purpose::Export(command) => command.explanation(),
        }
    }

    /// What confirms it.
    pub fn verb(self) -> &'static str {
        match self {
            Purpose::Open => "Open",
            Purpose::Injector(_) | Purpose::Occluder(_) | Purpose::Mesh | Purpose::Dump => "Use",
            Purpose::SaveAs | Purpose::Export(_) => "Save to file",
        }
    }

    /// Whether a picture is made whose size and colours are chosen.
    pub fn is_picture(self) -> bool {
        matches!(self, Purpose::Export(command) if !matches!(command, Command::ExportCsv | Command::ExportSheet))
    }

    /// Whether the file is written.
    pub fn writes(self) -> bool {
        matches!(self, Purpose::SaveAs | Purpose::Export(_))
    }

    /// The endings that fit, the usual one first.
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            Purpose::Open | Purpose::SaveAs => &["ron"],
            Purpose::Injector(_) => &["csv", "npy"],
            Purpose::Mesh => &FORMATS,
            Purpose::Dump => &["npy", "csv"],
            Purpose::Occluder(_) | Purpose::Export(Command::ExportCsv) => &["csv"],
            Purpose::Export(Command::ExportSvg) => &["svg"],
            Purpose::Export(
                Command::ExportPng | Command::ExportFilm | Command::ExportFrames | Command::ExportSheet,
            ) => &["png"],
            Purpose::Export(_) => &["svg", "png"],
        }
    }
}
