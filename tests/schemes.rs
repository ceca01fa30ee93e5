//! One suite of properties, instantiated for every propagation scheme: free, and among occluders.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use glam::DVec3;
use lpv_lab::field::{Cell, Grid, Layout};
use lpv_lab::scene::occluder::{BlockingSign, OcclusionMode};
use lpv_lab::scene::{Occlusion, Problem, Propagation, Solid, Source};
use lpv_lab::sh::Sh;
use lpv_lab::simulation::Simulation;
use lpv_lab::study::laws::Symmetry;
use lpv_lab::transport::lattice::kernel::plain;
use lpv_lab::transport::lattice::scheme::{Scheme, Surface};
use lpv_lab::transport::lattice::schemes;
use lpv_lab::transport::lattice::stencil::Stencil;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

const N: usize = 8;
/// Scenes to try.
const MANY: u32 = 20;
/// Scenes to try in all 48 positions.
const FEW: u32 = 4;

type Light = Vec<(Cell, Sh<f64>)>;

/// A scene of white light.
fn problem(scheme: &Scheme, light: Light, iterations: usize) -> Problem {
    Problem {
        size: N,
        coarsest: 1,
        sources: vec![Source { color: [1.0; 3], light, ..Source::default() }],
        solids: Vec::new(),
        occlusion: Occlusion::default(),
        propagation: Propagation { scheme: scheme.name.to_owned(), factor: 3.0, iterations, ..Propagation::default() },
        ..Problem::default()
    }
}

fn run(problem: Problem) -> Simulation<f64> {
    let mut simulation = Simulation::new(problem).unwrap();
    simulation.run(|_| true);
    simulation
}

fn accumulated(simulation: &Simulation<f64>, level: usize) -> &Grid<f64> {
    simulation.lights()[0].accumulated.level(level)
}

/// The energy of every snapshot on every level.
fn energies(problem: Problem) -> Vec<Vec<f64>> {
    let mut simulation = Simulation::<f64>::new(problem).unwrap();
    let mut energies = Vec::new();
    simulation.run(|now| {
        energies.push(now.lights()[0].source.levels().iter().map(Grid::energy).collect());
        true
    });
    energies
}

fn all_faces_clamp(scheme: &Scheme) -> bool {
    scheme.faces.iter().all(|face| face.clamp)
}

fn direction() -> impl Strategy<Value = DVec3> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0f64].prop_filter_map("no direction", |v| DVec3::from_array(v).try_normalize())
}

fn lobes() -> impl Strategy<Value = Light> {
    let lobe = ([0..N, 0..N, 0..N], direction(), 0.1..2.0);
    prop::collection::vec(lobe.prop_map(|(cell, d, strength)| (cell, Sh::lobe(d) * strength)), 1..5)
}

/// Blockers in cells up to `last`, each cell once.
fn solids(last: usize, albedo: f64) -> impl Strategy<Value = Vec<Solid>> {
    let cells = prop::collection::btree_set([0..=last, 0..=last, 0..=last], 1..60);
    cells.prop_flat_map(move |cells| {
        let surfaces = prop::collection::vec((direction(), 0.1..=1.0), cells.len());
        surfaces.prop_map(move |surfaces| {
            let block =
                |(cell, (normal, opacity)): (&Cell, (DVec3, f64))| Solid::new(*cell, normal, opacity, [albedo; 3]);
            cells.iter().zip(surfaces).map(block).collect()
        })
    })
}

fn occlusion() -> impl Strategy<Value = Occlusion> {
    let mode = prop_oneof![Just(OcclusionMode::Fuzzy), Just(OcclusionMode::Hard)];
    let sign = prop_oneof![Just(BlockingSign::AlongTravel), Just(BlockingSign::AgainstTravel)];
    (mode, sign, 0.2..3.0, 0usize..4).prop_map(|(mode, sign, amplifier, from_iteration)| Occlusion {
        mode,
        sign,
        amplifier,
        from_iteration,
        ..Occlusion::default()
    })
}

fn check<S: Strategy>(cases: u32, strategy: S, test: impl Fn(S::Value) -> Result<(), TestCaseError>) {
    let mut runner = TestRunner::new(ProptestConfig { cases, failure_persistence: None, ..Default::default() });
    runner.run(&strategy, test).unwrap();
}

/// Whether two grids hold the same light once the first is turned.
fn equal_when_turned(symmetry: Symmetry, plain: &Grid<f64>, turned: &Grid<f64>) -> bool {
    let last = plain.side() - 1;
    plain.iter().all(|(cell, light)| {
        (turned.get(symmetry.cell(cell, last)) - symmetry.light(light)).max_norm() < 1e-12 * (1.0 + light.max_norm())
    })
}

