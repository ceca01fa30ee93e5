//! What must be true of [`Leaves`], whatever tiles the volume.

use glam::{DMat4, DVec3, DVec4};

use super::blockers::{Blockers, Ways};
use super::decay::Decay;
use super::leaves::{Leaves, Way};
use super::walls;
use crate::field::{Cell, Grid, Layout, Levels, Marks, Octree};
use crate::scene::Solid;
use crate::sh::{LOBE0, Sh};
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::geometry_volume::GeometryVolume;
use crate::transport::lattice::hard_solids::HardSolids;
use crate::transport::lattice::kernel::form::{Form, Share};
use crate::transport::lattice::kernel::occluded::{Fuzzy, Hard, Mirrored, OcclusionLaw, Which};
use crate::transport::lattice::kernel::{self, Instructions, Level, Order};
use crate::transport::lattice::reach::everywhere;
use crate::transport::lattice::schemes::{cascaded, find};
use crate::transport::lattice::stencil::{Stencil, matrices};

const N: usize = 16;

fn stencil(factor: f64) -> Stencil<f64> {
    Stencil::new(&cascaded::scheme(), factor, false)
}

fn share(factor: f64) -> Share<f64> {
    Form::of(&stencil(factor)).unwrap().share
}

/// The numbers of single precision, in double.
fn widened(share: Share<f32>) -> Share<f64> {
    let Share { alpha, beta, gamma, delta, epsilon } = share;
    let [alpha, beta, gamma, delta, epsilon] = [alpha, beta, gamma, delta, epsilon].map(f64::from);
    Share { alpha, beta, gamma, delta, epsilon }
}

/// Numbers from 0 to 1 that follow from `seed`.
fn noise(seed: usize) -> f64 {
    ((seed as f64 * 12.9898).sin() * 43758.5453).fract().abs()
}

fn some_light(seed: usize) -> Sh<f64> {
    Sh([0, 1, 2, 3].map(|c| noise(4 * seed + c) - if c == 0 { 0.0 } else { 0.5 }))
}

/// Leaves that are fine around `centre`: a block is split where its nearest cell is nearer than its width.
fn around(centre: Cell) -> Vec<Marks> {
    let levels = Levels::new(N, 1).unwrap();
    let mut marks: Vec<Marks> = levels.sides().map(Marks::new).collect();
    let mut open = vec![(levels.count() - 1, [0; 3])];
    while let Some((i, cell)) = open.pop() {
        let h = 1 << i;
        let away = |k: usize| {
            let (low, high): (usize, usize) = (cell[k] * h, cell[k] * h + h - 1);
            low.saturating_sub(centre[k]).max(centre[k].saturating_sub(high))
        };
        if i > 0 && (0..3).map(away).max().unwrap() < h {
            open.extend(
                (0..8).map(|c| (i - 1, [2 * cell[0] + (c & 1), 2 * cell[1] + (c >> 1 & 1), 2 * cell[2] + (c >> 2)])),
            );
        } else {
            marks[i].set(cell);
        }
    }
    marks
}

/// Light in every leaf and nowhere else.
fn lit(leaves: &Leaves<f64>) -> Octree<f64> {
    let mut light = Octree::new(Levels::new(N, 1).unwrap());
    for i in leaves.levels() {
        for (k, cell) in leaves.marks(i).cells().enumerate() {
            light.level_mut(i).set(cell, some_light(1000 * i + k));
        }
    }
    light
}

fn energy(light: &Octree<f64>) -> f64 {
    light.levels().iter().enumerate().map(|(i, grid)| 8f64.powi(i as i32) * grid.energy()).sum()
}

