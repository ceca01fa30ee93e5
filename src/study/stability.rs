//! Where a scheme keeps its light bounded: the gain of a uniform field, and the critical factor of every
//! size.
//!
//! With dark borders every scheme multiplies the light that is left, in the long run, by p·λ an iteration,
//! λ the growth of its slowest mode at p = 1. So the light stays bounded up to the critical factor 1/λ,
//! which is smaller the larger the volume: less light is near a border.

pub(crate) mod drift;
pub(crate) mod level;
pub(crate) mod outlook;

pub use outlook::{Exceeded, exceeded, surely_bounded};
use std::f64::consts::PI;

use crate::field::{Cell, Grid};
use crate::sh::Sh;
use crate::system::random::Random;
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::kernel::plain;
use crate::transport::lattice::scheme::Scheme;
use crate::transport::lattice::stencil::Stencil;

/// The sizes whose critical factors people are shown: sides of the volume, in cells.
pub const SIZES: [usize; 5] = [2, 4, 8, 16, 32];

/// How closely two estimates of λ, two iterations apart, agree before one is taken.
const SETTLED: f64 = 1e-7;
/// Iterations after which the estimate is taken as it is.
const MOST_ITERATIONS: usize = 4000;
/// The side of the volume that stands for one without borders.
const TORUS: usize = 8;
/// The seed of the light that power iteration starts from.
const SEED: u64 = 1;

/// What is computed about a scheme.
#[derive(Clone, Debug, PartialEq)]
pub struct Stability {
    /// What an iteration at p = 1 multiplies the mean (c00) of a uniform field by.
    pub mean_gain: f64,
    /// What it multiplies the direction part (X, Y, Z) of a uniform field by.
    pub direction_gain: f64,
    /// For each of the sizes asked for, the factor above which light in an open volume grows without bound.
    pub critical: Vec<(usize, f64)>,
}

/// The gains of `scheme` and its critical factors for volumes of the given sides.
pub fn of_scheme(scheme: &Scheme, sizes: &[usize]) -> Stability {
    let stencil = Stencil::new(scheme, 1.0, true);
    let [mean_gain, direction_gain] = stencil.uniform_gain();
    let critical = sizes.iter().map(|&n| (n, 1.0 / growth(&stencil, Start::Arch, Borders::Open(n)))).collect();
    Stability { mean_gain, direction_gain, critical }
}

/// The factor above which the light of a scheme without clamps grows, whatever its shape: the start is
/// noise of either sign, which holds every mode of the volume.
pub fn critical_without_clamps(scheme: &Scheme, n: usize) -> f64 {
    1.0 / growth(&Stencil::new(scheme, 1.0, false), Start::Noise, Borders::Open(n))
}

/// The factor above which light grows in a volume without borders, as a large one is far from its sides.
pub fn critical_without_borders(scheme: &Scheme, clamp: bool) -> f64 {
    let start = if clamp { Start::Lobes } else { Start::Noise };
    1.0 / growth(&Stencil::new(scheme, 1.0, clamp), start, Borders::None)
}

/// What lies beyond the sides of the volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Borders {
    /// Darkness, around a volume of this side.
    Open(usize),
    /// Nothing: what leaves at one side comes in at the other.
    None,
}

/// The light that power iteration starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Start {
    /// The slowest mode of plain diffusion, close to the answer.
    Arch,
    /// A lobe of random strength and direction in every cell.
    Lobes,
    /// Every coefficient random and of either sign, over an arch.
    Noise,
}

impl Start {
    fn light(self, n: usize) -> Grid<f64> {
        let mut random = Random::new(SEED);
        let mut light = Grid::new(n);
        for cell in light.layout().cells() {
            let arch: f64 = cell.map(|c| (PI * (c + 1) as f64 / (n + 1) as f64).sin()).iter().product();
            let mut signed = || random.between(-1.0, 1.0);
            light.set(
                cell,
                match self {
                    Start::Arch => Sh([arch, 0.0, 0.0, 0.0]),
                    Start::Lobes => {
                        let direction = glam::DVec3::new(signed(), signed(), signed());
                        Sh::lobe(direction.normalize_or(glam::DVec3::X)) * signed().abs()
                    }
                    Start::Noise => Sh([arch + signed(), signed(), signed(), signed()]),
                },
            );
        }
        light
    }
}

