//! Leaks, light behind its own source and jumps between levels, where the answer is known beforehand.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::Path;

use lpv_lab::scene::Problem;
use lpv_lab::simulation::Simulation;
use lpv_lab::study::artefacts::{Artefacts, Shares, back_bleeding, jump, leak};
use lpv_lab::study::difference::Difference;
use lpv_lab::transport::{self, preset};

/// A preset's text, run to its end.
fn run(text: &str) -> Simulation<f32> {
    let preset = preset::parse(text, Path::new("test.ron")).unwrap();
    let mut simulation = Simulation::new(Problem::build(&preset, Path::new("")).unwrap()).unwrap();
    simulation.run(|_| true);
    simulation
}

/// A lit plane at x = `at` that sends +x, and a closed wall one cell thick eight cells further, in a 16³ volume: the
/// thesis's thin wall (000, 6.2).
fn walled(at: usize, scheme: &str, occlusion: &str, opacity: f64) -> String {
    format!(
        "(version: 1, size: 16,
          injectors: [(kind: Rectangle(from: ({at}, 0, 0), to: ({at}, 15, 15)), direction: (1, 0, 0))],
          occluders: [(kind: Plane(axis: X, at: {}), normal: (-1, 0, 0), opacity: {opacity:?})],
          occlusion: ({occlusion}), propagation: (scheme: {scheme:?}, factor: 3.0, iterations: 16))",
        at + 8
    )
}

fn leak_of(text: &str) -> Shares {
    leak::of(&run(text)).unwrap().unwrap()
}

/// Every propagator there is, and how a wall can stand in its way.
const MODES: [(&str, f64); 6] = [
    ("mode: Off", 1.0),
    ("mode: Fuzzy", 1.0),
    ("mode: Fuzzy, amplifier: 1.6", 1.0),
    ("mode: Fuzzy", 0.5),
    ("mode: Hard", 1.0),
    ("mode: Hard", 0.5),
];

#[test]
fn without_a_wall_all_light_leaks_on_every_level() {
    for scheme in transport::names() {
        for (occlusion, opacity) in [("mode: Off", 1.0), ("mode: Hard", 1e-6), ("mode: Fuzzy", 1e-6)] {
            let Shares { merged, levels } = leak_of(&walled(0, scheme, occlusion, opacity));
            let known: Vec<f64> = merged.into_iter().chain(levels.into_iter().flatten()).collect();
            assert!(known.len() >= 4, "{scheme}, {occlusion}");
            assert!(known.iter().all(|leak| (leak - 1.0).abs() < 0.02), "{scheme}, {occlusion}: {known:?}");
        }
    }
}

#[test]
fn through_a_perfect_wall_nothing_leaks_on_any_level() {
    for scheme in transport::names() {
        let Shares { merged, levels } = leak_of(&walled(0, scheme, "mode: Hard", 1.0));
        assert_eq!(merged, Some(0.0), "{scheme}");
        assert!(levels.iter().flatten().all(|leak| *leak == 0.0), "{scheme}: {levels:?}");
    }
}

#[test]
fn the_leak_is_the_same_wherever_the_scene_lies() {
    for scheme in transport::names() {
        for (occlusion, opacity) in MODES {
            let [here, there] = [0, 3].map(|at| leak_of(&walled(at, scheme, occlusion, opacity)).finest().unwrap());
            assert!((here - there).abs() <= 0.05 * here, "{scheme}, {occlusion}, {opacity}: {here}, {there}");
        }
    }
}

#[test]
fn a_wall_of_half_the_opacity_lets_more_through_and_not_all() {
    for scheme in transport::names() {
        for mode in ["mode: Hard", "mode: Fuzzy"] {
            let [whole, half] = [1.0, 0.5].map(|opacity| leak_of(&walled(0, scheme, mode, opacity)).finest().unwrap());
            assert!(whole < half && half < 1.0, "{scheme}, {mode}: {whole}, {half}");
        }
    }
}

#[test]
fn a_fuzzy_wall_passes_what_its_lobe_lets_by_and_the_octree_can_be_worse() {
    // Four tenths of the light pass (000, 6.2 shows it; the wall's lobe holds back 60 % at this amplifier).
    let cascaded = leak_of(&walled(0, "cascaded", "mode: Fuzzy", 1.0));
    assert!((0.38..=0.40).contains(&cascaded.finest().unwrap()), "{cascaded:?}");
    // A wall that the finest level hardly lets through is passed on coarse ones.
    let amplified = leak_of(&walled(0, "cascaded", "mode: Fuzzy, amplifier: 1.6", 1.0));
    assert!(amplified.finest().unwrap() < 0.05 && amplified.levels[1].unwrap() > 0.3, "{amplified:?}");
    assert!(amplified.merged.unwrap() > 1.0, "{amplified:?}");
}

#[test]
fn nothing_lies_behind_where_nothing_stands_in_the_way() {
    let text = "(version: 1, size: 8, injectors: [(kind: Single(cell: (3, 4, 4)))])";
    assert_eq!(leak::of(&run(text)).unwrap(), None);
}

/// One lobe in the middle of a 16³ volume without levels.
fn lobe(iterations: usize, factor: f64) -> String {
    format!(
        "(version: 1, size: 16, coarsest: 16, injectors: [(kind: Single(cell: (8, 8, 8)), direction: (1, 0, 0))],
          propagation: (factor: {factor:?}, iterations: {iterations}))"
    )
}

