//! The licences of everything that the program is built from: each must be one that lets anybody use and
//! pass it on. Cargo itself lists them, from the lock file.
#![allow(clippy::expect_used)]

use std::process::Command;

/// Licences that ask for no more than to be named.
const PERMISSIVE: [&str; 11] = [
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "ISC",
    "MIT",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];
/// Those of the fonts in the window and the exported pictures.
const FONTS: [&str; 2] = ["OFL-1.1", "Ubuntu-font-1.0"];

/// Whether every part of an expression that counts offers a licence from the lists.
fn is_permissive(expression: &str) -> bool {
    let bare = expression.replace(['(', ')'], "").replace('/', " OR ");
    let known = |licence: &str| PERMISSIVE.contains(&licence) || FONTS.contains(&licence);
    bare.split(" AND ").all(|part| part.split(" OR ").map(str::trim).any(known))
}

#[test]
fn every_dependency_may_be_used_and_passed_on() {
    let tree = ["tree", "--offline", "--locked", "--edges", "normal,build,dev", "--prefix", "none", "--no-dedupe"];
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(tree).args(["--format", "{p}|{l}"]).current_dir(env!("CARGO_MANIFEST_DIR"));
    let output = cargo.output().expect("cargo");
    let listed = String::from_utf8(output.stdout).expect("text");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut count = 0;
    for line in listed.lines() {
        let (package, licence) = line.split_once('|').expect("a package and its licence");
        assert!(is_permissive(licence), "{package} has the licence `{licence}`");
        count += 1;
    }
    assert!(count > 50, "{listed}");
}

#[test]
fn other_licences_are_told_apart() {
    for good in ["MIT", "MIT/Apache-2.0", "Apache-2.0 OR GPL-2.0-only", "(MIT OR Apache-2.0) AND Unicode-3.0"] {
        assert!(is_permissive(good), "{good}");
    }
    for bad in ["", "GPL-3.0-only", "MIT AND GPL-3.0-only", "LGPL-2.1 OR MPL-2.0", "MITNFA"] {
        assert!(!is_permissive(bad), "{bad}");
    }
}
