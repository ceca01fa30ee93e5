//! What the lab shows: slices of light as polar glyphs, pictures, plots and tables.
//!
//! Everything here is pure: values in, outlines, text or bytes out. The window draws the same
//! [`mod@slice`], [`glyph`] and [`colour`] with its own meshes.

pub mod apng;
mod axis;
pub mod colour;
pub mod error_figure;
pub mod fonts;
pub mod glyph;
pub mod number;
pub mod pareto_figure;
pub mod picture;
pub mod plot;
pub mod port;
pub mod radiance;
pub mod raster;
pub mod shadow_map;
pub mod sheet;
pub mod slice;
mod svg;
pub mod table;
