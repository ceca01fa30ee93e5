//! What must be true of a descent, against fixed points that are known.

use glam::DVec3;

use super::channel::Sorter;
use super::nest::Nest;
use super::partition::{self, Tiling};
use super::{Descent, Grids, Injected};
use crate::field::{Cell, Grid, Levels, Marks, Octree};
use crate::scene::propagation::Snapshots;
use crate::scene::propagation::descent::Inside;
use crate::sh::{Real, Sh};
use crate::transport::lattice::exact::decay::Decay;
use crate::transport::lattice::exact::leaves::{Leaves, Way};
use crate::transport::lattice::kernel::form::Form;
use crate::transport::lattice::schemes::cascaded;
use crate::transport::lattice::stencil::Stencil;

/// Merged light after `k` iterations of every stage.
fn descend<T: Real>(source: &Grid<T>, factor: f64, tiling: Tiling, k: usize, inside: Inside) -> Grid<T> {
    let sizes = Levels::new(source.side(), 1).unwrap();
    let form = Form::of(&Stencil::<T>::new(&cascaded::scheme(), factor, true)).unwrap();
    let share = Form::of(&Stencil::<f64>::new(&cascaded::scheme(), factor, false)).unwrap().share;
    let mut descent = Descent::new(sizes, tiling, form, share, Snapshots::Thesis);
    let (mut a, mut b, mut c) = (Octree::new(sizes), Octree::new(sizes), Octree::new(sizes));
    let mut grids = Grids { source: &mut a, target: &mut b, accumulated: &mut c };
    take_up(&mut descent, source);
    descent.run(k, std::slice::from_mut(&mut grids));
    let mut merged = Grid::new(source.side());
    descent.sample(0, inside, &c, &mut merged);
    merged
}

fn take_up<T: Real>(descent: &mut Descent<T>, light: &Grid<T>) {
    let (mut light, mut room) = (light.clone(), Grid::new(light.side()));
    descent.take_up(&mut [Injected { light: &mut light, room: &mut room }]);
    assert_eq!(room.iter().find(|(_, light)| !light.is_zero()), None);
}

fn with_lobes<T: Real>(n: usize, lobes: impl IntoIterator<Item = (Cell, DVec3)>) -> Grid<T> {
    let mut grid = Grid::new(n);
    lobes.into_iter().for_each(|(cell, direction)| grid.add(cell, Sh::lobe(direction)));
    grid
}

fn mixed<T: Real>() -> Grid<T> {
    let floor = (0..256).map(|i| ([i % 16, 0, i / 16], DVec3::Y));
    let screen = (4..=11).flat_map(|x| (4..=13).map(move |y| ([x, y, 6], DVec3::NEG_Z)));
    with_lobes(16, floor.chain(screen))
}

/// Cells of a published fixed point.
fn golden(text: &str) -> Vec<(Cell, Sh<f64>)> {
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|n| n.parse().unwrap()).collect();
        let cell = [0, 1, 2].map(|k| numbers[k] as usize);
        (cell, Sh::from_basis([3, 4, 5, 6].map(|k| numbers[k])))
    };
    text.lines().skip(1).map(row).collect()
}

/// Σ‖O − Ô‖∞/Σ‖Ô‖∞
fn l1<T: Real>(found: &Grid<T>, wanted: impl IntoIterator<Item = (Cell, Sh<f64>)>) -> f64 {
    let (mut off, mut all) = (0.0, 0.0);
    for (cell, wanted) in wanted {
        off += (found.get(cell).widen() - wanted).max_norm();
        all += wanted.max_norm();
    }
    off / all
}

#[test]
fn many_iterations_of_every_stage_reach_the_published_fixed_points() {
    let lobe = || with_lobes::<f64>(16, [([8, 8, 8], DVec3::X)]);
    for (source, factor, text) in [
        (lobe(), 3.0, include_str!("../../../tests/golden/ref64_lobe_p3_fixedpoint_16c.csv")),
        (lobe(), 3.8, include_str!("../../../tests/golden/ref64_lobe_p3.8_fixedpoint_16c.csv")),
        (mixed(), 3.8, include_str!("../../../tests/golden/ref64_mixed_p3.8_fixedpoint_16c.csv")),
    ] {
        let wanted = golden(text);
        assert!(wanted.len() > 4000);
        let found = descend(&source, factor, Tiling::Cells, 400, Inside::Exponential);
        let most = wanted.iter().map(|(_, light)| light.max_norm()).fold(0.0, f64::max);
        for (cell, light) in &wanted {
            let off = (found.get(*cell) - *light).max_norm();
            assert!(off < 1e-8 * most, "p = {factor}, {cell:?}: {off:e}");
        }
    }
}