#[test]
fn all_leaves_at_the_finest_level_are_the_uniform_volume_to_the_bit() {
    let form = Form::of(&Stencil::<f32>::new(&cascaded::scheme(), 3.0, true)).unwrap();
    let mut source = Octree::<f32>::new(Levels::new(N, 1).unwrap());
    for (k, cell) in Layout::new(N).cells().enumerate() {
        source.level_mut(0).set(cell, some_light(k).cast());
    }
    let order =
        Order { form, linear: true, drop_dark: false, cone: None, energy: false, instructions: Instructions::Best };
    let mut wanted = Grid::new(N);
    let mut level = Level {
        source: &mut source.level(0).clone(),
        source_lit: &mut everywhere(N),
        target: &mut wanted,
        target_lit: &mut Marks::new(N),
        sum: None,
        marks: &mut Marks::new(N),
    };
    kernel::step::step(&order, &mut level, 1, None);
    for way in [Way::InStep, Way::Ahead] {
        let leaves = Leaves::<f32>::uniform(&widened(form.share), way, 0, N, &walls::Open(None));
        let mut target = Octree::new(source.sizes());
        leaves.apply(&source, &mut target);
        assert!(target.level(0) == &wanted, "{way:?}");
    }
}

#[test]
fn plane_light_goes_through_every_level_as_through_the_finest() {
    // Means of light that depends on x alone, over cells of h planes: P of the means is the mean of P.
    let share = share(3.0);
    for level in 0..3 {
        let (n, h) = (N >> level, 1usize << level);
        let leaves = Leaves::<f64>::uniform(&share, Way::InStep, level, n, &walls::Open(None));
        let mu = Decay::of(&share).mu();
        // A sum of e^(μx) and e^(−μx) with a direction, as the two are everywhere.
        let plane = |x: f64| Sh([(mu * (x - 7.0)).cosh(), 0.3 * (mu * (x - 7.0)).sinh(), 0.0, 0.0]);
        let mean = |from: usize, at: &dyn Fn(f64) -> Sh<f64>| {
            (from..from + h).map(|x| at(x as f64)).sum::<Sh<f64>>() * (1.0 / h as f64)
        };
        let Share { alpha, beta, gamma, delta, epsilon } = share;
        let stepped = |x: f64| {
            let (before, here, after) = (plane(x - 1.0).0, plane(x).0, plane(x + 1.0).0);
            Sh([
                alpha * (before[0] + after[0] + 4.0 * here[0]) + beta * (before[1] - after[1]),
                gamma * (before[0] - after[0]) + delta * (before[1] + after[1]) + 4.0 * epsilon * here[1],
                0.0,
                0.0,
            ])
        };
        let mut light = Octree::new(Levels::new(N, 1).unwrap());
        for cell in Layout::new(n).cells() {
            light.level_mut(level).set(cell, mean(cell[0] * h, &plane));
        }
        let mut target = Octree::new(light.sizes());
        leaves.apply(&light, &mut target);
        for x in 1..n - 1 {
            let found = target.level(level).get([x, n / 2, n / 2]);
            let wanted = mean(x * h, &stepped);
            assert!(
                (found - wanted).max_norm() < 1e-11 * wanted.max_norm(),
                "level {level}, {x}: {found:?}, {wanted:?}"
            );
        }
    }
}

#[test]
fn energy_gains_a_quarter_of_the_factor_in_any_tiling() {
    for factor in [3.0, 3.8, 4.0] {
        for centre in [[8, 8, 8], [7, 9, 8], [5, 8, 10]] {
            let leaves = Leaves::<f64>::new(&share(factor), Way::InStep, around(centre));
            let mut light = lit(&leaves);
            // What lies at the border loses light: leave it dark.
            for grid in light.levels_mut() {
                let n = grid.side();
                for cell in grid.layout().cells().filter(|cell| cell.iter().any(|c| *c == 0 || *c + 1 == n)) {
                    grid.set(cell, Sh::ZERO);
                }
            }
            let mut target = Octree::new(light.sizes());
            leaves.apply(&light, &mut target);
            let (before, after) = (energy(&light), energy(&target));
            assert!(before > 1.0 && leaves.levels() == (0..5));
            assert!((after / before - factor / 4.0).abs() < 1e-12, "p = {factor}, {centre:?}: {}", after / before);
        }
    }
}

