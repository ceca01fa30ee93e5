//! The light that reaches a surface by way of others: the estimators of the truth.
//!
//! After one bounce the irradiance at x, on the side of its normal, is an integral over all surfaces y that x sees,
//!
//! ```text
//! E₁(x) = ∫ B(y)·g/r² dA        g = cosθ_x·cosθ_y,  r = |x − y|,  B = L_e(y) + ρ(y)/π·Σ_l E_l(y)
//! ```
//!
//! B being the radiance that a volume is given to carry: what y emits, and what it reflects of the light of each
//! lamp l. Two samples are drawn for each term of B, by densities p and q per area,
//!
//! ```text
//! p = g/(π·r²)             a cosine-distributed ray from x
//! q = q_l(y)               a ray from the lamp ([`Lamp::density`]), or an even point of the emitting surfaces
//! ```
//!
//! and each counts as f/(p + q) with f = B·g/r²: the balance heuristic (Veach and Guibas 1995). In the form
//!
//! ```text
//! f/(p + q) = B·g/(g/π + r²·q)
//! ```
//!
//! it is at most πB wherever the points lie, so corners make no bright specks. Light of more bounces comes along the
//! cosine-distributed ray, times the albedo of what it meets: E_N(x) = E₁(x) + ρ(y)·E_(N−1)(y), in the mean over y.
//! From the third bounce on a path goes on with the probability of its greatest throughput, and weighs as much more.

use std::f64::consts::PI;

use super::lamp::Lamp;
use super::rgb::{Rgb, add, times};
use super::sampler;
use super::sequence::{Points, Stream};
use super::world::{Surface, World};

/// How often light is reflected on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bounces {
    /// At most so often; 0 is direct light alone, 1 what a light propagation volume approximates.
    UpTo(u32),
    /// As often as there is.
    All,
}

/// The bounce from which on paths may end by chance.
const ROULETTE_FROM: u32 = 3;
/// The most that a path goes on by, so that none goes on for ever where surfaces absorb nothing.
const GOES_ON_AT_MOST: f64 = 0.98;

impl Bounces {
    /// Whether light may be reflected for the `bounce`-th time, counted from 1.
    fn allow(self, bounce: u32) -> bool {
        match self {
            Bounces::UpTo(most) => bounce <= most,
            Bounces::All => true,
        }
    }
}

/// Numbers for the first bounce, by sample. Of a place the light along the ray from the surface and that along the rays
/// from the lights add up, so each pair is spread as evenly as two numbers can be, whatever the other one is.
#[derive(Clone, Copy, Debug, Default)]
pub struct First(Points<2>);

impl First {
    /// Those of sample `i`, shifted by `shift`.
    pub fn at(&self, [a, b, c, d]: [u64; 4], i: u64) -> [f64; 4] {
        let ([u, v], [s, t]) = (self.0.at(&[a, b], i), self.0.at(&[c, d], i));
        [u, v, s, t]
    }
}

/// One sample of the irradiance [W/m²] that a surface gets after one bounce and more. `first` are even numbers for the
/// first bounce, two for the ray from the surface and two for those from the lights; later ones take theirs from
/// `later`.
pub fn indirect(world: &World, surface: &Surface, bounces: Bounces, first: [f64; 4], later: &mut Stream) -> Rgb {
    let (mut sum, mut weight) = ([0.0; 3], [1.0; 3]);
    let (mut at, mut numbers) = (*surface, first);
    for bounce in 1.. {
        if !bounces.allow(bounce) {
            break;
        }
        if bounce >= ROULETTE_FROM {
            let goes_on = weight.iter().copied().fold(0.0, f64::max).min(GOES_ON_AT_MOST);
            if later.unit() >= goes_on {
                break;
            }
            weight = weight.map(|w| w / goes_on);
        }
        let (one, next) = one_bounce(world, &at, numbers);
        sum = add(sum, times(weight, one));
        let Some(next) = next else { break };
        weight = times(weight, next.albedo);
        at = next;
        numbers = std::array::from_fn(|_| later.unit());
    }
    sum
}

/// One sample of E₁, and the surface that the cosine-distributed ray met.
fn one_bounce(world: &World, at: &Surface, [u, v, s, t]: [f64; 4]) -> (Rgb, Option<Surface>) {
    let mut sum = [0.0; 3];
    let next = world.meet(at.at, sampler::cosine(at.normal, [u, v]));
    if let Some(met) = &next {
        let pair = Pair::new(at, met);
        for lamp in world.lamps() {
            let lit = world.lit(lamp, met);
            if lit != [0.0; 3] {
                sum = add(sum, pair.counts(met.reflects(lit), lamp.density(met.at, met.normal)));
            }
        }
        if met.emission != [0.0; 3] {
            sum = add(sum, pair.counts(met.emission, world.emitting_density()));
        }
    }
    for lamp in world.lamps() {
        sum = add(sum, from_lamp(world, at, lamp, [s, t]));
    }
    if let Some(emitting) = world.emitting(at.at, [s, t]).filter(|emitting| world.see_each_other(at, emitting)) {
        sum = add(sum, Pair::new(at, &emitting).counts(emitting.emission, world.emitting_density()));
    }
    (sum, next)
}

/// The sample that begins with a ray from the lamp.
fn from_lamp(world: &World, at: &Surface, lamp: &Lamp, numbers: [f64; 2]) -> Rgb {
    let (from, way) = lamp.ray(numbers);
    let Some(lit) = world.meet(from, way).filter(|lit| world.see_each_other(at, lit)) else { return [0.0; 3] };
    let ray = lamp.light(lit.at);
    let cosine = ray.to_light.dot(lit.normal).max(0.0);
    let radiance = lit.reflects(ray.across.map(|e| e * cosine));
    Pair::new(at, &lit).counts(radiance, lamp.density(lit.at, lit.normal))
}

/// Two places that see each other.
struct Pair {
    /// g, the product of the cosines.
    cosines: f64,
    /// r² [m²].
    squared: f64,
}

impl Pair {
    fn new(x: &Surface, y: &Surface) -> Self {
        let offset = y.at - x.at;
        let squared = offset.length_squared();
        let cosines = offset.dot(x.normal) * -offset.dot(y.normal) / squared;
        Pair { cosines: if cosines > 0.0 { cosines } else { 0.0 }, squared }
    }

    /// B·g/(g/π + r²·q).
    fn counts(&self, radiance: Rgb, density: f64) -> Rgb {
        let divisor = self.cosines / PI + self.squared * density;
        if divisor > 0.0 { radiance.map(|b| b * self.cosines / divisor) } else { [0.0; 3] }
    }
}
