//! Any text as a preset: refused in one line with its place, or read; what is read is written and read back equal.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use lpv_lab::scene::Preset;

fuzz_target!(|text: &str| {
    match Preset::parse(text, Path::new("p.ron")) {
        Ok(preset) => assert_eq!(Preset::parse(&preset.to_ron(), Path::new("p.ron")), Ok(preset)),
        Err(error) => {
            let line = error.to_string();
            assert!(line.lines().count() == 1 && line.starts_with("p.ron:") && line.contains("; "), "{line}");
        }
    }
});