#[test]
fn walls_between_finest_leaves_are_those_of_the_uniform_volume() {
    let solid = |cell: Cell| Solid::new(cell, DVec3::NEG_X, 0.75, [0.5; 3]);
    let cells = Layout::new(N).cells().filter(|[x, y, z]| *x == 5 && (*y, *z) != (3, 4));
    let solids: Vec<Solid> = cells.map(solid).collect();
    let sizes = Levels::new(N, 1).unwrap();
    let (hard_solids, geometry) = (HardSolids::new(sizes, &solids, [[0, 0, 0]]), GeometryVolume::new(sizes, &solids));
    let hard = Hard { hard_solids, geometry, bounce: 0.8 };
    let occluders = OcclusionLaw::Hard(hard.clone());
    let mut source = Octree::new(sizes);
    for (k, cell) in Layout::new(N).cells().enumerate() {
        source.level_mut(0).set(cell, some_light(k));
    }
    let mut wanted = Grid::new(N);
    occluders.propagate(&stencil(3.0), Which { level: 0, colour: 0, blocks: true }, source.level(0), &mut wanted);
    let mut marks: Vec<Marks> = sizes.sides().map(Marks::new).collect();
    marks[0] = everywhere(N);
    let leaves = Leaves::<f64>::among(&share(3.0), Way::InStep, marks, &walls::Solid { hard: &hard, colour: 0 });
    let mut target = Octree::new(sizes);
    leaves.apply(&source, &mut target);
    for (cell, light) in wanted.iter() {
        let found = target.level(0).get(cell);
        assert!((found - light).max_norm() < 1e-13, "{cell:?}: {found:?}, {light:?}");
    }
}

/// Surfaces here and there, leaning and translucent.
fn surfaces() -> Vec<Solid> {
    let cells = Layout::new(N).cells().enumerate().filter(|(i, [x, y, _])| *x == 6 && noise(*i) < 0.7 || *y == 11);
    let solid = |(i, cell): (usize, Cell)| {
        let normal = DVec3::new(-1.0, noise(i) - 0.5, noise(i + 1) - 0.5).normalize();
        Solid::new(cell, normal, 0.3 + 0.7 * noise(i + 2), [0.9, 0.2, 0.5])
    };
    cells.map(solid).collect()
}

fn finest() -> Levels {
    Levels::new(N, N).unwrap()
}

/// Laws of what weakens light or turns it, for the blue of [`surfaces`].
fn soft_laws() -> Vec<(OcclusionLaw<f64>, Which)> {
    let geometry = GeometryVolume::new(finest(), &surfaces());
    let which = Which { level: 0, colour: 2, blocks: true };
    let fuzzy = |along_travel, bounce| {
        OcclusionLaw::Fuzzy(Fuzzy { geometry: geometry.clone(), amplifier: 0.8, along_travel, bounce })
    };
    vec![
        (fuzzy(false, 0.0), which),
        (fuzzy(true, 0.5), which),
        (fuzzy(false, 0.5), Which { blocks: false, ..which }),
        (OcclusionLaw::Mirrored(Mirrored { geometry: geometry.clone() }), which),
    ]
}

fn free(factor: f64) -> Ways {
    matrices(|d, light| stencil(factor).send(d.index(), light))
}

fn blockers(law: &OcclusionLaw<f64>, which: Which, factor: f64) -> Blockers {
    let touched = law.touched(0, N).cells;
    assert!(touched.len() > N * N && touched.len() < N * N * N);
    let ways = touched.into_iter().map(|cell| (cell, law.matrices(&stencil(factor), which, cell).unwrap()));
    Blockers::new(Levels::new(N, 1).unwrap(), free(factor), ways)
}

