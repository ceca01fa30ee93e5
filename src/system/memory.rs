//! What the machine has left of its memory.

mod control_group;
mod limits;

use std::path::Path;

/// Bytes that can be taken before the machine runs out, as Linux estimates them, or the container or service that
/// the program runs in, or the limits it was started under (`ulimit -v`); `None` where none is known.
pub fn free() -> Option<u64> {
    free_under(Path::new("/"))
}

/// What any work takes at least, in bytes: threads, tables, a picture and its fonts.
const LEAST: u64 = 32 << 20;
/// Bytes of addresses that the allocator sets aside for a thread's first small need, taken or not; limits on the
/// process count them.
const SET_ASIDE: u64 = 64 << 20;

/// Refuses to begin where not even a small scene could be worked on.
///
/// # Errors
/// One line that says how much there is and how much there should be.
pub fn check() -> Result<(), String> {
    check_under(Path::new("/"))
}

fn check_under(root: &Path) -> Result<(), String> {
    let too_little = |free: Option<u64>, least: u64| free.filter(|free| *free < least).map(|free| (free, least));
    let limited = too_little(limits::left(root), LEAST + SET_ASIDE);
    let Some((free, least)) = limited.or_else(|| too_little(free_under(root), LEAST)) else { return Ok(()) };
    let (free, least) = (in_words(free), in_words(least));
    Err(format!("{free} of memory are free, and at least {least} are needed; close something, or raise `ulimit -v`"))
}

/// As [`free`], with the system's files under `root`.
fn free_under(root: &Path) -> Option<u64> {
    let of_machine = std::fs::read_to_string(root.join("proc/meminfo")).ok().and_then(|text| available(&text));
    [of_machine, control_group::left(root), limits::left(root)].into_iter().flatten().min()
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
    fn a_limit_must_leave_room_for_what_the_allocator_sets_aside() {
        let root = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            std::fs::create_dir_all(root.path().join("proc/self")).unwrap();
            std::fs::write(root.path().join(name), text).unwrap();
        };
        assert_eq!(check_under(root.path()), Ok(()));
        write("proc/meminfo", "MemAvailable: 40960 kB\n");
        assert_eq!(check_under(root.path()), Ok(()));
        write("proc/self/status", "VmSize: 1024 kB\nVmData: 1024 kB\n");
        let limit =
            |mebibytes: u64| write("proc/self/limits", &format!("Max address space {} bytes\n", mebibytes << 20));
        limit(97);
        assert_eq!(check_under(root.path()), Ok(()));
        limit(96);
        assert!(check_under(root.path()).is_err_and(|told| told.contains("95.0 MiB") && told.contains("96.0 MiB")));
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
