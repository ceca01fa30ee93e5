//! One suite over every kind of transport: each is held against all laws that it claims, and against those that none
//! may break: stepping is running, and neither threads nor what is left out change a bit.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use glam::DVec3;
use lpv_lab::field::{Cell, Grid};
use lpv_lab::scene::occluder::OcclusionMode;
use lpv_lab::scene::propagation::Policy;
use lpv_lab::scene::propagation::Propagation;
use lpv_lab::scene::propagation::descent::Descent;
use lpv_lab::scene::propagation::directions::{Lattice, Setting};
use lpv_lab::scene::{Occlusion, Problem, Solid, Source};
use lpv_lab::sh::Sh;
use lpv_lab::simulation::options::{Options, Skip, Wanted};
use lpv_lab::simulation::{Action, Simulation};
use lpv_lab::study::laws::{self, Reach, Symmetry};
use lpv_lab::transport::{Kind, kinds};
use lpv_lab::transport::{Law, Precision};

const N: usize = 8;

type Lights = Vec<(Cell, Sh<f64>)>;

fn problem(size: usize, light: Lights, propagation: Propagation) -> Problem {
    Problem {
        size,
        coarsest: 1,
        sources: vec![Source { color: [1.0; 3], light, ..Source::default() }],
        solids: Vec::new(),
        occlusion: Occlusion::default(),
        propagation,
        ..Problem::default()
    }
}

/// The settings under which every kind is tried: with its clamps and without, and both ways to spread directions.
fn settings() -> impl Iterator<Item = (&'static Kind, Propagation)> {
    let setting = |kind: &'static Kind, clamp: bool| {
        let lattice = if clamp { Lattice::Octahedral } else { Lattice::Fibonacci };
        let ordinates = Setting { directions: 32, lattice, ..Setting::default() };
        let propagation =
            Propagation { scheme: kind.name.to_owned(), iterations: 6, clamp, ordinates, ..Propagation::default() };
        (kind, propagation)
    };
    kinds().iter().flat_map(move |kind| [true, false].map(|clamp| setting(kind, clamp)))
}

/// Every kind that has levels, with its coarse levels starting the fine ones, at a factor at which none grows.
fn descents() -> impl Iterator<Item = (&'static Kind, Propagation)> {
    let cascades = |alone| Descent::Cascades { side: N, center: None, alone };
    let descents = [Descent::Cells, Descent::Leaves { distance: 2.0 }, cascades(false), cascades(true)];
    settings().filter(|(kind, propagation)| kind.can.levels && propagation.clamp).flat_map(
        move |(kind, propagation)| {
            descents.map(|descent| (kind, Propagation { descent, factor: 2.0, ..propagation.clone() }))
        },
    )
}

/// Every kind that has levels with exact ones, in step and ahead.
fn exact() -> impl Iterator<Item = (&'static Kind, Propagation)> {
    settings().filter(|(kind, _)| kind.can.levels).flat_map(|(kind, propagation)| {
        let of = |levels| (kind, Propagation { levels, factor: 2.0, ..propagation.clone() });
        [Policy::Exact, Policy::Ahead].map(of)
    })
}

/// Those that claim a law; every law is claimed by somebody.
fn claiming(law: Law) -> Vec<(&'static Kind, Propagation)> {
    let all = settings().chain(descents()).chain(exact());
    let found: Vec<_> = all.filter(|(kind, propagation)| (kind.laws)(propagation).contains(&law)).collect();
    assert!(!found.is_empty(), "{law:?}");
    found
}

fn lobe(cell: Cell, direction: [f64; 3], strength: f64) -> (Cell, Sh<f64>) {
    (cell, Sh::lobe(DVec3::from_array(direction).normalize()) * strength)
}

fn lobes() -> Lights {
    vec![
        lobe([2, 3, 5], [1.0, 0.3, -0.2], 1.0),
        lobe([6, 1, 1], [-0.5, 0.9, 0.4], 0.7),
        lobe([0, 7, 2], [0.0, -1.0, 0.0], 0.3),
    ]
}

fn run<T: Precision>(problem: Problem) -> Simulation<T> {
    let mut simulation = Simulation::new(problem).unwrap();
    simulation.run(|_| true);
    simulation
}

fn finest<T: Precision>(simulation: &Simulation<T>) -> &Grid<T> {
    simulation.lights()[0].accumulated.level(0)
}

fn holds(kind: &Kind, verdict: Result<(), String>) {
    assert_eq!(verdict, Ok(()), "{}", kind.name);
}

