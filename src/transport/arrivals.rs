//! What arrives at solids, cell by cell and face by face.
//!
//! A solid that stops light at the border of its cell leaves in the cell only what was injected there, so c·L(−n) of the
//! cell's light would show a wall unlit on which all light ends. Such a transport tells what came to the solids instead,
//! as flux along each axis, and a surface with normal n and area s² in the cell gets
//!
//! ```text
//! E(n) = s⁻² · Σ_k n_k² · Φ_k        Φ_k along axis k, towards the surface
//! ```
//!
//! which for walls along the axes is all that arrives, neither more nor less.

use glam::DVec3;

use crate::field::Cell;

/// +x, −x, +y, −y, +z, −z.
const WAYS: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
/// Stands for a cell without a solid.
const NONE: u32 = u32::MAX;

/// What arrived in the cells of an n³ grid, one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrivals {
    n: usize,
    /// By cell, x fastest, where its flux stands.
    places: Vec<u32>,
    /// By way, in W.
    flux: Vec<[f32; 6]>,
}

impl Arrivals {
    /// No solids in n³ cells.
    pub fn new(n: usize) -> Self {
        Arrivals { n, places: vec![NONE; n.pow(3)], flux: Vec::new() }
    }

    /// Sets the flux in W that arrived in a cell with a solid along +x, −x, +y, −y, +z and −z.
    pub fn set(&mut self, cell: Cell, flux: [f32; 6]) {
        let place = self.place(cell);
        self.places[place] = self.flux.len() as u32;
        self.flux.push(flux);
    }

    /// E(n)·s² in W of a surface with unit normal `normal` in a cell; `None` where no solid is.
    pub fn on(&self, cell: Cell, normal: DVec3) -> Option<f64> {
        let flux = self.flux.get(self.places[self.place(cell)] as usize)?;
        let facing = |way: &DVec3| way.dot(normal).min(0.0).powi(2);
        Some(WAYS.iter().zip(flux).map(|(way, flux)| facing(way) * f64::from(*flux)).sum())
    }

    fn place(&self, [x, y, z]: Cell) -> usize {
        (z * self.n + y) * self.n + x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_gets_what_travels_towards_it() {
        let mut arrivals = Arrivals::new(4);
        arrivals.set([1, 2, 3], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        let on = |normal| arrivals.on([1, 2, 3], normal).unwrap();
        assert_eq!([on(DVec3::X), on(DVec3::NEG_X), on(DVec3::Z)], [1.0, 0.0, 5.0]);
        assert!((on(DVec3::new(0.6, -0.8, 0.0)) - (0.36 + 0.64 * 2.0)).abs() < 1e-12);
        assert_eq!(arrivals.on([0, 0, 0], DVec3::X), None);
    }
}
