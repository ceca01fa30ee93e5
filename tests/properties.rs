//! What must hold for every scene: the symmetries of the cube, linearity, parity and reach, stepping = running,
//! the index volume and the merge by their definitions.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use glam::DVec3;
use lpv_lab::field::{Cell, Grid};
use lpv_lab::scene::propagation::{Propagation, Snapshots};
use lpv_lab::scene::{Occlusion, Problem, Source};
use lpv_lab::sh::Sh;
use lpv_lab::simulation::{Action, Simulation};
use lpv_lab::study::laws::Symmetry;
use lpv_lab::transport::lattice::schemes;
use lpv_lab::transport::lattice::stencil::Stencil;
use proptest::prelude::*;

const N: usize = 8;

fn problem(light: Vec<(Cell, Sh<f64>)>, propagation: Propagation) -> Problem {
    Problem {
        size: N,
        coarsest: 1,
        sources: vec![Source { color: [1.0; 3], light, ..Source::default() }],
        solids: Vec::new(),
        occlusion: Occlusion::default(),
        propagation,
        ..Problem::default()
    }
}

fn run(light: Vec<(Cell, Sh<f64>)>, propagation: Propagation) -> Simulation<f64> {
    let mut simulation = Simulation::new(problem(light, propagation)).unwrap();
    simulation.run(|_| true);
    simulation
}

fn settings(factor: f64, iterations: usize, clamp: bool) -> Propagation {
    Propagation { factor, iterations, clamp, ..Propagation::default() }
}

fn cell() -> impl Strategy<Value = Cell> {
    [0..N, 0..N, 0..N]
}

fn direction() -> impl Strategy<Value = DVec3> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0f64].prop_filter_map("no direction", |v| DVec3::from_array(v).try_normalize())
}

fn lobes() -> impl Strategy<Value = Vec<(Cell, Sh<f64>)>> {
    let lobe = (cell(), direction(), 0.1..2.0).prop_map(|(cell, d, strength)| (cell, Sh::lobe(d) * strength));
    prop::collection::vec(lobe, 1..5)
}

