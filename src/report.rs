//! What the lab shows: slices of light as polar glyphs, pictures, plots and tables.
//!
//! Everything here is pure: values in, outlines, text or bytes out. The window draws the same
//! [`slice`], [`glyph`] and [`colour`] with its own meshes.

pub mod colour;
pub mod glyph;
pub mod slice;
