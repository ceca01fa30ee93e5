//! Where the light of lamps first falls: rays from every lamp, traced once for a batch of samples.
//!
//! A sample that begins at a lamp needs a place that the lamp lights. The places of one batch are drawn from a table, a
//! jittered grid over the numbers that rays are made from, so that they cost one ray each for all pixels together. The
//! next batch has a table of its own: what a table gets wrong is in the error bar like everything else.

use rayon::prelude::*;

use super::rgb::Rgb;
use super::world::{Surface, World};
use crate::system::random::Random;

/// Rays along each side of a lamp's grid.
const SIDE: usize = 256;

/// The lit places of one batch, lamp by lamp.
#[derive(Clone, Debug)]
pub struct Sparks(Vec<Vec<Option<Spark>>>);

/// A place that a lamp lights.
#[derive(Clone, Copy, Debug)]
pub struct Spark {
    /// The place, on the side that is lit.
    pub lit: Surface,
    /// The radiance that it reflects of the lamp's light.
    pub radiance: Rgb,
    /// How dense such places are there, by area [1/m²].
    pub density: f64,
}

impl Sparks {
    /// Those of the batch of this number.
    pub fn new(world: &World, batch: u64) -> Self {
        let of = |lamp: usize| (0..SIDE * SIDE).into_par_iter().map(move |i| spark(world, batch, lamp, i)).collect();
        Sparks((0..world.lamps().len()).map(of).collect())
    }

    /// The place that a lamp's ray by these even numbers meets; `None` where it meets nothing.
    pub fn at(&self, lamp: usize, [s, t]: [f64; 2]) -> Option<&Spark> {
        let along = |u: f64| ((u * SIDE as f64) as usize).min(SIDE - 1);
        self.0[lamp][along(t) * SIDE + along(s)].as_ref()
    }
}

fn spark(world: &World, batch: u64, lamp: usize, i: usize) -> Option<Spark> {
    let mut jitter = Random::of([batch, lamp as u64, i as u64]);
    let lamp = &world.lamps()[lamp];
    let [s, t] = [i % SIDE, i / SIDE].map(|place| (place as f64 + jitter.unit()) / SIDE as f64);
    let (from, way) = lamp.ray([s, t]);
    let lit = world.meet(from, way)?;
    let ray = lamp.light(lit.at);
    let cosine = ray.to_light.dot(lit.normal).max(0.0);
    let radiance = lit.reflects(ray.across.map(|e| e * cosine));
    Some(Spark { lit, radiance, density: lamp.density(lit.at, lit.normal) })
}
