//! Whatever bytes a glTF file holds, as text or binary, reading them ends in a mesh or in one line.
#![no_main]

mod memory;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    memory::read_mesh("a.glb", &[("a.glb", bytes), ("a.bin", &[0; 64])]);
});
