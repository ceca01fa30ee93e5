//! Nested cascades, two-way and each alone, held against uniform volumes.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use glam::DVec3;
use lpv_lab::field::{Cell, Grid};
use lpv_lab::scene::occluder::OcclusionMode;
use lpv_lab::scene::propagation::descent::Descent;
use lpv_lab::scene::{Problem, Propagation, Solid, Source};
use lpv_lab::sh::Sh;
use lpv_lab::simulation::Simulation;
use lpv_lab::study::laws::{self, Symmetry};
use lpv_lab::study::octree::{Way, measure};
use lpv_lab::transport::descent::nest::Nest;

const SIDE: usize = 8;

type Lobes = Vec<(Cell, DVec3)>;

fn problem(size: usize, light: &Lobes, descent: Descent, iterations: usize) -> Problem {
    let light = light.iter().map(|(cell, way)| (*cell, Sh::lobe(way.normalize()))).collect();
    Problem {
        size,
        coarsest: 1,
        sources: vec![Source { color: [1.0; 3], light, ..Source::default() }],
        propagation: Propagation { factor: 3.8, iterations, descent, ..Propagation::default() },
        ..Problem::default()
    }
}

fn run(problem: Problem) -> Simulation<f64> {
    let mut simulation = Simulation::new(problem).unwrap();
    simulation.run(|_| true);
    simulation
}

fn cascades(center: Option<[f64; 3]>, alone: bool) -> Descent {
    Descent::Cascades { side: SIDE, center, alone }
}

/// In the finest grid, in the next, and in the last of a volume of 32³.
fn lobes() -> Lobes {
    vec![([16, 15, 17], DVec3::X), ([10, 18, 20], DVec3::new(0.3, -1.0, 0.2)), ([3, 2, 28], DVec3::Z)]
}

#[test]
fn one_grid_that_fills_the_volume_is_a_descent_over_all_cells_to_the_bit() {
    let of = |descent| run(problem(SIDE, &vec![([2, 3, 5], DVec3::Y)], descent, 3)).lights()[0].clone();
    assert!(of(cascades(None, false)) == of(Descent::Cells));
}

#[test]
fn where_the_octree_ends_before_its_coarsest_level_is_the_last_grid() {
    for alone in [false, true] {
        let of = |descent| {
            let mut asked = problem(32, &lobes(), descent, 3);
            asked.coarsest = 32;
            run(asked).lights()[0].merged.clone().unwrap()
        };
        let uniform = of(if alone { Descent::Off } else { Descent::Cells });
        assert!(of(cascades(None, alone)) == uniform, "alone: {alone}");
    }
}

#[test]
fn a_grid_alone_is_a_volume_of_its_own() {
    let k = 5;
    let grids = run(problem(32, &lobes(), cascades(None, true), k));
    let nest = Nest::new(grids.sizes(), SIDE, None);
    let injected = run(problem(32, &lobes(), Descent::Off, 0));
    for i in 0..3 {
        // What lies in the grid, in a volume of its side with no other level.
        let corner = nest.corner(i);
        let there = |cell: Cell| [0, 1, 2].map(|a| cell[a] + corner[a]);
        let mut own = problem(SIDE, &Vec::new(), Descent::Off, k);
        own.coarsest = SIDE;
        let source = injected.lights()[0].source.level(i);
        let cells = Grid::<f64>::new(SIDE).layout().cells();
        own.sources[0].light = cells.map(|cell| (cell, source.get(there(cell)))).collect();
        let own = run(own);
        let (wanted, found) = (own.lights()[0].accumulated.level(0), grids.lights()[0].accumulated.level(i));
        assert!(wanted.energy() > 0.0);
        for (cell, light) in wanted.iter() {
            assert_eq!(found.get(there(cell)), light, "grid {i}, {cell:?}");
        }
        assert!((found.energy() - wanted.energy()).abs() < 1e-12 * wanted.energy(), "grid {i} is lit outside");
    }
    assert_eq!(grids.work().visited, 3 * k * SIDE.pow(3));
}

