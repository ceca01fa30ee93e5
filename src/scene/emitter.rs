//! From virtual point lights to light in cells (000, 3.2.2).
//!
//! A virtual point light of flux Φ on a surface with normal n sends the intensity (Φ/π)·max(0, n·u). Its cell holds
//! the lobe c = (Φ/π)·L(n), since ∫L = π: a cell's flux is 2√π·c00 = Φ. (000, 3.2.2) injects Φ·L(n), which is π times
//! too bright and hides in the scale of a renderer. Light that keeps its direction takes the cosine itself, not the
//! two bands of it, and finds it in [`Cosine`].
//!
//! It goes into the cell half a cell off its surface, ⌊(x + s/2·n − origin)/s⌋, so that a wall between two cells
//! lights the one before it.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::DVec3;

use super::Source;
use super::mesh_scene::Injection;
use super::placement::Placement;
use crate::field::Cell;
use crate::mesh::Mesh;
use crate::sh::Sh;

/// A virtual point light: a spot of surface that sends light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// Where it is, in metres.
    pub position: DVec3,
    /// The unit normal of the side that sends.
    pub normal: DVec3,
    /// What it sends in red, green and blue, in W.
    pub flux: [f64; 3],
}

/// Light that leaves a cell as it leaves a surface: (flux/π)·max(0, n·u) along u.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cosine {
    /// The cell.
    pub cell: Cell,
    /// The surface's unit normal, n.
    pub normal: DVec3,
    /// All that it sends, in W.
    pub flux: f64,
}

/// What became of virtual point lights.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Injected {
    /// The light, by colour or, where it is white, at once.
    pub sources: Vec<Source>,
    /// What lies in the volume, by colour, in W.
    pub flux: [f64; 3],
    /// How many virtual point lights lie in the volume.
    pub inside: usize,
}

/// Puts virtual point lights into cells.
pub fn inject(emitters: &[Emitter], placement: &Placement, injection: Injection) -> Injected {
    // By cell and normal: all light that one flat surface sends from one cell is one cosine.
    let mut cosines: BTreeMap<(usize, [u64; 3]), [f64; 3]> = BTreeMap::new();
    let n = placement.size;
    let mut add = |[x, y, z]: Cell, normal: DVec3, flux: [f64; 3]| {
        // Minus zero is the same normal.
        let key = ((z * n + y) * n + x, (normal + DVec3::ZERO).to_array().map(f64::to_bits));
        let sum = cosines.entry(key).or_default();
        (0..3).for_each(|c| sum[c] += flux[c]);
    };
    let (mut flux, mut inside) = ([0.0; 3], 0);
    for emitter in emitters {
        let off = emitter.position + emitter.normal * (placement.cell_side / 2.0);
        let Some(cell) = placement.cell_of(off) else { continue };
        inside += 1;
        (0..3).for_each(|c| flux[c] += emitter.flux[c]);
        match injection {
            Injection::Nearest => add(cell, emitter.normal, emitter.flux),
            Injection::Split => {
                for (cell, weight) in around(placement.in_cells(off), n) {
                    add(cell, emitter.normal, emitter.flux.map(|f| f * weight));
                }
            }
        }
    }
    Injected { sources: sources(&cosines, n), flux, inside }
}

/// The cells around a place, in cells, whose middles it lies between, each with its share; the shares sum to 1.
/// Where one would lie outside the volume the one at the border takes its share.
fn around(place: DVec3, n: usize) -> impl Iterator<Item = (Cell, f64)> {
    let from_middle = place - DVec3::splat(0.5);
    let (low, part) = (from_middle.floor(), from_middle - from_middle.floor());
    (0..8usize).filter_map(move |i| {
        let upper = [i & 1, i >> 1 & 1, i >> 2];
        let weight: f64 = (0..3).map(|k| if upper[k] == 1 { part[k] } else { 1.0 - part[k] }).product();
        let cell = [0, 1, 2].map(|k| (low[k] + upper[k] as f64).clamp(0.0, n as f64 - 1.0) as usize);
        (weight > 0.0).then_some((cell, weight))
    })
}

/// The sources of each colour; one white one where the colours are alike everywhere.
fn sources(cosines: &BTreeMap<(usize, [u64; 3]), [f64; 3]>, n: usize) -> Vec<Source> {
    let white = cosines.values().all(|[red, green, blue]| red == green && green == blue);
    let colors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let colors: &[[f64; 3]] = if white { &[[1.0; 3]] } else { &colors };
    let source = |(c, color): (usize, &[f64; 3])| {
        let mut source = Source { color: *color, ..Source::default() };
        for ((i, normal), flux) in cosines.iter().filter(|(_, flux)| flux[c] > 0.0) {
            let (cell, normal) = ([i % n, i / n % n, i / (n * n)], DVec3::from_array(normal.map(f64::from_bits)));
            let lobe = Sh::lobe(normal) * (flux[c] / PI);
            match source.light.last_mut() {
                Some((last, light)) if *last == cell => *light += lobe,
                _ => source.light.push((cell, lobe)),
            }
            source.cosines.push(Cosine { cell, normal, flux: flux[c] });
        }
        source
    };
    colors.iter().enumerate().map(source).filter(|source| !source.light.is_empty()).collect()
}

