//! What the window draws itself: slices, glyphs, light in space.

pub(crate) mod axis;
pub(crate) mod ball;
pub(crate) mod borders;
pub(crate) mod clip;
pub(crate) mod glyphs;
pub(crate) mod grids;
pub(crate) mod ink;
pub(crate) mod lobes;
pub(crate) mod mesh_cut;
pub(crate) mod placing;
pub(crate) mod scales;
pub(crate) mod space;
pub(crate) mod sprites;
pub(crate) mod stage;
pub(crate) mod style;
