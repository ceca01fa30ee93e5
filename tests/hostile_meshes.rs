//! Meshes that are broken, that lie, or that mean harm: the program says why in one line and ends with exit code 2,
//! within a gibibyte of memory.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;

use assert_cmd::Command;

/// A binary glTF of this JSON and binary part.
fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    for number in [2, (28 + json.len() + binary.len()) as u32, json.len() as u32] {
        out.extend(number.to_le_bytes());
    }
    out.extend(b"JSON");
    out.extend(json);
    out.extend((binary.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(binary);
    out
}

/// A good document of one triangle, its three corners as 36 bytes; `buffer` is its buffer's uri, if any.
fn document(buffer: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}], "buffers": [{{{buffer}"byteLength": 36}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}]}}"#
    )
}

fn triangle(x: f32) -> Vec<u8> {
    [0.0, 0.0, 0.0, x, 0.0, 0.0, 0.0, 1.0, 0.0f32].iter().flat_map(|c| c.to_le_bytes()).collect()
}

/// The files that no mesh can be made of: name and bytes.
fn hostile() -> Vec<(String, Vec<u8>)> {
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let many_corners = "1 2 3 ".repeat(400);
    let deep = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    let chain: String = (0..400).map(|i| format!(r#"{{"children": [{}]}},"#, i + 1)).collect();
    let texts: Vec<(&str, String)> = vec![
        ("empty.obj", String::new()),
        ("no-faces.obj", corners.to_owned()),
        ("nan.obj", format!("{corners}v nan 0 0\nf 1 2 4\n")),
        ("infinite.obj", format!("{corners}v 1e39 0 0\nf 1 2 4\n")),
        ("far.obj", format!("{corners}v 1e30 0 0\nf 1 2 4\n")),
        ("two-numbers.obj", "v 0 0\n".to_owned()),
        ("words.obj", "v one two three\n".to_owned()),
        ("comma.obj", "v 0,5 0,5 0,5\n".to_owned()),
        ("beyond.obj", format!("{corners}f 1 2 4\n")),
        ("zero.obj", format!("{corners}f 0 1 2\n")),
        ("behind.obj", format!("{corners}f -1 -2 -4\n")),
        ("overflow.obj", format!("{corners}f 1 2 18446744073709551617\n")),
        ("smallest.obj", format!("{corners}f 1 2 -9223372036854775808\n")),
        ("texture-beyond.obj", format!("{corners}f 1/9223372036854775807 2/1 3/1\n")),
        ("texture-nan.obj", format!("{corners}vt nan 0\nf 1/1 2/1 3/1\n")),
        ("one-corner.obj", format!("{corners}f 1\n")),
        ("no-corner.obj", format!("{corners}f\n")),
        ("thousand-corners.obj", format!("{corners}f {many_corners}\n")),
        ("slashes.obj", format!("{corners}f ///// 2 3\n")),
        ("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n".to_owned()),
        ("one-point.obj", "v 1 1 1\nf 1 1 1\n".to_owned()),
        ("continued.obj", format!("{corners}f 1 2 \\\n3\n")),
        ("passwd.obj", format!("mtllib ../../../../etc/passwd\n{corners}f 1 2 3\n")),
        ("root.obj", format!("mtllib /etc/passwd\n{corners}f 1 2 3\n")),
        ("folder.obj", format!("mtllib .\n{corners}f 1 2 3\n")),
        ("bad-colour.obj", format!("mtllib bad-colour.mtl\n{corners}usemtl a\nf 1 2 3\n")),
        ("bad-texture.obj", format!("mtllib bad-texture.mtl\n{corners}usemtl a\nf 1 2 3\n")),
        ("no-json.gltf", "glTF?".to_owned()),
        ("list.gltf", "[1, 2, 3]".to_owned()),
        ("deep.gltf", deep),
        ("no-scene.gltf", r#"{"asset": {"version": "2.0"}}"#.to_owned()),
        ("old.gltf", document("").replace("2.0", "1.0")),
        ("no-buffer.gltf", document(r#""uri": "nowhere.bin", "#)),
        ("passwd.gltf", document(r#""uri": "../../etc/passwd", "#)),
        ("far.gltf", document(r#""uri": "https://example.org/a.bin", "#)),
        ("base64.gltf", document(r#""uri": "data:application/octet-stream;base64,?", "#)),
        (
            "draco.gltf",
            document("")
                .replace(r#""scene": 0"#, r#""extensionsRequired": ["KHR_draco_mesh_compression"], "scene": 0"#),
        ),
        ("loop.gltf", document("").replace(r#"{"mesh": 0}"#, r#"{"mesh": 0, "children": [0]}"#)),
        ("chain.gltf", document("").replace(r#"{"mesh": 0}"#, &format!("{chain}{{}}"))),
    ];
    let mut files: Vec<(String, Vec<u8>)> =
        texts.into_iter().map(|(name, text)| (name.to_owned(), text.into_bytes())).collect();
    let good = glb(&document(""), &triangle(1.0));
    let mut add = |name: &str, bytes: Vec<u8>| files.push((name.to_owned(), bytes));
    add("cut.glb", good[..good.len() - 20].to_vec());
    add("header.glb", good[..10].to_vec());
    add("noise.glb", (0..4096u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect());
    add("nan.glb", glb(&document(""), &triangle(f32::NAN)));
    add("billions.glb", glb(&document("").replace(r#""count": 3"#, r#""count": 4000000000"#), &triangle(1.0)));
    add(
        "wrap.glb",
        glb(&document("").replace(r#""byteLength": 36}]"#, r#""byteLength": 18446744073709551615}]"#), &triangle(1.0)),
    );
    add("accessor.glb", glb(&document("").replace(r#""POSITION": 0"#, r#""POSITION": 4294967295"#), &triangle(1.0)));
    add("latin.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl \xe9\nf 1 2 3\n".to_vec());
    add("solid.stl", b"solid a\nendsolid a\n".to_vec());
    files
}

/// Whether the system lets a shell bound the memory of a program.
fn bounded(folder: &Path, preset: &Path) -> std::process::Output {
    let program = assert_cmd::cargo::cargo_bin("lpv-lab");
    let script = format!("ulimit -v 1048576; exec {} scene {}", program.display(), preset.display());
    Command::new("sh").current_dir(folder).args(["-c", &script]).output().unwrap()
}

#[test]
fn each_is_refused_in_one_line_with_exit_code_2_and_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bad-colour.mtl"), "newmtl a\nKd 2 nan 0\n").unwrap();
    std::fs::write(folder.path().join("bad-texture.mtl"), "newmtl a\nmap_Kd bad.png\n").unwrap();
    std::fs::write(folder.path().join("bad.png"), b"\x89PNG\r\n\x1a\nno more").unwrap();
    let files = hostile();
    assert!(files.len() >= 44, "{}", files.len());
    for (name, bytes) in files {
        std::fs::write(folder.path().join(&name), bytes).unwrap();
        let preset = folder.path().join("p.ron");
        std::fs::write(&preset, format!("(version: 1, size: 8, scene: (mesh: \"{name}\"))")).unwrap();
        let output = bounded(folder.path(), &preset);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{name}: {said}");
        assert_eq!(said.lines().count(), 1, "{name}: {said}");
        // The mesh's own file is named, or the one beside it that is at fault.
        let stem = Path::new(&name).file_stem().unwrap().to_str().unwrap();
        assert!([stem, "bad.png", "nowhere.bin", "passwd"].iter().any(|file| said.contains(file)), "{name}: {said}");
        assert!(output.stdout.is_empty(), "{name}");
    }
}
