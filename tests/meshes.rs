//! Meshes read from files: what each format says, what can be helped, and what is refused with its place.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};
use lpv_lab::mesh::read::{Files, LampKind, Loaded, Unread, read};
use lpv_lab::system::file::FileError;

/// Files in memory.
struct Memory(HashMap<PathBuf, Vec<u8>>);

impl Memory {
    fn of(files: &[(&str, &[u8])]) -> Self {
        Memory(files.iter().map(|(name, bytes)| (PathBuf::from(name), bytes.to_vec())).collect())
    }
}

impl Files for Memory {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, Unread> {
        let bytes = self.0.get(path).ok_or(Unread::Missing)?;
        assert!(bytes.len() as u64 <= limit);
        Ok(bytes.clone())
    }
}

fn load(name: &str, files: &[(&str, &[u8])]) -> Result<Loaded, FileError> {
    read(Path::new(name), &Memory::of(files), &mut |_| {})
}

fn obj(text: &str) -> Result<Loaded, FileError> {
    load("a.obj", &[("a.obj", text.as_bytes())])
}

fn shipped(name: &str) -> Loaded {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/scenes");
    let bytes = |ending: &str| std::fs::read(folder.join(name).with_extension(ending)).unwrap();
    let (mesh, library) = (format!("{name}.obj"), format!("{name}.mtl"));
    load(&mesh, &[(&mesh, &bytes("obj")), (&library, &bytes("mtl"))]).unwrap()
}

#[test]
fn the_shipped_meshes_have_the_triangles_and_areas_that_they_should() {
    let room = shipped("cube-room").mesh;
    // Six walls of 4 m, and five sides of a crate of 1 m: it stands on the floor.
    assert_eq!((room.len(), room.bounds()), (22, [DVec3::ZERO, DVec3::splat(4.0)]));
    assert!((room.total_area() - (6.0 * 16.0 + 5.0)).abs() < 1e-9, "{}", room.total_area());
    assert_eq!(shipped("atrium").mesh.len(), 4764);
    let cornell = shipped("cornell");
    assert_eq!((cornell.mesh.len(), cornell.notes.len()), (30, 0));
    let colours: Vec<&str> = cornell.mesh.materials().iter().map(|m| m.name.as_str()).collect();
    assert_eq!(colours, ["white", "red", "green"]);
}

