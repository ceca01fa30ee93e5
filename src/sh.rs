//! Two-band spherical harmonics: the basis, clamped cosine lobes, evaluation and products.
//!
//! Inside the lab a vector is kept as (c00, X, Y, Z), with the signs of the basis folded in, so that
//! (X, Y, Z) points where the light flows:
//!
//! ```text
//! f(ω) ≈ K0·c00 + K1·(X·ω_x + Y·ω_y + Z·ω_z)          K0 = 1/(2√π),  K1 = √3/(2√π)
//! ```
//!
//! Files and people see the published basis (c00, c1-1, c10, c11) of (000, 3.1, eq. 3), where
//! c1-1 = −Y, c10 = +Z and c11 = −X; [`Sh::from_basis`] and [`Sh::to_basis`] convert.
//!
//! (000, eq. 7) prints the lobe's y and x coefficients without the minus signs that eq. 3 gives
//! them. With eq. 3's basis they must be there, or light runs backwards; a quadrature test holds us to it.

use std::f64::consts::PI;
use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub};

use glam::DVec3;

/// What the lab needs of a number: f32 for the volumes that people look at, f64 for references and stability.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialEq
    + PartialOrd
    + Send
    + Sync
    + Sum
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + MulAssign
    + 'static
{
    /// Zero.
    const ZERO: Self;
    /// The largest finite value, widened.
    const LARGEST: f64;
    /// The nearest value to `x`.
    fn of(x: f64) -> Self;
    /// This value, widened.
    fn to_f64(self) -> f64;
    /// The larger of the two; `other` where `self` is NaN.
    fn max(self, other: Self) -> Self;
    /// The absolute value.
    fn abs(self) -> Self;
}

macro_rules! real {
    ($t:ty) => {
        impl Real for $t {
            const ZERO: Self = 0.0;
            const LARGEST: f64 = <$t>::MAX as f64;
            #[inline]
            fn of(x: f64) -> Self {
                x as $t
            }
            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline]
            fn abs(self) -> Self {
                <$t>::abs(self)
            }
        }
    };
}
real!(f32);
real!(f64);

/// Band 0 of the basis, 1/(2√π).
pub const K0: f64 = 0.282_094_791_773_878_14;
/// Magnitude of band 1 of the basis, √3/(2√π).
pub const K1: f64 = 0.488_602_511_902_919_9;
/// c00 of the clamped cosine lobe, √π/2.
pub const LOBE0: f64 = 0.886_226_925_452_758;
/// Length of band 1 of the clamped cosine lobe, √(π/3).
pub const LOBE1: f64 = 1.023_326_707_946_488_5;

/// A function on the sphere in two bands: (c00, X, Y, Z), the signs of the basis folded in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sh<T>(pub [T; 4]);

impl<T: Real> Sh<T> {
    /// The dark function.
    pub const ZERO: Self = Sh([T::ZERO; 4]);

    /// The basis functions at the unit direction `d`, so that `f(d) = f.dot(Sh::basis(d))`
    /// (000, 3.1, eq. 3 and 5).
    pub fn basis(d: DVec3) -> Self {
        Sh([T::of(K0), T::of(K1 * d.x), T::of(K1 * d.y), T::of(K1 * d.z)])
    }

    /// The clamped cosine lobe max(cos θ, 0) about the unit vector `n` (000, 3.1, eq. 6); it integrates to π.
    pub fn lobe(n: DVec3) -> Self {
        Sh([T::of(LOBE0), T::of(LOBE1 * n.x), T::of(LOBE1 * n.y), T::of(LOBE1 * n.z)])
    }

    /// From coefficients in the published basis, order (c00, c1-1, c10, c11).
    pub fn from_basis([c00, c1m1, c10, c11]: [T; 4]) -> Self {
        Sh([c00, -c11, -c1m1, c10])
    }

    /// Coefficients in the published basis, order (c00, c1-1, c10, c11).
    pub fn to_basis(self) -> [T; 4] {
        let Sh([c00, x, y, z]) = self;
        [c00, -y, z, -x]
    }

    /// The function's value at the unit direction `d`.
    pub fn eval(self, d: DVec3) -> T {
        self.dot(Self::basis(d))
    }

    /// The integral of the product of two functions over the sphere.
    pub fn dot(self, other: Self) -> T {
        let (Sh(a), Sh(b)) = (self, other);
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
    }

    /// The largest magnitude among the four coefficients, ‖·‖∞ of (000, 6.2). The same in either basis.
    pub fn max_norm(self) -> T {
        self.0.iter().fold(T::ZERO, |m, c| c.abs().max(m))
    }

    /// Whether every coefficient is zero.
    pub fn is_zero(self) -> bool {
        self.0.iter().all(|c| *c == T::ZERO)
    }