#[test]
fn symmetry() {
    for (kind, propagation) in claiming(Law::Symmetry) {
        let straight = run::<f64>(problem(N, lobes(), propagation));
        Symmetry::all().for_each(|by| holds(kind, laws::symmetry(&straight, by, 1e-12)));
    }
}

#[test]
fn superposition() {
    for (kind, propagation) in claiming(Law::Superposition) {
        holds(kind, laws::superposition(&run::<f64>(problem(N, lobes(), propagation)), 1e-12));
    }
}

#[test]
fn reach_and_parity() {
    let (from, direction) = ([2, 4, 3], [0.6, -0.3, 0.74]);
    for (kind, propagation) in claiming(Law::Reach) {
        let mut now = Simulation::<f64>::new(problem(N, vec![lobe(from, direction, 1.0)], propagation)).unwrap();
        now.act(Action::Inject);
        now.act(Action::Downsample);
        let mut reach = Reach::new(&now);
        for k in 1..=6 {
            now.act(Action::Propagate);
            reach.step(false);
            holds(kind, reach.check(&now));
            let distance = |cell: Cell| (0..3).map(|a| cell[a].abs_diff(from[a])).sum::<usize>();
            let front =
                now.lights()[0].source.level(0).iter().filter(|(cell, light)| distance(*cell) == k && !light.is_zero());
            // It is not only never ahead of its reach: it gets there.
            assert!(front.count() > 0, "{}, k = {k}", kind.name);
        }
    }
}

#[test]
fn what_is_solved_for_is_what_iterating_comes_to() {
    let mut solved = Vec::new();
    for (kind, propagation) in settings() {
        for factor in [2.0, 3.5, 4.0] {
            let propagation = Propagation { factor, ..propagation.clone() };
            if (kind.laws)(&propagation).contains(&Law::FixedPoint) {
                holds(kind, laws::fixed_point(&problem(N, lobes(), propagation), 2e-5, 300));
                solved.push(kind.name);
            }
        }
    }
    assert!(solved.contains(&"cascaded") && solved.contains(&"ordinates"), "{solved:?}");
}

#[test]
fn conservation() {
    for (kind, propagation) in claiming(Law::Conservation) {
        let propagation = Propagation { factor: kind.conserving, ..propagation };
        let light = vec![lobe([8, 8, 7], [0.2, 0.9, 0.1], 1.0), ([7, 8, 8], Sh([0.4, 0.1, -0.05, 0.2]))];
        let mut energies = Vec::new();
        let mut simulation = Simulation::<f64>::new(problem(16, light, propagation)).unwrap();
        simulation.run(|now| {
            energies.push(now.lights()[0].source.level(0).energy());
            true
        });
        for (k, energy) in energies.iter().enumerate().skip(2) {
            assert!((energy / energies[1] - 1.0).abs() < 1e-9, "{}, k = {k}: {energy}, {}", kind.name, energies[1]);
        }
    }
}

#[test]
fn closed_walls_shut() {
    let wall = |x: usize| (0..N * N).map(move |i| Solid::new([x, i % N, i / N], DVec3::NEG_X, 1.0, [0.0; 3]));
    for (kind, propagation) in claiming(Law::Shutters) {
        let mut problem =
            problem(N, vec![lobe([1, 3, 3], [1.0, 0.2, 0.0], 1.0)], Propagation { iterations: 12, ..propagation });
        problem.solids = wall(4).collect();
        problem.occlusion.mode = OcclusionMode::Hard;
        let behind = |simulation: &Simulation<f64>| -> f64 {
            // Leaves of a descent are coarse far from the light.
            let descends = simulation.problem().propagation.descent.goes_down();
            let light = if descends { simulation.lights()[0].merged.as_ref().unwrap() } else { finest(simulation) };
            light.iter().filter(|(cell, _)| cell[0] > 4).map(|(_, light)| light.max_norm()).sum()
        };
        assert_eq!(behind(&run(problem.clone())), 0.0, "{}", kind.name);
        problem.solids.clear();
        assert!(behind(&run(problem)) > 0.0, "{}: without a wall there is light", kind.name);
    }
}

#[test]
fn single_precision_is_near_double() {
    for (kind, propagation) in claiming(Law::Precision) {
        let problem = || problem(N, lobes(), propagation.clone());
        let (narrow, wide) = (run::<f32>(problem()), run::<f64>(problem()));
        let most = finest(&wide).iter().map(|(_, light)| light.max_norm()).fold(0.0, f64::max);
        let mut differs = false;
        for (cell, light) in finest(&wide).iter() {
            let off = (finest(&narrow).get(cell).widen() - light).max_norm();
            assert!(off < 2e-6 * most, "{}, {cell:?}: {off}", kind.name);
            differs |= off > 0.0;
        }
        assert!(differs, "{}: double precision is no wider", kind.name);
    }
}

