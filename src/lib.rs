//! lpv-lab: an interactive laboratory for light propagation volumes in an octree.
//!
//! The house, each floor using only floors below it:
//!
//! | floor | module | what lives there |
//! |---|---|---|
//! | 9 | `app`, [`cli`] | the window; the headless commands |
//! | 8 | [`report`] | glyphs, pictures, plots, tables |
//! | 7 | [`study`] | questions put to simulations: errors, references, comparisons, benchmarks |
//! | 6 | [`render`] | what a camera or a surface sees: camera, direct light, the truth |
//! | 5 | [`simulation`] | the stepper: clear, inject, downsample, propagate once, merge |
//! | 4 | [`transport`] | every way light travels: the schemes of the lattice, ordinates, straight lines |
//! | 3 | [`scene`] | the preset document, injectors, occluders, cell files, and the problem they end in |
//! | 2 | [`field`] | grids, octrees, the index volume |
//! | 2 | [`mesh`] | triangles, materials, readers, rays |
//! | 1 | [`sh`] | two-band spherical harmonics |
//! | 0 | [`system`] | memory that is free |
#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used))]

#[cfg(feature = "app")]
pub mod app;
pub mod cli;
pub mod field;
pub mod mesh;
pub mod render;
pub mod report;
pub mod scene;
pub mod sh;
pub mod simulation;
pub mod study;
pub mod system;
pub mod transport;