#[test]
fn obj_faces_of_every_spelling_are_read() {
    let text = "# all at once\r\nv 0 0 0 1.0\r\nv 1 0 0\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0\nvt 0 0\nvn 0 0 1\n\
                g wall\ns off\nl 1 2\nf 1/1/1 2/1/1 3/1/1 4/1/1 # a comment\nf -4//-1 -3//1 -2\n";
    let loaded = obj(text).unwrap();
    assert_eq!(loaded.mesh.triangles(), [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    assert_eq!(loaded.mesh.total_area(), 1.5);
    assert_eq!(loaded.mesh.albedo(0), [0.5; 3]);
    let progress = RefCell::new(Vec::new());
    let files = Memory::of(&[("a.obj", text.as_bytes())]);
    read(Path::new("a.obj"), &files, &mut |done| progress.borrow_mut().push(done)).unwrap();
    let progress = progress.into_inner();
    assert!(progress.is_sorted() && progress.last() == Some(&1.0));
}

#[test]
fn what_is_missing_or_flat_is_helped_and_told() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\n";
    let loaded = obj(&format!("mtllib no.mtl\n{square}usemtl brick\nf 1 2 3 4\nf 1 2 5\n")).unwrap();
    assert_eq!((loaded.mesh.len(), loaded.mesh.albedo(0)), (2, [0.5; 3]));
    assert_eq!(loaded.notes.len(), 3, "{:?}", loaded.notes);
    let library = b"newmtl a\nKd 1 0 0\nKe 2 3 4\nmap_Kd no.png\n";
    let text = format!("mtllib a.mtl\n{square}usemtl a\nf 1 2 3 4\n");
    let loaded = load("a.obj", &[("a.obj", text.as_bytes()), ("a.mtl", library)]).unwrap();
    assert_eq!((loaded.mesh.albedo(0), loaded.mesh.emission(0)), ([0.5; 3], [2.0, 3.0, 4.0]));
    assert!(loaded.notes[0].contains("no.png"), "{:?}", loaded.notes);
}

#[test]
fn a_texture_gives_each_triangle_its_mean() {
    // Left half black, right half white: the triangle on the right half is white, the one on the left black.
    let picture = image::RgbImage::from_fn(8, 8, |x, _| image::Rgb([if x < 4 { 0 } else { 255 }; 3]));
    let mut png = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.1 0.1\nvt 0.4 0.1\nvt 0.1 0.9\nvt 0.6 0.1\nvt 0.9 0.1\n\
                vt 0.6 0.9\nusemtl a\nf 1/1 2/2 3/3\nf 1/4 2/5 3/6\n";
    let files: [(&str, &[u8]); 3] = [
        ("scenes/a.obj", text.as_bytes()),
        ("scenes/a.mtl", b"newmtl a\nKd 0.5 1 1\nmap_Kd textures\\a.png\n"),
        ("scenes/textures/a.png", png.get_ref()),
    ];
    let mesh = load("scenes/a.obj", &files).unwrap().mesh;
    assert_eq!(mesh.albedo(0), [0.0; 3]);
    assert_eq!(mesh.albedo(1), [0.5, 1.0, 1.0]);
}

#[test]
fn what_cannot_be_read_is_refused_with_its_line() {
    for (text, place, what) in [
        ("v 0 0 0\nv nan 0 0\n", "a.obj:2: ", "cannot stand"),
        ("v 0 0 0\nv 1 inf 0\n", "a.obj:2: ", "cannot stand"),
        ("v 0 0\n", "a.obj:1: ", "no vertex"),
        ("v 0 0 zero\n", "a.obj:1: ", "no vertex"),
        ("v 1e10 0 0\n", "a.obj:1: ", "cannot stand"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "a.obj:4: ", "no corner"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 0 1 2\n", "a.obj:5: ", "no corner"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", "a.obj:4: ", "no corner"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n", "a.obj:4: ", "vt that is not there"),
        ("v 0 0 0\nv 1 0 0\nf 1 2\n", "a.obj:3: ", "2 corners"),
        ("v 0 0 0\nf 1 1 99999999999999999999999\n", "a.obj:2: ", "no corner"),
        ("v 0 0 0\nf 1 \\\n1 1\n", "a.obj:2: ", "goes on"),
        ("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "a.obj: ", "no triangle with an area"),
        ("", "a.obj: ", "no triangle"),
        ("mtllib /etc/passwd\n", "a.obj: ", "not a file beside it"),
        ("mtllib http://a/b.mtl\n", "a.obj: ", "not a file beside it"),
    ] {
        let fault = obj(text).unwrap_err().to_string();
        assert!(fault.starts_with(place) && fault.contains(what) && !fault.contains('\n'), "{text}: {fault}");
    }
    let fault = load("a.stl", &[("a.stl", b"solid")]).unwrap_err().to_string();
    assert!(fault.contains(".obj, .gltf or .glb"), "{fault}");
    assert!(load("b.obj", &[]).unwrap_err().to_string().contains("no such file"));
    let polygon: String = (0..1001).map(|i| format!("{} ", 1 + i % 3)).collect();
    assert!(obj(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf {polygon}\n")).unwrap_err().what.contains("1001 corners"));
}

/// A binary glTF of these parts.
fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let pad = |bytes: &[u8], with: u8| {
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(4), with);
        padded
    };
    let (json, binary) = (pad(json.as_bytes(), b' '), pad(binary, 0));
    let mut out = b"glTF".to_vec();
    let length = 12 + 8 + json.len() + 8 + binary.len();
    for number in [2, length as u32, json.len() as u32] {
        out.extend(number.to_le_bytes());
    }
    out.extend(b"JSON");
    out.extend(json);
    out.extend((binary.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(binary);
    out
}

/// A square of side 2 in the plane z = 0: four corners as f32, then six indices as u16.
fn square() -> Vec<u8> {
    let corners = [[0.0f32, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
    let indices = [0u16, 1, 2, 0, 2, 3];
    let corners = corners.iter().flatten().flat_map(|c| c.to_le_bytes());
    corners.chain(indices.iter().flat_map(|i| i.to_le_bytes())).collect()
}

/// A document around [`square`]; `nodes` and `more` are put in as they stand.
fn document(nodes: &str, more: &str, buffer: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{nodes}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 0}}]}}],
        "materials": [{{"name": "red", "pbrMetallicRoughness": {{"baseColorFactor": [0.5, 0.25, 0, 1]}},
            "emissiveFactor": [0, 0, 1]}}],
        "buffers": [{{{buffer}"byteLength": 60}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 12}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
                      {{"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}}]{more}}}"#
    )
}

#[test]
fn gltf_is_read_in_both_forms_with_its_nodes_materials_and_lamps() {
    let nodes = r#"{"children": [1, 2], "translation": [10, 0, 0], "scale": [2, 2, 2]},
                   {"mesh": 0, "rotation": [0, 0.70710678, 0, 0.70710678]},
                   {"translation": [0, 1, 0], "rotation": [-0.70710678, 0, 0, 0.70710678],
                    "extensions": {"KHR_lights_punctual": {"light": 0}}}"#;
    let more = r#", "extensionsUsed": ["KHR_lights_punctual"], "extensions": {"KHR_lights_punctual": {"lights":
        [{"type": "spot", "color": [1, 0.5, 0], "intensity": 20, "spot": {"outerConeAngle": 0.7}}]}}"#;
    let apart = document(nodes, more, r#""uri": "a%20b.bin", "#);
    let files: [(&str, &[u8]); 2] = [("x/a.gltf", apart.as_bytes()), ("x/a b.bin", &square())];
    let loaded = load("x/a.gltf", &files).unwrap();
    let one = glb(&document(nodes, more, ""), &square());
    assert_eq!(load("a.glb", &[("a.glb", &one)]).unwrap(), loaded);
    // Turned a quarter about y, (2, 2, 0) becomes (0, 2, −2); then twice as large, then ten along x.
    let mesh = &loaded.mesh;
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert!(mesh.vertices()[2].distance(Vec3::new(10.0, 4.0, -4.0)) < 1e-5, "{:?}", mesh.vertices());
    assert!((mesh.total_area() - 16.0).abs() < 1e-5);
    assert_eq!((mesh.albedo(0), mesh.emission(1)), ([0.5, 0.25, 0.0], [0.0, 0.0, 1.0]));
    let [lamp] = &loaded.lamps[..] else { panic!("one lamp") };
    assert!(matches!(lamp.kind, LampKind::Spot { outer, .. } if (outer - 0.7).abs() < 1e-6));
    assert_eq!((lamp.position, lamp.power), ([10.0, 2.0, 0.0], [20.0, 10.0, 0.0]));
    assert!(DVec3::from_array(lamp.direction).distance(DVec3::NEG_Y) < 1e-6, "{:?}", lamp.direction);
}

#[test]
fn gltf_that_lies_is_refused_with_the_place() {
    let node = r#"{"mesh": 0}"#;
    let good = document(node, "", "");
    assert!(load("a.glb", &[("a.glb", &glb(&good, &square()))]).is_ok());
    let swaps: [(&str, &str, &str); 16] = [
        (r#""POSITION": 0"#, r#""POSITION": 7"#, "meshes[0]"),
        (r#""indices": 1"#, r#""indices": 7"#, "indices"),
        (r#""material": 0"#, r#""material": 7"#, "material"),
        (r#""mesh": 0"#, r#""mesh": 7"#, "nodes[0]"),
        (r#""count": 4"#, r#""count": 5"#, "accessors[0]"),
        (r#""count": 4"#, r#""count": 4000000000"#, "more than 10000000"),
        (r#""count": 6"#, r#""count": 0"#, "accessors[1]"),
        (r#""count": 4"#, r#""count": 3"#, "index 5 is 3"),
        (r#""byteLength": 48"#, r#""byteLength": 48, "byteStride": 4"#, "accessors[0]"),
        (r#""byteOffset": 48"#, r#""byteOffset": 18446744073709551615"#, "accessors[1]"),
        (r#""VEC3""#, r#""VEC2""#, "accessors[0]"),
        ("5123", "5126", "accessors[1]"),
        (r#"{"mesh": 0}"#, r#"{"mesh": 0, "children": [0]}"#, "nodes[0]"),
        (r#"{"mesh": 0}"#, r#"{"mesh": 0, "scale": [1e30, 1, 1]}"#, "vertex 1"),
        (r#""byteLength": 60"#, r#""byteLength": 600"#, "buffers[0] holds 60"),
        (r#""2.0""#, r#""1.0""#, "glTF 1.0"),
    ];
    for (from, to, what) in swaps {
        assert!(good.contains(from), "{from}");
        let bytes = glb(&good.replacen(from, to, 1), &square());
        let fault = load("a.glb", &[("a.glb", &bytes)]).unwrap_err().to_string();
        assert!(fault.contains(what) && fault.starts_with("a.glb: ") && !fault.contains('\n'), "{to}: {fault}");
    }
    let whole = glb(&good, &square());
    for cut in 0..whole.len() {
        let fault = load("a.glb", &[("a.glb", &whole[..cut])]).unwrap_err().to_string();
        assert!(!fault.contains('\n'), "{fault}");
    }
    for uri in ["../../etc/passwd", "http://a/b.bin", "/a.bin", "data:;base64,A", "data:;base64", "no.bin"] {
        let text = document(node, "", &format!(r#""uri": "{uri}", "#));
        assert!(load("a.gltf", &[("a.gltf", text.as_bytes())]).is_err(), "{uri}");
    }
}
