//! From a mesh and its lights to light in cells: what the lights give is what the cells hold.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use lpv_lab::scene::mesh_scene::{Injection, Light, LightKind, MeshScene, Volume};
use lpv_lab::scene::occluder::OcclusionMode;
use lpv_lab::scene::stage::Cache;
use lpv_lab::scene::{Occlusion, Preset, Problem, SceneError};

/// The flux that a problem's cells hold, by colour, in W: 2√π·c00 each.
fn held(problem: &Problem) -> [f64; 3] {
    let mut flux = [0.0; 3];
    for source in &problem.sources {
        let sum: f64 = source.light.iter().map(|(_, light)| 2.0 * PI.sqrt() * light.0[0]).sum();
        let kept: f64 = source.cosines.iter().map(|cosine| cosine.flux).sum();
        assert!((sum / kept - 1.0).abs() < 1e-12, "lobes hold {sum}, cosines {kept}");
        (0..3).for_each(|c| flux[c] += source.color[c] * sum);
    }
    flux
}

fn scene(mesh: &str, lights: Vec<Light>) -> MeshScene {
    MeshScene { lights, shadow_map: 128, ..MeshScene::new(mesh) }
}

fn preset(scene: MeshScene, size: usize) -> Preset {
    Preset { size, scene: Some(scene), ..Preset::default() }
}

fn shipped(scene: MeshScene, size: usize) -> Problem {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets");
    Problem::build(&preset(scene, size), &folder).unwrap()
}

/// A mesh of squares, each of a corner and two sides, all of one grey, in a folder of its own.
fn squares(squares: &[[[f32; 3]; 3]], grey: f64) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::from("mtllib a.mtl\nusemtl a\n");
    for (i, [corner, u, v]) in squares.iter().enumerate() {
        for (a, b) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            let [x, y, z] = [0, 1, 2].map(|k| corner[k] + a * u[k] + b * v[k]);
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        let first = 4 * i + 1;
        writeln!(text, "f {} {} {} {}", first, first + 1, first + 2, first + 3).unwrap();
    }
    std::fs::write(folder.path().join("a.obj"), text).unwrap();
    std::fs::write(folder.path().join("a.mtl"), format!("newmtl a\nKd {grey} {grey} {grey}\n")).unwrap();
    folder
}

/// The six walls of the cube from 0 to 4.
fn cube() -> Vec<[[f32; 3]; 3]> {
    let axes = [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    (0..6).map(|i| [if i < 3 { [0.0; 3] } else { axes[i - 3] }, axes[(i + 1) % 3], axes[(i + 2) % 3]]).collect()
}

#[test]
fn a_closed_room_of_one_albedo_sends_back_its_share_of_all_that_a_light_gives() {
    let folder = squares(&cube(), 0.5);
    for (position, size) in [([2.6, 3.2, 2.0], 32), ([0.5, 0.25, 3.9], 8)] {
        for injection in [Injection::Nearest, Injection::Split] {
            let scene = MeshScene { injection, ..scene("a.obj", vec![Light::point(position, [10.0, 5.0, 1.0])]) };
            let flux = held(&Problem::build(&preset(scene, size), folder.path()).unwrap());
            for (c, intensity) in [10.0, 5.0, 1.0].into_iter().enumerate() {
                let wanted = 0.5 * 4.0 * PI * intensity;
                assert!((flux[c] / wanted - 1.0).abs() < 1e-4, "{injection:?}: {} of {wanted}", flux[c]);
            }
        }
    }
}

#[test]
fn with_a_crate_and_colours_the_cells_hold_what_the_texels_do() {
    let spot = LightKind::Spot { position: [2.6, 3.2, 2.0], direction: [-1.0, -2.0, 0.3], angle: 35.0, blend: 0.3 };
    for light in [
        Light::point([2.6, 3.2, 2.0], [10.0, 9.0, 8.0]),
        Light { kind: spot, ..Light::point([0.0; 3], [10.0, 9.0, 8.0]) },
        Light::sun([0.3, -1.0, 0.2], [3.0, 2.0, 1.0]),
    ] {
        // A margin: the sun lights the room from outside.
        let scene = MeshScene { volume: Volume::Fit { margin: 2.0 }, ..scene("scenes/cube-room.obj", vec![light]) };
        let problem = shipped(scene, 32);
        let stage = problem.stage.as_ref().unwrap();
        let (texels, flux) = (stage.maps[0].flux(), held(&problem));
        for c in 0..3 {
            assert!(texels[c] > 0.0 && (flux[c] / texels[c] - 1.0).abs() < 1e-6, "{flux:?}, texels {texels:?}");
            assert!(texels[c] < stage.maps[0].met[c] && stage.maps[0].met[c] <= stage.maps[0].given[c]);
        }
    }
}

#[test]
fn a_spot_gives_the_integral_over_its_cone_and_the_sun_what_falls_on_the_floor() {
    let folder = squares(&cube(), 0.5);
    let spot = |blend: f64| {
        let kind = LightKind::Spot { position: [1.0, 3.0, 2.0], direction: [0.2, -1.0, 0.1], angle: 40.0, blend };
        Light { kind, ..Light::point([0.0; 3], [2.0; 3]) }
    };
    let held_of = |light: Light, folder: &Path| {
        let scene = MeshScene { shadow_map: 256, ..scene("a.obj", vec![light]) };
        held(&Problem::build(&preset(scene, 16), folder).unwrap())[0]
    };
    // A sharp cone: I·2π(1 − cos θ).
    let wanted = 0.5 * 2.0 * 2.0 * PI * (1.0 - 40f64.to_radians().cos());
    let found = held_of(spot(0.0), folder.path());
    assert!((found / wanted - 1.0).abs() < 1e-4, "{found} {wanted}");
    // One that fades: the same with the smooth step of the cosine, whose mean is a half.
    let (edge, full) = (40f64.to_radians().cos(), 24f64.to_radians().cos());
    let wanted = 0.5 * 2.0 * 2.0 * PI * ((1.0 - full) + (full - edge) / 2.0);
    let found = held_of(spot(0.4), folder.path());
    assert!((found / wanted - 1.0).abs() < 1e-4, "{found} {wanted}");
    // A floor alone: ρ·E⊥·cos θ·area.
    let floor = squares(&[[[0.0; 3], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0]]], 0.5);
    let found = held_of(Light::sun([0.6, -0.8, 0.0], [3.0; 3]), floor.path());
    assert!((found / (0.5 * 3.0 * 0.8 * 16.0) - 1.0).abs() < 1e-4, "{found}");
}

