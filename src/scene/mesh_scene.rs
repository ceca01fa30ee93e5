//! The part of the document that says which mesh stands in the volume, what lights it, and who looks at it.
//!
//! Units are radiometric: a point or spot light has an intensity in W/sr, the sun an irradiance in W/m² on a surface
//! that faces it. Lengths are metres in the mesh's coordinates.

use std::path::PathBuf;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::error::{Fault, Step};
use super::file;
use super::injector::{is_yes, yes};
use super::value::unit;

/// The most lights of a scene.
pub const MOST_LIGHTS: usize = 64;
/// The most texels along a side of a face of a shadow map.
pub const LARGEST_MAP: usize = 1024;
/// The brightest light, in W/sr or W/m².
pub const BRIGHTEST: f64 = 1e20;

/// A mesh, the volume around it and its lights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshScene {
    /// The mesh: an `.obj` with its `.mtl`, a `.gltf` or a `.glb`, relative to the preset and in its folder.
    pub mesh: PathBuf,
    /// Where the volume lies; `Fit(margin: 0)`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub volume: Volume,
    /// The lights; none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lights: Vec<Light>,
    /// Whether the lamps that a glTF file brings along shine too; false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub lamps_of_file: bool,
    /// Texels along a side of a face of a reflective shadow map, all of them injected: 1 to [`LARGEST_MAP`]; 256.
    #[serde(default = "shadow_map")]
    pub shadow_map: usize,
    /// Into which cells a virtual point light goes; `Nearest`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub injection: Injection,
    /// Who looks at it; left out, a camera in front of the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<Camera>,
}

/// Where the volume of a scene lies: a cube.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Volume {
    /// Around the middle of the mesh, as large as its longest side.
    Fit {
        /// How many cells stay empty on every side besides, 0 to under half of the cells along a side; 0.
        #[serde(default)]
        margin: f64,
    },
    /// A given cube.
    Cube {
        /// Its middle, in metres.
        center: [f64; 3],
        /// Its side, in metres, above 0.
        side: f64,
    },
}

/// Into which cells a virtual point light goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Injection {
    /// Into the cell that it lies in, half a cell off its surface (000, 3.2.2).
    #[default]
    Nearest,
    /// Into the eight cells around that place, by how near they are: light that moves moves smoothly.
    Split,
}

/// A light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Light {
    /// What it is and where.
    pub kind: LightKind,
    /// Its intensity in red, green and blue, W/sr, each ≥ 0: of a point or a spot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intensity: Option<[f64; 3]>,
    /// The irradiance of a surface that faces it, W/m², each ≥ 0: of the sun.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub irradiance: Option<[f64; 3]>,
    /// Whether it shines; true.
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    pub enabled: bool,
}

/// The kinds of lights.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum LightKind {
    /// Alike in all directions.
    Point {
        /// Where it is, in metres.
        position: [f64; 3],
    },
    /// A cone of light.
    Spot {
        /// Where it is, in metres.
        position: [f64; 3],
        /// Where it shines, any length but zero.
        direction: [f64; 3],
        /// The cone's half angle in degrees, above 0 and at most 80.
        angle: f64,
        /// The share of the half angle over which it fades out, 0 to 1; 0.
        #[serde(default)]
        blend: f64,
    },
    /// Parallel light from far away.
    Sun {
        /// Where it shines, any length but zero.
        direction: [f64; 3],
    },
}

/// Who looks at a scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Where it stands, in metres.
    pub from: [f64; 3],
    /// What it looks at.
    pub to: [f64; 3],
    /// What is up in the picture, any length but zero and not along the view; (0, 1, 0).
    #[serde(default = "up", skip_serializing_if = "is_up")]
    pub up: [f64; 3],
    /// The vertical field of view in degrees, above 0 and below 180; 40.
    #[serde(default = "fov")]
    pub fov: f64,
}

impl Default for Volume {
    fn default() -> Self {
        Volume::Fit { margin: 0.0 }
    }
}

