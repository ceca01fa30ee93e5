//! Light that is known by patches of the surface, for places between them.
//!
//! A transport that keeps directions tells what each patch receives. A place takes the light of the patch in its cell
//! that looks most the way that it does; or, smoothly, of such patches in the eight nearest cells, each by its share of
//! a trilinear sample.

use std::collections::HashMap;

use glam::DVec3;

use super::cells::cell_of;
use super::rgb::{Rgb, add};
use super::surface::Patches;
use crate::field::Cell;
use crate::scene::placement::Placement;

/// The least cosine between the normals of a place and of a patch whose light it may take.
const LIKE: f64 = 0.5;

/// The irradiance [W/m²] of every patch, to be looked up by place.
#[derive(Clone, Debug)]
pub struct PatchLight<'a> {
    patches: &'a Patches,
    placement: &'a Placement,
    of_cell: HashMap<Cell, Vec<usize>>,
    irradiance: Vec<Rgb>,
    smooth: bool,
}

impl<'a> PatchLight<'a> {
    /// The light of patches; `smooth` to pass from one to the next without a step.
    pub fn new(patches: &'a Patches, placement: &'a Placement, irradiance: Vec<Rgb>, smooth: bool) -> Self {
        let mut of_cell: HashMap<Cell, Vec<usize>> = HashMap::new();
        for (i, patch) in patches.all().iter().enumerate().take(irradiance.len()) {
            of_cell.entry(patch.cell).or_default().push(i);
        }
        PatchLight { patches, placement, of_cell, irradiance, smooth }
    }

    /// The irradiance of every patch.
    pub fn patches(&self) -> &[Rgb] {
        &self.irradiance
    }

    /// The irradiance of a place with unit normal `normal`; none where no patch is near that looks its way.
    pub fn at(&self, at: DVec3, normal: DVec3) -> Rgb {
        let place = self.placement.in_cells(at);
        let nearest = || {
            let cell = cell_of(place, self.placement.size)?;
            self.patch(cell, normal).map(|i| self.irradiance[i])
        };
        if !self.smooth {
            return nearest().unwrap_or_default();
        }
        let low = (place - 0.5).floor();
        let part = place - 0.5 - low;
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for corner in 0..8usize {
            let upper = |axis: usize| corner >> axis & 1;
            let along = |axis: usize| if upper(axis) == 1 { part[axis] } else { 1.0 - part[axis] };
            let cell = DVec3::from_array(std::array::from_fn(|axis| low[axis] + upper(axis) as f64 + 0.5));
            let weight = along(0) * along(1) * along(2);
            let patch = cell_of(cell, self.placement.size).and_then(|cell| self.patch(cell, normal));
            if let Some(i) = patch.filter(|_| weight > 0.0) {
                sum = add(sum, self.irradiance[i].map(|e| e * weight));
                weights += weight;
            }
        }
        if weights > 0.0 { sum.map(|e| e / weights) } else { nearest().unwrap_or_default() }
    }

    /// The patch of a cell that looks most along `normal`.
    fn patch(&self, cell: Cell, normal: DVec3) -> Option<usize> {
        let cosine = |i: &usize| self.patches.all()[*i].normal.dot(normal);
        let here = self.of_cell.get(&cell)?.iter().copied();
        here.filter(|i| cosine(i) > LIKE).max_by(|a, b| cosine(a).total_cmp(&cosine(b)))
    }
}
