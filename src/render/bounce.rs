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
//! it is at most πB wherever the points lie, so corners make no bright specks. Rays from lamps are those of [`Sparks`]. Light of more bounces comes along the
//! cosine-distributed ray, times the albedo of what it meets: E_N(x) = E₁(x) + ρ(y)·E_(N−1)(y), in the mean over y.
//! From the third bounce on a path goes on with the probability of its greatest throughput, and weighs as much more.

use std::f64::consts::PI;

use super::rgb::{Rgb, add, times};
use super::sampler;
use super::sequence::Points;
use super::sparks::{Spark, Sparks};
use super::world::{Surface, World};
use crate::system::random::Random;

/// How often light is reflected on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bounces {
    /// At most so often; 0 is direct light alone, 1 what a light propagation volume approximates.
    UpTo(u32),
    /// As often as there is.
    All,
}

/// Lit places of which one is chosen.
const CANDIDATES: usize = 8;
/// The golden ratio's part behind the point.
const GOLDEN: f64 = 0.618_033_988_749_894_8;
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
pub fn indirect(
    world: &World,
    sparks: &Sparks,
    surface: &Surface,
    bounces: Bounces,
    first: [f64; 4],
    later: &mut Random,
) -> Rgb {
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
        let (one, next) = one_bounce(world, sparks, &at, numbers, later);
        sum = add(sum, times(weight, one));
        let Some(next) = next else { break };
        weight = times(weight, next.albedo);
        at = next;
        numbers = std::array::from_fn(|_| later.unit());
    }
    sum
}

/// One sample of E₁, and the surface that the cosine-distributed ray met.
fn one_bounce(
    world: &World,
    sparks: &Sparks,
    at: &Surface,
    [u, v, s, t]: [f64; 4],
    later: &mut Random,
) -> (Rgb, Option<Surface>) {
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
    for lamp in 0..world.lamps().len() {
        sum = add(sum, from_lamp(world, sparks, at, lamp, [s, t], later.unit()));
    }
    if let Some(emitting) = world.emitting(at.at, [s, t]).filter(|emitting| world.see_each_other(at, emitting)) {
        sum = add(sum, Pair::new(at, &emitting).counts(emitting.emission, world.emitting_density()));
    }
    (sum, next)
}

/// The sample that begins with a ray from the lamp: of several lit places one, by how much each would count if nothing
/// stood between, so that only that one costs a ray (resampling; Talbot 2005).
fn from_lamp(world: &World, sparks: &Sparks, at: &Surface, lamp: usize, [s, t]: [f64; 2], choice: f64) -> Rgb {
    let mut kept: Option<(&Spark, Rgb, f64)> = None;
    let (mut sum, mut choice) = (0.0, choice);
    for i in 0..CANDIDATES {
        // Shifts of an even set are even.
        let numbers = [(s + i as f64 / CANDIDATES as f64).fract(), (t + i as f64 * GOLDEN).fract()];
        let Some(spark) = sparks.at(lamp, numbers) else { continue };
        let counts = Pair::new(at, &spark.lit).counts(spark.radiance, spark.density);
        let weight: f64 = counts.iter().sum();
        if weight <= 0.0 {
            continue;
        }
        // One pass: the newest takes the place of the kept one by its part of the sum, and the number is even again.
        sum += weight;
        let part = weight / sum;
        if choice < part {
            kept = Some((spark, counts, weight));
            choice /= part;
        } else {
            choice = (choice - part) / (1.0 - part);
        }
    }
    match kept {
        Some((spark, counts, weight)) if world.see_each_other(at, &spark.lit) => {
            counts.map(|value| value * sum / (weight * CANDIDATES as f64))
        }
        _ => [0.0; 3],
    }
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