#[test]
fn stepping_running_threads_and_skipping_give_the_same_bits() {
    let modes = [OcclusionMode::Off, OcclusionMode::Fuzzy, OcclusionMode::Hard];
    for ((kind, propagation), mode) in settings().flat_map(|setting| modes.map(|mode| (setting.clone(), mode))) {
        let mut problem = problem(N, lobes(), propagation);
        problem.solids = (0..9).map(|i| Solid::new([4, 2 + i % 3, 3 + i / 3], DVec3::X, 0.9, [0.5; 3])).collect();
        problem.occlusion = Occlusion { mode, bounce: 0.5, ..Occlusion::default() };
        let what = format!("{}, {mode:?}", kind.name);
        let stepped = run::<f32>(problem.clone());
        for threads in [1, 3] {
            for skip in [Skip::default(), Skip { channels: true, ..Skip::NOTHING }] {
                let options = Options { skip, ..Options::default() };
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let whole = pool.install(|| {
                    let mut whole = Simulation::<f32>::with_options(problem.clone(), options).unwrap();
                    whole.run_all(Wanted::Everything);
                    whole
                });
                assert!(whole.lights() == stepped.lights(), "{what}, {threads} threads, {skip:?}");
                assert!(whole.index() == stepped.index(), "{what}, {threads} threads, {skip:?}");
            }
        }
        let mut again = stepped.clone();
        again.act(Action::Clear);
        again.run(|_| true);
        assert!(again.lights() == stepped.lights(), "{what}: clearing leaves nothing behind");
        assert_eq!(laws::again(&stepped), Ok(()), "{what}");
    }
}

#[test]
fn what_is_counted_is_what_is_allocated() {
    let wall = |x: usize| (0..64 * 64).map(move |i| Solid::new([x, i % 64, i / 64], DVec3::X, 1.0, [0.5; 3]));
    for kind in kinds() {
        for mode in [OcclusionMode::Off, OcclusionMode::Fuzzy, OcclusionMode::Hard] {
            let ordinates = Setting { directions: 32, ..Setting::default() };
            let propagation =
                Propagation { scheme: kind.name.to_owned(), iterations: 2, ordinates, ..Propagation::default() };
            // Light on both sides of the wall, so that hard occluders shut nothing off.
            let light = vec![lobe([3, 30, 30], [1.0, 0.0, 0.0], 1.0), lobe([60, 30, 30], [-1.0, 0.0, 0.0], 1.0)];
            let mut problem = problem(64, light, propagation);
            problem.solids = wall(32).collect();
            problem.occlusion.mode = mode;
            let counted = Simulation::<f32>::bytes_of(&problem, &Options::default()).unwrap() as f64;
            let simulation = run::<f32>(problem);
            let allocated = (simulation.bytes() + simulation.shared_bytes()) as f64;
            assert!((counted / allocated - 1.0).abs() < 0.05, "{}, {mode:?}: {counted} of {allocated}", kind.name);
        }
    }
}

#[test]
fn occluders_of_exact_levels_and_descents_are_counted() {
    let wall: Vec<Solid> =
        (0..64 * 64).map(|i| Solid::new([32, i % 64, i / 64], DVec3::X, 1.0, [0.9, 0.5, 0.1])).collect();
    for (levels, descent) in [
        (Policy::Exact, Descent::Off),
        (Policy::Same, Descent::Cells),
        (Policy::Same, Descent::Leaves { distance: 2.0 }),
    ] {
        for (mode, bounce) in [(OcclusionMode::Fuzzy, 0.0), (OcclusionMode::Fuzzy, 0.5), (OcclusionMode::Hard, 0.5)] {
            let propagation = Propagation { levels, descent, iterations: 1, ..Propagation::default() };
            let mut problem = problem(64, vec![lobe([3, 30, 30], [1.0, 0.0, 0.0], 1.0)], propagation);
            problem.solids = wall.clone();
            problem.occlusion = Occlusion { mode, bounce, ..Occlusion::default() };
            let counted = Simulation::<f32>::bytes_of(&problem, &Options::default()).unwrap() as f64;
            let simulation = run::<f32>(problem);
            let allocated = (simulation.bytes() + simulation.shared_bytes()) as f64;
            let ratio = counted / allocated;
            assert!((0.8..1.25).contains(&ratio), "{levels:?}, {descent:?}, {mode:?}: {counted} of {allocated}");
        }
    }
}
