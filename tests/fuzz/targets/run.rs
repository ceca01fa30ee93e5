//! Any seed as a random scene: run, and held against every rule of the lab.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lpv_lab::system::random::Random;
use lpv_lab::study::stress::{invariants, preset};

fuzz_target!(|seed: u64| {
    let preset = preset(&mut Random::new(seed));
    let report = invariants::check(&preset);
    assert_eq!(report.broken, None, "{}", preset.to_ron());
});
