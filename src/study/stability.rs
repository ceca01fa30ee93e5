//! Where a scheme keeps its light bounded: the gain of a uniform field, and the critical factor of every
//! size.
//!
//! With dark borders every scheme multiplies the light that is left, in the long run, by p·λ an iteration,
//! λ the growth of its slowest mode at p = 1. So the light stays bounded up to the critical factor 1/λ,
//! which is smaller the larger the volume: less light is near a border.

use std::f64::consts::PI;

use crate::field::Grid;
use crate::propagate::kernel::plain;
use crate::propagate::scheme::Scheme;
use crate::propagate::stencil::Stencil;
use crate::sh::Sh;

/// The sizes whose critical factors people are shown: sides of the volume, in cells.
pub const SIZES: [usize; 5] = [2, 4, 8, 16, 32];

/// How closely two estimates of λ, two iterations apart, agree before one is taken.
const SETTLED: f64 = 1e-7;
/// Iterations after which the estimate is taken as it is.
const MOST_ITERATIONS: usize = 4000;

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
    let critical = sizes.iter().map(|&n| (n, 1.0 / growth(&stencil, n))).collect();
    Stability { mean_gain, direction_gain, critical }
}

/// What an iteration multiplies the light in an open n³ volume by, in the long run, clamps included: power
/// iteration.
///
/// Light hops between the even and the odd cells, so that λ and −λ go together; two iterations at a time
/// see λ² alone. The start is the slowest mode of plain diffusion, close to the answer.
fn growth(stencil: &Stencil<f64>, n: usize) -> f64 {
    let arch = |c: usize| (PI * (c + 1) as f64 / (n + 1) as f64).sin();
    let (mut light, mut next) = (Grid::new(n), Grid::new(n));
    for cell in light.layout().cells() {
        light.set(cell, Sh([cell.map(arch).iter().product(), 0.0, 0.0, 0.0]));
    }
    let mut last = 0.0;
    for _ in 0..MOST_ITERATIONS {
        let before = light.energy();
        plain::propagate(stencil, &light, &mut next);
        plain::propagate(stencil, &next, &mut light);
        let after = light.energy();
        let growth = (after / before).sqrt();
        if (growth - last).abs() <= SETTLED * growth {
            return growth;
        }
        last = growth;
        light.scale(1.0 / after);
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::propagate::{cascaded, scheme};

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
    fn light_shrinks_below_the_critical_factor_and_grows_above() {
        for scheme in scheme::all() {
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
