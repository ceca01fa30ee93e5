//! How light is looked at: what the window remembers between runs of the program.

use serde::{Deserialize, Serialize};

use crate::app::worker::look::Layer;
use crate::report::colour::Paint;
use crate::report::glyph::Hue;
use crate::report::slice::{Axis, Plane};

/// How an intensity becomes a glyph's radius.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Scaling {
    /// In proportion.
    Linear,
    /// By its logarithm.
    #[default]
    Log,
    /// Every glyph fills its cell.
    PerGlyph,
}

impl Scaling {
    /// All of them.
    pub const ALL: [Scaling; 3] = [Scaling::Linear, Scaling::Log, Scaling::PerGlyph];

    /// Its name on screen.
    pub fn name(self) -> &'static str {
        match self {
            Scaling::Linear => "Linear",
            Scaling::Log => "Logarithmic",
            Scaling::PerGlyph => "Each glyph full",
        }
    }
}

/// Which glyph fills its cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fill {
    /// The brightest of all iterations, so that light can be seen to fade.
    #[default]
    Run,
    /// The brightest that is seen.
    Frame,
    /// That of a chosen intensity.
    Fixed,
}

impl Fill {
    /// All of them.
    pub const ALL: [Fill; 3] = [Fill::Run, Fill::Frame, Fill::Fixed];

    /// Its name on screen.
    pub fn name(self) -> &'static str {
        match self {
            Fill::Run => "Per run",
            Fill::Frame => "Per frame",
            Fill::Fixed => "Fixed",
        }
    }

    /// What it means, in a line.
    pub fn about(self) -> &'static str {
        match self {
            Fill::Run => "The brightest glyph of all iterations fills its cell: light can be seen to fade",
            Fill::Frame => "The brightest glyph that is seen fills its cell: every iteration looks as bright",
            Fill::Fixed => "The intensity that fills a cell is chosen",
        }
    }
}

/// What lies under the glyphs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Heat {
    /// Nothing.
    #[default]
    None,
    /// The mean light, c00.
    Mean,
    /// The absolute error, against what the plots' metric compares with.
    Absolute,
    /// The relative error, against the same.
    Relative,
}

impl Heat {
    /// All of them.
    pub const ALL: [Heat; 4] = [Heat::None, Heat::Mean, Heat::Absolute, Heat::Relative];

    /// Its name on screen.
    pub fn name(self) -> &'static str {
        match self {
            Heat::None => "None",
            Heat::Mean => "Mean light c00",
            Heat::Absolute => "Absolute error",
            Heat::Relative => "Relative error",
        }
    }
}

/// What fills the window between the bars.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Workspace {
    /// How light travels through the volume.
    #[default]
    Light,
    /// The scene as a mesh in space, with its lights.
    Scene,
    /// What a camera sees.
    Picture,
    /// Questions put to the light.
    Study,
}

impl Workspace {
    /// Those that there is something in.
    pub const FILLED: &[Workspace] = &[Workspace::Light, Workspace::Scene, Workspace::Picture, Workspace::Study];

    /// Its name on screen.
    pub fn name(self) -> &'static str {
        match self {
            Workspace::Light => "Light",
            Workspace::Scene => "Scene",
            Workspace::Picture => "Picture",
            Workspace::Study => "Study",
        }
    }
}

/// The middle of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stage {
    /// Source, target and accumulated light of one run.
    #[default]
    Grids,
    /// The same light of several propagators, or of two iterations.
    Compare,
    /// One of the grids in three dimensions.
    Space,
}

/// How light is looked at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct View {
    /// The middle of the window.
    pub stage: Stage,
    /// Which level.
    pub layer: Layer,
    /// The axis that slices are cut across.
    #[serde(rename = "across", with = "super::place")]
    pub axis: Axis,
    /// How far along that axis, in finest cells.
    pub index: usize,
    /// How intensities become radii.
    pub scaling: Scaling,
    /// Which glyph fills its cell.
    pub fill: Fill,
    /// The intensity that fills a cell where it is chosen.
    pub full: f32,
    /// The powers of ten that a logarithmic scale spans.
    pub decades: f32,
    /// What a glyph's colour tells.
    #[serde(with = "super::place")]
    pub paint: Paint,
    /// Whether light that has hues is shown in its own colours where directions would be told.
    pub hues: bool,
    /// Which colour of the light glyphs show.
    #[serde(with = "super::place")]
    pub hue: Hue,
    /// Whether negative lobes are drawn.
    pub negative: bool,
    /// Whether each cell's middle and the direction of its flux are marked.
    pub flux: bool,
    /// What lies under the glyphs.
    pub heat: Heat,
    /// Whether glyphs are drawn.
    pub glyphs: bool,
    /// Whether cells are drawn.
    pub cells: bool,
    /// Whether the index volume is drawn.
    pub levels: bool,
    /// Whether occupied cells are drawn.
    pub occluders: bool,
    /// Whether all views are zoomed and panned together.
    pub linked: bool,
}

impl Default for View {
    fn default() -> Self {
        View {
            stage: Stage::Grids,
            layer: Layer::Merged,
            axis: Axis::Z,
            index: 16,
            scaling: Scaling::Log,
            fill: Fill::Run,
            full: 0.1,
            decades: 4.0,
            paint: Paint::Direction,
            hues: true,
            hue: Hue::Mean,
            negative: true,
            flux: true,
            heat: Heat::None,
            glyphs: true,
            cells: true,
            levels: true,
            occluders: true,
            linked: true,
        }
    }
}

impl View {
    /// Where slices are cut.
    pub fn plane(&self) -> Plane {
        Plane { axis: self.axis, index: self.index }
    }
}

/// A kind of glyph colour's name on screen.
pub fn paint_name(paint: Paint) -> &'static str {
    match paint {
        Paint::Single => "One colour",
        Paint::Light => "Colour of the light",
        Paint::Direction => "Direction",
        Paint::Intensity => "Intensity",
    }
}

/// A colour's name on screen.
pub fn hue_name(hue: Hue) -> &'static str {
    match hue {
        Hue::Mean => "Mean of RGB",
        Hue::Red => "Red",
        Hue::Green => "Green",
        Hue::Blue => "Blue",
    }
}
