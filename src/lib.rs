//! lpv-lab: an interactive laboratory for light propagation volumes in an octree.
//!
//! # Quick start
//!
//! Build a scene, run it, look into a cell, and hold the light against what it ought to be:
//!
//! ```
//! use std::path::Path;
//!
//! use lpv_lab::scene::injector::{Injector, InjectorKind};
//! use lpv_lab::scene::{Preset, Problem};
//! use lpv_lab::simulation::Simulation;
//! use lpv_lab::study::expectation::{Expectation, References};
//!
//! let lobe = Injector {
//!     direction: Some([1.0, 0.0, 0.0]),
//!     ..Injector::new(InjectorKind::Single { cell: [8, 8, 8] })
//! };
//! let preset = Preset { size: 16, injectors: vec![lobe], ..Preset::default() };
//! let problem = Problem::build(&preset, Path::new(""))?;
//!
//! let mut simulation = Simulation::<f32>::new(problem)?;
//! simulation.run(|now| now.iteration() < 4);
//! let merged = simulation.lights()[0].merged.as_ref().expect("a run ends in a merge");
//! // c00 and the direction of the flow: ahead of the lobe there is more light than behind it.
//! assert!(merged.get([10, 8, 8]).0[0] > merged.get([6, 8, 8]).0[0]);
//!
//! let errors = Expectation::Merged.rows(&simulation, &References::default());
//! assert!(errors[0].l1_ratio > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Or step by step, in any order and any number of times:
//!
//! ```
//! use std::path::Path;
//!
//! use lpv_lab::scene::Problem;
//! use lpv_lab::simulation::{Action, Simulation};
//! use lpv_lab::transport::preset;
//!
//! let text = "(version: 1, size: 8, injectors: [(kind: Wall(side: NegX))])";
//! let problem = Problem::build(&preset::parse(text, Path::new("wall.ron"))?, Path::new(""))?;
//! let mut simulation = Simulation::<f32>::new(problem)?;
//! simulation.act(Action::Inject);
//! simulation.act(Action::Downsample);
//! let change = simulation.act(Action::Propagate);
//! // From the wall at x = 0 light has moved one cell further.
//! assert!(change.iteration == 1 && change.newly_lit >= 64);
//! assert!(simulation.index().level(0).get([1, 3, 3]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Where to go on: [`study::compare`] puts schemes side by side, [`study::artefacts`] says what goes wrong with
//! light, [`study::difference`] holds one run against another, [`report::error_figure`] and [`report::picture`] draw,
//! [`scene::cell_file`] reads and writes the light of cells.
//!
//! # What is public
//!
//! What a program of your own is built from; all else may change at any time:
//!
//! - [`scene`]: the [preset](scene::Preset) and its parts, built in code or read from a file, and the
//!   [`Problem`](scene::Problem) they end in; [cell files](scene::cell_file).
//! - [`simulation`]: a run, whole or step by step, and its [options](simulation::options).
//! - [`field`], [`sh`]: the light that a run gives, cell by cell and level by level.
//! - [`transport`]: the registry ([`transport::kinds`], [`transport::find`]), the trait of every way light travels,
//!   the [schemes](transport::lattice::schemes) of the lattice as data and the
//!   [kernel](transport::lattice::kernel::plain) that defines what they do.
//! - [`study`]: what light is held against ([`study::expectation`]), and what is asked of several runs.
//! - [`mesh`], [`render`]: triangles from files, cameras, direct light, pictures and their
//!   [truth](render::truth).
//! - [`report`]: figures, pictures, tables.
//! - `system`, `cli`, `app`: what the program itself and its tests need.
//!
//! # The house
//!
//! Each floor uses only floors below it:
//!
//! | floor | module | what lives there |
//! |---|---|---|
//! | 9 | `app`, [`cli`] | the window; the headless commands |
//! | 8 | [`report`] | glyphs, pictures, plots, tables |
//! | 7 | [`study`] | questions put to simulations: errors, references, comparisons, benchmarks |
//! | 6 | [`render`] | what a camera or a surface sees: camera, direct light, the truth |
//! | 5 | [`simulation`] | the stepper: clear, inject, downsample, propagate once, merge |
//! | 4 | [`transport`] | every way light travels: the schemes of the lattice, directions kept, straight lines |
//! | 3 | [`scene`] | the preset document, injectors, occluders, cell files, and the problem they end in |
//! | 2 | [`field`] | grids, octrees, the index volume |
//! | 2 | [`mesh`] | triangles, materials, readers, rays |
//! | 1 | [`sh`] | two-band spherical harmonics |
//! | 0 | [`system`] | memory that is free |
#![forbid(unsafe_code)]
// The docs of a module speak of its private parts too: `cargo doc --document-private-items` links them, and a name
// that is gone is an error in either case.
#![allow(rustdoc::private_intra_doc_links)]
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