#[test]
fn four_iterations_of_every_stage_are_near_the_fixed_point() {
    let lobe = || with_lobes::<f32>(16, [([8, 8, 8], DVec3::X)]);
    for (source, factor, text) in [
        (lobe(), 3.0, include_str!("../../../tests/golden/ref64_lobe_p3_fixedpoint_16c.csv")),
        (lobe(), 3.8, include_str!("../../../tests/golden/ref64_lobe_p3.8_fixedpoint_16c.csv")),
        (mixed(), 3.8, include_str!("../../../tests/golden/ref64_mixed_p3.8_fixedpoint_16c.csv")),
    ] {
        for (tiling, most) in
            [(Tiling::Cells, 0.05), (Tiling::Leaves { distance: 3.0 }, 0.07), (Tiling::Leaves { distance: 2.0 }, 0.13)]
        {
            let found = descend(&source, factor, tiling, 4, Inside::Exponential);
            let error = l1(&found, golden(text));
            assert!(error < most, "p = {factor}, {tiling:?}: {error}");
        }
    }
}

#[test]
fn what_leaves_hold_inside_matters() {
    let source = with_lobes::<f64>(16, [([8, 8, 8], DVec3::X)]);
    let wanted = golden(include_str!("../../../tests/golden/ref64_lobe_p3.8_fixedpoint_16c.csv"));
    let error =
        |inside| l1(&descend(&source, 3.8, Tiling::Leaves { distance: 2.0 }, 4, inside), wanted.iter().copied());
    assert!(error(Inside::Constant) > 2.0 * error(Inside::Exponential));
}

#[test]
fn a_single_level_is_the_uniform_volume_to_the_bit() {
    let sizes = Levels::new(16, 16).unwrap();
    let form = Form::of(&Stencil::<f32>::new(&cascaded::scheme(), 3.8, true)).unwrap();
    let share = Form::of(&Stencil::<f64>::new(&cascaded::scheme(), 3.8, false)).unwrap().share;
    let source = mixed::<f32>();
    let mut descent = Descent::new(sizes, Tiling::Cells, form, share, Snapshots::Thesis);
    let (mut a, mut b, mut c) = (Octree::new(sizes), Octree::new(sizes), Octree::new(sizes));
    let mut grids = Grids { source: &mut a, target: &mut b, accumulated: &mut c };
    take_up(&mut descent, &source);
    descent.enter(0, &mut grids);
    let mut snapshot = crate::transport::lattice::kernel::step::once(&form, source);
    assert!(grids.source.level(0) == &snapshot);
    // From there on light is in the cone, and clamped and linear loops differ in rounding alone.
    descent.iterate(0, &mut grids);
    snapshot = crate::transport::lattice::kernel::step::once(&form, snapshot);
    let most = snapshot.iter().map(|(_, light)| light.max_norm()).fold(0.0, f32::max);
    for (cell, light) in grids.source.level(0).iter() {
        assert!((light - snapshot.get(cell)).max_norm() < 1e-6 * most, "{cell:?}");
    }
}

#[test]
fn light_taken_up_anew_starts_from_the_dark() {
    let source = with_lobes::<f64>(16, [([3, 8, 12], DVec3::Y)]);
    let once = descend(&source, 3.0, Tiling::Leaves { distance: 2.0 }, 3, Inside::Exponential);
    let sizes = Levels::new(16, 1).unwrap();
    let form = Form::of(&Stencil::<f64>::new(&cascaded::scheme(), 3.0, true)).unwrap();
    let mut descent = Descent::new(sizes, Tiling::Leaves { distance: 2.0 }, form, form.share, Snapshots::Thesis);
    let (mut a, mut b, mut c) = (Octree::new(sizes), Octree::new(sizes), Octree::new(sizes));
    let mut grids = Grids { source: &mut a, target: &mut b, accumulated: &mut c };
    for light in [&mixed(), &source] {
        take_up(&mut descent, light);
        descent.run(3, std::slice::from_mut(&mut grids));
    }
    let mut merged = Grid::new(16);
    descent.sample(0, Inside::Exponential, &c, &mut merged);
    assert!(merged == once);
}