#[test]
fn finest_leaves_among_blockers_are_the_uniform_volume() {
    for (law, which) in soft_laws() {
        let blockers = blockers(&law, which, 3.0);
        let mut source = Octree::new(Levels::new(N, 1).unwrap());
        for (k, cell) in Layout::new(N).cells().enumerate() {
            source.level_mut(0).set(cell, some_light(k));
        }
        let mut wanted = Grid::new(N);
        law.propagate(&stencil(3.0), which, source.level(0), &mut wanted);
        let mut marks: Vec<Marks> = source.sizes().sides().map(Marks::new).collect();
        marks[0] = everywhere(N);
        for way in [Way::InStep, Way::Ahead] {
            let leaves = Leaves::<f64>::among(&share(3.0), way, marks.clone(), &walls::Open(Some(&blockers)));
            let mut target = Octree::new(source.sizes());
            leaves.apply(&source, &mut target);
            for (cell, light) in wanted.iter() {
                let found = target.level(0).get(cell);
                assert!((found - light).max_norm() < 1e-13, "{cell:?}: {found:?}, {light:?}");
            }
        }
    }
}

#[test]
fn coarse_cells_among_blockers_take_a_finest_step_of_evenly_spread_light() {
    for (law, which) in soft_laws() {
        let blockers = blockers(&law, which, 3.0);
        for level in 1..=3 {
            let (n, h) = (N >> level, f64::from(1u32 << level));
            let mut coarse = Grid::new(n);
            Layout::new(n).cells().enumerate().for_each(|(k, cell)| coarse.set(cell, some_light(k)));
            let mut fine = Grid::new(N);
            Layout::new(N).cells().for_each(|cell| fine.set(cell, coarse.get(cell.map(|c| c >> level))));
            let mut moved = Grid::new(N);
            law.propagate(&stencil(3.0), which, &fine, &mut moved);
            let mut wanted = Grid::new(n);
            moved.iter().for_each(|(cell, light)| wanted.add(cell.map(|c| c >> level), light * h.powi(-3)));
            for (cell, wanted) in wanted.iter() {
                let Some(means) = blockers.means(level, cell) else { continue };
                let mut found = Sh::ZERO;
                for (d, direction) in Direction::ALL.into_iter().enumerate() {
                    let times = |matrix: DMat4, light: Sh<f64>| Sh((matrix * DVec4::from_array(light.0)).to_array());
                    let sender = direction.opposite().neighbour(cell, n).map_or(Sh::ZERO, |from| coarse.get(from));
                    found += times(means.inside[d], coarse.get(cell)) * (1.0 - 1.0 / h);
                    found += times(means.entering[d], sender) * (1.0 / h);
                }
                assert!((found - wanted).max_norm() < 1e-13, "level {level}, {cell:?}: {found:?}, {wanted:?}");
            }
        }
    }
}

#[test]
fn blockers_that_do_nothing_leave_leaves_of_all_sizes_as_they_are() {
    let (marks, cells) = (around([5, 8, 10]), Layout::new(N).cells().filter(|[x, y, z]| (x + 2 * y + 5 * z) % 7 == 0));
    let idle = Blockers::new(Levels::new(N, 1).unwrap(), free(3.8), cells.map(|cell| (cell, free(3.8))));
    for way in [Way::InStep, Way::Ahead] {
        let open = Leaves::<f64>::new(&share(3.8), way, marks.clone());
        let among = Leaves::<f64>::among(&share(3.8), way, marks.clone(), &walls::Open(Some(&idle)));
        let light = lit(&open);
        let [mut wanted, mut found] = [(); 2].map(|()| Octree::new(light.sizes()));
        open.apply(&light, &mut wanted);
        among.apply(&light, &mut found);
        for i in open.levels() {
            let everywhere: Vec<(Cell, Sh<f64>)> = light.level(i).iter().collect();
            open.add_source(i, &everywhere, wanted.level_mut(i));
            among.add_source(i, &everywhere, found.level_mut(i));
            for (cell, light) in wanted.level(i).iter() {
                let other = found.level(i).get(cell);
                assert!((light - other).max_norm() < 1e-13, "level {i}, {cell:?}: {light:?}, {other:?}");
            }
        }
    }
}

