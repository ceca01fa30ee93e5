//! Files in memory, and what must hold of any mesh that is read from them.

use std::path::Path;

use lpv_lab::mesh::Bvh;
use lpv_lab::mesh::read::{Files, Unread, read};

struct Memory<'a>(&'a [(&'a str, &'a [u8])]);

impl Files for Memory<'_> {
    fn read(&self, path: &Path, _: u64) -> Result<Vec<u8>, Unread> {
        let file = self.0.iter().find(|(name, _)| Path::new(name) == path);
        file.map(|(_, bytes)| bytes.to_vec()).ok_or(Unread::Missing)
    }
}

/// Reads a mesh; a refusal is one line, and what is read is sound and can be met by rays.
pub fn read_mesh(name: &str, files: &[(&str, &[u8])]) {
    match read(Path::new(name), &Memory(files), &mut |_| {}) {
        Err(fault) => assert_eq!(fault.to_string().lines().count(), 1),
        Ok(loaded) => {
            let mesh = loaded.mesh;
            assert!((0..mesh.len()).all(|i| mesh.area(i) > 0.0 && mesh.normal(i).is_normalized()));
            let bvh = Bvh::new(&mesh);
            let [low, high] = mesh.bounds();
            bvh.closest(low - (high - low), high - low, f64::INFINITY);
        }
    }
}
