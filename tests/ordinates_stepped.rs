//! Discrete ordinates as a simulation steps them, against their own single sweep.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use glam::DVec3;
use lpv_lab::field::Grid;
use lpv_lab::scene::occluder::OcclusionMode;
use lpv_lab::scene::propagation::directions::{Lattice, Rule, Setting};
use lpv_lab::scene::propagation::{Propagation, Snapshots};
use lpv_lab::scene::{Occlusion, Problem, Solid, Source};
use lpv_lab::sh::Sh;
use lpv_lab::simulation::{Action, Refusal, Simulation};
use lpv_lab::transport::Precision;
use lpv_lab::transport::ordinates::Ordinates;
use lpv_lab::transport::transmittance::Transmittance;

fn problem(factor: f64) -> Problem {
    let light = vec![([2, 3, 3], Sh::lobe(DVec3::X)), ([5, 5, 1], Sh([0.4, 0.0, -0.1, 0.2]))];
    let ordinates = Setting { directions: 40, rule: Rule::Faces, lattice: Lattice::Octahedral };
    Problem {
        size: 8,
        coarsest: 1,
        sources: vec![Source { color: [1.0, 0.5, 0.0], light, ..Source::default() }],
        solids: Vec::new(),
        occlusion: Occlusion::default(),
        propagation: Propagation {
            scheme: "ordinates".to_owned(),
            factor,
            iterations: 24,
            ordinates,
            ..Propagation::default()
        },
        ..Problem::default()
    }
}

fn run<T: Precision>(problem: &Problem) -> Simulation<T> {
    let mut simulation = Simulation::new(problem.clone()).unwrap();
    simulation.run(|_| true);
    simulation
}

#[test]
fn at_four_all_iterations_are_one_sweep_and_what_is_merged_is_the_finest_level() {
    for mode in [OcclusionMode::Hard, OcclusionMode::Fuzzy, OcclusionMode::Off] {
        let mut problem = problem(4.0);
        problem.occlusion.mode = mode;
        problem.solids = vec![Solid::new([4, 3, 3], DVec3::X, 0.7, [0.5; 3])];
        let simulation = run::<f32>(&problem);
        let mut injected = Grid::new(8);
        problem.sources[0].light.iter().for_each(|(cell, light)| injected.set(*cell, light.cast()));
        let occluders = Transmittance::new(8, &problem.solids).filter(|_| mode != OcclusionMode::Off);
        let mut wanted = Ordinates::<f32>::of(&problem.propagation.ordinates).solve(&injected, occluders.as_ref());
        wanted.add_grid(&injected);
        let light = &simulation.lights()[0];
        assert_eq!(light.merged.as_ref(), Some(light.accumulated.level(0)));
        for (cell, wanted) in wanted.iter() {
            let found = light.accumulated.level(0).get(cell);
            assert!((found - wanted).max_norm() < 1e-6, "{mode:?}, {cell:?}: {found:?}, {wanted:?}");
        }
    }
}

#[test]
fn the_factor_thins_every_snapshot_and_coarser_levels_hold_means() {
    let (full, haze) = (run::<f32>(&problem(4.0)), run::<f64>(&problem(3.0)));
    let mut sum = 0.0;
    let mut stepped = Simulation::<f32>::new(problem(4.0)).unwrap();
    stepped.run(|now| {
        sum += 0.75f64.powi(now.iteration() as i32) * now.lights()[0].source.level(0).energy();
        true
    });
    assert!((haze.lights()[0].accumulated.level(0).energy() / sum - 1.0).abs() < 1e-5);
    let octree = &full.lights()[0].accumulated;
    let mut means = octree.clone();
    means.downsample();
    for i in 0..4 {
        for (cell, mean) in means.level(i).iter() {
            assert!((octree.level(i).get(cell) - mean).max_norm() < 1e-6, "level {i}, {cell:?}");
        }
    }
}

#[test]
fn light_injected_on_the_way_adds_up_and_clearing_forgets_it() {
    let once = run::<f32>(&problem(4.0));
    let mut again = Simulation::<f32>::new(problem(4.0)).unwrap();
    let act = |simulation: &mut Simulation<f32>, action, times| {
        for _ in 0..times {
            simulation.act(action);
        }
    };
    act(&mut again, Action::Inject, 1);
    act(&mut again, Action::Propagate, 3);
    act(&mut again, Action::Inject, 1);
    act(&mut again, Action::Propagate, 24);
    let [once, twice] = [&once, &again].map(|s| s.lights()[0].accumulated.level(0).energy());
    assert!((twice / once - 2.0).abs() < 1e-5);
    let under_way = again.bytes();
    act(&mut again, Action::Clear, 1);
    assert!(again.bytes() < under_way);
    act(&mut again, Action::Propagate, 1);
    assert_eq!(again.lights()[0].accumulated.level(0).energy(), 0.0);
}

#[test]
fn copying_first_sends_the_injected_light_twice() {
    let mut copied = problem(4.0);
    copied.propagation.snapshots = Snapshots::CopyFirst;
    copied.propagation.iterations = 25;
    let [plain, copied] = [problem(4.0), copied].map(|problem| {
        let simulation = run::<f32>(&problem);
        simulation.lights()[0].accumulated.level(0).energy()
    });
    let injected = problem(4.0).sources[0].light.iter().map(|(_, light)| light.0[0]).sum::<f64>();
    // S_1 + S_2 + … with S_1 = S_0 + P(S_0) is S_0 + 2·(P(S_0) + P(P(S_0)) + …).
    assert!((copied - (2.0 * plain - injected)).abs() < 1e-4 * plain, "{copied}, {plain}, {injected}");
}

#[test]
fn what_would_leave_the_range_of_numbers_or_the_memory_is_refused() {
    let mut simulation = run::<f32>(&problem(1e30));
    assert!(simulation.divergence().is_some());
    assert!(simulation.lights()[0].accumulated.level(0).iter().all(|(_, light)| light.0.iter().all(|c| c.is_finite())));
    simulation.act(Action::Clear);
    assert!(simulation.act(Action::Propagate).target);
    let mut large = problem(4.0);
    large.size = 1024;
    large.propagation.ordinates.directions = 8192;
    assert!(matches!(Simulation::<f32>::new(large), Err(Refusal::Memory { .. })));
}