#[test]
fn light_that_has_moved_already_is_a_better_start_than_the_dark() {
    let sizes = Levels::new(16, 16).unwrap();
    let form = Form::of(&Stencil::<f64>::new(&cascaded::scheme(), 3.8, true)).unwrap();
    let share = Form::of(&Stencil::<f64>::new(&cascaded::scheme(), 3.8, false)).unwrap().share;
    let wanted = golden(include_str!("../../../tests/golden/ref64_lobe_p3.8_fixedpoint_16c.csv"));
    let source = with_lobes::<f64>(16, [([8, 8, 8], DVec3::X)]);
    // What a lobe one cell further left, without that lobe itself.
    let beside = with_lobes::<f64>(16, [([8, 8, 9], DVec3::X)]);
    let mut before = descend(&beside, 3.8, Tiling::Cells, 300, Inside::Exponential);
    before.add([8, 8, 9], Sh::lobe(DVec3::X) * -1.0);
    let error = |start: Option<&Grid<f64>>, k: usize| {
        let mut descent = Descent::new(sizes, Tiling::Cells, form, share, Snapshots::Thesis);
        let (mut a, mut b, mut c) = (Octree::new(sizes), Octree::new(sizes), Octree::new(sizes));
        let mut grids = Grids { source: &mut a, target: &mut b, accumulated: &mut c };
        take_up(&mut descent, &source);
        descent.skip_to_finest();
        match start {
            Some(start) => descent.resume(0, start, &mut grids),
            None => descent.enter(0, &mut grids),
        }
        (1..k).for_each(|_| descent.iterate(0, &mut grids));
        l1(grids.accumulated.level(0), wanted.iter().copied())
    };
    assert!(error(Some(&before), 4) < error(None, 12), "{}, {}", error(Some(&before), 4), error(None, 12));
    // Both lead to the same light.
    assert!(error(Some(&before), 400) < 1e-8 && error(None, 400) < 1e-8);
}

#[test]
fn between_nested_cascades_light_is_neither_made_nor_lost() {
    let sizes = Levels::new(32, 1).unwrap();
    for factor in [3.0, 3.8, 4.0] {
        let share = Form::of(&Stencil::<f64>::new(&cascaded::scheme(), factor, false)).unwrap().share;
        let tiling = Tiling::Cascades(Nest::new(sizes, 8, Some([11.0, 16.0, 20.5])));
        for marks in partition::stages(sizes, tiling, &Marks::new(32)) {
            let leaves = Leaves::<f64>::new(&share, Way::InStep, marks);
            for i in leaves.levels() {
                // A leaf alone is lit, all four coefficients of it: its neighbours get what it gives.
                let inner = |cell: &Cell| cell.iter().all(|c| *c > 0 && *c + 1 < sizes.side(i));
                for cell in leaves.marks(i).cells().filter(inner).step_by(97) {
                    let (mut light, mut next) = (Octree::new(sizes), Octree::new(sizes));
                    light.level_mut(i).set(cell, Sh([1.0, 0.3, -0.2, 0.4]));
                    leaves.apply(&light, &mut next);
                    let energy = |octree: &Octree<f64>| -> f64 {
                        octree.levels().iter().enumerate().map(|(i, grid)| 8f64.powi(i as i32) * grid.energy()).sum()
                    };
                    let gain = energy(&next) / energy(&light);
                    assert!((gain - factor / 4.0).abs() < 1e-13, "p = {factor}, level {i}, {cell:?}: {gain}");
                }
            }
        }
    }
}

#[test]
fn light_beyond_the_finest_leaves_is_handed_to_its_own_whole() {
    let sizes = Levels::new(32, 1).unwrap();
    let share = Form::of(&Stencil::<f64>::new(&cascaded::scheme(), 3.8, false)).unwrap().share;
    let decay = Decay::of(&share);
    let stages = partition::stages(sizes, Tiling::Cascades(Nest::new(sizes, 8, None)), &Marks::new(32));
    let stages: Vec<Leaves<f64>> = stages.into_iter().map(|marks| Leaves::new(&share, Way::Ahead, marks)).collect();
    let leaves = &stages[5];
    let sorter = Sorter { sizes, decay: &decay, obstacles: None, stages: &stages };
    // In the finest grid, beside it on either side of a coarse cell, and in the last grid beside the second.
    for (cell, is_finest) in [([12, 16, 16], true), ([11, 16, 16], false), ([10, 16, 16], false), ([7, 12, 20], false)]
    {
        let light = Sh([1.0, 0.5, -0.25, 0.125]);
        let mut reached = Marks::new(32);
        reached.set(cell);
        let found = sorter.coarser(0, &vec![(cell, light)], &reached);
        assert_eq!(found.is_empty(), is_finest);
        let volume = |i: usize| 8f64.powi(i as i32);
        let sum: Sh<f64> = found.iter().map(|(i, _, light)| *light * volume(*i)).sum();
        assert!(is_finest || (sum - light).max_norm() < 1e-14, "{cell:?}: {sum:?}");
        for (i, at, _) in &found {
            assert!(leaves.marks(*i).get(*at), "{cell:?}: {i}, {at:?}");
        }
    }
}