fn close(a: Sh<f64>, b: Sh<f64>, scale: f64) -> bool {
    (a - b).max_norm() <= 1e-12 * scale
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn the_48_symmetries_of_the_cube_commute_with_a_run(light in lobes(), clamp: bool) {
        let plain = run(light.clone(), settings(3.0, 5, clamp));
        for symmetry in Symmetry::all() {
            let turned = light.iter().map(|(cell, value)| (symmetry.cell(*cell, N - 1), symmetry.light(*value))).collect();
            let turned = run(turned, settings(3.0, 5, clamp));
            let grids = |s: &Simulation<f64>| (s.lights()[0].accumulated.level(0).clone(), s.lights()[0].merged.clone());
            let ((plain, merged), (turned, turned_merged)) = (grids(&plain), grids(&turned));
            for (a, b) in [(Some(plain), Some(turned)), (merged, turned_merged)] {
                let (a, b) = (a.unwrap(), b.unwrap());
                for (cell, value) in a.iter() {
                    prop_assert!(close(b.get(symmetry.cell(cell, N - 1)), symmetry.light(value), 1.0), "{symmetry:?} {cell:?}");
                }
            }
        }
    }

    #[test]
    fn without_clamp_light_adds_up(a in lobes(), b in lobes()) {
        let both = a.iter().chain(&b).copied().collect();
        let [a, b, both] = [a, b, both].map(|light| run(light, settings(3.0, 6, false)));
        for i in 0..both.sizes().count() {
            let level = |s: &Simulation<f64>| s.lights()[0].accumulated.level(i).clone();
            let (a, b) = (level(&a), level(&b));
            for (cell, value) in level(&both).iter() {
                prop_assert!(close(a.get(cell) + b.get(cell), value, 4.0), "level {i}, {cell:?}");
            }
        }
    }

    #[test]
    fn stepping_gives_the_bits_of_a_run(light in lobes(), k in 0usize..7, copy_first: bool) {
        let snapshots = if copy_first { Snapshots::CopyFirst } else { Snapshots::Thesis };
        let propagation = Propagation { snapshots, ..settings(3.0, k, true) };
        let whole = run(light.clone(), propagation.clone());
        let mut stepped = Simulation::<f64>::new(problem(light, propagation)).unwrap();
        for action in [Action::Inject, Action::Downsample] {
            stepped.act(action);
        }
        for _ in 0..k {
            stepped.act(Action::Propagate);
        }
        stepped.act(Action::Merge);
        prop_assert_eq!(whole.lights(), stepped.lights());
        prop_assert_eq!(whole.index(), stepped.index());
    }

    #[test]
    fn the_index_volume_is_where_light_has_been_and_the_merge_samples_by_it(light in lobes(), k in 0usize..4) {
        let mut simulation = Simulation::<f64>::new(problem(light, settings(3.0, k, true))).unwrap();
        let levels = simulation.sizes().count();
        // The definition, kept apart: every cell of every level that a snapshot has lit.
        let mut been: Vec<Grid<f64>> = simulation.sizes().sides().map(Grid::new).collect();
        simulation.run(|s| {
            for (i, been) in been.iter_mut().enumerate() {
                for (cell, value) in s.lights()[0].source.level(i).iter() {
                    if !value.is_zero() {
                        been.set(cell, Sh([1.0; 4]));
                    }
                }
            }
            true
        });
        let light = &simulation.lights()[0];
        for (cell, merged) in light.merged.as_ref().unwrap().iter() {
            let lit = |i: &usize| !been[*i].get(cell.map(|c| c >> i)).is_zero();
            let index = (0..levels).find(lit).unwrap_or(levels - 1);
            prop_assert_eq!(simulation.index().index(cell), index);
            prop_assert_eq!(merged, light.accumulated.level(index).get(cell.map(|c| c >> index)));
        }
    }

    #[test]
    fn light_stays_within_reach_and_parity_of_its_source(from in cell(), d in direction(), k in 0usize..12) {
        let simulation = run(vec![(from, Sh::lobe(d))], settings(3.0, k, true));
        for (cell, value) in simulation.lights()[0].source.level(0).iter() {
            let distance: usize = (0..3).map(|a| cell[a].abs_diff(from[a])).sum();
            if distance > k || (distance + k) % 2 == 1 {
                prop_assert!(value.is_zero(), "k = {k}, {cell:?}");
            }
        }
    }

    #[test]
    fn energy_is_never_negative_and_never_gains_more_than_a_lone_lobe_does(light in lobes()) {
        // Clamped, an iteration is sublinear, and all light is a sum of lobes with weights of zero or more. So no
        // light gains more than the lobe that gains most.
        let stencil = Stencil::<f64>::new(&schemes::find("cascaded").unwrap(), 4.0, true);
        let gain = |n: DVec3| (0..6).map(|d| stencil.send(d, Sh::lobe(n)).0[0]).sum::<f64>() / Sh::<f64>::lobe(n).0[0];
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let directions = (0..4000).map(|i| {
            let (z, angle) = (1.0 - (f64::from(i) + 0.5) / 2000.0, golden * f64::from(i));
            DVec3::new(angle.cos() * (1.0 - z * z).sqrt(), angle.sin() * (1.0 - z * z).sqrt(), z)
        });
        let most = directions.map(gain).fold(0.0, f64::max) + 1e-3;
        let mut simulation = Simulation::<f64>::new(problem(light, settings(4.0, 10, true))).unwrap();
        let mut energies = Vec::new();
        simulation.run(|s| { energies.push(s.lights()[0].source.level(0).energy()); true });
        for (before, after) in energies.iter().zip(&energies[1..]) {
            prop_assert!(*after >= 0.0 && *after <= most * before, "{before} became {after}");
        }
    }
}

#[test]
fn a_corner_light_needs_three_times_the_side_less_one_to_fill_the_volume() {
    // MATH.md section 4: 21 iterations for 8³, because light moves one axis a step.
    let towards_the_far_corner = Sh::lobe(DVec3::ONE.normalize());
    let lit_after = |k| {
        let simulation = run(vec![([0; 3], towards_the_far_corner)], settings(3.0, k, true));
        simulation.index().level(0).count()
    };
    assert!(lit_after(20) < N * N * N);
    assert_eq!(lit_after(21), N * N * N);
}

#[test]
fn every_action_tells_what_it_changed() {
    let light = vec![([4, 4, 4], Sh::lobe(DVec3::X))];
    let mut simulation = Simulation::<f64>::new(problem(light, settings(3.0, 4, true))).unwrap();
    let inject = simulation.act(Action::Inject);
    assert!(inject.source && inject.accumulated && !inject.target && !inject.merged);
    assert_eq!((inject.newly_lit, inject.iteration), (1, 0));
    let downsample = simulation.act(Action::Downsample);
    assert_eq!(downsample.newly_lit, 3);
    let propagate = simulation.act(Action::Propagate);
    assert!(propagate.source && propagate.target && propagate.accumulated);
    // Level 0 reaches five of six neighbours (none backwards), 4³ the same, 2³ three inside less one backwards.
    assert_eq!(propagate.iteration, 1);
    assert_eq!(propagate.newly_lit, 5 + 5 + 3 - backwards_inside());
    let merge = simulation.act(Action::Merge);
    assert!(merge.merged && !merge.source);
    let clear = simulation.act(Action::Clear);
    assert_eq!((clear.iteration, clear.newly_lit), (0, 0));
    assert!(simulation.lights()[0].merged.is_none());
    assert_eq!(simulation.index().level(0).count(), 0);
}

/// In the 2³ level the light sits in cell (1, 1, 1); of its three neighbours inside, −x gets nothing from a lobe along +X.
fn backwards_inside() -> usize {
    1
}