/// The scene as a symmetry turns it; blockers go from 0 to `last`.
fn turn(problem: &Problem, symmetry: Symmetry, last: usize) -> Problem {
    let mut turned = problem.clone();
    for (cell, light) in turned.sources.iter_mut().flat_map(|source| &mut source.light) {
        (*cell, *light) = (symmetry.cell(*cell, N - 1), symmetry.light(*light));
    }
    for blocker in &mut turned.solids {
        let normal = DVec3::from_array(symmetry.vector(blocker.normal.to_array()));
        *blocker = Solid::new(symmetry.cell(blocker.cell, last), normal, blocker.opacity[0], blocker.albedo);
    }
    turned
}

fn commutes_with_the_48_symmetries(scheme: &Scheme) {
    check(FEW, lobes(), |light| {
        let problem = problem(scheme, light, 4);
        let plain = run(problem.clone());
        for symmetry in Symmetry::all() {
            let turned = run(turn(&problem, symmetry, N - 1));
            for level in 0..plain.sizes().count() {
                let equal = equal_when_turned(symmetry, accumulated(&plain, level), accumulated(&turned, level));
                prop_assert!(equal, "{symmetry:?}, level {level}");
            }
        }
        Ok(())
    });
}

fn commutes_with_the_48_symmetries_among_occluders(scheme: &Scheme) {
    for mode in [OcclusionMode::Fuzzy, OcclusionMode::Hard] {
        // Fuzzy blockers sit half a cell off the light, between cells. The lab's mirrors sit in them.
        let between = mode == OcclusionMode::Fuzzy && scheme.surface == Surface::Blocked;
        let last = if between { N - 2 } else { N - 1 };
        check(FEW, (lobes(), solids(last, 0.5)), |(light, solids)| {
            let occlusion = Occlusion { mode, bounce: 0.7, ..Occlusion::default() };
            let problem = Problem { solids, occlusion, ..problem(scheme, light, 4) };
            let plain = run(problem.clone());
            for symmetry in Symmetry::all() {
                let turned = run(turn(&problem, symmetry, last));
                let equal = equal_when_turned(symmetry, accumulated(&plain, 0), accumulated(&turned, 0));
                prop_assert!(equal, "{symmetry:?}, {mode:?}");
            }
            Ok(())
        });
    }
}

fn adds_up_without_clamps(scheme: &Scheme) {
    check(MANY, (lobes(), lobes(), solids(N - 1, 0.5), occlusion()), |(a, b, solids, occlusion)| {
        let both = a.iter().chain(&b).copied().collect();
        let [a, b, both] = [a, b, both].map(|light| {
            // Hard occluders depend on where light is: to add up, all must start from the same cells.
            let occlusion = Occlusion { mode: OcclusionMode::Fuzzy, bounce: 0.5, ..occlusion };
            let mut problem = Problem { solids: solids.clone(), occlusion, ..problem(scheme, light, 5) };
            problem.propagation.clamp = false;
            run(problem)
        });
        for level in 0..both.sizes().count() {
            for (cell, light) in accumulated(&both, level).iter() {
                let sum = accumulated(&a, level).get(cell) + accumulated(&b, level).get(cell);
                prop_assert!((sum - light).max_norm() < 1e-11 * (1.0 + light.max_norm()), "level {level}, {cell:?}");
            }
        }
        Ok(())
    });
}

fn the_mean_of_a_uniform_field_gains_what_is_documented(scheme: &Scheme) {
    let documented = if scheme.name == "blog" { 0.3652 } else { 0.25 };
    let stencil = Stencil::<f64>::new(scheme, 1.0, true);
    let received: Sh<f64> = (0..6).map(|d| stencil.send(d, Sh([1.0, 0.0, 0.0, 0.0]))).sum();
    assert!((received.0[0] - documented).abs() < 5e-5, "{}", received.0[0]);
    assert!(received.vector().length() < 1e-15);
}

fn no_cell_holds_less_than_no_light(scheme: &Scheme) {
    check(MANY, (lobes(), solids(N - 1, 0.5), occlusion()), |(light, solids, occlusion)| {
        let simulation = run(Problem { solids, occlusion, ..problem(scheme, light, 6) });
        let darkest = |grid: &Grid<f64>| grid.iter().map(|(_, light)| light.0[0]).fold(0.0, f64::min);
        for grid in simulation.lights()[0].accumulated.levels() {
            // The blog scheme's unclamped sides send negative light; its total stays positive.
            let least = if all_faces_clamp(scheme) { darkest(grid) } else { grid.energy() };
            prop_assert!(least >= 0.0, "{least}");
        }
        Ok(())
    });
}

