//! A scheme made ready to run: its faces turned into all six directions, at a given factor and precision.

use glam::DMat4;

use super::face::Direction;
use super::scheme::Scheme;
use crate::sh::{Real, Sh};

/// One face as the loops use it; see [`super::scheme::Face`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap<T> {
    /// flux = sampler · a.
    pub sampler: Sh<T>,
    /// Whether a negative flux counts as none.
    pub clamp: bool,
    /// What one unit of flux adds to the neighbour, the propagation factor included.
    pub lobe: Sh<T>,
    /// The direction of travel as basis values, for evaluating blockers.
    pub travel: Sh<T>,
}

impl<T: Real> Tap<T> {
    /// The flux of the light `a` through this face.
    #[inline]
    pub fn flux(&self, a: Sh<T>) -> T {
        let flux = self.sampler.dot(a);
        if self.clamp { flux.max(T::ZERO) } else { flux }
    }
}

/// A scheme at a factor: for each [`Direction`] the taps that carry light that way.
#[derive(Clone, Debug, PartialEq)]
pub struct Stencil<T> {
    taps: [Vec<Tap<T>>; 6],
    /// What reflected light is multiplied with, by band: what the level does to all that arrives, without p.
    reflection: [T; 2],
}

impl<T: Real> Stencil<T> {
    /// `scheme` at propagation factor `factor`, without its clamps where `clamp` is false.
    pub fn new(scheme: &Scheme, factor: f64, clamp: bool) -> Self {
        Self::scaled(scheme, [factor; 2], clamp)
    }

    /// As [`Self::new`], with a factor for each band: what arrives as c00 is multiplied by the first, what
    /// arrives as direction by the second.
    pub fn scaled(scheme: &Scheme, [band0, band1]: [f64; 2], clamp: bool) -> Self {
        let taps = Direction::ALL.map(|d| {
            let turned = scheme.faces.iter().map(|face| {
                let Sh([c00, x, y, z]) = d.turn_sh(face.lobe);
                Tap {
                    sampler: d.turn_sh(face.sampler).cast(),
                    clamp: face.clamp && clamp,
                    lobe: Sh([c00 * band0, x * band1, y * band1, z * band1]).cast(),
                    travel: Sh::basis(d.turn(face.direction)),
                }
            });
            turned.collect()
        });
        Stencil { taps, reflection: [T::of(1.0); 2] }
    }

    /// The taps that carry light in each of [`Direction::ALL`].
    pub fn taps(&self) -> &[Vec<Tap<T>>; 6] {
        &self.taps
    }

    /// The same for a level that multiplies whatever arrives by a number for each band, p aside: reflected light too.
    pub fn reflecting(self, reflection: [f64; 2]) -> Self {
        Stencil { reflection: reflection.map(T::of), ..self }
    }

    /// What a level makes of light that a blocker reflects into a cell. The factor p has no part in it: that is the
    /// flux from neighbour to neighbour, and this flux has arrived.
    pub fn reflect(&self, Sh([c00, x, y, z]): Sh<T>) -> Sh<T> {
        let [band0, band1] = self.reflection;
        Sh([c00 * band0, x * band1, y * band1, z * band1])
    }

    /// What a neighbour in direction `d` (an index of [`Direction::ALL`]) receives of the light `a`.
    #[inline]
    pub fn send(&self, d: usize, a: Sh<T>) -> Sh<T> {
        let mut received = Sh::ZERO;
        for tap in &self.taps[d] {
            received += tap.lobe * tap.flux(a);
        }
        received
    }

    /// The gain of the mean (c00) and of the direction part of a uniform field in one iteration, clamps
    /// aside: the diagonal of T = Σ_d M_d.
    pub fn uniform_gain(&self) -> [f64; 2] {
        let gain = |band: usize| -> f64 {
            self.taps.iter().flatten().map(|tap| tap.lobe.0[band].to_f64() * tap.sampler.0[band].to_f64()).sum()
        };
        [gain(0), gain(1)]
    }
}

/// What is sent in each of [`Direction::ALL`], if it goes with the light, as matrices on it.
pub fn matrices(sent: impl Fn(Direction, Sh<f64>) -> Sh<f64>) -> [DMat4; 6] {
    let units = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]].map(Sh);
    Direction::ALL.map(|d| DMat4::from_cols_array_2d(&units.map(|unit| sent(d, unit).0)))
}

#[cfg(test)]
mod tests {
    use super::super::schemes::cascaded;
    use super::*;
    use glam::DVec3;

    #[test]
    fn one_step_of_a_unit_lobe_gives_the_published_neighbours() {
        // MATH.md section 2, p = 1, k = 1, unit lobe +X; coefficients (c00, c1-1, c10, c11).
        let stencil = Stencil::<f64>::new(&cascaded::scheme(), 1.0, true);
        let lobe = Sh::lobe(DVec3::X);
        let expected = [
            [0.104_473_16, 0.0, 0.0, -0.024_471_03],
            [0.0; 4],
            [0.036_926_13, -0.008_157_01, 0.0, -0.015_420_65],
            [0.036_926_13, 0.008_157_01, 0.0, -0.015_420_65],
            [0.036_926_13, 0.0, 0.008_157_01, -0.015_420_65],
            [0.036_926_13, 0.0, -0.008_157_01, -0.015_420_65],
        ];
        for (d, expected) in expected.iter().enumerate() {
            for (found, wanted) in stencil.send(d, lobe).to_basis().iter().zip(expected) {
                assert!((found - wanted).abs() < 2e-8, "direction {d}: {found}, {wanted}");
            }
        }
    }

    #[test]
    fn the_mean_gains_a_quarter_of_the_factor() {
        for factor in [1.0, 3.0, 4.0] {
            let [mean, direction] = Stencil::<f64>::new(&cascaded::scheme(), factor, true).uniform_gain();
            assert!((mean - factor / 4.0).abs() < 1e-15);
            assert!((direction - 0.3686 * factor / 4.0).abs() < 5e-5 * factor);
        }
    }
}