#[test]
fn the_areas_of_all_cells_are_those_of_the_meshes() {
    for mesh in ["scenes/cube-room.obj", "scenes/cornell.obj", "scenes/atrium.obj", "scenes/room-with-windows.obj"] {
        for size in [8, 32, 64] {
            let problem = shipped(scene(mesh, Vec::new()), size);
            let stage = problem.stage.as_ref().unwrap();
            let (sum, wanted) = (stage.voxels.areas.iter().sum::<f64>(), stage.model.mesh.total_area());
            assert!((sum / wanted - 1.0).abs() < 1e-5, "{mesh} at {size}: {sum} of {wanted}");
            for solid in &problem.solids {
                assert!(solid.opacity.iter().chain(&solid.albedo).all(|share| (0.0..=1.0).contains(share)));
                assert!(solid.most_opaque() > 0.0);
            }
        }
    }
}

#[test]
fn the_walls_of_a_fitted_room_are_its_border_cells_shut_across_and_open_along() {
    let folder = squares(&cube(), 0.5);
    let problem = Problem::build(&preset(scene("a.obj", Vec::new()), 8), folder.path()).unwrap();
    assert_eq!(problem.solids.len(), 8 * 8 * 8 - 6 * 6 * 6);
    for solid in &problem.solids {
        for axis in 0..3 {
            let shut = if [0, 7].contains(&solid.cell[axis]) { 1.0 } else { 0.0 };
            assert!((solid.opacity[axis] - shut).abs() < 1e-6, "{solid:?}");
        }
    }
    // Between the cells stands nothing: the walls are where the volume ends, at cells −½ and 7½ of the others.
    assert!(problem.blockers().iter().all(|solid| solid.cell.contains(&7)), "{:?}", problem.blockers());
}

#[test]
fn what_has_not_changed_is_not_made_again() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets");
    let cache = Cache::default();
    let lights = [Light::point([2.6, 3.2, 2.0], [1.0; 3]), Light::point([1.0, 3.0, 1.0], [2.0; 3])];
    let build = |lights: &[Light], size: usize| {
        let preset = preset(scene("scenes/cube-room.obj", lights.to_vec()), size);
        Problem::build_with(&preset, &folder, &cache, &mut |_| {}).unwrap().stage.unwrap()
    };
    let before = build(&lights, 16);
    let moved = [lights[0].clone(), Light::point([1.1, 3.0, 1.0], [2.0; 3])];
    let after = build(&moved, 16);
    assert!(Arc::ptr_eq(&before.model, &after.model) && Arc::ptr_eq(&before.voxels, &after.voxels));
    assert!(Arc::ptr_eq(&before.maps[0], &after.maps[0]) && !Arc::ptr_eq(&before.maps[1], &after.maps[1]));
    assert_ne!(before.injected, after.injected);
    let larger = build(&moved, 32);
    assert!(Arc::ptr_eq(&after.model, &larger.model) && Arc::ptr_eq(&after.maps[1], &larger.maps[1]));
    assert!(!Arc::ptr_eq(&after.voxels, &larger.voxels));
    // A fresh one is the same.
    let fresh = shipped(scene("scenes/cube-room.obj", moved.to_vec()), 16).stage.unwrap();
    assert_eq!((&*fresh, &fresh.maps), (&*after, &after.maps));
}

