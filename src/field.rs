//! Light in space: one padded planar [`Grid`] a level, the [`Octree`] of levels, the [`IndexVolume`]
//! that says which level to sample where, and the [`Channels`] that carry a scene's colours.

mod channels;
mod distance;
mod grid;
mod index_volume;
pub(crate) mod memory;
mod octree;
mod slabs;

pub use channels::{Channels, Share};
pub use distance::squared_distances;
pub use grid::{Cell, CellList, Grid, Layout, memory_order};
pub use index_volume::{IndexVolume, Marks, row_mask};
pub use octree::{Levels, Octree, downsample_into, mean_of_children};
pub use slabs::Slabs;
