//! What control groups leave a program of the memory: containers and services may have less than the machine.
//!
//! Linux has two versions of them, which can be mounted together: <https://docs.kernel.org/admin-guide/cgroup-v2.html>
//! and <https://docs.kernel.org/admin-guide/cgroup-v1/memory.html>.

use std::fs;
use std::path::Path;

/// Where a version keeps its numbers.
struct Version {
    /// The folders that it may be mounted at, under the root.
    mounts: &'static [&'static str],
    limit: &'static str,
    used: &'static str,
    /// The line of `memory.stat` that counts file contents which are given up as soon as memory is wanted.
    idle: &'static str,
}

const FIRST: Version = Version {
    mounts: &["sys/fs/cgroup/memory"],
    limit: "memory.limit_in_bytes",
    used: "memory.usage_in_bytes",
    idle: "total_inactive_file",
};

const SECOND: Version = Version {
    mounts: &["sys/fs/cgroup", "sys/fs/cgroup/unified"],
    limit: "memory.max",
    used: "memory.current",
    idle: "inactive_file",
};

/// Bytes that this program's groups and all those around them leave it; `None` where there is no limit. The
/// system's files are under `root`.
pub(super) fn left(root: &Path) -> Option<u64> {
    let groups = fs::read_to_string(root.join("proc/self/cgroup")).ok()?;
    groups.lines().filter_map(|line| of_line(root, line)).min()
}

/// What the groups of a line `number:controllers:path` leave; the second version names no controllers.
fn of_line(root: &Path, line: &str) -> Option<u64> {
    let mut fields = line.splitn(3, ':');
    let (number, controllers, group) = (fields.next()?, fields.next()?, fields.next()?);
    match controllers {
        "" if number == "0" => SECOND.left(root, group),
        _ if controllers.split(',').any(|name| name == "memory") => FIRST.left(root, group),
        _ => None,
    }
}

impl Version {
    /// What a group and all those around it leave. In a container the group's own files may stand where the mount
    /// begins, whatever its path says; that place is asked like all those on the way.
    fn left(&self, root: &Path, group: &str) -> Option<u64> {
        let group = Path::new(group.trim_start_matches('/'));
        let places =
            self.mounts.iter().flat_map(|mount| group.ancestors().map(move |part| root.join(mount).join(part)));
        places.filter_map(|folder| self.left_in(&folder)).min()
    }

    fn left_in(&self, folder: &Path) -> Option<u64> {
        let number = |name| fs::read_to_string(folder.join(name)).ok()?.trim().parse::<u64>().ok();
        let (limit, used) = (number(self.limit)?, number(self.used)?);
        let counts = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
        let idle = counts.lines().find_map(|line| line.strip_prefix(self.idle)?.trim().parse().ok()).unwrap_or(0);
        Some(limit.saturating_sub(used.saturating_sub(idle)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A root with these files, and what is left there.
    fn left_with(files: &[(&str, &str)]) -> Option<u64> {
        let root = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        left(root.path())
    }

    #[test]
    fn the_tightest_group_on_the_way_up_counts() {
        let files = [
            ("proc/self/cgroup", "0::/a/b\n"),
            ("sys/fs/cgroup/a/b/memory.max", "max\n"),
            ("sys/fs/cgroup/a/b/memory.current", "10\n"),
            ("sys/fs/cgroup/a/memory.max", "5000\n"),
            ("sys/fs/cgroup/a/memory.current", "2000\n"),
            ("sys/fs/cgroup/memory.max", "9000\n"),
            ("sys/fs/cgroup/memory.current", "2500\n"),
        ];
        assert_eq!(left_with(&files), Some(3000));
        assert_eq!(left_with(&files[..3]), None);
    }

    #[test]
    fn the_first_version_is_read_where_memory_is_under_it() {
        let files = [
            ("proc/self/cgroup", "5:cpu,cpuacct:/\n4:hugetlb,memory:/docker/x\n1:name=systemd:/\n0::/\n"),
            // A container sees its own group where the mount begins.
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "4096\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "96\n"),
        ];
        assert_eq!(left_with(&files), Some(4000));
        let elsewhere = [("proc/self/cgroup", "4:cpu:/\n"), files[1], files[2]];
        assert_eq!(left_with(&elsewhere), None);
    }

    #[test]
    fn contents_of_files_are_given_up_and_do_not_count_as_used() {
        let of = |stat: &'static str, used: &'static str| {
            left_with(&[
                ("proc/self/cgroup", "0::/\n"),
                ("sys/fs/cgroup/unified/memory.max", "1000"),
                ("sys/fs/cgroup/unified/memory.current", used),
                ("sys/fs/cgroup/unified/memory.stat", stat),
            ])
        };
        assert_eq!(of("anon 5\ninactive_file 300\nactive_file 100\n", "900"), Some(400));
        assert_eq!(of("inactive_file 9999\n", "900"), Some(1000));
        assert_eq!(of("inactive_file many\n", "1200"), Some(0));
    }

    #[test]
    fn what_is_no_group_is_passed_over() {
        for text in ["", "\n", "0", "0:", "0::", "::::", "0::/../../x\n"] {
            assert_eq!(left_with(&[("proc/self/cgroup", text)]), None, "{text}");
        }
        let files =
            [("proc/self/cgroup", "0::/\n"), ("sys/fs/cgroup/memory.max", "-1"), ("sys/fs/cgroup/memory.current", "1")];
        assert_eq!(left_with(&files), None);
    }
}
