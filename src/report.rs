//! What the lab shows: slices of light as polar glyphs, pictures, plots and tables.
//!
//! Everything here is pure: values in, outlines, text or bytes out. The window draws the same
//! [`mod@slice`], [`glyph`] and [`colour`] with its own meshes.

pub(crate) mod apng;
mod axis;
pub mod colour;
pub mod error_figure;
pub(crate) mod fonts;
pub mod glyph;
pub mod number;
pub(crate) mod pareto_figure;
pub mod picture;
pub mod plot;
pub(crate) mod port;
pub mod radiance;
pub(crate) mod raster;
pub(crate) mod shadow_map;
pub mod sheet;
pub mod slice;
mod svg;
pub mod table;

pub use raster::RasterError;
