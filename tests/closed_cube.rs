//! A closed room whose walls lie on the volume's border: at factor 4 all light ends on them, so what arrives at the
//! walls is what was injected, whatever the size.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;

use glam::DVec3;
use lpv_lab::scene::mesh_scene::{Light, MeshScene};
use lpv_lab::scene::occluder::OcclusionMode;
use lpv_lab::scene::{Occlusion, Preset, Problem, Propagation};
use lpv_lab::sh::Sh;
use lpv_lab::simulation::Simulation;

/// What leaves a cell that holds `light`, all that was ever there, by its face in direction `d`, in W: the sum over the
/// five faces of the neighbour that the scheme `cascaded` sends through, Ω·max(0, c·Y).
fn leaves(light: Sh<f64>, d: DVec3) -> f64 {
    let far = 4.0 * 0.1f64.asin();
    let side = (2.0 * std::f64::consts::PI / 3.0 - far) / 4.0;
    let across = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]).filter(|axis| axis.dot(d) == 0.0);
    let sides: f64 = across.map(|f| side * light.eval((2.0 * d + f) / 5f64.sqrt()).max(0.0)).sum();
    far * light.eval(d).max(0.0) + sides
}

/// A closed room of 4 m, one albedo, a lamp in it, its walls on the volume's border; solids stop light or do not.
fn room(folder: &Path, size: usize, iterations: usize, mode: OcclusionMode) -> Problem {
    let corners =
        (0..8).map(|i| format!("v {} {} {}\n", 4 * (i & 1), 4 * (i >> 1 & 1), 4 * (i >> 2))).collect::<String>();
    let walls = "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n";
    std::fs::write(folder.join("a.obj"), format!("mtllib a.mtl\n{corners}usemtl a\n{walls}")).unwrap();
    std::fs::write(folder.join("a.mtl"), "newmtl a\nKd 0.5 0.5 0.5\n").unwrap();
    let preset = Preset {
        size,
        coarsest: size,
        occlusion: Occlusion { mode, ..Occlusion::default() },
        propagation: Propagation { factor: 4.0, iterations, ..Propagation::default() },
        scene: Some(MeshScene {
            lights: vec![Light::point([2.6, 3.2, 2.0], [10.0; 3])],
            shadow_map: 64,
            ..MeshScene::new("a.obj")
        }),
        ..Preset::default()
    };
    Problem::build(&preset, folder).unwrap()
}

/// What arrives at the walls by leaving a cell at the border, in W.
fn leaves_the_volume(simulation: &Simulation<f64>) -> f64 {
    let size = simulation.sizes().finest();
    let mut arrived = 0.0;
    for (cell, light) in simulation.lights()[0].accumulated.level(0).iter() {
        for (axis, d) in DVec3::AXES.into_iter().enumerate() {
            arrived += if cell[axis] == 0 { leaves(light, -d) } else { 0.0 };
            arrived += if cell[axis] == size - 1 { leaves(light, d) } else { 0.0 };
        }
    }
    arrived
}

#[test]
fn what_arrives_at_the_walls_is_what_was_injected() {
    let folder = tempfile::tempdir().unwrap();
    for (size, iterations) in [(8, 200), (16, 700), (32, 2200)] {
        let problem = room(folder.path(), size, iterations, OcclusionMode::Off);
        let injected = problem.stage.as_ref().unwrap().injected.flux[0];
        let mut simulation = Simulation::<f64>::new(problem).unwrap();
        simulation.run(|_| true);
        let arrived = leaves_the_volume(&simulation);
        assert!((arrived / injected - 1.0).abs() < 3e-3, "{size}³: {arrived} W of {injected} W arrive");
    }
}

#[test]
fn what_arrives_at_solids_on_the_border_is_what_was_injected() {
    let folder = tempfile::tempdir().unwrap();
    for (size, iterations) in [(8, 200), (16, 600)] {
        let problem = room(folder.path(), size, iterations, OcclusionMode::Hard);
        let injected = problem.stage.as_ref().unwrap().injected.flux[0];
        let mut simulation = Simulation::<f64>::new(problem).unwrap();
        simulation.run(|_| true);
        let arrivals = &simulation.arrivals(Some(0)).unwrap()[0];
        let on = |cell: [usize; 3], axis: usize, normal: DVec3| match cell[axis] {
            0 => arrivals.on(cell, normal).unwrap(),
            last if last + 1 == size => arrivals.on(cell, -normal).unwrap(),
            _ => 0.0,
        };
        let all = |cell| DVec3::AXES.into_iter().enumerate().map(|(axis, normal)| on(cell, axis, normal)).sum::<f64>();
        let arrived: f64 = simulation.lights()[0].source.level(0).layout().cells().map(all).sum();
        assert!((arrived / injected - 1.0).abs() < 3e-3, "{size}³: {arrived} W of {injected} W arrive");
    }
}
