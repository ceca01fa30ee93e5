//! Files of cells: what is written is read back to the last bit, and no file, however made, does more
//! than give one clear line.
#![allow(clippy::expect_used)]

use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;
use lpv_lab::field::{Cell, Grid};
use lpv_lab::scene::cell_file::{self, Column, Grids};
use lpv_lab::scene::{Preset, Problem};
use lpv_lab::sh::Sh;
use lpv_lab::transport::preset;
use npyz::WriterBuilder;
use proptest::prelude::*;
use tempfile::TempDir;

/// A file of this name and content in a folder that lasts as long as the result.
fn file(name: &str, content: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    fs::write(&path, content).expect("writable");
    (folder, path)
}

fn read(name: &str, content: &[u8], size: usize, column: Option<Column>) -> Result<Vec<(Cell, Sh<f64>)>, String> {
    let (folder, path) = file(name, content);
    let read = cell_file::read(&path, size, column);
    read.map_err(|error| {
        let line = error.to_string();
        assert!(line.lines().count() == 1 && line.contains("; "), "one line with a remedy: {line}");
        line.replace(&format!("{}/", folder.path().display()), "")
    })
}

/// The grids of a finest level.
fn grids<'a>(source: Option<&'a Grid<f32>>, accumulated: &'a Grid<f32>) -> Grids<'a> {
    Grids { source, accumulated: Some(accumulated), side: false }
}

/// Checks that a file of side 8 is refused with all of `words`.
fn refused(name: &str, content: &[u8], words: &[&str]) {
    let line = read(name, content, 8, None).expect_err(&String::from_utf8_lossy(content));
    assert!(words.iter().all(|word| line.contains(word)), "{line}\n  lacks one of {words:?}");
}

#[test]
fn every_header_is_read_in_the_published_basis() {
    let both = b"x,y,z,s0,s1,s2,s3,a0,a1,a2,a3\n1,2,3,1,2,3,4,5,6,7,8\n";
    let sh = |c| vec![([1, 2, 3], Sh::from_basis(c))];
    assert_eq!(read("a.csv", both, 8, Some(Column::Source)), Ok(sh([1.0, 2.0, 3.0, 4.0])));
    assert_eq!(read("a.csv", both, 8, Some(Column::Accumulated)), Ok(sh([5.0, 6.0, 7.0, 8.0])));
    let any = [None, Some(Column::Source), Some(Column::Accumulated)];
    for (header, columns) in [
        ("x,y,z,a0,a1,a2,a3", &any[..1]),
        ("x,y,z,a0,a1,a2,a3", &any[2..]),
        ("x,y,z,s0,s1,s2,s3", &any[..2]),
        ("x,y,z,c0,c1,c2,c3", &any[..]),
        ("\u{feff}X, Y, Z, C0, C1, C2, C3\r", &any[..]),
    ] {
        for column in columns {
            let text = format!("{header}\n1, 2 ,3, 1e0,-2.5E-1,+3,.5\r\n\r\n");
            assert_eq!(read("a.csv", text.as_bytes(), 8, *column), Ok(sh([1.0, -0.25, 3.0, 0.5])));
        }
    }
}

#[test]
fn no_light_is_guessed() {
    let both = b"x,y,z,s0,s1,s2,s3,a0,a1,a2,a3\n1,2,3,1,2,3,4,5,6,7,8\n";
    refused("a.csv", both, &["holds two lights", "`column: Source`", "`column: Accumulated`"]);
    for (letter, other) in [("s", Column::Accumulated), ("a", Column::Source)] {
        let text = format!("x,y,z,{letter}0,{letter}1,{letter}2,{letter}3\n1,2,3,1,2,3,4\n");
        let line = read("a.csv", text.as_bytes(), 8, Some(other)).expect_err("another light");
        assert!(line.contains("alone") && line.contains("leave it out"), "{line}");
    }
}