/// The virtual point lights of surfaces that emit by themselves: each triangle in pieces no longer than half a cell,
/// of flux Φ = π·L·area on either side.
pub fn glowing(mesh: &Mesh, placement: &Placement) -> Vec<Emitter> {
    let mut emitters = Vec::new();
    for triangle in (0..mesh.len()).filter(|t| mesh.emission(*t).iter().any(|e| *e > 0.0)) {
        let [a, b, c] = mesh.corners(triangle);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let m = (longest / (placement.cell_side / 2.0)).ceil().clamp(1.0, MOST_PIECES as f64) as usize;
        let (area, normal) = (mesh.area(triangle) / (m * m) as f64, mesh.normal(triangle));
        let flux = mesh.emission(triangle).map(|radiance| PI * radiance * area);
        let mut piece = |i: usize, j: usize, third: f64| {
            let position = a + (b - a) * ((i as f64 + third) / m as f64) + (c - a) * ((j as f64 + third) / m as f64);
            emitters.extend([normal, -normal].map(|normal| Emitter { position, normal, flux }));
        };
        for (i, j) in (0..m).flat_map(|i| (0..m - i).map(move |j| (i, j))) {
            piece(i, j, 1.0 / 3.0);
            if i + j + 1 < m {
                piece(i, j, 2.0 / 3.0);
            }
        }
    }
    emitters
}

/// The most pieces along a side of a triangle that glows.
const MOST_PIECES: usize = 256;

#[cfg(test)]
mod tests {
    use super::*;

    fn placement() -> Placement {
        Placement { origin: DVec3::new(-1.0, 0.0, 2.0), cell_side: 0.5, size: 4 }
    }

    #[test]
    fn a_virtual_point_light_goes_half_a_cell_off_its_surface_with_all_its_flux() {
        let flux = [3.0, 2.0, 0.0];
        // On the border between the cells 1 and 2 along x: its normal decides.
        for (normal, x) in [(DVec3::X, 2), (DVec3::NEG_X, 1)] {
            let emitter = Emitter { position: DVec3::new(0.0, 0.6, 2.3), normal, flux };
            let injected = inject(&[emitter], &placement(), Injection::Nearest);
            assert_eq!((injected.flux, injected.inside, injected.sources.len()), (flux, 1, 2));
            for (source, flux) in injected.sources.iter().zip([3.0, 2.0]) {
                let [(cell, light)] = source.light[..] else { panic!("one cell") };
                assert_eq!(cell, [x, 1, 0]);
                assert!((2.0 * PI.sqrt() * light.0[0] - flux).abs() < 1e-12);
                assert!((light.vector().normalize() - normal).length() < 1e-12);
                assert_eq!(source.cosines, [Cosine { cell, normal, flux }]);
            }
        }
        let outside = Emitter { position: DVec3::new(-1.0, 0.6, 2.3), normal: DVec3::NEG_X, flux };
        assert_eq!(inject(&[outside], &placement(), Injection::Nearest), Injected::default());
    }

    #[test]
    fn split_light_keeps_its_flux_and_its_centre() {
        let normal = DVec3::new(0.6, 0.0, 0.8);
        let emitter = Emitter { position: DVec3::new(-0.1, 0.9, 2.7), normal, flux: [2.0; 3] };
        let injected = inject(&[emitter], &placement(), Injection::Split);
        let [source] = &injected.sources[..] else { panic!("white") };
        let (sum, centre) = source.light.iter().fold((0.0, DVec3::ZERO), |(sum, centre), (cell, light)| {
            let flux = 2.0 * PI.sqrt() * light.0[0];
            (sum + flux, centre + placement().middle(*cell) * flux)
        });
        assert!((sum - 2.0).abs() < 1e-12);
        assert!((centre / sum).distance(emitter.position + normal * 0.25) < 1e-12);
        // At the border the light stays inside, all of it.
        let low = Emitter { position: DVec3::new(-0.95, 0.05, 2.05), normal: DVec3::Y, flux: [1.0; 3] };
        let light = &inject(&[low], &placement(), Injection::Split).sources[0].light;
        assert!((light.iter().map(|(_, l)| 2.0 * PI.sqrt() * l.0[0]).sum::<f64>() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_surface_that_glows_sends_pi_times_its_radiance_and_area_to_either_side() {
        use crate::mesh::Material;
        use glam::Vec3;
        let paint = Material { emission: [2.0, 1.0, 0.0], ..Material::grey("") };
        let corners = vec![Vec3::new(-0.9, 1.0, 2.1), Vec3::new(0.9, 1.0, 2.1), Vec3::new(-0.9, 1.0, 3.9)];
        let mesh = Mesh::new(corners, vec![[0, 1, 2]], vec![0], vec![paint]).unwrap();
        let emitters = glowing(&mesh, &placement());
        let flux = inject(&emitters, &placement(), Injection::Nearest).flux;
        let wanted = 2.0 * PI * 2.0 * mesh.area(0);
        assert!((flux[0] / wanted - 1.0).abs() < 1e-9 && (flux[1] / wanted - 0.5).abs() < 1e-9, "{flux:?} {wanted}");
    }
}