#[test]
fn both_ways_to_iterate_have_one_fixed_point() {
    one_fixed_point(&walls::Open(None));
    for (law, which) in soft_laws() {
        one_fixed_point(&walls::Open(Some(&blockers(&law, which, 3.8))));
    }
}

fn one_fixed_point(walls: &dyn walls::Walls) {
    let share = share(3.8);
    let marks = around([8, 8, 8]);
    let solve = |way| {
        let leaves = Leaves::<f64>::among(&share, way, marks.clone(), walls);
        let mut light = Octree::new(Levels::new(N, 1).unwrap());
        let mut next = light.clone();
        leaves.add_source(0, &[([9, 8, 8], Sh([LOBE0, 0.1, -0.2, 0.0]))], light.level_mut(0));
        let mut sum = light.clone();
        for _ in 0..1500 {
            leaves.apply(&light, &mut next);
            std::mem::swap(&mut light, &mut next);
            sum.levels_mut().iter_mut().zip(light.levels()).for_each(|(sum, grid)| sum.add_grid(grid));
        }
        sum
    };
    let (step, ahead) = (solve(Way::InStep), solve(Way::Ahead));
    for (a, b) in step.levels().iter().zip(ahead.levels()) {
        for (cell, light) in a.iter() {
            let other = b.get(cell);
            assert!((light - other).max_norm() <= 1e-9 * other.max_norm(), "{cell:?}: {light:?}, {other:?}");
        }
    }
    assert!(step.level(2).energy() > 0.0);
}

#[test]
fn the_48_symmetries_of_the_cube_are_kept() {
    let share = share(3.0);
    let centre = [5, 8, 10];
    let leaves = Leaves::<f64>::new(&share, Way::Ahead, around(centre));
    let light = lit(&leaves);
    let mut target = Octree::new(light.sizes());
    leaves.apply(&light, &mut target);
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for flips in 0..8 {
            let turn = |cell: Cell, n: usize| {
                let mut to = [0; 3];
                for k in 0..3 {
                    to[k] = if flips >> k & 1 == 1 { n - 1 - cell[order[k]] } else { cell[order[k]] };
                }
                to
            };
            let turn_sh = |Sh([c, v @ ..]): Sh<f64>| {
                let mut to = [c, 0.0, 0.0, 0.0];
                for k in 0..3 {
                    to[k + 1] = if flips >> k & 1 == 1 { -v[order[k]] } else { v[order[k]] };
                }
                Sh(to)
            };
            let turned = Leaves::<f64>::new(&share, Way::Ahead, around(turn(centre, N)));
            let mut source = Octree::new(light.sizes());
            for (i, grid) in light.levels().iter().enumerate() {
                for (cell, value) in grid.iter() {
                    source.level_mut(i).set(turn(cell, grid.side()), turn_sh(value));
                }
            }
            let mut found = Octree::new(light.sizes());
            turned.apply(&source, &mut found);
            for (i, grid) in target.levels().iter().enumerate() {
                for (cell, value) in grid.iter() {
                    let other = found.level(i).get(turn(cell, grid.side()));
                    assert!((turn_sh(value) - other).max_norm() < 1e-14, "level {i}, {cell:?}");
                }
            }
        }
    }
}

#[test]
fn every_scheme_with_a_linear_form_has_leaves() {
    for name in ["cascaded", "blog", "axial", "cone", "reflective"] {
        let form = Form::of(&Stencil::<f64>::new(&find(name).unwrap(), 2.0, false)).unwrap();
        let decay = Decay::of(&form.share);
        assert!(decay.mu().is_finite() && decay.mu() >= 0.0, "{name}: {decay:?}");
    }
}