#[test]
fn grids_alone_go_with_their_light_by_whole_coarse_cells() {
    let near: Lobes = lobes()[..2].to_vec();
    let by = [4, 0, 4];
    let moved = near.iter().map(|(cell, way)| ([0, 1, 2].map(|a| cell[a] + by[a]), *way)).collect();
    let here = run(problem(64, &near, cascades(Some([16.0, 17.0, 18.0]), true), 6));
    let there = run(problem(64, &moved, cascades(Some([20.0, 17.0, 22.0]), true), 6));
    // Grids 0 and 1 lie in cells of levels 1 and 2; the coarser ones stand at the volume's border.
    for i in 0..2 {
        let (before, after) = (here.lights()[0].accumulated.level(i), there.lights()[0].accumulated.level(i));
        assert!(before.energy() > 0.0);
        for (cell, light) in before.iter().filter(|(_, light)| !light.is_zero()) {
            assert_eq!(after.get([0, 1, 2].map(|a| cell[a] + (by[a] >> i))), light, "grid {i}, {cell:?}");
        }
    }
}

#[test]
fn both_keep_the_symmetries_of_the_cube_and_grids_alone_are_linear() {
    for alone in [false, true] {
        let straight = run(problem(32, &lobes(), cascades(None, alone), 3));
        for by in Symmetry::all() {
            assert_eq!(laws::symmetry(&straight, by, 1e-12), Ok(()), "alone: {alone}");
        }
    }
    // A descent hands light down as it lies in the coarse cells, which is not linear; only its fixed point is.
    let mut alone = problem(32, &lobes(), cascades(None, true), 3);
    alone.propagation.clamp = false;
    assert_eq!(laws::superposition(&run(alone), 1e-12), Ok(()));
}

#[test]
fn a_closed_wall_shuts_in_every_grid() {
    for x in [14, 21, 26] {
        for alone in [false, true] {
            let mut asked = problem(32, &lobes(), cascades(None, alone), 6);
            asked.occlusion.mode = OcclusionMode::Hard;
            let lit = |asked: &Problem| run(asked.clone()).lights()[0].merged.clone().unwrap();
            // The coarse cells that hold the wall reach up to four cells from it.
            let beyond = |merged: &Grid<f64>| -> f64 {
                merged.iter().filter(|(cell, _)| cell[0] >= x + 4).map(|(_, light)| light.max_norm()).sum()
            };
            asked.sources[0].light.retain(|(cell, _)| cell[0] < x);
            let open = beyond(&lit(&asked));
            asked.solids = (0..1024).map(|i| Solid::new([x, i % 32, i / 32], DVec3::NEG_X, 1.0, [0.5; 3])).collect();
            assert_eq!(beyond(&lit(&asked)), 0.0, "a wall at {x}, alone: {alone}");
            assert!(alone || open > 0.0, "without a wall there is light");
        }
    }
}

#[test]
fn two_way_cascades_are_at_most_half_as_wrong_as_grids_alone() {
    let floor = (0..1024).map(|i| ([i % 32, 0, i / 32], DVec3::Y)).collect();
    let ways = Way::all(&[], &[SIDE]);
    for light in [lobes()[..1].to_vec(), lobes()[1..].to_vec(), lobes(), floor] {
        let asked = problem(32, &light, Descent::Off, 0);
        let rows = measure("scene", &asked, (&ways, &[4, 64]), 1, &|_| true).unwrap().unwrap();
        let of =
            |way: &str| -> Vec<f64> { rows.iter().filter(|row| row.way == way).map(|row| row.converged).collect() };
        let (both, alone) = (of("descent-cascades-8"), of("cascades-8-alone"));
        println!("two-way {both:.3?}, alone {alone:.3?}");
        assert!(both.len() == 2 && both.iter().zip(&alone).all(|(both, alone)| 2.0 * both <= *alone));
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    for (side, center) in [(12, None), (4, None), (64, None), (8, Some([16.0, 33.0, 0.0]))] {
        for alone in [false, true] {
            let descent = Descent::Cascades { side, center, alone };
            let told = Simulation::<f32>::new(problem(32, &lobes(), descent, 4)).unwrap_err().to_string();
            assert!(told.contains("cascades cannot"), "{told}");
        }
    }
}
