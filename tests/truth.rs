//! The path tracer against an independent one: Mitsuba 3.9.1, `path`, box filter, 4096 and more samples a pixel.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;

use glam::DVec3;
use lpv_lab::mesh::read::{Files, Unread};
use lpv_lab::mesh::{Bvh, read};
use lpv_lab::render::Bounces;
use lpv_lab::render::Lamp;
use lpv_lab::render::image::Image;
use lpv_lab::render::truth::Truth;
use lpv_lab::render::view::View;
use lpv_lab::render::world::World;
use lpv_lab::study::picture::{self, Difference};

/// The exposure at which FLIP looks at the room.
const EXPOSURE: f32 = 0.5;

struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path, _: u64) -> Result<Vec<u8>, Unread> {
        std::fs::read(path).map_err(|_| Unread::Missing)
    }
}

fn path(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// 64 × 64 pixels of radiance.
fn golden(name: &str) -> Image {
    let file = std::fs::File::open(path(&format!("tests/golden/scenes/{name}"))).unwrap();
    let array = npyz::NpyFile::new(std::io::BufReader::new(file)).unwrap();
    assert_eq!(array.shape(), [64, 64, 3]);
    let numbers: Vec<f32> = array.into_vec().unwrap();
    Image::new(64, numbers.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect())
}

/// The cube room traced with so many paths a pixel: its difference from the golden picture, and its noise.
fn traced(bounces: Bounces, samples: u64, golden_name: &str) -> (Difference, f64) {
    let mesh = read::read(&path("presets/scenes/cube-room.obj"), &Disk, &mut |_| ()).unwrap().mesh;
    let bvh = Bvh::new(&mesh);
    let lamp = Lamp::Point { position: DVec3::new(2.6, 3.2, 2.0), intensity: [10.0; 3] };
    let world = World::new(&mesh, &bvh, vec![lamp]);
    let view = View::new(DVec3::new(2.0, 2.0, 0.2), DVec3::new(2.0, 1.7, 4.0), DVec3::Y, 75.0, [64, 64]).unwrap();
    let truth = Truth::traced(&world, view, bounces, samples, &|_| true).unwrap();
    (picture::difference(&golden(golden_name), &truth.total(), EXPOSURE), truth.noise())
}

#[test]
fn direct_light_is_that_of_an_independent_renderer() {
    let (difference, _) = traced(Bounces::UpTo(0), 512, "truth_cube-room_d2.npy");
    assert!((difference.mean_ratio - 1.0).abs() < 0.003, "{difference:?}");
    assert!(difference.rel_mse < 1e-3 && difference.flip < 0.01, "{difference:?}");
}

#[test]
fn one_bounce_is_that_of_an_independent_renderer() {
    let (difference, noise) = traced(Bounces::UpTo(1), 256, "truth_cube-room_d3.npy");
    assert!((difference.mean_ratio - 1.0).abs() < 0.003, "{difference:?}");
    // Its own noise is 1 % of a pixel's bounced light.
    assert!(difference.rel_mse < 2.0 * (noise * noise + 0.01 * 0.01), "{difference:?}, {noise}");
}

#[test]
fn all_bounces_are_those_of_an_independent_renderer() {
    let (difference, noise) = traced(Bounces::All, 256, "truth_cube-room_d20.npy");
    assert!((difference.mean_ratio - 1.0).abs() < 0.005, "{difference:?}");
    assert!(difference.rel_mse < 2.0 * (noise * noise + 0.01 * 0.01), "{difference:?}, {noise}");
}
