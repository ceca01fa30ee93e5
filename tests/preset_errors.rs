//! Presets: those that come with the program load; whatever is wrong with one is told in one line, with
//! its place and what would be right; and nothing that a file may hold makes the reader panic or hang.
#![allow(clippy::expect_used)]

#[cfg(unix)]
mod unprivileged;

use std::fs;
use std::path::{Path, PathBuf};

use lpv_lab::scene::Preset;
use lpv_lab::transport::preset;

/// Reads `text` as the file `p.ron` and gives the error's line.
fn refusal(text: &str) -> String {
    let line = preset::parse(text, Path::new("p.ron")).expect_err(text).to_string();
    assert!(line.lines().count() == 1 && line.contains("; "), "one line with a remedy: {line}");
    line
}

/// Checks that `text` is refused where it says `»`, with all of `words`.
fn refused(text: &str, words: &[&str]) {
    let (before, after) = text.split_once('»').expect("a mark");
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
    let found = refusal(&format!("{before}{after}"));
    let place = format!("p.ron:{line}:{column}: ");
    assert!(found.starts_with(&place), "{text}\n  {found}\n  expected at {place}");
    for word in words {
        assert!(found.contains(word), "{text}\n  {found}\n  lacks {word}");
    }
}

#[test]
fn what_the_parser_refuses_comes_with_place_and_remedy() {
    refused("(version: 1,\n  »siez: 32)", &["`siez`", "`size`"]);
    refused("(version: 1, »weight: 32)", &["`weight`", "title", "propagation"]);
    refused("(version: 1, propagation: (\n    »fcator: 3))", &["`fcator`", "`factor`"]);
    refused("(version: 1, propagation: (snapshots: »Thesys))", &["`Thesys`", "`Thesis`"]);
    refused("(version: 1, injectors: [(kind: »Wal(side: NegX))])", &["`Wal`", "`Wall`"]);
    refused("(version: 1, injectors: [(kind: Wall(side: »Left))])", &["`Left`", "NegX, PosX"]);
    refused("(version: 1, injectors: [(kind: Wall(side: NegX), »oclor: (1, 1, 1))])", &["`color`"]);
    refused("(version: »2, new_in_version_2: 3)", &["version 2", "`version: 1`"]);
    refused("(size: 32»)", &["`version`", "missing"]);
    refused("(version: 1, size: 32, »size: 32)", &["twice"]);
    refused("(version: 1, propagation: (scheme: »cascaded))", &["double quotes"]);
    refused("(version: 1) »more", &["ended"]);
    refused("(version: 1, propagation: (factor: 3,»5, iterations: 1))", &["comma", "decimals", "write 3.5"]);
    refused("(version: 1, propagation: (factor: 0,»25))", &["write 0.25"]);
    refused("»[1, 2]", &["no preset", "(version: 1"]);
    refused("»", &["no preset"]);
}

#[test]
fn what_only_its_meaning_refuses_comes_with_the_values_place() {
    refused("(version: 1, size: »48)", &["48", "power of two", "nearest is 64"]);
    refused("(version: 1, size: »33)", &["nearest is 32"]);
    refused("(version: 1, size: »0)", &["nearest is 1"]);
    refused("(version: 1, size: »2048)", &["nearest is 1024"]);
    refused("(version: 1, size: 8, coarsest: »16)", &["16", "1 to 8"]);
    refused("(version: 1, size: 8, coarsest: »3)", &["3", "power of two"]);
    for number in ["NaN", "inf", "-inf", "1e999", "-1.0"] {
        refused(&format!("(version: 1, propagation: (factor: »{number}))"), &["factor", "finite"]);
    }
    refused("(version: 1, propagation: (iterations: »4000000))", &["4000000", "1000000"]);
    refused("(version: 1, propagation: (scheme: »\"\"))", &["scheme", "cascaded"]);
    refused("(version: 1, occlusion: (amplifier: »-1.0))", &["amplifier"]);
    refused("(version: 1, occlusion: (bounce: »NaN))", &["bounce"]);
}

