//! One suite for all fast paths: every scheme, form, instruction set, thread count, skip and depth has
//! to give what the plain kernel gives, and all that share a form the same bits.

use proptest::prelude::*;

use super::form::Form;
use super::{FLOOR, Instructions, Level, Order, Tally, blocked, plain, slab, step};
use crate::field::{Grid, Marks};
use crate::sh::{Real, Sh};
use crate::transport::lattice::reach::everywhere;
use crate::transport::lattice::schemes;
use crate::transport::lattice::stencil::Stencil;

/// A level on its way: what a run has to agree about to the last bit.
#[derive(Clone, Debug, PartialEq)]
struct Run<T> {
    source: Grid<T>,
    target: Grid<T>,
    sum: Grid<T>,
    marks: Marks,
}

/// How a run is made; none of it may change a bit.
#[derive(Clone, Copy, Debug)]
struct Way {
    instructions: Instructions,
    threads: usize,
    reach: bool,
    drop_dark: bool,
    depth: usize,
    /// Whether a wave takes as few rows as it can.
    leaning: bool,
    /// Whether the energy is asked for, so that every row is looked at.
    energy: bool,
}

const DEFINING: Way = Way {
    instructions: Instructions::Baseline,
    threads: 1,
    reach: false,
    drop_dark: false,
    depth: 1,
    leaning: false,
    energy: true,
};

fn ways() -> Vec<Way> {
    let mut ways = Vec::new();
    for instructions in [Instructions::Baseline, Instructions::Avx2, Instructions::Best] {
        for (threads, reach, drop_dark, depth, leaning, energy) in [
            (1, true, false, 1, false, false),
            (1, false, true, 1, false, true),
            (1, true, true, 3, false, false),
            (1, true, true, 4, true, false),
            (2, true, true, 1, false, false),
            (2, false, false, 3, true, true),
            (3, true, true, 5, false, false),
        ] {
            ways.push(Way { instructions, threads, reach, drop_dark, depth, leaning, energy });
        }
    }
    ways
}

fn start<T: Real>(n: usize, light: &[([usize; 3], Sh<T>)]) -> Run<T> {
    let mut source = Grid::new(n);
    let mut marks = Marks::new(n);
    for (cell, value) in light {
        source.add(*cell, *value);
    }
    marks.mark_lit(&source);
    Run { sum: source.clone(), target: Grid::new(n), source, marks }
}

fn advance<T: Real>(form: Form<T>, linear: bool, way: Way, iterations: usize, mut run: Run<T>) -> (Run<T>, Tally) {
    let Way { instructions, drop_dark, energy, .. } = way;
    let order = Order { form, linear, drop_dark, cone: None, energy, instructions };
    let n = run.source.side();
    let rows = if way.leaning { slab::grain(run.source.layout()).min(n) } else { n };
    let mut source_lit = if way.reach { run.marks.clone() } else { everywhere(n) };
    let mut target_lit = Marks::new(n);
    let (mut done, mut tally) = (0, Tally::NONE);
    while done < iterations {
        let mut level = Level {
            source: &mut run.source,
            source_lit: &mut source_lit,
            target: &mut run.target,
            target_lit: &mut target_lit,
            sum: Some(&mut run.sum),
            marks: &mut run.marks,
        };
        let depth = way.depth.min(iterations - done);
        let found = if depth == 1 {
            step::step(&order, &mut level, way.threads, None)
        } else {
            blocked::in_waves(&order, &mut level, depth, way.threads, rows, None)
        };
        tally = Tally { visited: tally.visited + found.visited, ..found };
        level.turn(depth);
        done += depth;
    }
    (run, tally)
}

fn plainly<T: Real>(stencil: &Stencil<T>, iterations: usize, mut run: Run<T>) -> Run<T> {
    for _ in 0..iterations {
        plain::propagate(stencil, &run.source, &mut run.target);
        run.marks.mark_lit(&run.target);
        run.sum.add_grid(&run.target);
        std::mem::swap(&mut run.source, &mut run.target);
    }
    run
}