#[test]
fn no_light_is_behind_a_lobe_until_it_has_gone_around() {
    // Figure 16 of (000): the first iteration sends nothing back, the second does.
    let back = |iterations| back_bleeding::of(&run(&lobe(iterations, 3.0))).unwrap().merged.unwrap();
    assert_eq!(back(1), 0.0);
    assert!(0.0 < back(2) && back(2) < back(3));
}

#[test]
fn light_that_goes_both_ways_alike_bleeds_back_as_much() {
    // Two opposite lobes in one cell have no direction: there is no back. A hair's breadth more one way gives it one.
    let both = |multiplier: f64| {
        let lobe = |way: i32, multiplier: f64| {
            format!("(kind: Single(cell: (8, 8, 8)), direction: ({way}, 0, 0), multiplier: {multiplier:?})")
        };
        let text = format!(
            "(version: 1, size: 16, coarsest: 16, injectors: [{}, {}], propagation: (iterations: 6))",
            lobe(1, multiplier),
            lobe(-1, 1.0)
        );
        back_bleeding::of(&run(&text))
    };
    assert_eq!(both(1.0), None);
    let even = both(1.000_1).unwrap().merged.unwrap();
    assert!((even - 1.0).abs() < 0.02, "{even}");
}

#[test]
fn a_lit_wall_has_no_back() {
    let text = "(version: 1, size: 8, injectors: [(kind: Wall(side: NegX))])";
    assert_eq!(back_bleeding::of(&run(text)), None);
}

#[test]
fn one_level_has_no_jumps_and_the_thesis_s_octree_has() {
    assert_eq!(jump::of(&run(&lobe(4, 3.0))).unwrap(), None);
    let walls = |levels: &str, iterations: usize| {
        let text = format!(
            "(version: 1, size: 32, injectors: [(kind: Wall(side: NegX)), (kind: Wall(side: PosX))],
              propagation: (factor: 3.0, iterations: {iterations}, levels: {levels}))"
        );
        jump::of(&run(&text)).unwrap().unwrap().mean
    };
    assert!(walls("Same", 4) > 1.0);
    assert!(walls("Consistent", 4) < walls("Same", 4));
}

/// A lobe in a volume of 32³ whose coarsest cells are eight wide, after four iterations of every level of a descent.
fn descent(x: usize, inside: &str) -> String {
    format!(
        "(version: 1, size: 32, coarsest: 4, injectors: [(kind: Single(cell: ({x}, 16, 16)), direction: (0, 0, 1))],
          propagation: (factor: 3.0, iterations: 4, descent: Leaves(distance: 2.0), inside: {inside}))"
    )
}

#[test]
fn a_descent_jumps_little_as_its_leaves_are_shown_and_much_if_they_are_flat() {
    let of = |inside| jump::of(&run(&descent(16, inside))).unwrap().unwrap();
    let (shown, flat) = (of("Exponential"), of("Constant"));
    assert!(shown.mean <= 0.25 && flat.mean > 2.0 * shown.mean, "{shown:?}, {flat:?}");
    assert_eq!((shown.pairs, shown.undefined), (flat.pairs, flat.undefined));
}

#[test]
fn a_scene_that_is_moved_by_the_coarsest_cell_jumps_as_before() {
    let of = |x| jump::of(&run(&descent(x, "Exponential"))).unwrap().unwrap();
    let (here, there) = (of(8), of(16));
    assert_eq!(here.pairs, there.pairs);
    assert!((here.mean - there.mean).abs() < 1e-3 * here.mean, "{here:?}, {there:?}");
}

#[test]
fn negative_light_is_counted() {
    assert_eq!(Artefacts::of(&run(&lobe(4, 3.0)), None).unwrap().negative, 0);
    // Without the clamp a lobe sends negative light backwards.
    let text = lobe(1, 3.0).replace("iterations: 1", "iterations: 1, clamp: false");
    assert_eq!(Artefacts::of(&run(&text), None).unwrap().negative, 1);
}

#[test]
fn a_run_against_itself_has_no_difference_and_a_moved_one_has_moved() {
    let at = |x: usize| {
        run(&format!(
            "(version: 1, size: 32, injectors: [(kind: Single(cell: ({x}, 16, 16)), direction: (0, 1, 0))],
              propagation: (factor: 3.0, iterations: 4))"
        ))
    };
    let (here, there) = (at(15), at(16));
    let none = Difference::between(&here, &here).unwrap();
    assert!(none.rows.iter().all(|row| row.absolute_max == 0.0 && row.l1_ratio == 0.0));
    assert_eq!((none.shift(), none.moved()), ([0.0; 3], [0.0; 3]));
    let moved = Difference::between(&here, &there).unwrap();
    assert_eq!(moved.moved(), [1.0, 0.0, 0.0]);
    // Across the middle of the octree the merged light jumps by 1.65 cells more than the light moves.
    assert!((moved.shift()[0] - moved.moved()[0] - 1.65).abs() < 0.05, "{:?}", moved.shift());
    assert!(moved.rows[0].level.is_none() && moved.rows[0].l1_ratio > 0.5);
    let small = run(&lobe(1, 3.0));
    assert_eq!(Difference::between(&here, &small), None);
}
