//! lpv-lab: an interactive laboratory for light propagation volumes in an octree.
//!
//! The house, each floor using only floors below it:
//!
//! | floor | module | what lives there |
//! |---|---|---|
//! | 8 | `app`, [`cli`] | the window; the headless commands |
//! | 7 | [`report`] | glyphs, pictures, plots, tables |
//! | 6 | [`study`] | questions put to simulations: errors, references, comparisons, benchmarks |
//! | 5 | [`simulation`] | the stepper: clear, inject, downsample, propagate once, merge |
//! | 4 | [`scene`] | the preset document, injectors, occluders, cell files |
//! | 3 | [`propagate`] | what a propagator is, the registry, the loops |
//! | 2 | [`field`] | grids, octrees, the index volume |
//! | 2 | [`mesh`] | triangles, materials, readers, rays |
//! | 1 | [`sh`] | two-band spherical harmonics |
#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used))]

#[cfg(feature = "app")]
pub mod app;
pub mod cli;
pub mod field;
pub mod mesh;
pub mod report;
pub mod scene;
pub mod sh;
pub mod simulation;
pub mod study;
pub mod system;
pub mod transport;
