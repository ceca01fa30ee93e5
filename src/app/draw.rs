//! What the window draws itself: slices, glyphs, light in space.

pub mod axis;
pub mod ball;
pub mod borders;
pub mod clip;
pub mod glyphs;
pub mod grids;
pub mod ink;
pub mod lobes;
pub mod mesh_cut;
pub mod placing;
pub mod scales;
pub mod space;
pub mod sprites;
pub mod stage;
pub mod style;