#[test]
fn what_spreadsheets_and_scripts_write_is_read() {
    let expected = read("a.csv", b"x,y,z,c0,c1,c2,c3\n1,2,3,0.886227,0,0,-1.02333\n", 8, None).expect("good");
    assert_eq!(expected.len(), 1);
    for text in [
        "x;y;z;c0;c1;c2;c3\n1;2;3;0.886227;0;0;-1.02333\n",
        "x;y;z;c0;c1;c2;c3\r\n1;2;3;0,886227;0;0;-1,02333\r\n",
        "x\ty\tz\tc0\tc1\tc2\tc3\n1\t2\t3\t0,886227\t0\t0\t-1.02333\n",
        "# made by a script\nx,y,z,c0,c1,c2,c3\n # two remarks\n\n1,2,3,0.886227,0,0,-1.02333\n# the end",
        "\"x\",\"y\",\"z\",\"c0\",\"c1\",\"c2\",\"c3\"\n\"1\",\"2\",\"3\",\"0.886227\",\"0\",\"0\",\"-1.02333\"",
        "x,y,z,c0,c1,c2,c3,side\n1,2,3,0.886227,0,0,-1.02333,8\n",
    ] {
        assert_eq!(read("a.csv", text.as_bytes(), 8, None).as_ref(), Ok(&expected), "{text}");
    }
    assert_eq!(read("a.csv", b"x,y,z,c0,c1,c2,c3\n", 8, None), Ok(Vec::new()));
}

#[test]
fn what_is_something_else_is_named() {
    let zip = [&b"PK\x03\x04"[..], &[0xff; 3000]].concat();
    refused("a.npz", &zip, &["an archive (.npz", "numpy.save"]);
    refused("a.csv", &zip, &["an archive"]);
    refused("a.npy", &zip, &["an archive"]);
    refused("a.csv", &npy(1, &plain("<f4")), &["a .npy array", "ends in .npy"]);
    refused("a.csv", b"\x1f\x8b\x08\0\0", &["compressed", "unpack"]);
    refused("a.npy", &npy(9, &plain("<f4")), &["version 9", "versions 1 to 3"]);
    // A whole array of another size is told by its shape, not by its length.
    for side in [4usize, 16] {
        let shape = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({side}, {side}, {side}, 4), }}");
        let array = [npy(1, &shape), vec![0; side.pow(3) * 16]].concat();
        refused("a.npy", &array, &[&format!("shape is `({side},{side},{side},4)`"), "(8, 8, 8, 4)"]);
    }
    refused("a.csv", b"x,y,z,c0,c1,c2,c3\n8,0,0,1,0,0,0\n", &["`8`", "0 to 7", "a larger one or a finer level"]);
    refused("a.csv", b"x,y,z,c0,c1,c2,c3,side\n1,0,0,1,0,0,0,4\n", &["4 cells a side, the volume has 8", "level 0"]);
    refused("a.csv", b"x,y,z,c0,c1,c2,c3\n1,2,3,0,5,0,0,1\n", &["8 columns", "decimal point"]);
}

#[test]
fn a_last_row_that_may_have_been_cut_is_refused() {
    let whole = "x,y,z,c0,c1,c2,c3\n1,2,3,0.886227,0,0,-1.02333\n2,2,3,9.5e-13,-6.4e-14,-1.3e-13,4.3036636e-13\n";
    for end in 1..whole.len() {
        let text = &whole[..end];
        match read("a.csv", text.as_bytes(), 8, None) {
            Ok(cells) => assert!(text.ends_with('\n') && cells.len() + 1 == text.lines().count(), "{text}"),
            Err(line) => assert!(!text.ends_with('\n'), "{line}"),
        }
    }
    let cut = whole.strip_suffix("e-13\n").expect("its end");
    refused("a.csv", cut.as_bytes(), &["a.csv:3: ", "no line end", "may have been cut"]);
}

#[test]
fn rows_come_in_the_volumes_order_and_dark_ones_are_left_out() {
    let text = b"x,y,z,c0,c1,c2,c3\n1,0,1,4,0,0,0\n0,1,0,3,0,0,0\n0,0,0,0,0,0,0\n1,0,0,2,0,0,0\n";
    let cells = read("a.csv", text, 2, Some(Column::Source)).expect("good");
    assert_eq!(cells.iter().map(|(cell, _)| *cell).collect::<Vec<_>>(), [[1, 0, 0], [0, 1, 0], [1, 0, 1]]);
}

