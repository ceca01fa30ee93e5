//! Any bytes as a file of occluders: one line that says why not, or blockers inside the volume.
#![no_main]

mod scratch;

use libfuzzer_sys::fuzz_target;
use lpv_lab::scene::occluder::{Occluder, OccluderKind};
use lpv_lab::scene::{Preset, Problem};

fuzz_target!(|bytes: &[u8]| {
    let path = scratch::file("walls.csv", bytes);
    let occluder = Occluder::new(OccluderKind::File { path: "walls.csv".into() });
    let preset = Preset { size: 4, occluders: vec![occluder], ..Preset::default() };
    match Problem::build(&preset, path.parent().expect("a folder")) {
        Ok(problem) => {
            for blocker in &problem.solids {
                assert!(blocker.cell.iter().all(|c| *c < 4) && blocker.opacity.iter().all(|o| (0.0..=1.0).contains(o)));
                assert!(blocker.normal.is_finite() && blocker.normal.length() < 1.0 + 1e-9);
            }
        }
        Err(error) => {
            let line = error.to_string();
            assert!(line.lines().count() == 1 && line.contains("walls.csv") && line.contains("; "), "{line}");
        }
    }
});