/// The largest difference between two grids, as a part of the largest number in them.
fn difference<T: Real>(a: &Grid<T>, b: &Grid<T>) -> f64 {
    let size = a.iter().map(|(_, v)| v.max_norm().to_f64()).fold(f64::MIN_POSITIVE, f64::max);
    a.iter().zip(b.iter()).map(|((_, a), (_, b))| (a - b).max_norm().to_f64() / size).fold(0.0, f64::max)
}

fn agree<T: Real>(fast: &Run<T>, plain: &Run<T>, tolerance: f64, what: &str) {
    for (fast, plain) in [(&fast.source, &plain.source), (&fast.target, &plain.target), (&fast.sum, &plain.sum)] {
        let found = difference(fast, plain);
        assert!(found <= tolerance, "{what}: {found}");
    }
}

/// Some light: lobes, a wall, and something behind them.
fn scene<T: Real>(n: usize) -> Run<T> {
    let lobe = |v: [f64; 3]| Sh::lobe(glam::DVec3::from_array(v).normalize());
    let mut light = vec![([n / 2, n / 3, n - 1], lobe([1.0, 0.2, -0.4])), ([0, n - 1, n / 2], lobe([0.0, -1.0, 0.0]))];
    light.extend((0..n).map(|y| ([0, y, n / 4], lobe([1.0, 0.0, 0.0]) * T::of(0.25))));
    start(n, &light)
}

#[test]
fn every_way_gives_the_same_bits_and_what_the_plain_kernel_gives() {
    for scheme in schemes::all() {
        for clamp in [true, false] {
            let stencil = Stencil::<f32>::new(&scheme, 3.0, clamp);
            let form = Form::of(&stencil).unwrap();
            for n in [1, 2, 8, 16, 32] {
                let (iterations, linear) = (11, !clamp);
                let (defining, _) = advance(form, linear, DEFINING, iterations, scene(n));
                let what = format!("{}, clamp {clamp}, n = {n}", scheme.name);
                agree(&defining, &plainly(&stencil, iterations, scene(n)), 3e-6, &what);
                for way in ways() {
                    let (found, tally) = advance(form, linear, way, iterations, scene(n));
                    assert!(found == defining, "{what}: {way:?}");
                    assert!(tally.visited <= iterations * n * n * n.next_multiple_of(16));
                }
            }
        }
    }
}

#[test]
fn rows_of_several_words_take_the_same_paths() {
    let stencil = Stencil::<f32>::new(&schemes::find("cascaded").unwrap(), 3.0, true);
    let form = Form::of(&stencil).unwrap();
    for (n, iterations) in [(128, 3), (256, 1)] {
        let (defining, _) = advance(form, false, DEFINING, iterations, scene(n));
        let mut free = scene(n);
        free.marks.words_mut().fill(u64::MAX);
        // Marks everywhere and light from end to end: rows that are computed as one stretch.
        for way in [Way { reach: true, ..DEFINING }, Way { reach: true, drop_dark: true, energy: false, ..DEFINING }] {
            let (whole, _) = advance(form, false, way, iterations, free.clone());
            assert!(whole.source == defining.source && whole.sum == defining.sum, "n = {n}, {way:?}");
        }
        if n > 128 {
            continue;
        }
        agree(&defining, &plainly(&stencil, iterations, scene(n)), 3e-6, "n = 128");
        for way in ways().into_iter().filter(|way| way.instructions == Instructions::Best) {
            assert!(advance(form, false, way, iterations, scene(n)).0 == defining, "n = {n}: {way:?}");
        }
    }
}

#[test]
fn double_precision_takes_the_same_paths() {
    let stencil = Stencil::<f64>::new(&schemes::find("cascaded").unwrap(), 3.0, true);
    let form = Form::of(&stencil).unwrap();
    for n in [4, 16] {
        let (defining, _) = advance(form, false, DEFINING, 7, scene(n));
        agree(&defining, &plainly(&stencil, 7, scene(n)), 1e-14, "f64");
        for way in ways() {
            assert!(advance(form, false, way, 7, scene(n)).0 == defining, "{way:?}");
        }
    }
}

