//! The part of a step that stays in a leaf, and its inverse.

use crate::sh::{Real, Sh};
use crate::transport::lattice::kernel::form::Share;

/// The own parts of the faces across an axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Own {
    pub(super) even: f64,
    /// Outward through the upper face counts up, through the lower face down.
    pub(super) odd: f64,
    /// What is mirrored at the faces, through the upper and through the lower one.
    pub(super) mirrored: [f64; 2],
}

/// The part D of a step that stays in a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Within<T> {
    mean: T,
    direction: [T; 3],
    /// c00 from the direction.
    inward: [T; 3],
    /// The direction from c00.
    outward: [T; 3],
    /// 1/(1 − direction).
    residence: [T; 3],
    /// (I − D)⁻¹ from the direction, and from c00 itself, to c00.
    through: [T; 3],
    whole: T,
}

impl<T: Real> Within<T> {
    /// From the own parts of the faces across each axis.
    pub(super) fn new(share: &Share<f64>, own: [Own; 3]) -> Self {
        let Share { alpha, beta, gamma, delta, epsilon } = *share;
        let sum = |of: &dyn Fn(&Own) -> f64| own.iter().map(of).sum::<f64>();
        let (even, mirrored) = (sum(&|own| own.even), sum(&|own| own.mirrored[0] + own.mirrored[1]));
        // A mirror turns the direction across it: what comes back of a share has γ and δ the other way round.
        let direction = |own: &Own| {
            let back = own.mirrored[0] + own.mirrored[1];
            delta * (2.0 + own.even - back) + epsilon * (4.0 + (even - own.even) + (mirrored - back))
        };
        let turned = |own: &Own| own.mirrored[0] - own.mirrored[1];
        let mean = alpha * (6.0 + even + mirrored);
        let direction = own.map(|own| direction(&own));
        let inward = own.map(|own| beta * (own.odd + turned(&own)));
        let outward = own.map(|own| gamma * (own.odd - turned(&own)));
        // The directions, put into the equation of c00.
        let residence = direction.map(|direction| 1.0 / (1.0 - direction));
        let back: f64 = (0..3).map(|k| inward[k] * residence[k] * outward[k]).sum();
        let whole = 1.0 / (1.0 - mean - back);
        let through = [0, 1, 2].map(|k| whole * inward[k] * residence[k]);
        Within {
            mean: T::of(mean),
            direction: direction.map(T::of),
            inward: inward.map(T::of),
            outward: outward.map(T::of),
            residence: residence.map(T::of),
            through: through.map(T::of),
            whole: T::of(whole),
        }
    }

    /// D·a
    #[inline(always)]
    pub(super) fn apply(&self, Sh([c, v @ ..]): Sh<T>) -> Sh<T> {
        let axis = |k: usize| self.outward[k] * c + self.direction[k] * v[k];
        let mean = self.mean * c + (self.inward[0] * v[0] + self.inward[1] * v[1] + self.inward[2] * v[2]);
        Sh([mean, axis(0), axis(1), axis(2)])
    }

    /// (I − D)⁻¹·r
    #[inline(always)]
    pub(super) fn solve(&self, Sh([c, v @ ..]): Sh<T>) -> Sh<T> {
        let mean = self.whole * c + (self.through[0] * v[0] + self.through[1] * v[1] + self.through[2] * v[2]);
        let axis = |k: usize| (v[k] + self.outward[k] * mean) * self.residence[k];
        Sh([mean, axis(0), axis(1), axis(2)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solving_undoes_what_stays_in_a_leaf() {
        let share = Share { alpha: 0.125, beta: 0.05, gamma: 0.04, delta: 0.03, epsilon: 0.06 };
        let own = [(-0.2, 0.1), (-0.9, -0.3), (-0.5, 0.0)].map(|(even, odd)| Own { even, odd, mirrored: [0.1, 0.2] });
        let within = Within::<f64>::new(&share, own);
        let light = Sh([1.0, 0.3, -0.2, 0.7]);
        let left = light - within.apply(light);
        assert!((within.solve(left) - light).max_norm() < 1e-14);
    }
}