impl MeshScene {
    /// A scene of a mesh with every other field at its default.
    pub fn new(mesh: impl Into<PathBuf>) -> Self {
        MeshScene {
            mesh: mesh.into(),
            volume: Volume::default(),
            lights: Vec::new(),
            lamps_of_file: false,
            shadow_map: shadow_map(),
            injection: Injection::default(),
            camera: None,
        }
    }

    /// Whether it can stand in a volume of side `size`; files are not opened.
    pub(super) fn check(&self, size: usize) -> Result<(), Fault> {
        file::check_relative(&self.mesh).map_err(|f| f.field("mesh"))?;
        self.volume.check(size).map_err(|f| f.field("volume"))?;
        if self.lights.len() > MOST_LIGHTS {
            let what = format!("the scene has {} lights", self.lights.len());
            return Err(Fault::new(what, format!("write at most {MOST_LIGHTS}")).field("lights"));
        }
        for (i, light) in self.lights.iter().enumerate() {
            light.check().map_err(|f| f.within(Step::Item(i)).field("lights"))?;
        }
        if !(1..=LARGEST_MAP).contains(&self.shadow_map) {
            let what = format!("a shadow map cannot have {} texels along a side", self.shadow_map);
            return Err(Fault::new(what, format!("write 1 to {LARGEST_MAP}")).field("shadow_map"));
        }
        self.camera.iter().try_for_each(Camera::check).map_err(|f| f.field("camera"))
    }
}

impl Volume {
    fn check(&self, size: usize) -> Result<(), Fault> {
        match *self {
            Volume::Fit { margin } if (0.0..size as f64 / 2.0).contains(&margin) => Ok(()),
            Volume::Fit { margin } => {
                let what = format!("a margin of {margin} cells leaves no cell for the mesh");
                Err(Fault::new(what, format!("write 0 to under {}", size as f64 / 2.0)).field("margin"))
            }
            Volume::Cube { center, side } => {
                place(center, "the centre").map_err(|f| f.field("center"))?;
                if side.is_finite() && side > 1e-9 && side < 1e12 {
                    return Ok(());
                }
                Err(Fault::new(format!("the side is {side} m"), "write a length above 0").field("side"))
            }
        }
    }
}

impl Light {
    /// A point light of an intensity in W/sr.
    pub fn point(position: [f64; 3], intensity: [f64; 3]) -> Self {
        let kind = LightKind::Point { position };
        Light { kind, intensity: Some(intensity), irradiance: None, enabled: true }
    }

    /// The sun, by the irradiance in W/m² of a surface that faces it.
    pub fn sun(direction: [f64; 3], irradiance: [f64; 3]) -> Self {
        let kind = LightKind::Sun { direction };
        Light { kind, intensity: None, irradiance: Some(irradiance), enabled: true }
    }

    /// Its intensity in W/sr, of the sun the irradiance in W/m².
    pub fn power(&self) -> [f64; 3] {
        match self.kind {
            LightKind::Sun { .. } => self.irradiance,
            _ => self.intensity,
        }
        .unwrap_or_default()
    }

    /// The unit vector along which it shines; of a point light none.
    pub fn direction(&self) -> Option<DVec3> {
        match self.kind {
            LightKind::Point { .. } => None,
            LightKind::Spot { direction, .. } | LightKind::Sun { direction } => unit(direction, "direction").ok(),
        }
    }

    /// The share of its intensity that a spot sends at an angle of this cosine to its direction: 1 within the angle
    /// that does not fade, 0 beyond the half angle, and 3t² − 2t³ of the cosine between; 1 for other lights.
    pub fn share(&self, cosine: f64) -> f64 {
        let LightKind::Spot { angle, blend, .. } = self.kind else { return 1.0 };
        fade(cosine, angle.to_radians().cos(), (angle * (1.0 - blend)).to_radians().cos())
    }

