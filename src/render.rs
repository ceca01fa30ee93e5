//! What a camera or a surface sees: direct light with exact shadows, light sampled from cells, and the truth.
//!
//! - [`view`]: from pixels to rays. [`image`]: pictures of linear radiance and their files.
//! - [`world`]: a mesh and its [lamps](lamp), as rays want them; direct light with exact shadows.
//! - [`stage`]: a problem's mesh, lights and camera made ready, and what a run's light gives to its surfaces.
//! - [`surface`]: patches of a surface, and what truly reaches them. [`cells`] and [`patch_light`]: what a volume says does.
//! - [`seen`]: a picture of a scene whose reflected light somebody else knows.
//! - [`truth`]: what light does in the scene itself, path traced ([`bounce`], [`estimate`], [`sampler`], [`sequence`],
//!   [`sparks`]).

pub(crate) mod bounce;
pub(crate) mod cells;
pub(crate) mod estimate;
pub mod image;
pub(crate) mod lamp;
pub(crate) mod patch_light;
pub(crate) mod rgb;
pub(crate) mod sampler;
pub(crate) mod seen;
pub(crate) mod sequence;
pub(crate) mod sparks;
pub mod stage;
pub mod surface;
pub mod truth;
pub mod view;
pub mod world;

pub use bounce::Bounces;
pub use lamp::{Lamp, Ray};
pub use seen::Seen;

#[cfg(test)]
mod closed_forms;
