//! Whatever way a simulation is run, the light is the same: to the bit where only skipping, threads,
//! blocking or instruction sets differ, to rounding where the kernel does.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;

use lpv_lab::field::{Cell, Grid};
use lpv_lab::scene::Problem;
use lpv_lab::scene::occluder::{Accumulate, Occlusion, OcclusionMode};
use lpv_lab::scene::propagation::Policy;
use lpv_lab::scene::propagation::Snapshots;
use lpv_lab::sh::Sh;
use lpv_lab::simulation::options::{Device, Instructions, Kernel, Options, Skip, Wanted};
use lpv_lab::simulation::{Action, Simulation};
use lpv_lab::transport::lattice::schemes;
use lpv_lab::transport::preset;

const PRESETS: [&str; 7] = [
    "two-walls.ron",
    "one-lobe.ron",
    "mixed.ron",
    "colours.ron",
    "opposite-lobes.ron",
    "thin-wall-bleeding.ron",
    "room-with-window.ron",
];

fn preset(name: &str) -> Problem {
    let mut problem = preset::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("presets").join(name)).unwrap().1;
    problem.propagation.iterations = problem.propagation.iterations.min(16);
    problem
}

fn stepped(problem: &Problem, options: Options) -> Simulation<f32> {
    let mut simulation = Simulation::with_options(problem.clone(), options).unwrap();
    simulation.run(|_| true);
    simulation
}

fn at_once(problem: &Problem, options: Options, wanted: Wanted) -> Simulation<f32> {
    let mut simulation = Simulation::with_options(problem.clone(), options).unwrap();
    simulation.run_all(wanted);
    simulation
}

/// One way in which nothing is left out, shared or fast but the loop.
const STRAIGHT: Options = Options {
    device: Device::Cpu,
    kernel: Kernel::Fast,
    instructions: Instructions::Baseline,
    blocked: false,
    skip: Skip { channels: true, ..Skip::NOTHING },
    tolerance: None,
};

/// Options, and how many threads carry them out.
fn ways() -> Vec<(usize, Options)> {
    let skips = [
        Skip::default(),
        Skip { reach: false, ..Skip::default() },
        Skip { dark: false, ..Skip::default() },
        Skip { channels: true, ..Skip::NOTHING },
    ];
    let ways = skips.into_iter().flat_map(|skip| {
        [(1, true), (2, false), (3, true)]
            .map(|(threads, blocked)| (threads, Options { blocked, skip, ..Options::default() }))
    });
    ways.collect()
}

/// Does the work on so many threads.
fn on<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

#[test]
fn every_way_leaves_the_same_light_on_all_levels() {
    for name in PRESETS {
        for levels in Policy::ALL {
            let mut problem = preset(name);
            problem.propagation.levels = levels;
            let straight = on(1, || stepped(&problem, STRAIGHT));
            for (threads, options) in ways() {
                let both = || [stepped(&problem, options), at_once(&problem, options, Wanted::Everything)];
                for found in on(threads, both) {
                    assert!(found.lights() == straight.lights(), "{name}, {threads} threads, {options:?}");
                    assert!(found.index() == straight.index(), "{name}, {threads} threads, {options:?}");
                }
            }
        }
    }
}

#[test]
fn where_only_the_merged_light_is_wanted_it_is_the_same() {
    for name in PRESETS {
        for iterations in [1, 4, 16, 31] {
            let mut problem = preset(name);
            problem.propagation.iterations = iterations;
            let straight = on(1, || stepped(&problem, STRAIGHT));
            for (threads, options) in ways() {
                let found = on(threads, || at_once(&problem, options, Wanted::Merged));
                for (found, wanted) in found.lights().iter().zip(straight.lights()) {
                    assert!(found.merged == wanted.merged, "{name}, k = {iterations}, {threads} threads, {options:?}");
                }
            }
        }
    }
}