    fn check(&self) -> Result<(), Fault> {
        let is_sun = matches!(self.kind, LightKind::Sun { .. });
        let in_kind = |fault: Fault| fault.field("kind");
        match self.kind {
            LightKind::Point { position } => {
                place(position, "the position").map_err(|f| in_kind(f.field("position")))?
            }
            LightKind::Spot { position, direction, angle, blend } => {
                place(position, "the position").map_err(|f| in_kind(f.field("position")))?;
                unit(direction, "direction").map_err(|f| in_kind(f.field("direction")))?;
                if !(angle > 0.0 && angle <= 80.0) {
                    let fault = Fault::new(format!("the half angle is {angle}°"), "write more than 0, at most 80");
                    return Err(in_kind(fault.field("angle")));
                }
                if !(0.0..=1.0).contains(&blend) {
                    let fault = Fault::new(format!("the blend is {blend}"), "write a number from 0 to 1");
                    return Err(in_kind(fault.field("blend")));
                }
            }
            LightKind::Sun { direction } => {
                unit(direction, "direction").map_err(|f| in_kind(f.field("direction")))?;
            }
        }
        let (wanted, other) =
            if is_sun { (self.irradiance, self.intensity) } else { (self.intensity, self.irradiance) };
        let (name, unit_name) = if is_sun { ("irradiance", "W/m²") } else { ("intensity", "W/sr") };
        if other.is_some() {
            let (what, name_of_other) = if is_sun {
                ("the sun has no intensity", "intensity")
            } else {
                ("only the sun has an irradiance", "irradiance")
            };
            return Err(
                Fault::new(what, format!("write {name}: (red, green, blue) in {unit_name}")).field(name_of_other)
            );
        }
        match wanted {
            Some(power) if power.iter().all(|p| (0.0..=BRIGHTEST).contains(p)) => Ok(()),
            Some(_) => {
                let remedy = format!("write three numbers from 0 to {BRIGHTEST:e}, in {unit_name}");
                Err(Fault::new(format!("the {name} is not finite, negative or too great"), remedy).field(name))
            }
            None => {
                Err(Fault::new(format!("the light has no {name}"), format!("write {name}: (1, 1, 1), in {unit_name}")))
            }
        }
    }
}

/// The share of a spot light's intensity at an angle of this cosine to its direction: 1 from `full` on, 0 below `edge`, smooth between (3t² − 2t³).
pub fn fade(cosine: f64, edge: f64, full: f64) -> f64 {
    if cosine < edge {
        0.0
    } else if cosine >= full {
        1.0
    } else {
        let t = (cosine - edge) / (full - edge);
        t * t * (3.0 - 2.0 * t)
    }
}

impl Camera {
    fn check(&self) -> Result<(), Fault> {
        place(self.from, "where the camera stands").map_err(|f| f.field("from"))?;
        place(self.to, "what the camera looks at").map_err(|f| f.field("to"))?;
        let up = unit(self.up, "up").map_err(|f| f.field("up"))?;
        let view = (DVec3::from_array(self.to) - DVec3::from_array(self.from)).try_normalize();
        let Some(view) = view else {
            return Err(Fault::new("the camera looks at the place where it stands", "write another place").field("to"));
        };
        if view.cross(up).length() < 1e-9 {
            return Err(Fault::new("up lies along the view", "write another direction").field("up"));
        }
        if !(self.fov > 0.0 && self.fov < 180.0) {
            let what = format!("the field of view is {}°", self.fov);
            return Err(Fault::new(what, "write more than 0 and less than 180").field("fov"));
        }
        Ok(())
    }
}

/// Checks a place in space; `what` names it.
fn place(at: [f64; 3], what: &str) -> Result<(), Fault> {
    if at.iter().all(|c| c.abs() <= 1e9) {
        return Ok(());
    }
    Err(Fault::new(format!("{what} is not finite or too far away"), "write three numbers up to 1e9, in metres"))
}

fn shadow_map() -> usize {
    256
}

fn up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

fn is_up(at: &[f64; 3]) -> bool {
    *at == up()
}

fn fov() -> f64 {
    40.0
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
