//! The geometry volume: the occluders of a scene as SH blockers, opacities and albedos, on an octree of
//! their own (000, 6.2; NVIDIA's sample; MATH.md section 9).
//!
//! A blocker is a clamped cosine lobe about the surface's normal, scaled by how much of the cell is
//! blocked. Coarser levels hold the mean of their children, so that every level is occluded by its own
//! blockers: a wall one cell thick blocks half as much a level further up.
//!
//! For fuzzy occlusion the volume sits half a cell off the light: blocker g lies at the corner that the
//! light cells g and g + (1, 1, 1) share, so that eight blockers surround a cell, and a wall at x = 9
//! stands between the cells 9 and 10. The coarse blockers do not quite keep to it: the mean of the
//! children lies (2^i − 1)/2 finest cells before the corner that level i takes it to be at.

use crate::field::{Cell, Levels, Octree};
use crate::scene::Solid;
use crate::sh::{Real, Sh};

/// The occluders of a scene on every level.
#[derive(Clone, Debug, PartialEq)]
pub struct GeometryVolume<T> {
    lobes: Octree<T>,
    /// In place of a function on the sphere four numbers that downsample alike: the opacity, and for each
    /// colour the albedo times the opacity.
    surfaces: Octree<T>,
    /// In the same way how much of a cell is blocked along x, y and z.
    covers: Octree<T>,
}

impl<T: Real> GeometryVolume<T> {
    /// The geometry volume of `blockers`, each cell at most once.
    pub fn new(sizes: Levels, solids: &[Solid]) -> Self {
        let [mut lobes, mut surfaces, mut covers] = [(); 3].map(|()| Octree::new(sizes));
        for blocker in solids {
            lobes.level_mut(0).set(blocker.cell, blocker.blocker.cast());
            let weight = blocker.most_opaque();
            let [red, green, blue] = blocker.albedo.map(|albedo| albedo * weight);
            surfaces.level_mut(0).set(blocker.cell, Sh([weight, red, green, blue]).cast());
            let [x, y, z] = blocker.opacity;
            covers.level_mut(0).set(blocker.cell, Sh([x, y, z, 0.0]).cast());
        }
        lobes.downsample();
        surfaces.downsample();
        covers.downsample();
        GeometryVolume { lobes, surfaces, covers }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.lobes.bytes() + self.surfaces.bytes() + self.covers.bytes()
    }

    /// The blocker of a cell.
    pub fn lobe(&self, level: usize, cell: Cell) -> Sh<T> {
        self.lobes.level(level).get(cell)
    }

    /// How much of a cell is blocked along an axis (0 for x, 1 for y, 2 for z), 0 to 1.
    pub fn opacity(&self, level: usize, cell: Cell, axis: usize) -> T {
        self.covers.level(level).get(cell).0[axis]
    }

    /// Whether anything stands in a cell.
    pub fn is_occupied(&self, level: usize, cell: Cell) -> bool {
        self.surfaces.level(level).get(cell).0[0] != T::ZERO
    }

    /// The share of a colour (0 red, 1 green, 2 blue) that is sent back by what is blocked of a cell: on
    /// coarse levels the mean over its occupied children by their opacity, 0 where nothing is blocked.
    pub fn albedo(&self, level: usize, cell: Cell, colour: usize) -> T {
        let surface = self.surfaces.level(level).get(cell).0;
        if surface[0] == T::ZERO { T::ZERO } else { surface[1 + colour] / surface[0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn coarse_levels_hold_the_mean_blocker_and_the_albedo_of_what_is_there() {
        let blocker = |cell, opacity, albedo| Solid::new(cell, DVec3::Y, opacity, albedo);
        let solids = [blocker([2, 1, 0], 1.0, [0.5, 0.0, 1.0]), blocker([3, 0, 1], 0.5, [0.8, 0.0, 0.4])];
        let geometry = GeometryVolume::<f64>::new(Levels::new(4, 1).unwrap(), &solids);
        let lobe = Sh::<f64>::lobe(DVec3::Y);
        assert_eq!(geometry.lobe(0, [3, 0, 1]), lobe * 0.5);
        assert!((geometry.lobe(1, [1, 0, 0]) - lobe * (1.5 / 8.0)).max_norm() < 1e-15);
        assert!((geometry.opacity(1, [1, 0, 0], 2) - 1.5 / 8.0).abs() < 1e-15);
        // (1 · 0.5 + 0.5 · 0.8) / 1.5
        for level in [1, 2] {
            assert!((geometry.albedo(level, [1 >> (level - 1), 0, 0], 0) - 0.6).abs() < 1e-15);
        }
        assert_eq!(geometry.albedo(1, [0, 0, 0], 0), 0.0);
    }
}