/// What an iteration multiplies light by, in the long run: power iteration.
///
/// Light hops between the even and the odd cells, so that λ and −λ go together; two iterations at a time
/// see λ² alone.
fn growth(stencil: &Stencil<f64>, start: Start, borders: Borders) -> f64 {
    let n = match borders {
        Borders::Open(n) => n,
        Borders::None => TORUS,
    };
    let step = |from: &Grid<f64>, to: &mut Grid<f64>| match borders {
        Borders::Open(_) => plain::propagate(stencil, from, to),
        Borders::None => propagate_around(stencil, from, to),
    };
    let (mut light, mut next) = (start.light(n), Grid::new(n));
    let mut last = 0.0;
    for _ in 0..MOST_ITERATIONS {
        let before = strength(&light);
        step(&light, &mut next);
        step(&next, &mut light);
        let after = strength(&light);
        let growth = (after / before).sqrt();
        if (growth - last).abs() <= SETTLED * growth {
            return growth;
        }
        last = growth;
        light.scale(1.0 / after);
    }
    last
}

/// The Euclidean norm of all coefficients: light of either sign counts.
fn strength(light: &Grid<f64>) -> f64 {
    light.planes().iter().flatten().map(|c| c * c).sum::<f64>().sqrt()
}

/// [`plain::propagate`] where what leaves at one side comes in at the other.
fn propagate_around(stencil: &Stencil<f64>, source: &Grid<f64>, target: &mut Grid<f64>) {
    let n = source.side();
    for cell in source.layout().cells() {
        let sender = |d: Direction| -> Cell {
            let mut sender = cell;
            let back = if d.is_positive() { n - 1 } else { 1 };
            sender[d.axis()] = (sender[d.axis()] + back) % n;
            sender
        };
        let received = Direction::ALL.iter().enumerate().map(|(i, d)| stencil.send(i, source.get(sender(*d))));
        target.set(cell, received.sum());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::lattice::schemes::{self, cascaded};

    #[test]
    fn cascaded_is_stable_up_to_the_published_factors() {
        // MATH.md section 2.
        let published = [9.53, 5.22, 4.33, 4.09, 4.03];
        let found = of_scheme(&cascaded::scheme(), &SIZES);
        for ((n, critical), expected) in found.critical.iter().zip(published) {
            assert!((critical / expected - 1.0).abs() < 0.01, "{n}³: {critical}, {expected}");
        }
    }

    #[test]
    fn without_borders_and_without_clamps_the_uniform_field_grows_most() {
        // MATH.md section 2: the mean gains p/4, so p = 4 is critical; no other mode may be faster.
        let cascaded = cascaded::scheme();
        for clamp in [true, false] {
            let critical = critical_without_borders(&cascaded, clamp);
            assert!((critical - 4.0).abs() < 1e-3, "clamp {clamp}: {critical}");
        }
        for (n, expected) in [(2, 9.53), (4, 5.22), (8, 4.33)] {
            let critical = critical_without_clamps(&cascaded, n);
            assert!((critical / expected - 1.0).abs() < 0.01, "{n}³: {critical}");
        }
    }

    #[test]
    fn light_shrinks_below_the_critical_factor_and_grows_above() {
        for scheme in schemes::all() {
            let n = 4;
            let (_, critical) = of_scheme(&scheme, &[n]).critical[0];
            for (share, grows) in [(0.95, false), (1.05, true)] {
                let stencil = Stencil::<f64>::new(&scheme, share * critical, true);
                let mut light = Grid::new(n);
                light.set([1, 2, 0], Sh::lobe(glam::DVec3::X));
                let mut next = Grid::new(n);
                let mut energy = Vec::new();
                for _ in 0..200 {
                    plain::propagate(&stencil, &light, &mut next);
                    std::mem::swap(&mut light, &mut next);
                    energy.push(light.energy());
                }
                assert_eq!(energy[199] > energy[99], grows, "{} at {share} of {critical}", scheme.name);
            }
        }
    }
}
