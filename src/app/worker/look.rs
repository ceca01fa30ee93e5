//! What the window asks to see and what it gets: plain data between it and the worker.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::report::slice::{Plane, Slice};
use crate::sh::Sh;
use crate::study::error::CellError;
use crate::study::expectation::Expectation;

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

    /// Its symbol after iteration `k`, where there is little room.
    pub fn letter(self, k: usize) -> String {
        match self {
            Light::Source => format!("S_{k}"),
            Light::Target => k.checked_sub(1).map_or("empty".to_owned(), |k| format!("S_{k}")),
            Light::Accumulated => "S_A".to_owned(),
        }
    }

    /// Its symbol after iteration `k`.
    pub fn symbol(self, k: usize) -> String {
        match self {
            Light::Source => format!("S_{k}"),
            Light::Target if k == 0 => "empty until the first iteration".to_owned(),
            Light::Target => format!("S_{}", k - 1),
            Light::Accumulated if k == 0 => "S_A = S_0".to_owned(),
            Light::Accumulated if k == 1 => "S_A = S_0 + S_1".to_owned(),
            Light::Accumulated => format!("S_A = S_0 + … + S_{k}"),
        }
    }
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
    /// Cells above the threshold that there was no room for.
    pub left_out: usize,
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

/// What a pinned cell held after one iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinSample {
    /// The iteration.
    pub iteration: usize,
    /// S_k in red, green and blue.
    pub source: [Sh<f32>; 3],
    /// S_A in red, green and blue.
    pub accumulated: [Sh<f32>; 3],
}
