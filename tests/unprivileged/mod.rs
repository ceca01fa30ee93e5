//! For tests of what permissions forbid: the superuser passes by every permission, so as that user they would
//! prove nothing.

use std::fs::{self, File, Permissions};
use std::io::ErrorKind;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::process::Command;

/// Says that this program was started as a user without privileges.
const AS_NOBODY: &str = "LPV_LAB_TEST_AS_NOBODY";
/// The user and the group that own nothing.
const NOBODY: u32 = 65534;

/// Runs `check` as a user whom permissions bind. The superuser starts a copy of this program as nobody, with only the
/// test of this name, which must be the caller's.
pub fn check(test: &str, check: impl FnOnce()) {
    let folder = tempfile::tempdir().expect("a folder");
    let locked = folder.path().join("locked");
    fs::write(&locked, "").expect("writable");
    fs::set_permissions(&locked, Permissions::from_mode(0o000)).expect("changeable");
    if File::open(&locked).is_err() {
        return check();
    }
    assert!(std::env::var_os(AS_NOBODY).is_none(), "permissions must bind nobody");
    // A copy, because the program may lie in a folder that nobody may enter.
    let program = folder.path().join("test");
    fs::copy(std::env::current_exe().expect("this program"), &program).expect("copied");
    fs::set_permissions(folder.path(), Permissions::from_mode(0o777)).expect("changeable");
    let mut command = Command::new(&program);
    command.args(["--exact", test]).env(AS_NOBODY, "").env("TMPDIR", folder.path()).current_dir(folder.path());
    command.uid(NOBODY).gid(NOBODY);
    let output = loop {
        match command.output() {
            // Another test that starts a program just now holds the copy open until it has started.
            Err(error) if error.kind() == ErrorKind::ExecutableFileBusy => std::thread::yield_now(),
            output => break output.expect("started"),
        }
    };
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.contains("1 passed"), "{said}{}", String::from_utf8_lossy(&output.stderr));
}
