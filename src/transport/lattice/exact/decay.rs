//! How light that depends on one coordinate alone dies out, and what follows from it for cells of any size.
//!
//! Let light be the same all over each plane across one axis, and let nothing be injected where we look. With the
//! five numbers α β γ δ ε of a neighbour's share ([`Share`], the factor included), one step takes the mean c and
//! the direction V along the axis to
//!
//! ```text
//! c' = α·(c₋ + c₊) + 4α·c + β·(V₋ − V₊)          V' = γ·(c₋ − c₊) + δ·(V₋ + V₊) + 4ε·V
//! ```
//!
//! (₋ and ₊ the planes before and behind; the four neighbours in the plane itself send 4α and 4ε). In the fixed
//! point both are sums of e^(μx) and e^(−μx). Put that in, and the determinant must vanish:
//!
//! ```text
//! (α·ch + 4α − 1)·(δ·ch + 4ε − 1) = βγ·(ch² − 4)          ch = 2·cosh μ
//! ```
//!
//! Of the two roots the smaller is the light that gets far; the other, where it is a light at all, changes sign from
//! plane to plane and is gone after one. Where ch would be below 2 the light does not die out (`cascaded`: from
//! p = 4 on), and μ is taken to be 0.
//!
//! **Cells of h planes.** A cell of level i holds the mean over h = 2^i planes. All that the levels need to agree
//! follows from asking that such light be treated exactly:
//!
//! - One finest step makes differences of first and of second order between neighbouring planes. Between
//!   neighbouring cells the same differences of means are smaller or larger by what [`Decay::odd`] and
//!   [`Decay::even`] say: (sinh μ)/(sinh μh) and (sinh(μ/2)/sinh(μh/2))².
//! - Across a face between cells of hₗ and hᵣ planes there is one a·cosh μx + b·sinh μx that has both means. Its two
//!   planes at the face are what crosses it: [`Decay::face`].
//! - At an open border all is dark from the next plane on, so light there is sinh μj, j planes from the dark:
//!   [`Decay::border`] is its last plane over its mean.
//!
//! Everything is written with ratios sinh μx / sinh μy, x ≤ y, which are x/y at μ = 0 and stay finite where the
//! sines themselves do not.
//!
//! ```
//! use lpv_lab::transport::lattice::exact::decay::Decay;
//! let decay = Decay::new(0.0); // light that does not die out, `cascaded` at p = 4
//! let face = decay.face(1.0, 2.0);
//! assert_eq!(face.right, [1.0 / 3.0, 2.0 / 3.0]); // straight lines between the centres
//! ```

use crate::transport::lattice::kernel::form::Share;

/// What a decay longer than this many planes' e-foldings counts as: nothing gets from a plane to the next.
const STEEPEST: f64 = 700.0;

/// The decay μ of plane light, per finest cell; 0 or more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decay {
    mu: f64,
}

/// The planes next to a face, each as a sum of the means on its two sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// The plane on the left of the face: weights of the left and of the right cell's mean.
    pub left: [f64; 2],
    /// The plane on the right of the face.
    pub right: [f64; 2],
}

impl Decay {
    /// A decay by e^−μ a plane.
    pub fn new(mu: f64) -> Self {
        Decay { mu: mu.clamp(0.0, STEEPEST) }
    }

    /// The decay of a scheme's light, from its share of one neighbour at the factor used.
    pub fn of(share: &Share<f64>) -> Self {
        let Share { alpha, beta, gamma, delta, epsilon } = *share;
        let (c, v) = (1.0 - 4.0 * alpha, 1.0 - 4.0 * epsilon);
        // square·ch² − linear·ch + constant = 0
        let square = alpha * delta - beta * gamma;
        let linear = alpha * v + delta * c;
        let constant = c * v + 4.0 * beta * gamma;
        if c <= 0.0 {
            return Decay::new(0.0);
        }
        // The smaller root, written so that it holds for square = 0 too.
        let discriminant = linear * linear - 4.0 * square * constant;
        let ch = 2.0 * constant / (linear + discriminant.max(0.0).sqrt());
        // Where nothing is sent, 0/0 or worse: nothing gets anywhere.
        if ch.is_finite() { Decay::new((0.5 * ch).max(1.0).acosh()) } else { Decay::new(STEEPEST) }
    }

    /// μ, per finest cell.
    pub fn mu(&self) -> f64 {
        self.mu
    }

    /// sinh μx / sinh μy for 0 ≤ x ≤ y, y > 0.
    fn ratio(&self, x: f64, y: f64) -> f64 {
        if x == y {
            return 1.0;
        }
        if self.mu * y < 1e-6 {
            return x / y;
        }
        let shrink = |x: f64| -(-2.0 * self.mu * x).exp_m1();
        (self.mu * (x - y)).exp() * shrink(x) / shrink(y)
    }

    /// What differences of second order between cells of `h` planes are multiplied with: (sinh(μ/2)/sinh(μh/2))².
    pub fn even(&self, h: f64) -> f64 {
        self.ratio(0.5, 0.5 * h).powi(2)
    }

    /// What differences of first order between cells of `h` planes are multiplied with: sinh μ/sinh μh.
    pub fn odd(&self, h: f64) -> f64 {
        self.ratio(1.0, h)
    }

