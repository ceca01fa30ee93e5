//! A port's grids beside what they should be: the scheme that it is nearest to, without its mistakes, from the light
//! that was injected.

use std::f64::consts::PI;

use super::Dumps;
use super::light::Light;
use super::port::{KINDS, Kind, Order, Port};
use super::verdict::Verdict;
use super::weights::{self, Nominal};
use crate::transport::lattice::schemes;

/// What a port should do.
pub struct Right {
    port: Port,
    weights: [f64; KINDS],
    /// How much of the injected light the first iteration keeps.
    kept: f64,
}

impl Right {
    /// A scheme at the factor that a port has; `port` is how the scheme reads and puts back in the port's convention.
    pub fn new(port: &Port, nominal: &Nominal, factor: f64, copies_first: bool) -> Self {
        // Who forgot to divide by 4π meant the factor without it.
        let factor = if factor > 0.75 * 4.0 * PI { factor / (4.0 * PI) } else { factor };
        let mut port = port.clone();
        port.order = Order::AtOnce;
        port.reads_itself = false;
        port.taps.iter_mut().flatten().for_each(|tap| tap.clamp |= nominal.scheme != "blog");
        let mut weights = [0.0; KINDS];
        weights[Kind::Far as usize] = nominal.far * factor;
        weights[Kind::Side as usize] = nominal.side * factor;
        Right { port, weights, kept: f64::from(u8::from(copies_first)) }
    }

    /// The grid after one iteration more.
    pub fn step(&self, iteration: usize, before: &Light) -> Light {
        let mut weights = self.weights;
        let kept = if iteration == 0 { self.kept } else { 0.0 };
        weights[Kind::Own0 as usize] = kept;
        weights[Kind::Own1 as usize] = kept;
        self.port.step(&weights, before)
    }
}

/// A grid of a port, and what it should be.
#[derive(Clone, Debug)]
pub struct Beside {
    /// After so many iterations.
    pub iteration: usize,
    /// As it is.
    pub found: Light,
    /// As it should be.
    pub right: Light,
}

/// Every source grid of a port, the injected one first, beside what it should be. Empty where no scheme is near.
pub fn beside(dumps: &Dumps, verdict: &Verdict) -> Vec<Beside> {
    let bases = weights::bases(&schemes::all());
    let known = bases.iter().flat_map(|base| base.schemes.iter().map(move |nominal| (base, nominal)));
    let mut known = known.filter(|(_, nominal)| Some(nominal.scheme) == verdict.scheme);
    let (Some((base, nominal)), Some(factor)) = (known.next(), verdict.factor) else { return Vec::new() };
    let right = Right::new(&base.port, nominal, factor.value, verdict.snapshots == "copy-first");
    let injected = verdict.layout.light(&dumps.injected);
    let mut light = injected.clone();
    let mut grids = vec![Beside { iteration: 0, found: injected.clone(), right: injected }];
    for k in 0..dumps.source.keys().max().copied().unwrap_or(0) {
        light = right.step(k, &light);
        if let Some(dump) = dumps.source.get(&(k + 1)) {
            grids.push(Beside { iteration: k + 1, found: verdict.layout.light(dump), right: light.clone() });
        }
    }
    grids
}