#[test]
fn injectors_are_refused_at_the_field_that_is_wrong() {
    let injector =
        |text: &str| format!("(version: 1, size: 8, injectors: [\n  (kind: Wall(side: NegX)),\n  {text},\n])");
    // A value that is not written has the place of what it belongs to.
    refused(&injector("»(kind: Single(cell: (1, 2, 3)), color: (1e31, 1, 1))"), &["single precision", "colour"]);
    let one = "(kind: Single(cell: (1, 2, 3)), ";
    for (text, words) in [
        ("(kind: Single(cell: »(1, 8, 3)))".to_owned(), ["(1, 8, 3)", "0 to 7"]),
        ("(kind: Rectangle(from: (0, 0, 0), to: »(1, 9, 0)))".to_owned(), ["(1, 9, 0)", "0 to 7"]),
        ("(kind: Rectangle(from: (0, 3, 0), to: »(1, 2, 0)))".to_owned(), ["y = 2", "smaller"]),
        ("(kind: Rectangle(from: (0, 0, 0), to: »(3, 2, 1)))".to_owned(), ["2 cells thick", "same x, y or z"]),
        (format!("{one}direction: »(0, 0, 0))"), ["length zero", "any other length"]),
        (format!("{one}direction: »(0, inf, 0))"), ["not finite", "any other length"]),
        (format!("{one}direction: »(NaN, 0, 0))"), ["not finite", "any other length"]),
        (format!("{one}color: »(1, -0.5, 1))"), ["-0.5", "zero or more"]),
        (format!("{one}color: »(1, NaN, 1))"), ["NaN", "finite"]),
        (format!("{one}multiplier: »-2)"), ["-2", "zero or more"]),
        (format!("{one}multiplier: »1e31)"), ["single precision", "1e30"]),
        ("(kind: File(path: \"a.csv\"), direction: »(1, 0, 0))".to_owned(), ["its own light", "leave direction out"]),
        ("(kind: File(path: »\"../a.csv\"))".to_owned(), ["`../a.csv`", "out of the preset's folder"]),
        ("(kind: File(path: »\"/etc/passwd\"))".to_owned(), ["`/etc/passwd`", "beside the preset"]),
        ("(kind: File(path: »\"\"))".to_owned(), ["names no file", "beside the preset"]),
    ] {
        refused(&injector(&text), &words);
    }
}

#[test]
fn occluders_are_refused_at_the_field_that_is_wrong() {
    let plane = "(kind: Plane(axis: X, at: 4), ";
    for (text, words) in [
        ("(kind: Box(from: »(0, 0, 8), to: (1, 1, 9)))".to_owned(), ["(0, 0, 8)", "0 to 7"]),
        ("(kind: Box(from: (3, 0, 0), to: »(1, 0, 0)))".to_owned(), ["x = 1", "larger"]),
        ("(kind: Plane(axis: Y, at: »8))".to_owned(), ["outside", "0 to 7"]),
        ("(kind: Plane(axis: »W, at: 4))".to_owned(), ["`W`", "X, Y, Z"]),
        (format!("{plane}normal: »(0, 0, 0))"), ["normal", "length zero"]),
        (format!("{plane}opacity: »1.5)"), ["1.5", "0 to 1"]),
        (format!("{plane}opacity: »NaN)"), ["NaN", "0 to 1"]),
        (format!("{plane}albedo: »(0, 0, -0.1))"), ["-0.1", "0 to 1"]),
        ("(kind: File(path: »\"a/../../b.csv\"))".to_owned(), ["out of the preset's folder", "beside"]),
    ] {
        refused(&format!("(version: 1, size: 8, occluders: [{text}])"), &words);
    }
}

#[test]
fn the_place_is_found_past_comments_strings_and_odd_layout() {
    refused(
        "#![enable(implicit_some)]\n// size: 3, (\n/* /* nested ( */ size: 5 */ (version: 1, title: \"é, size: 7) \\\" (\",\n\tr#size: »12)",
        &["12"],
    );
    refused("\u{feff}(version: 1,\n size: »12)", &["12"]);
    refused("(version: 1, title: r#\"a \" ), size: 3\"#, injectors: [], /* , */ size /* : */ : /**/ »12)", &["12"]);
    refused("(version: 1, injectors: [(kind: Single(cell: (0, 0, 0)),), (kind: Single(cell: »(40, 0, 0)))])", &["40"]);
}

#[test]
fn deep_nesting_is_refused_without_running_out_of_stack() {
    let starts =
        ["[", "(", "{", "/*", "Some(", "\"", "'", "r#", "#![enable(", "(version:(", "(version: 1, title: (", "-"];
    for start in starts {
        refusal(&start.repeat(300_000));
    }
    let inside = "(version: 1, injectors: [(direction: ";
    for start in ["Some(", "(", "["] {
        refusal(&format!("{inside}{}", start.repeat(300_000)));
    }
}

