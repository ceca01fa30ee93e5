//! Divergence, as a simulation shows it.

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
