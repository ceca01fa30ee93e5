//! Whatever bytes an OBJ file and its library hold, reading them ends in a mesh or in one line.
#![no_main]

mod memory;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // What follows the first zero byte is the library of materials.
    let mut parts = bytes.splitn(2, |byte| *byte == 0);
    let (mesh, library) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
    memory::read_mesh("a.obj", &[("a.obj", mesh), ("a.mtl", library)]);
});