    /// The planes beside a face between a cell of `left` planes and one of `right` planes, from the means of both.
    ///
    /// With A = μ·left/2, B = μ·right/2 and the light a·cosh μx + b·sinh μx (x = 0 on the face, the planes at ±½) the
    /// two means give a and b, and after some halving of angles
    ///
    /// ```text
    /// right plane = right·sinh(μ/2)·sinh(A + μ/2)/(sinh B·sinh(A + B)) · right mean
    ///             +  left·sinh(μ/2)·sinh(B − μ/2)/(sinh A·sinh(A + B)) · left mean
    /// ```
    pub fn face(&self, left: f64, right: f64) -> Face {
        let own = |near: f64, far: f64| {
            near * self.ratio(0.5, 0.5 * near) * self.ratio(0.5 * (far + 1.0), 0.5 * (far + near))
        };
        let other =
            |near: f64, far: f64| far * self.ratio(0.5, 0.5 * far) * self.ratio(0.5 * (near - 1.0), 0.5 * (far + near));
        Face { left: [own(left, right), other(left, right)], right: [other(right, left), own(right, left)] }
    }

    /// The last plane before an open border over the mean of its cell of `h` planes: sinh μ / mean of sinh μj, j = 1 … h.
    pub fn border(&self, h: f64) -> f64 {
        // Σ sinh μj = sinh(μh/2)·sinh(μ(h+1)/2)/sinh(μ/2)
        h * self.ratio(0.5, 0.5 * h) * self.ratio(1.0, 0.5 * (h + 1.0))
    }

    /// The weight w of the filter that takes light from cells of h/2 planes to cells of `h` planes (h = 2, 4, …):
    /// 1/(4·cosh²(μh/4)); see [`super::filter`].
    pub fn filter(&self, h: f64) -> f64 {
        let x = 0.25 * self.mu * h;
        // cosh² = (1 + cosh 2x)/2, and e^(−2x) keeps it in range.
        let small = (-2.0 * x).exp();
        small / ((1.0 + small) * (1.0 + small))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::lattice::kernel::form::Form;
    use crate::transport::lattice::scheme::Scheme;
    use crate::transport::lattice::schemes::{axial, cascaded};
    use crate::transport::lattice::stencil::Stencil;

    fn share(scheme: &Scheme, factor: f64) -> Share<f64> {
        Form::of(&Stencil::<f64>::new(scheme, factor, false)).unwrap().share
    }

    fn decay(factor: f64) -> Decay {
        Decay::of(&share(&cascaded::scheme(), factor))
    }

    #[test]
    fn cascaded_light_decays_as_derived() {
        for (factor, mu) in [(3.0, 1.146_309_91), (3.8, 0.475_835_79), (4.0, 0.0), (4.3, 0.0)] {
            assert!((decay(factor).mu() - mu).abs() < 1e-7, "{factor}: {}", decay(factor).mu());
        }
    }

    #[test]
    fn light_of_that_decay_is_what_a_step_leaves_as_it_is() {
        for (scheme, factor) in [(cascaded::scheme(), 3.0), (cascaded::scheme(), 1.0), (axial::scheme(), 3.0)] {
            let share = share(&scheme, factor);
            let Share { alpha, beta, gamma, delta, epsilon } = share;
            let mu = Decay::of(&share).mu();
            let (ch, sh) = (2.0 * mu.cosh(), 2.0 * mu.sinh());
            // c = 1, V = v: from the step of V, then the step of c must give c again.
            let v = gamma * sh / (delta * ch + 4.0 * epsilon - 1.0);
            let c = alpha * ch + 4.0 * alpha - beta * v * sh;
            assert!((c - 1.0).abs() < 1e-9, "{} at {factor}: {c}", scheme.name);
        }
    }

    #[test]
    fn where_nothing_is_sent_nothing_gets_on() {
        let dark = decay(0.0);
        assert_eq!(dark.mu(), STEEPEST);
        for h in [2.0, 1024.0] {
            assert!(dark.even(h) < 1e-300 && dark.odd(h) < 1e-300 && dark.filter(h) < 1e-100);
            let face = dark.face(h, 2.0 * h);
            assert!(face.left.iter().chain(&face.right).all(|w| w.is_finite()), "{face:?}");
        }
    }

    #[test]
    fn the_planes_at_a_face_weigh_the_means_as_published() {
        for (factor, sides, left, right) in [
            (3.0, [1.0, 2.0], [1.0, 0.0], [0.223_996, 0.447_992]),
            (3.8, [1.0, 2.0], [1.0, 0.0], [0.309_528, 0.619_056]),
            (4.0, [1.0, 2.0], [1.0, 0.0], [1.0 / 3.0, 2.0 / 3.0]),
            (3.0, [2.0, 4.0], [0.481_260, 0.019_206], [0.148_520, 0.085_741]),
            (3.8, [2.0, 4.0], [0.737_949, 0.106_595], [0.384_109, 0.344_381]),
            (4.0, [2.0, 4.0], [5.0 / 6.0, 1.0 / 6.0], [0.5, 0.5]),
        ] {
            let face = decay(factor).face(sides[0], sides[1]);
            for (found, wanted) in face.left.iter().chain(&face.right).zip(left.iter().chain(&right)) {
                assert!((found - wanted).abs() < 1e-6, "{factor}, {sides:?}: {face:?}");
            }
        }
    }

    #[test]
    fn filter_and_border_are_as_derived() {
        for (factor, w) in [(3.0, 0.183_004), (3.8, 0.236_366), (4.0, 0.25)] {
            assert!((decay(factor).filter(2.0) - w).abs() < 1e-6);
        }
        for h in [1.0, 2.0, 8.0] {
            assert!((decay(4.0).border(h) - 2.0 / (h + 1.0)).abs() < 1e-7);
            let mu = decay(3.0).mu();
            let mean = (1..=h as i32).map(|j| (mu * f64::from(j)).sinh()).sum::<f64>() / h;
            assert!((decay(3.0).border(h) - mu.sinh() / mean).abs() < 1e-12);
        }
    }
}