fn no_occluder_adds_to_what_cells_send(scheme: &Scheme) {
    if !all_faces_clamp(scheme) {
        return; // An occluder that stops negative light does; the scheme's documentation says so.
    }
    let stencil = Stencil::new(scheme, 3.0, true);
    check(MANY, (lobes(), solids(N - 1, 0.0), occlusion()), |(light, solids, occlusion)| {
        let mut sent: Vec<f64> = Vec::new();
        let mut simulation =
            Simulation::<f64>::new(Problem { solids, occlusion, ..problem(scheme, light, 8) }).unwrap();
        let mut added = None;
        simulation.run(|now| {
            let levels = now.lights()[0].source.levels();
            for (level, (grid, sent)) in levels.iter().zip(&sent).enumerate() {
                let received = grid.energy();
                if received > sent * (1.0 + 1e-12) {
                    added = Some(format!("k = {}, level {level}: {received} of {sent}", now.iteration()));
                }
            }
            sent = levels.iter().map(|grid| freely(&stencil, grid)).collect();
            true
        });
        prop_assert_eq!(added, None);
        Ok(())
    });
}

/// The energy that one iteration without occluders would make of a grid.
fn freely(stencil: &Stencil<f64>, grid: &Grid<f64>) -> f64 {
    let mut received = Grid::new(grid.side());
    plain::propagate(stencil, grid, &mut received);
    received.energy()
}

fn with_occluders_less_light_is_left(scheme: &Scheme) {
    if !all_faces_clamp(scheme) {
        return;
    }
    // Where a scheme looks straight along the axes alone, opposite lights in a cell hold each other back. An
    // occluder that takes one away may turn the other from a border and so keep it in the volume a little longer.
    let slack = if scheme.faces.len() == 1 { 1e-3 } else { 1e-12 };
    check(MANY, (lobes(), solids(N - 1, 0.0), occlusion()), |(light, solids, occlusion)| {
        let free = energies(problem(scheme, light.clone(), 8));
        let occluded = energies(Problem { solids, occlusion, ..problem(scheme, light, 8) });
        for (k, (free, occluded)) in free.iter().zip(&occluded).enumerate() {
            for (level, (free, occluded)) in free.iter().zip(occluded).enumerate() {
                prop_assert!(*occluded <= free * (1.0 + slack), "k = {k}, level {level}: {occluded} > {free}");
            }
        }
        Ok(())
    });
}

fn behind_a_closed_hard_occluder_it_is_dark(scheme: &Scheme) {
    // A closed box around some light, walls one cell thick, at every place that puts it askew to coarse levels.
    let inside = |cell: Cell, from: Cell| (0..3).all(|a| cell[a] > from[a] && cell[a] < from[a] + 4);
    let outside = |cell: Cell, from: Cell| (0..3).any(|a| cell[a] < from[a] || cell[a] > from[a] + 4);
    check(MANY, ([0..3usize, 0..3, 0..3], [1..4usize, 1..4, 1..4], direction(), 0.0..1.0), |(from, at, d, albedo)| {
        let shell = Layout::new(N).cells().filter(|cell| !inside(*cell, from) && !outside(*cell, from));
        let block = |cell| Solid::new(cell, DVec3::ZERO, 1.0, [albedo; 3]);
        let lit = std::array::from_fn(|a| from[a] + at[a]);
        let problem = Problem {
            solids: shell.map(block).collect(),
            occlusion: Occlusion { mode: OcclusionMode::Hard, bounce: 1.0, ..Occlusion::default() },
            ..problem(scheme, vec![(lit, Sh::lobe(d))], 24)
        };
        let simulation = run(problem);
        let light = &simulation.lights()[0];
        for (cell, sample) in light.merged.as_ref().unwrap().iter() {
            prop_assert_eq!(sample.is_zero(), !inside(cell, from), "{:?}", cell);
        }
        for level in 0..simulation.sizes().count() {
            for (cell, found) in light.accumulated.level(level).iter() {
                let touches = |fine: Cell| (0..3).all(|a| fine[a] >> level == cell[a]);
                let reached = Layout::new(N).cells().any(|fine| touches(fine) && inside(fine, from));
                prop_assert!(reached || found.is_zero(), "level {level}, {cell:?}");
            }
        }
        Ok(())
    });
}

macro_rules! conformance {
    ($($scheme:ident),*) => {
        $(mod $scheme {
            use super::schemes;
            conformance!(@each $scheme:
                commutes_with_the_48_symmetries,
                commutes_with_the_48_symmetries_among_occluders,
                adds_up_without_clamps,
                the_mean_of_a_uniform_field_gains_what_is_documented,
                no_cell_holds_less_than_no_light,
                no_occluder_adds_to_what_cells_send,
                with_occluders_less_light_is_left,
                behind_a_closed_hard_occluder_it_is_dark);
        })*

        #[test]
        fn no_scheme_is_left_out() {
            assert_eq!(schemes::names(), [$(stringify!($scheme)),*]);
        }
    };
    (@each $scheme:ident: $($property:ident),*) => {
        $(#[test]
        fn $property() {
            super::$property(&schemes::find(stringify!($scheme)).unwrap());
        })*
    };
}

conformance!(cascaded, blog, axial, cone, reflective);
