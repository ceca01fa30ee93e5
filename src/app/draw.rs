//! What the window draws itself: slices, glyphs, light in space.

pub mod axis;
pub mod glyphs;
pub mod grids;
pub mod ink;
pub mod space;
pub mod sprites;
pub mod stage;
pub mod style;