#[test]
fn long_nonsense_is_not_repeated_in_the_error() {
    let name = "a\n".repeat(50_000).replace('\n', "b");
    assert!(refusal(&format!("(version: 1, {name}: 3)")).len() < 300);
    assert!(refusal(&format!("(version: 1, propagation: (snapshots: {name}))")).len() < 300);
}

/// A folder with a preset `p.ron` that injects from `cells.csv`, and the error of loading it.
fn load_error(prepare: impl FnOnce(&Path)) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let preset = folder.path().join("p.ron");
    fs::write(&preset, "(version: 1, size: 8, injectors: [\n  (kind: File(path: \"cells.csv\")),\n])")
        .expect("writable");
    prepare(&folder.path().join("cells.csv"));
    let line = preset::load(&preset).expect_err("a bad file").to_string();
    assert_eq!(line.lines().count(), 1, "{line}");
    line.replace(&*folder.path().to_string_lossy(), "")
}

#[test]
fn a_file_that_cannot_be_opened_is_told_at_its_path_in_the_preset() {
    let missing = load_error(|_| {});
    assert!(missing.starts_with("/p.ron:2:21: `/cells.csv`: no such file; "), "{missing}");
    let folder = load_error(|path| fs::create_dir(path).expect("a folder"));
    assert!(folder.starts_with("/p.ron:2:21: ") && folder.contains("this is a folder"), "{folder}");
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_without_being_opened() {
    let link = |to: &'static str| move |path: &Path| std::os::unix::fs::symlink(to, path).expect("a link");
    for device in ["/dev/zero", "/dev/tty", "/dev/stdin"].into_iter().filter(|d| Path::new(d).exists()) {
        let line = load_error(link(device));
        assert!(line.starts_with("/p.ron:2:21: "), "{device}: {line}");
    }
    let pipe = load_error(|path| {
        let made = std::process::Command::new("mkfifo").arg(path).status().expect("mkfifo");
        assert!(made.success());
    });
    assert!(pipe.contains("a pipe or a device"), "{pipe}");
}

#[cfg(unix)]
#[test]
fn a_file_without_permission_is_refused() {
    use std::os::unix::fs::PermissionsExt;
    unprivileged::check("a_file_without_permission_is_refused", || {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("p.ron");
        fs::write(&path, "(version: 1)").expect("writable");
        assert!(Preset::load(&path).is_ok());
        fs::set_permissions(&path, fs::Permissions::from_mode(0o000)).expect("changeable");
        let line = Preset::load(&path).expect_err("no permission").to_string();
        assert!(line.contains("p.ron: permission denied; "), "{line}");
    });
}

#[test]
fn a_preset_file_that_is_too_long_or_not_text_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("p.ron");
    // A sparse file: it claims a terabyte and holds nothing.
    fs::File::create(&path).and_then(|file| file.set_len(1 << 40)).expect("a sparse file");
    let line = Preset::load(&path).expect_err("too long").to_string();
    assert!(line.contains("p.ron: 1099511627776 bytes are too many; at most 4194304"), "{line}");
    fs::write(&path, b"(version: 1,\n title: \"\xff\")").expect("writable");
    let line = Preset::load(&path).expect_err("no text").to_string();
    assert!(line.contains("p.ron:2: this line is not UTF-8"), "{line}");
    assert!(Preset::load(folder.path()).expect_err("a folder").to_string().contains("this is a folder"));
}

/// The presets that come with the program.
fn presets() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets");
    let entries = fs::read_dir(folder).expect("presets").map(|entry| entry.expect("an entry").path());
    entries.filter(|path| path.extension().is_some_and(|extension| extension == "ron")).collect()
}

#[test]
fn every_preset_loads_says_what_to_look_for_and_lights_something() {
    assert!(presets().len() >= 14);
    for path in presets() {
        let text = fs::read_to_string(&path).expect("text");
        assert!((2..=4).contains(&text.lines().take_while(|line| line.starts_with("// ")).count()), "{path:?}");
        let (preset, problem) = preset::load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!(!preset.title.is_empty(), "{path:?}");
        assert!(problem.sources.iter().any(|source| !source.light.is_empty()), "{path:?}");
        let has_solids = !preset.occluders.is_empty() || preset.scene.is_some();
        assert_eq!(has_solids, !problem.solids.is_empty(), "{path:?}");
        assert_eq!(Preset::parse(&preset.to_ron(), &path).as_ref(), Ok(&preset), "{path:?}");
    }
}
