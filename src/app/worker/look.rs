//! What the window asks to see and what it gets: plain data between it and the worker.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::report::glyph::Hue;
use crate::report::slice::{Plane, Slice};
use crate::sh::Sh;
use crate::study::error::CellError;
use crate::study::expectation::Expectation;
use crate::transport::lattice::face::Direction;

/// One of the three octrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Light {
    /// S_k, what the next iteration propagates.
    Source,
    /// S_{k−1}, what the next iteration overwrites.
    Target,
    /// S_A, the running sum.
    #[default]
    Accumulated,
}

impl Light {
    /// All three, in the order of the algorithm.
    pub const ALL: [Light; 3] = [Light::Source, Light::Target, Light::Accumulated];

    /// Its name on screen.
    pub fn name(self) -> &'static str {
        match self {
            Light::Source => "Source",
            Light::Target => "Target",
            Light::Accumulated => "Accumulated",
        }
    }

    /// What it is for, in a few words.
    pub fn about(self) -> &'static str {
        match self {
            Light::Source => "what the next iteration sends on",
            Light::Target => "what the next iteration writes over",
            Light::Accumulated => "the sum of all so far",
        }
    }

    /// Its symbol after iteration `k`, where there is little room.
    pub fn letter(self, k: usize) -> String {
        match self {
            Light::Source => snapshot(k),
            Light::Target => k.checked_sub(1).map_or("empty".to_owned(), snapshot),
            Light::Accumulated => "S_A".to_owned(),
        }
    }

    /// Its symbol after iteration `k`.
    pub fn symbol(self, k: usize) -> String {
        match self {
            Light::Source => snapshot(k),
            Light::Target if k == 0 => "empty until the first iteration".to_owned(),
            Light::Target => snapshot(k - 1),
            Light::Accumulated if k == 0 => "S_A = S₀".to_owned(),
            Light::Accumulated if k == 1 => "S_A = S₀ + S₁".to_owned(),
            Light::Accumulated => format!("S_A = S₀ + … + {}", snapshot(k)),
        }
    }
}

/// S with its number below the line.
fn snapshot(k: usize) -> String {
    let below = |digit: char| char::from_u32('₀' as u32 + digit.to_digit(10).unwrap_or_default()).unwrap_or(digit);
    std::iter::once('S').chain(k.to_string().chars().map(below)).collect()
}

/// A level of the octree, or all of them merged by the index volume.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Layer {
    /// One level, 0 the finest. Beyond the last level the last is meant.
    Level(usize),
    /// The sample S(x, y, z) of (000, 4.2).
    #[default]
    Merged,
}

impl Layer {
    /// Its name on screen.
    pub fn name(self) -> String {
        match self {
            Layer::Level(0) => "Level 0 (finest)".to_owned(),
            Layer::Level(i) => format!("Level {i}"),
            Layer::Merged => "Merged".to_owned(),
        }
    }
}

/// Whose light is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// That of a simulation, 0 the document's own.
    Track(usize),
    /// What truly arrives, the same at every iteration.
    Truth,
}

/// Whose light is seen, and after which iteration, `None` for the present one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    /// Whose.
    pub of: Of,
    /// The iteration.
    pub iteration: Option<usize>,
}

/// One view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pane {
    /// Which octree.
    pub light: Light,
    /// Of which state.
    pub state: State,
    /// What is subtracted: the same octree of another state. With what truly arrives on either side the other
    /// is the merged light that has moved, which is what it can be compared with.
    pub minus: Option<State>,
}

impl Pane {
    /// Whether light that has moved is compared with what truly arrives.
    pub fn moved(&self) -> bool {
        self.minus.is_some_and(|minus| minus.of == Of::Truth || self.state.of == Of::Truth)
    }
}

/// The three-dimensional view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudAsk {
    /// Which octree of which state.
    pub pane: Pane,
    /// The share of the strongest cell's light below which cells are left out, 0 to 1.
    pub threshold: f32,
}

/// Which glyph is the one that fills its cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brightest {
    /// What of coloured light counts.
    pub hue: Hue,
    /// The share of glyphs that may not be larger: 1 for all of them.
    pub quantile: f32,
}

impl Default for Brightest {
    fn default() -> Self {
        Brightest { hue: Hue::Mean, quantile: 1.0 }
    }
}

/// All that is to be seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// The flat views, from left to right.
    pub panes: Vec<Pane>,
    /// The level that they show.
    pub layer: Layer,
    /// Where they cut.
    pub plane: Plane,
    /// What cells' errors are against.
    pub against: Expectation,
    /// Which glyph fills its cell.
    pub brightest: Brightest,
    /// The three-dimensional view, if it is open.
    pub cloud: Option<CloudAsk>,
}

/// One view as it is.
#[derive(Clone, Debug)]
pub struct Shown {
    /// What was asked for.
    pub pane: Pane,
    /// The iteration that is shown.
    pub iteration: usize,
    /// Whether an iteration asked for is no longer remembered, so that the present one is shown.
    pub forgotten: bool,
    /// The light.
    pub slice: Arc<Slice>,
    /// The intensity that makes the brightest glyph of all iterations at hand fill its cell, where there is one.
    pub of_run: Option<f32>,
    /// The error of each of the slice's cells. Differences have none, and level 0 has none but against what truly
    /// arrives.
    pub errors: Vec<Option<CellError>>,
    /// The level to sample for each finest cell of the cut, row by row from below.
    pub index: Vec<u8>,
    /// The occupied finest cells of the cut, (column, row).
    pub occupied: Vec<[usize; 2]>,
}

/// A lit cell in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudCell {
    /// Its middle, in finest cells.
    pub centre: [f32; 3],
    /// Its side, in finest cells.
    pub span: f32,
    /// Its light in red, green and blue.
    pub light: [Sh<f32>; 3],
    /// The cell that it was sampled from.
    pub pin: Pin,
}

/// The three-dimensional view as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Finest cells along a side.
    pub side: usize,
    /// The cells above the threshold, the strongest first.
    pub cells: Vec<CloudCell>,
    /// The middles of the occupied cells at the surface of occluders, in finest cells.
    pub occupied: Vec<[f32; 3]>,
    /// Their side, in finest cells.
    pub occupied_span: f32,
    /// Cells above the threshold that there was no room for.
    pub left_out: usize,
    /// The level that is the finest shown, where there was no room for the cells of the level asked for, and how many
    /// those are.
    pub coarsened: Option<(usize, usize)>,
    /// The strongest cell's mean light, c00.
    pub strongest: f32,
}

/// A cell that stays in sight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pin {
    /// The octree's level.
    pub level: usize,
    /// The cell, counted in its level.
    pub cell: crate::field::Cell,
}

/// What one neighbour sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sent {
    /// The way that the light went, from the neighbour into the cell.
    pub towards: Direction,
    /// All that arrived, in red, green and blue.
    pub light: [Sh<f32>; 3],
    /// The mean of the colours' c00 that came to the face in each of [`Direction::ALL`], by where its lobe points.
    pub faces: [f32; 6],
}

/// What a pinned cell held after one iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct PinSample {
    /// The iteration.
    pub iteration: usize,
    /// S_k in red, green and blue.
    pub source: [Sh<f32>; 3],
    /// S_A in red, green and blue.
    pub accumulated: [Sh<f32>; 3],
    /// What its neighbours sent it, where light goes by a scheme.
    pub received: Vec<Sent>,
}