#[test]
fn bad_csv_is_refused_at_its_line() {
    let head = "x,y,z,c0,c1,c2,c3\n0,0,0,1,0,0,0\n";
    for (row, words) in [
        ("1,2,3,1,2,3", ["a.csv:3: ", "6 columns, the header has 7"]),
        ("1,2,3,1,2,3,4,5", ["a.csv:3: ", "8 columns"]),
        ("\n1,8,3,1,2,3,4", ["a.csv:4: ", "y is `8`; cells go from 0 to 7"]),
        ("1,-1,3,1,2,3,4", ["a.csv:3: ", "`-1`"]),
        ("1.5,1,3,1,2,3,4", ["a.csv:3: ", "x is `1.5`"]),
        ("1,1,3,1,NaN,3,4", ["a.csv:3: ", "c1 is `NaN`, no finite number"]),
        ("1,1,3,1,2,inf,4", ["a.csv:3: ", "c2 is `inf`"]),
        ("1,1,3,1,2,3,1e999", ["a.csv:3: ", "c3 is `1e999`"]),
        ("1,1,3,1,2,3,", ["a.csv:3: ", "c3 is ``"]),
        ("1,1,3,1,2,3,x", ["a.csv:3: ", "c3 is `x`"]),
        ("1,1,1,1,0,0,0\n0,0,0,2,0,0,0", ["a.csv:4: ", "(0, 0, 0) is in line 2 already"]),
    ] {
        refused("a.csv", format!("{head}{row}\n").as_bytes(), &words);
    }
    refused("a.csv", b"", &["a.csv:1: ", "empty", "x,y,z,c0,c1,c2,c3"]);
    refused("a.csv", b"x,y,z\n1,2,3\n", &["a.csv:1: ", "`x,y,z`", "x,y,z,c0,c1,c2,c3"]);
    refused("a.csv", b"x,y,z,c0,c1,c2,c3\n1,2,3,4,5,6,\xff\n", &["a.csv:2: ", "UTF-8"]);
    refused("a.csv", "9".repeat(5000).as_bytes(), &["a.csv:1: ", "longer than 1024 bytes"]);
    refused("a.csv", &[b' '; 1 << 20], &["too many"]);
}

/// A `.npy` file's header by hand.
fn npy(version: u8, dictionary: &str) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    match version {
        1 => bytes.extend((dictionary.len() as u16).to_le_bytes()),
        _ => bytes.extend((dictionary.len() as u32).to_le_bytes()),
    }
    bytes.extend(dictionary.as_bytes());
    bytes
}

fn plain(descr: &str) -> String {
    format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (2, 2, 2, 4), }}   \n")
}

#[test]
fn npy_of_either_width_and_endianness_is_read_z_slowest() {
    let values: Vec<f64> = (0..32).map(|i| f64::from(i) / 4.0).collect();
    let bytes = |to_bytes: fn(f64) -> Vec<u8>| values.iter().copied().flat_map(to_bytes).collect::<Vec<u8>>();
    for (descr, data) in [
        ("<f4", bytes(|v| (v as f32).to_le_bytes().to_vec())),
        (">f4", bytes(|v| (v as f32).to_be_bytes().to_vec())),
        ("<f8", bytes(|v| v.to_le_bytes().to_vec())),
        (">f8", bytes(|v| v.to_be_bytes().to_vec())),
    ] {
        for version in [1, 2, 3] {
            let content = [npy(version, &plain(descr)), data.clone()].concat();
            let cells = read("a.npy", &content, 2, Some(Column::Source)).expect(descr);
            assert_eq!(cells.len(), 8);
            // [z, y, x] = [1, 0, 1] is the sixth of eight.
            assert_eq!(cells[5], ([1, 0, 1], Sh::from_basis([5.0, 5.25, 5.5, 5.75])), "{descr}");
        }
    }
}

#[test]
fn bad_npy_is_refused_before_anything_is_believed() {
    let with = |dictionary: &str, data: usize| [npy(1, dictionary), vec![0; data]].concat();
    let shape = |shape: &str| format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    let size = 8 * 8 * 8 * 4 * 4;
    refused("a.npy", b"", &["a.npy: ", "no .npy file"]);
    refused("a.npy", b"PK\x03\x05 something else", &["no .npy file"]);
    refused("a.npy", b"\x93NUMPY\x02\x00\xff\xff\xff\xff and no more", &["claims 4294967295 bytes"]);
    refused("a.npy", &npy(1, &shape("(8, 8, 8, 4)"))[..40], &["no .npy file"]);
    for dims in ["(2, 2, 2, 4)", "(512, 4)", "(8, 8, 8)", "(4611686018427387904, 4611686018427387904)", "(-8, 8, 8, 4)"]
    {
        refused("a.npy", &with(&shape(dims), size), &["shape is", "(8, 8, 8, 4)"]);
    }
    refused("a.npy", &with(&shape("(8, 8, 8, 4"), size), &["no shape"]);
    refused("a.npy", &with(&"[".repeat(4000), size), &["no shape"]);
    refused("a.npy", &with(&shape("(8, 8, 8, 4)"), size - 1), &["its header promises"]);
    refused("a.npy", &with(&shape("(8, 8, 8, 4)"), size + 1), &["its header promises"]);
    for descr in ["<i4", "|O", "<u1", "<c8", "<f4444444444"] {
        refused("a.npy", &with(&shape("(8, 8, 8, 4)").replace("<f4", descr), size), &["float32 or float64"]);
    }
    let fortran = shape("(8, 8, 8, 4)").replace("False", "True");
    refused("a.npy", &with(&fortran, size), &["Fortran order"]);
    let mut nan = with(&shape("(8, 8, 8, 4)"), size);
    let last = nan.len() - 4;
    nan[last..].copy_from_slice(&f32::NAN.to_le_bytes());
    refused("a.npy", &nan, &["[7, 7, 7, 3] is NaN"]);
}