#[test]
fn injectors_and_occluders_stand_beside_a_mesh() {
    let text = r#"(version: 1, size: 8,
        injectors: [(kind: Single(cell: (3, 3, 3)))],
        occluders: [(kind: Box(from: (4, 4, 4), to: (4, 4, 4))), (kind: Box(from: (0, 3, 3), to: (0, 4, 4)), opacity: 0.0)],
        occlusion: (mode: Hard),
        scene: (mesh: "a.obj", lights: [(kind: Point(position: (2, 2, 2)), intensity: (1, 1, 1))], shadow_map: 16))"#;
    let folder = squares(&cube(), 0.5);
    let preset = Preset::parse(text, Path::new("p.ron")).unwrap();
    assert_eq!(Preset::parse(&preset.to_ron(), Path::new("p.ron")).unwrap(), preset);
    let problem = Problem::build(&preset, folder.path()).unwrap();
    assert_eq!(
        (problem.sources.len(), problem.occlusion),
        (2, Occlusion { mode: OcclusionMode::Hard, ..Occlusion::default() })
    );
    assert_eq!(problem.solids.len(), 8 * 8 * 8 - 6 * 6 * 6 + 1 - 4);
}

#[test]
fn what_a_scene_cannot_be_is_told_with_its_place() {
    let scene = |text: &str| format!("(version: 1, size: 8,\n scene: ({text}))");
    for (text, place, what) in [
        (r#"mesh: "../a.obj""#, "p.ron:2:16: ", "leads out"),
        (r#"mesh: "a.obj", shadow_map: 0"#, "p.ron:2:37: ", "0 texels"),
        (r#"mesh: "a.obj", shadow_map: 4096"#, "p.ron:2:37: ", "4096 texels"),
        (r#"mesh: "a.obj", volume: Fit(margin: 4)"#, "p.ron:2:45: ", "no cell"),
        (r#"mesh: "a.obj", volume: Cube(center: (0, 0, 0), side: 0)"#, "", "the side is 0"),
        (r#"mesh: "a.obj", lights: [(kind: Point(position: (0, 0, 0)))]"#, "p.ron:2:34: ", "no intensity"),
        (r#"mesh: "a.obj", lights: [(kind: Point(position: (0, 0, 0)), irradiance: (1, 1, 1))]"#, "", "only the sun"),
        (r#"mesh: "a.obj", lights: [(kind: Sun(direction: (0, 0, 0)), irradiance: (1, 1, 1))]"#, "", "length zero"),
        (r#"mesh: "a.obj", lights: [(kind: Sun(direction: (0, 1, 0)), irradiance: (1, -1, 1))]"#, "", "negative"),
        (
            r#"mesh: "a.obj", lights: [(kind: Spot(position: (0, 0, 0), direction: (1, 0, 0), angle: 90), intensity: (1, 1, 1))]"#,
            "",
            "half angle",
        ),
        (r#"mesh: "a.obj", camera: (from: (0, 0, 0), to: (0, 0, 0))"#, "", "where it stands"),
        (r#"mesh: "a.obj", camera: (from: (0, 0, 0), to: (0, 1, 0))"#, "", "along the view"),
    ] {
        let fault = Preset::parse(&scene(text), Path::new("p.ron")).unwrap_err().to_string();
        assert!(fault.starts_with(place) && fault.starts_with("p.ron:2:") && fault.contains(what), "{text}: {fault}");
    }
    let missing = Problem::build(&preset(MeshScene::new("no.obj"), 8), Path::new("nowhere")).unwrap_err();
    assert!(matches!(missing, SceneError::File { .. }) && missing.to_string().contains("no.obj"), "{missing}");
    let folder = squares(&cube(), 0.5);
    let lights = (0..3).map(|i| Light::point([1.0 + f64::from(i), 1.0, 1.0], [1.0; 3])).collect();
    let large = MeshScene { shadow_map: 1024, lights, ..MeshScene::new("a.obj") };
    let fault = Problem::build(&preset(large, 8), folder.path()).unwrap_err().to_string();
    assert!(fault.starts_with("scene.shadow_map: ") && fault.contains("texels"), "{fault}");
}

#[test]
fn a_scene_seen_from_nowhere_has_a_camera_before_it() {
    let problem = shipped(scene("scenes/cornell.obj", Vec::new()), 8);
    let camera = problem.stage.unwrap().camera;
    let (from, to) = (DVec3::from_array(camera.from), DVec3::from_array(camera.to));
    assert!(from.z < -0.2 && (to.z - 0.2796).abs() < 1e-3, "{camera:?}");
}