#[test]
fn coarse_cells_that_no_sample_looks_at_are_left_out() {
    let mut problem = preset("two-walls.ron");
    problem.propagation.iterations = problem.size;
    let visited = |wanted| at_once(&problem, Options::default(), wanted).work().visited;
    // Light from both walls has filled level 0 long before the end: no coarser level is sampled.
    let finest = problem.size.pow(3) * problem.propagation.iterations;
    assert!(visited(Wanted::Merged) <= finest);
    assert!(visited(Wanted::Merged) < visited(Wanted::Everything));
}

#[test]
fn among_all_kinds_of_occluders_the_fast_loops_give_what_the_definition_gives() {
    for name in ["wall-with-gap.ron", "room-with-window.ron"] {
        for scheme in schemes::names() {
            for (mode, bounce) in [(OcclusionMode::Fuzzy, 0.5), (OcclusionMode::Hard, 0.5)] {
                for (levels, accumulate) in Policy::ALL.into_iter().zip([Accumulate::Everywhere, Accumulate::Occupied])
                {
                    let mut problem = preset(name);
                    problem.occlusion = Occlusion { mode, bounce, accumulate, ..problem.occlusion };
                    problem.propagation.scheme = scheme.to_owned();
                    problem.propagation.levels = levels;
                    problem.propagation.factor = 2.0;
                    problem.propagation.iterations = 6;
                    let plain = stepped(&problem, Options { kernel: Kernel::Plain, ..Options::default() });
                    let fast = stepped(&problem, Options::default());
                    for (fast, plain) in fast.lights().iter().zip(plain.lights()) {
                        for (fast, plain) in fast.accumulated.levels().iter().zip(plain.accumulated.levels()) {
                            let found = difference(fast, plain);
                            assert!(found < 1e-5, "{name}, {scheme}, {mode:?}, {levels:?}: {found}");
                        }
                    }
                    assert!(fast.index() == plain.index(), "{name}, {scheme}, {mode:?}, {levels:?}");
                }
            }
        }
    }
}

#[test]
fn where_only_surfaces_accumulate_the_others_hold_nothing() {
    let mut problem = preset("room-with-window.ron");
    problem.propagation.scheme = "reflective".to_owned();
    problem.propagation.iterations = 12;
    let everywhere = stepped(&problem, Options::default());
    problem.occlusion.accumulate = Accumulate::Occupied;
    let surfaces = stepped(&problem, Options::default());
    let occupied = |level: usize, cell: Cell| problem.solids.iter().any(|b| b.cell.map(|c| c >> level) == cell);
    for (all, found) in everywhere.lights().iter().zip(surfaces.lights()) {
        assert!(all.source == found.source);
        // Coarser levels begin with the mean of what the finest has accumulated, so they differ there too.
        for ((cell, all), (_, found)) in all.accumulated.level(0).iter().zip(found.accumulated.level(0).iter()) {
            let wanted = if occupied(0, cell) { all } else { Sh::ZERO };
            assert_eq!(found, wanted, "{cell:?}");
        }
        for level in 1..surfaces.sizes().count() {
            for (cell, light) in found.accumulated.level(level).iter() {
                assert!(occupied(level, cell) || light.is_zero(), "level {level}, {cell:?}");
            }
        }
    }
}

/// ‖found − wanted‖∞ over the largest ‖wanted‖∞.
fn difference(found: &Grid<f32>, wanted: &Grid<f32>) -> f32 {
    let most = wanted.iter().map(|(_, light)| light.max_norm()).fold(f32::MIN_POSITIVE, f32::max);
    found.iter().zip(wanted.iter()).map(|((_, a), (_, b))| (a - b).max_norm() / most).fold(0.0, f32::max)
}

#[test]
fn the_fast_loops_give_what_the_definition_gives() {
    for name in PRESETS {
        for snapshots in [Snapshots::Thesis, Snapshots::CopyFirst, Snapshots::WithoutInjected] {
            let mut problem = preset(name);
            problem.propagation.snapshots = snapshots;
            let plain = stepped(&problem, Options { kernel: Kernel::Plain, ..Options::default() });
            let fast = stepped(&problem, Options::default());
            for (fast, plain) in fast.lights().iter().zip(plain.lights()) {
                for (fast, plain) in fast.accumulated.levels().iter().zip(plain.accumulated.levels()) {
                    assert!(difference(fast, plain) < 3e-6, "{name}, {snapshots:?}");
                }
            }
        }
    }
}