    /// The direction of the flux, or `None` where the function has no direction.
    pub fn direction(self) -> Option<DVec3> {
        self.vector().try_normalize()
    }

    /// Band 1 as a vector (X, Y, Z): it points where the light flows.
    pub fn vector(self) -> DVec3 {
        let Sh([_, x, y, z]) = self;
        DVec3::new(x.to_f64(), y.to_f64(), z.to_f64())
    }

    /// The function mirrored on the plane across an axis (0 for x, 1 for y, 2 for z).
    pub fn mirrored(self, axis: usize) -> Self {
        let Sh(mut c) = self;
        c[1 + axis] = -c[1 + axis];
        Sh(c)
    }

    /// The function with every direction replaced by its opposite.
    pub fn reversed(self) -> Self {
        let Sh([c00, x, y, z]) = self;
        Sh([c00, -x, -y, -z])
    }

    /// The same function in double precision.
    pub fn widen(self) -> Sh<f64> {
        Sh(self.0.map(T::to_f64))
    }

    /// The same function with `U`'s precision.
    pub fn cast<U: Real>(self) -> Sh<U> {
        Sh(self.0.map(|c| U::of(c.to_f64())))
    }
}

impl<T: Real> Add for Sh<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (Sh(a), Sh(b)) = (self, other);
        Sh([a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]])
    }
}

impl<T: Real> AddAssign for Sh<T> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real> Sub for Sh<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        let (Sh(a), Sh(b)) = (self, other);
        Sh([a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]])
    }
}

impl<T: Real> Mul<T> for Sh<T> {
    type Output = Self;
    fn mul(self, s: T) -> Self {
        Sh(self.0.map(|c| c * s))
    }
}

impl<T: Real> Sum for Sh<T> {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::ZERO, Add::add)
    }
}

/// The whole sphere's solid angle, 4π.
pub const SPHERE: f64 = 4.0 * PI;

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint quadrature over the sphere: `f` at evenly spaced heights and angles, each with weight 4π/N.
    fn integrate(f: impl Fn(DVec3) -> f64) -> f64 {
        let (heights, angles) = (400, 800);
        let mut sum = 0.0;
        for i in 0..heights {
            let z = -1.0 + (f64::from(i) + 0.5) * 2.0 / f64::from(heights);
            let r = (1.0 - z * z).sqrt();
            for j in 0..angles {
                let phi = (f64::from(j) + 0.5) * 2.0 * PI / f64::from(angles);
                sum += f(DVec3::new(r * phi.cos(), r * phi.sin(), z));
            }
        }
        sum * SPHERE / f64::from(heights * angles)
    }

    /// The basis as (000, 3.1, eq. 3) prints it, signs and order.
    fn printed_basis(d: DVec3) -> [f64; 4] {
        let (k0, k1) = (0.5 / PI.sqrt(), 3f64.sqrt() / (2.0 * PI.sqrt()));
        [k0, -k1 * d.y, k1 * d.z, -k1 * d.x]
    }

    #[test]
    fn the_lobe_is_the_projection_of_the_clamped_cosine() {
        for n in [DVec3::X, DVec3::NEG_Y, DVec3::new(0.48, -0.6, 0.64)] {
            let lobe = Sh::<f64>::lobe(n).to_basis();
            for (j, coefficient) in lobe.iter().enumerate() {
                let projected = integrate(|d| n.dot(d).max(0.0) * printed_basis(d)[j]);
                assert!(
                    (coefficient - projected).abs() < 1e-4,
                    "coefficient {j} about {n}: {coefficient}, {projected}"
                );
            }
            assert!((integrate(|d| n.dot(d).max(0.0)) - PI).abs() < 2e-4);
        }
    }

    #[test]
    fn evaluation_agrees_with_the_printed_basis() {
        let c = [0.7, -0.2, 0.5, 0.3];
        let d = DVec3::new(2.0, -3.0, 6.0) / 7.0;
        let printed: f64 = c.iter().zip(printed_basis(d)).map(|(c, y)| c * y).sum();
        assert!((Sh::from_basis(c).eval(d) - printed).abs() < 1e-15);
        assert_eq!(Sh::from_basis(c).to_basis(), c);
    }

    #[test]
    fn the_product_integral_is_the_dot_product() {
        let (f, g) = (Sh([0.3, 0.1, -0.4, 0.2]), Sh([0.5, -0.6, 0.2, 0.1]));
        let integral = integrate(|d| f.eval(d) * g.eval(d));
        assert!((integral - f.dot(g)).abs() < 1e-5);
    }

    #[test]
    fn flux_points_where_the_lobe_does() {
        let n = DVec3::new(1.0, 2.0, -2.0) / 3.0;
        let found = Sh::<f64>::lobe(n).direction().unwrap_or_default();
        assert!((found - n).length() < 1e-15);
        assert_eq!(Sh::<f64>::ZERO.direction(), None);
    }
}