#[test]
fn what_another_program_writes_as_npy_is_read() {
    let mut bytes = Vec::new();
    let options = npyz::WriteOptions::<f64>::new().default_dtype().shape(&[1, 1, 1, 4]);
    let mut array = options.writer(&mut bytes).begin_nd().expect("a header");
    array.extend([1.0, 2.0, 3.0, 4.0]).expect("numbers");
    array.finish().expect("written");
    let cells = read("a.NPY", &bytes, 1, Some(Column::Source));
    assert_eq!(cells, Ok(vec![([0; 3], Sh::from_basis([1.0, 2.0, 3.0, 4.0]))]));
}

/// The lit cells of a grid, as a reader should give them.
fn lit(grid: &Grid<f32>) -> Vec<(Cell, Sh<f64>)> {
    grid.iter().filter(|(_, sh)| !sh.is_zero()).map(|(cell, sh)| (cell, sh.widen())).collect()
}

fn grid() -> impl Strategy<Value = Grid<f32>> {
    let finite = any::<f32>().prop_filter("finite", |x| x.is_finite());
    let sh = prop_oneof![2 => Just([0.0; 4]), 1 => prop::array::uniform4(finite)];
    prop::collection::vec(sh, 64).prop_map(|values| {
        let mut grid = Grid::new(4);
        for (cell, value) in grid.layout().cells().zip(values) {
            grid.set(cell, Sh(value));
        }
        grid
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Nine digits tell every f32 from its neighbours.
    #[test]
    fn csv_gives_back_every_bit(source in grid(), sum in grid()) {
        let read = |bytes: &[u8], column| {
            let cells = read("a.csv", bytes, 4, Some(column)).expect("good");
            cells.into_iter().map(|(cell, sh)| (cell, sh.cast::<f32>().widen())).collect::<Vec<_>>()
        };
        let mut bytes = Vec::new();
        cell_file::write_csv(&mut bytes, grids(Some(&source), &sum)).expect("written");
        prop_assert_eq!(read(&bytes, Column::Source), lit(&source));
        prop_assert_eq!(read(&bytes, Column::Accumulated), lit(&sum));
        let mut bytes = Vec::new();
        cell_file::write_csv(&mut bytes, grids(None, &sum)).expect("written");
        prop_assert_eq!(read(&bytes, Column::Accumulated), lit(&sum));
    }

    #[test]
    fn npy_gives_back_every_bit(grid in grid()) {
        let mut bytes = Vec::new();
        cell_file::write_npy(&mut bytes, &grid).expect("written");
        let array: Vec<f32> = npyz::NpyFile::new(&bytes[..]).and_then(npyz::NpyFile::into_vec).expect("an array");
        prop_assert_eq!(array.len(), 256);
        prop_assert_eq!(read("a.npy", &bytes, 4, Some(Column::Source)), Ok(lit(&grid)));
    }

    #[test]
    fn no_bytes_make_a_reader_panic(start in 0..4usize, bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let starts = [&b""[..], b"x,y,z,c0,c1,c2,c3\n", b"\x93NUMPY\x01\x00\x46\x00", b"\x93NUMPY\x01\x00\x46\x00{'descr':"];
        let content = [starts[start], &bytes].concat();
        for name in ["a.csv", "a.npy"] {
            let _ = read(name, &content, 4, Some(Column::Source));
        }
    }

    #[test]
    fn one_wrong_byte_in_a_good_file_never_panics(at in 0..2200usize, byte in any::<u8>()) {
        let mut grid = Grid::new(2);
        grid.set([1, 0, 1], Sh([1.0, 2.0, 3.0, 4.0]));
        let (mut csv, mut npy) = (Vec::new(), Vec::new());
        cell_file::write_csv(&mut csv, grids(Some(&grid), &grid)).expect("written");
        cell_file::write_npy(&mut npy, &grid).expect("written");
        for (name, mut bytes) in [("a.csv", csv), ("a.npy", npy)] {
            let at = at % bytes.len();
            bytes[at] = byte;
            let _ = read(name, &bytes, 2, Some(Column::Source));
        }
    }
}

/// The scene of a preset of side 4 with these lists, beside a file `cells.csv`.
fn scene_with(cells: &str, lists: &str) -> Result<Problem, String> {
    let (folder, _cells) = file("cells.csv", cells.as_bytes());
    let preset = Preset::parse(&format!("(version: 1, size: 4, {lists})"), Path::new("p.ron")).expect("a preset");
    Problem::build(&preset, folder.path()).map_err(|error| error.to_string())
}

#[test]
fn a_file_injector_brings_its_light_and_takes_the_multiplier() {
    let lists = "injectors: [(kind: File(path: \"cells.csv\"), multiplier: 2.0, color: (1, 0, 0))]";
    let problem = scene_with("x,y,z,c0,c1,c2,c3\n1,2,3,1,2,3,4\n", lists).expect("a scene");
    assert_eq!(problem.sources[0].light, [([1, 2, 3], Sh::from_basis([2.0, 4.0, 6.0, 8.0]))]);
    let bright = scene_with("x,y,z,c0,c1,c2,c3\n1,2,3,1e30,2,3,4\n", lists).expect_err("too bright");
    assert!(bright.starts_with("injectors[0].multiplier: "), "{bright}");
}

#[test]
fn an_occluder_file_may_bring_normals_and_opacity() {
    let lists = "occluders: [(kind: File(path: \"cells.csv\"), opacity: 0.5, albedo: (1, 0, 0.5))]";
    let text = "x,y,z,nx,ny,nz,opacity\n1,2,3,0,-2,0,0.5\n0,0,0,3,0,4,1\n2,2,2,1,0,0,0\n";
    let solids = scene_with(text, lists).expect("a scene").solids;
    let expected = [([0, 0, 0], DVec3::new(0.6, 0.0, 0.8), 0.5), ([1, 2, 3], DVec3::NEG_Y, 0.25)];
    assert_eq!(solids.len(), expected.len());
    for (found, (cell, normal, opacity)) in solids.iter().zip(expected) {
        assert_eq!((found.cell, found.opacity, found.albedo), (cell, [opacity; 3], [1.0, 0.0, 0.5]));
        assert!((found.normal - normal).length() < 1e-15);
    }
    for (row, words) in [
        ("0,0,0,0,0,0,1", "cells.csv:2: the normal has length zero"),
        ("0,0,0,1,0,0,1.5", "cells.csv:2: the opacity is 1.5"),
        ("0,0,4,1,0,0,1", "cells.csv:2: z is `4`"),
    ] {
        let line = scene_with(&format!("x,y,z,nx,ny,nz,opacity\n{row}\n"), lists).expect_err(row);
        assert!(line.contains(words), "{line}");
    }
    let both = lists.replace("opacity", "normal: (1, 0, 0), opacity");
    let line = scene_with(text, &both).expect_err("two normals");
    assert!(line.starts_with("occluders[0].normal: "), "{line}");
}

#[test]
fn the_ring_that_comes_with_the_program_is_what_its_preset_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/from-file.ron");
    let (_, problem) = preset::load(&path).expect("a scene");
    let light = &problem.sources[0].light;
    for (cell, sh) in light {
        let [x, z] = [cell[0], cell[2]].map(|c| c as f64 + 0.5 - 16.0);
        let lobe = Sh::<f64>::lobe(DVec3::new(-x, 0.0, -z).normalize());
        assert!((9.5..=10.5).contains(&x.hypot(z)) && cell[1] == 16, "{cell:?}");
        assert!((*sh - lobe).max_norm() < 1e-8, "{cell:?}");
    }
    let inside = |c: &usize| (9.5..=10.5).contains(&((c % 32) as f64 - 15.5).hypot((c / 32) as f64 - 15.5));
    assert_eq!(light.len(), (0..32 * 32).filter(inside).count());
}