#[test]
fn colours_carried_apart_are_the_multiples_that_sharing_makes_of_them() {
    let problem = preset("two-walls.ron");
    let apart = stepped(&problem, Options { skip: Skip { channels: false, ..Skip::default() }, ..Options::default() });
    let shared = stepped(&problem, Options::default());
    assert!(apart.lights().len() == 3 && shared.lights().len() == 1);
    for (colour, share) in shared.channels().rgb().iter().enumerate() {
        assert_eq!(share.scale, 1.0, "the preset is white");
        assert!(apart.lights()[colour].accumulated == shared.lights()[share.channel].accumulated);
    }
}

#[test]
fn a_run_that_stops_early_has_left_out_no_more_than_its_bound() {
    for (name, scheme) in [("two-walls.ron", "cascaded"), ("one-lobe.ron", "cascaded"), ("mixed.ron", "axial")] {
        let mut problem = preset(name);
        problem.propagation.scheme = scheme.to_owned();
        problem.propagation.iterations = 400;
        for tolerance in [1e-1, 1e-3] {
            let options = Options { tolerance: Some(tolerance), ..Options::default() };
            let early = at_once(&problem, options, Wanted::Everything);
            let bound = early.still_to_come().unwrap();
            assert!(bound <= tolerance && early.iteration() < 400, "{name}: {bound} after {}", early.iteration());
            let whole = at_once(&problem, Options::default(), Wanted::Everything);
            let mut missing = 0.0f64;
            for (early, whole) in early.lights().iter().zip(whole.lights()) {
                for (early, whole) in early.accumulated.levels().iter().zip(whole.accumulated.levels()) {
                    missing = missing.max((whole.energy() - early.energy()) / early.energy());
                }
            }
            assert!(missing <= bound * 1.001, "{name}: {missing} of {bound}");
            assert!(missing > 0.0);
            // Stepping stops at the same iteration.
            assert_eq!(stepped(&problem, options).iteration(), early.iteration());
        }
    }
}

#[test]
fn actions_in_any_order_never_meet_stale_knowledge() {
    use Action::{Clear, Downsample, Inject, Merge, Propagate};
    let orders: [&[Action]; 4] = [
        &[Inject, Propagate, Propagate, Inject, Propagate, Downsample, Propagate, Merge],
        &[Propagate, Inject, Downsample, Propagate, Downsample, Propagate, Propagate],
        &[Inject, Downsample, Propagate, Clear, Inject, Propagate, Merge, Propagate],
        &[Inject, Propagate, Propagate, Propagate, Clear, Propagate, Inject, Downsample, Propagate, Propagate],
    ];
    for order in orders {
        let run = |options| {
            let mut simulation = Simulation::<f32>::with_options(preset("mixed.ron"), options).unwrap();
            order.iter().for_each(|action| {
                simulation.act(*action);
            });
            simulation
        };
        let (quick, straight) = (run(Options::default()), run(STRAIGHT));
        assert!(quick.lights() == straight.lights(), "{order:?}");
        assert!(quick.index() == straight.index(), "{order:?}");
    }
}

#[test]
fn what_is_left_out_is_told_apart() {
    let mut problem = preset("one-lobe.ron");
    // So small a factor that light fades before it has reached everything.
    problem.propagation.factor = 0.05;
    problem.propagation.iterations = 60;
    let count = |skip| stepped(&problem, Options { skip, ..Options::default() }).work();
    let (both, nothing) = (count(Skip::default()), count(Skip::NOTHING));
    let no_reach = count(Skip { reach: false, ..Skip::default() });
    let no_dark = count(Skip { dark: false, ..Skip::default() });
    assert_eq!((nothing.share(), nothing.dark), (1.0, 0));
    assert!(both.dark > 0 && no_reach.dark > 0 && no_dark.dark == 0);
    assert!(both.visited + both.dark < both.volume);
    assert!(no_dark.visited >= both.visited + both.dark);
}