#[test]
fn skipping_visits_only_what_light_can_have_reached() {
    let form = Form::of(&Stencil::<f32>::new(&schemes::find("cascaded").unwrap(), 3.0, true)).unwrap();
    let lobe = || start(64, &[([32, 32, 32], Sh::lobe(glam::DVec3::X))]);
    let way = Way { reach: true, drop_dark: true, ..DEFINING };
    let (skipped, few) = advance(form, false, way, 8, lobe());
    let (whole, all) = advance(form, false, DEFINING, 8, lobe());
    assert!(skipped == whole);
    assert_eq!(all.visited, 8 * 64usize.pow(3));
    // Σ of the diamonds' rows (at most 2·8 + 1 squared), each at most 32 cells wide once rounded.
    assert!(few.visited <= 8 * 17 * 17 * 48, "{}", few.visited);
}

#[test]
fn light_goes_out_at_the_floor_and_then_costs_nothing() {
    let stencil = Stencil::<f32>::new(&schemes::find("cascaded").unwrap(), 3.0, true);
    let form = Form::of(&stencil).unwrap();
    let way = Way { reach: true, drop_dark: true, ..DEFINING };
    let (run, _) = advance(form, false, way, 400, scene(16));
    assert!(run.source.iter().all(|(_, light)| light.is_zero()));
    let (_, tally) = advance(form, false, Way { reach: false, ..way }, 2, run.clone());
    assert_eq!(tally.visited, 16 * 16 * 16, "a dark grid is looked at once, then never");
    assert!(FLOOR > f64::from(f32::MIN_POSITIVE) * 1e4);
}

fn light() -> impl Strategy<Value = Vec<([usize; 3], Sh<f64>)>> {
    let sum_of_lobes = (0.01..1.0f64, prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64), 1..3))
        .prop_map(|(size, axes)| {
            let lobes = axes.into_iter().filter_map(|(x, y, z)| glam::DVec3::new(x, y, z).try_normalize());
            lobes.map(|n| Sh::lobe(n) * size).sum::<Sh<f64>>()
        });
    prop::collection::vec(((0..8usize, 0..8usize, 0..8usize).prop_map(|(x, y, z)| [x, y, z]), sum_of_lobes), 1..6)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The claim of [`super::form`]: light in the cone stays in it, and there the linear form is the
    /// clamped one. Light from lobes gets there within a few steps.
    #[test]
    fn in_the_cone_nothing_is_clamped(light in light(), factor in 0.5..4.0f64) {
        let stencil = Stencil::<f64>::new(&schemes::find("cascaded").unwrap(), factor, true);
        let form = Form::of(&stencil).unwrap();
        let cone = form.cone.unwrap();
        let (mut run, mut inside) = (start(8, &light), false);
        for _ in 0..8 {
            let was_inside = std::mem::replace(&mut inside, in_cone(&run.source, cone));
            prop_assert!(inside || !was_inside);
            let linear = advance(form, true, DEFINING, 1, run.clone()).0;
            run = plainly(&stencil, 1, run);
            if inside {
                prop_assert!(difference(&linear.source, &run.source) < 1e-14);
            }
        }
        prop_assert!(inside);
    }

    /// What comes after a step is never more than the bounds say.
    #[test]
    fn gains_stay_under_their_bounds(light in light(), factor in 0.5..4.0f64) {
        for scheme in schemes::all() {
            let form = Form::of(&Stencil::<f64>::new(&scheme, factor, true)).unwrap();
            let Some(bound) = form.gain.of_lobes else { continue };
            let run = start(8, &light);
            let before = run.source.energy();
            let (run, tally) = advance(form, false, DEFINING, 1, run);
            prop_assert!(tally.energy <= before * bound * (1.0 + 1e-12), "{}", scheme.name);
            prop_assert!((tally.energy - run.source.energy()).abs() <= 1e-12 * before);
        }
    }
}

fn in_cone(grid: &Grid<f64>, r: f64) -> bool {
    grid.iter().all(|(_, light)| light.vector().length() <= r * light.0[0])
}
