//! Random presets: common ones and extreme ones, all of which a file could hold.

use crate::field::Cell;
use crate::scene::Preset;
use crate::scene::injector::{Injector, InjectorKind, Side};
use crate::scene::occluder::{Axis, BlockingSign, Occluder, OccluderKind, Occlusion, OcclusionMode};
use crate::scene::propagation::descent::{Descent, LEAST_SIDE};
use crate::scene::propagation::{Index, Policy, Propagation, Snapshots};
use crate::system::random::Random;
use crate::transport;

/// A preset of side 1 to 16 that passes [`Preset::check`] and names no file.
pub fn preset(random: &mut Random) -> Preset {
    let size = 1usize << random.below(5);
    let coarsest = if random.once_in(3) { 1 << random.below(size.ilog2() as usize + 1) } else { 1 };
    let injectors = if random.once_in(8) {
        everywhere(random, size)
    } else {
        (0..=random.below(4)).map(|_| injector(random, size)).collect()
    };
    let occluders = match random.below(8) {
        0 => vec![Occluder::new(OccluderKind::Box { from: [0; 3], to: [size - 1; 3] })],
        1..3 => (0..=random.below(3)).map(|_| occluder(random, size)).collect(),
        _ => Vec::new(),
    };
    Preset {
        size,
        coarsest,
        injectors,
        occluders,
        occlusion: occlusion(random),
        propagation: propagation(random, size),
        ..Preset::default()
    }
}

fn propagation(random: &mut Random, size: usize) -> Propagation {
    let kinds = transport::kinds();
    let kind = &kinds[random.below(kinds.len())];
    let factor = match random.below(8) {
        0 => 0.0,
        1 => 4.0,
        2 => random.between(4.0, 12.0),
        3 => 10f64.powf(random.between(-30.0, 300.0)),
        _ => random.between(0.0, 4.0),
    };
    let propagation = Propagation {
        scheme: kind.name.to_owned(),
        factor,
        iterations: 1 + random.below(40),
        snapshots: [Snapshots::Thesis, Snapshots::Thesis, Snapshots::CopyFirst, Snapshots::WithoutInjected]
            [random.below(4)],
        clamp: !random.once_in(4),
        levels: Policy::ALL[usize::from(random.once_in(3))],
        ..Propagation::default()
    };
    let variants = (kind.variants)(&propagation);
    let propagation = variants[random.below(variants.len())].clone();
    if kind.can.levels { with_coarse_levels(random, size, propagation) } else { propagation }
}

/// Coarse levels that start the fine ones, or are exact, or are sampled by distance; or as they were.
fn with_coarse_levels(random: &mut Random, size: usize, propagation: Propagation) -> Propagation {
    let descent = |descent| Propagation { descent, levels: Policy::Same, ..propagation.clone() };
    let side = size / 2;
    match random.below(10) {
        0 => descent(Descent::Cells),
        1 => descent(Descent::Leaves { distance: random.between(2.0, 4.0) }),
        2 if side >= LEAST_SIDE => descent(Descent::Cascades { side, center: None, alone: random.once_in(2) }),
        3 => Propagation { levels: Policy::Exact, ..propagation },
        4 => Propagation { levels: Policy::Ahead, ..propagation },
        5 => {
            let index = Index::Radial { reach: random.between(1.0, 4.0) };
            Propagation { levels: Policy::Ahead, index, ..propagation }
        }
        _ => propagation,
    }
}

fn injector(random: &mut Random, size: usize) -> Injector {
    let kind = match random.below(4) {
        0 => InjectorKind::Wall { side: Side::ALL[random.below(6)] },
        1 => {
            let (from, mut to) = corners(random, size);
            let across = random.below(3);
            to[across] = from[across];
            InjectorKind::Rectangle { from, to }
        }
        _ => InjectorKind::Single { cell: cell(random, size) },
    };
    // Light of one scene may differ by as much as a preset allows.
    let multiplier = match random.below(6) {
        0 => 10f64.powf(random.between(-30.0, 30.0)),
        1 => 0.0,
        _ => random.between(0.1, 2.0),
    };
    let color = match random.below(3) {
        0 => [1.0, random.unit(), 0.0],
        _ => [1.0; 3],
    };
    let direction = (!random.once_in(3)).then(|| direction(random));
    Injector { direction, multiplier, color, ..Injector::new(kind) }
}

/// Light in every cell: a rectangle a slab.
fn everywhere(random: &mut Random, size: usize) -> Vec<Injector> {
    let direction = Some(direction(random));
    let slab = |z| InjectorKind::Rectangle { from: [0, 0, z], to: [size - 1, size - 1, z] };
    (0..size).map(|z| Injector { direction, ..Injector::new(slab(z)) }).collect()
}

fn occluder(random: &mut Random, size: usize) -> Occluder {
    let kind = if random.once_in(2) {
        let axis = [Axis::X, Axis::Y, Axis::Z][random.below(3)];
        OccluderKind::Plane { axis, at: random.below(size) }
    } else {
        let (from, to) = corners(random, size);
        OccluderKind::Box { from, to }
    };
    let normal = random.once_in(2).then(|| direction(random));
    let albedo = if random.once_in(2) { [random.unit(), random.unit(), random.unit()] } else { [0.0; 3] };
    let opacity = if random.once_in(3) { random.unit() } else { 1.0 };
    Occluder { normal, opacity, albedo, ..Occluder::new(kind) }
}

fn occlusion(random: &mut Random) -> Occlusion {
    Occlusion {
        mode: [OcclusionMode::Fuzzy, OcclusionMode::Fuzzy, OcclusionMode::Hard, OcclusionMode::Off][random.below(4)],
        amplifier: if random.once_in(6) { 10f64.powf(random.between(-30.0, 300.0)) } else { random.between(0.0, 2.0) },
        sign: [BlockingSign::AgainstTravel, BlockingSign::AlongTravel][random.below(2)],
        from_iteration: random.below(4),
        bounce: if random.once_in(3) { random.between(0.0, 1.5) } else { 0.0 },
        ..Occlusion::default()
    }
}

fn cell(random: &mut Random, size: usize) -> Cell {
    std::array::from_fn(|_| random.below(size))
}

fn corners(random: &mut Random, size: usize) -> (Cell, Cell) {
    let (a, b) = (cell(random, size), cell(random, size));
    (std::array::from_fn(|i| a[i].min(b[i])), std::array::from_fn(|i| a[i].max(b[i])))
}

/// Any direction, of any length: along an axis more often than chance would have it.
fn direction(random: &mut Random) -> [f64; 3] {
    let length = 10f64.powf(random.between(-3.0, 3.0));
    if random.once_in(3) {
        let mut along = [0.0; 3];
        along[random.below(3)] = if random.once_in(2) { -length } else { length };
        return along;
    }
    // No component is zero, so no length is.
    std::array::from_fn(|_| length * random.between(0.01, 1.0) * if random.once_in(2) { -1.0 } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Problem;

    #[test]
    fn every_preset_is_one_that_a_file_could_hold() {
        for seed in 0..300 {
            let preset = preset(&mut Random::new(seed));
            assert_eq!(preset.check(), Ok(()));
            assert!(Problem::build(&preset, std::path::Path::new("")).is_ok());
            assert_eq!(Preset::parse(&preset.to_ron(), std::path::Path::new("p.ron")).as_ref(), Ok(&preset));
        }
    }
}
