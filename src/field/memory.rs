//! What light takes of the machine's memory, and what the machine has left.

mod control_group;

use std::path::Path;

use super::grid::Layout;
use super::octree::Levels;

/// Bytes of a simulation's light: for each channel the octrees source, target and accumulated and the
/// merged grid, all in numbers of type `T`, and a bit a cell for the index volume.
pub fn of_simulation<T>(sizes: Levels, channels: usize) -> u64 {
    let octree: u64 = sizes.sides().map(of_grid::<T>).sum();
    let light = 3 * octree + of_grid::<T>(sizes.finest());
    light * channels as u64 + sizes.cells() as u64 / 8
}

/// Bytes of one grid of side `n`, padding and all.
pub fn of_grid<T>(n: usize) -> u64 {
    4 * Layout::new(n).plane_len() as u64 * size_of::<T>() as u64
}

/// Bytes that can be taken before the machine runs out, as Linux estimates them, or the container or service that
/// the program runs in; `None` where neither is known.
pub fn free() -> Option<u64> {
    free_under(Path::new("/"))
}

/// The same, with the system's files under `root`.
fn free_under(root: &Path) -> Option<u64> {
    let of_machine = std::fs::read_to_string(root.join("proc/meminfo")).ok().and_then(|text| available(&text));
    [of_machine, control_group::left(root)].into_iter().flatten().min()
}

/// The line `MemAvailable:  123 kB` of /proc/meminfo.
fn available(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// A number of bytes as people say it, `3.4 GiB`.
pub fn in_words(bytes: u64) -> String {
    match bytes {
        0x4000_0000.. => format!("{:.1} GiB", bytes as f64 / f64::from(1u32 << 30)),
        _ => format!("{:.1} MiB", bytes as f64 / f64::from(1u32 << 20)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Grid, IndexVolume, Octree};

    #[test]
    fn what_is_computed_is_what_is_allocated() {
        for (size, coarsest) in [(1, 1), (8, 1), (64, 2)] {
            let sizes = Levels::new(size, coarsest).unwrap();
            let light = 3 * Octree::<f32>::new(sizes).bytes() + Grid::<f32>::new(size).bytes();
            let computed = of_simulation::<f32>(sizes, 2);
            let allocated = (2 * light + IndexVolume::new(sizes).bytes()) as u64;
            // Marks are kept in whole words a row, which small levels do not fill.
            assert!(computed <= allocated && allocated - computed < allocated / 10 + 1024, "{computed}, {allocated}");
        }
    }

    #[test]
    fn the_largest_volume_is_told_in_words() {
        let sizes = Levels::new(1024, 1).unwrap();
        // 3 · 8/7 + 1 grids of 4 · 4 bytes a cell, less than 10 % more with padding.
        let least = (3.0 * 8.0 / 7.0 + 1.0) * 16.0;
        let words = in_words(of_simulation::<f32>(sizes, 1));
        let told: f64 = words.strip_suffix(" GiB").unwrap().parse().unwrap();
        assert!(told > least && told < 1.1 * least, "{words}");
    }

    #[test]
    fn the_machine_and_its_groups_are_asked_and_the_least_counts() {
        let root = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = root.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        assert_eq!(free_under(root.path()), None);
        write("proc/meminfo", "MemAvailable: 8 kB\n");
        assert_eq!(free_under(root.path()), Some(8192));
        write("proc/self/cgroup", "0::/\n");
        write("sys/fs/cgroup/memory.current", "1000\n");
        for (limit, free) in [("max", 8192), ("100000", 8192), ("5000", 4000), ("500", 0)] {
            write("sys/fs/cgroup/memory.max", limit);
            assert_eq!(free_under(root.path()), Some(free), "{limit}");
        }
    }

    #[test]
    fn the_line_of_linux_is_read_and_no_other() {
        let text = "MemTotal:       16 kB\nMemFree:  2 kB\nMemAvailable:    1024 kB\nBuffers: 3 kB\n";
        assert_eq!(available(text), Some(1 << 20));
        for text in ["", "MemAvailable: lots", "MemAvailable: 7", "MemAvailable: 99999999999999999999 kB"] {
            assert_eq!(available(text), None, "{text}");
        }
    }
}
