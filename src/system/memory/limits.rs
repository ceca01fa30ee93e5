//! What the limits of the process leave of memory: `ulimit -v` and `ulimit -d` of the shell that started it. Linux
//! tells them, and what has been taken, under /proc/self.

use std::fs;
use std::path::Path;

/// Bytes that may still be taken; `None` where there is no limit, or none is told.
pub(super) fn left(root: &Path) -> Option<u64> {
    let limits = fs::read_to_string(root.join("proc/self/limits")).ok()?;
    let status = fs::read_to_string(root.join("proc/self/status")).ok()?;
    let of = |limit: &str, taken: &str| Some(bytes(&limits, limit)?.saturating_sub(kilobytes(&status, taken)? * 1024));
    [of("Max address space", "VmSize:"), of("Max data size", "VmData:")].into_iter().flatten().min()
}

/// The soft limit of a line such as `Max address space     1073741824     unlimited     bytes`.
fn bytes(limits: &str, name: &str) -> Option<u64> {
    limits.lines().find_map(|line| line.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
}

/// The number of a line such as `VmSize:     5120 kB`.
fn kilobytes(status: &str, name: &str) -> Option<u64> {
    status.lines().find_map(|line| line.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tighter_limit_counts() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("proc/self");
        fs::create_dir_all(&folder).unwrap();
        assert_eq!(left(root.path()), None);
        fs::write(folder.join("status"), "Name:\tlab\nVmSize:\t    2048 kB\nVmData:\t  1024 kB\n").unwrap();
        let limits = |space: &str, data: &str| {
            let text = format!(
                "Limit                     Soft Limit           Hard Limit           Units\n\
                 Max data size             {data:<20} unlimited            bytes\n\
                 Max address space         {space:<20} unlimited            bytes\n"
            );
            fs::write(folder.join("limits"), text).unwrap();
            left(root.path())
        };
        assert_eq!(limits("unlimited", "unlimited"), None);
        assert_eq!(limits("8388608", "unlimited"), Some((8 - 2) << 20));
        assert_eq!(limits("8388608", "3145728"), Some((3 - 1) << 20));
        assert_eq!(limits("1048576", "unlimited"), Some(0));
    }
}
