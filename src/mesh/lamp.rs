//! Lamps that come with a mesh.

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
