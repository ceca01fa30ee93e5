//! Divergence and ordinates, as a simulation shows them.

mod divergence {
    use crate::scene::propagation::{Propagation, Snapshots};
    use crate::scene::{Occlusion, Problem, Source};
    use crate::sh::Sh;
    use crate::simulation::{Action, Simulation, limit};

    fn simulation(factor: f64, strength: f64, snapshots: Snapshots) -> Simulation<f32> {
        let light = vec![([3, 4, 4], Sh::lobe(glam::DVec3::X) * strength)];
        let problem = Problem {
            size: 8,
            coarsest: 1,
            sources: vec![Source { color: [1.0; 3], light, ..Source::default() }],
            solids: Vec::new(),
            occlusion: Occlusion::default(),
            propagation: Propagation { factor, iterations: 10_000, snapshots, ..Propagation::default() },
            ..Problem::default()
        };
        Simulation::new(problem).unwrap()
    }

    fn is_finite(simulation: &Simulation<f32>) -> bool {
        let light = &simulation.lights()[0];
        let octrees = [&light.source, &light.target, &light.accumulated];
        let grids = octrees.iter().flat_map(|octree| octree.levels()).chain(&light.merged);
        grids.flat_map(|grid| grid.planes()).flatten().all(|c| c.is_finite())
    }

    #[test]
    fn growing_light_is_stopped_in_time_and_the_last_good_state_kept() {
        for (factor, strength) in [(10.0, 1.0), (1e4, 1.0), (1e30, 1.0), (1e300, 1.0), (4.5, 1e30)] {
            let mut simulation = simulation(factor, strength, Snapshots::CopyFirst);
            let mut last = None;
            simulation.run(|now| {
                last = Some(now.lights()[0].source.clone());
                true
            });
            let told = simulation.divergence().unwrap();
            assert_eq!((told.level, told.iteration, told.side), (0, simulation.iteration() + 1, 8), "{factor}");
            assert!(is_finite(&simulation));
            // Not given up long before there is need: an iteration gains p at most in any coefficient, clamps and all.
            assert!(told.largest * (8.0 * factor + 2.0) > limit::<f32>(), "{factor}: {told:?}");
            assert_eq!(Some(&simulation.lights()[0].source), last.as_ref());
        }
    }

    #[test]
    fn light_that_does_not_grow_is_never_stopped() {
        let mut simulation = simulation(3.0, 1e30, Snapshots::Thesis);
        simulation.run(|_| true);
        assert_eq!((simulation.divergence(), simulation.iteration()), (None, 10_000));
    }

    #[test]
    fn a_stopped_simulation_starts_anew_when_cleared() {
        let mut simulation = simulation(1e30, 1.0, Snapshots::Thesis);
        simulation.run(|_| true);
        assert!(simulation.divergence().is_some());
        simulation.act(Action::Clear);
        assert!(simulation.divergence().is_none() && is_finite(&simulation));
    }
}

mod ordinates {
    use crate::field::Grid;
    use crate::scene::occluder::OcclusionMode;
    use crate::scene::propagation::ordinates::{Lattice, Rule, Setting};
    use crate::scene::propagation::{Propagation, Snapshots};
    use crate::scene::{Occlusion, Problem, Solid, Source};
    use crate::sh::Sh;
    use crate::simulation::{Action, Refusal, Simulation};
    use crate::transport::kind::Precision;
    use crate::transport::ordinates::Ordinates;
    use crate::transport::transmittance::Transmittance;
    use glam::DVec3;

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
        assert!(
            simulation.lights()[0].accumulated.level(0).iter().all(|(_, light)| light.0.iter().all(|c| c.is_finite()))
        );
        simulation.act(Action::Clear);
        assert!(simulation.act(Action::Propagate).target);
        let mut large = problem(4.0);
        large.size = 1024;
        large.propagation.ordinates.directions = 8192;
        assert!(matches!(Simulation::<f32>::new(large), Err(Refusal::Memory { .. })));
    }
}
