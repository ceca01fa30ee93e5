//! All the way of all light of one octant, in one pass through the cells in the order of the wind.
//!
//! A cell's three downwind neighbours are visited after it, so all that must be kept of the flux is what
//! is under way: one row along x, one row of y faces, one slab of z faces. Directions lie side by side in
//! the lanes. Cells that are not downwind of any light are left out.

use std::ops::Range;

use multiversion::multiversion;

use super::receive::Facing;
use super::surfaces::ByCell;
use super::{Group, LANES, Lanes, Octant};
use crate::field::{Cell, Grid, Marks};
use crate::scene::propagation::directions::Rule;
use crate::sh::{K0, K1, Real, Sh};
use crate::transport::lattice::kernel::FLOOR;
use crate::transport::transmittance::Transmittance;

/// What is sent: light of cells, and light of surfaces.
#[derive(Debug)]
pub(super) struct Sent<'a, T> {
    pub cells: &'a Grid<T>,
    pub surfaces: &'a ByCell<'a, T>,
    lit: Vec<Range<usize>>,
}

impl<'a, T: Real> Sent<'a, T> {
    pub fn new(cells: &'a Grid<T>, surfaces: &'a ByCell<'a, T>) -> Self {
        Sent { cells, surfaces, lit: lit_rows(cells, surfaces.cells(cells.side())) }
    }
}

/// What is asked of a sweep.
#[derive(Debug)]
pub(super) struct Got<'a, T> {
    /// What arrives in each cell is added to it.
    pub arrived: &'a mut Grid<T>,
    pub receivers: &'a Facing,
    /// What each receiver gets is added to its number.
    pub received: &'a mut [f64],
}

/// Where light is sent: for every row (y, z), y fastest, the cells from its first to its last lit one.
fn lit_rows<T: Real>(grid: &Grid<T>, more: impl Iterator<Item = Cell>) -> Vec<Range<usize>> {
    let mut lit = Marks::new(grid.side());
    lit.mark_lit(grid);
    more.for_each(|cell| lit.set(cell));
    let row = |words: &[u64]| {
        let first = words.iter().position(|word| *word != 0).map(|w| 64 * w + words[w].trailing_zeros() as usize);
        let end = words.iter().rposition(|word| *word != 0).map(|w| 64 * (w + 1) - words[w].leading_zeros() as usize);
        first.unwrap_or(grid.side())..end.unwrap_or(grid.side())
    };
    lit.words().chunks_exact(lit.words_per_row()).map(row).collect()
}

/// Takes the light of one octant all its way; `under_way` is memory to use.
pub(super) fn sweep<T: Real>(
    octant: &Octant<T>,
    rule: Rule,
    sent: &Sent<'_, T>,
    occluders: Option<&Transmittance>,
    under_way: &mut Vec<Lanes<T>>,
    got: &mut Got<'_, T>,
) {
    if !octant.groups.is_empty() {
        best(octant, rule, sent, occluders, under_way, got);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+bmi2", "x86_64+avx2+bmi2", "aarch64+neon"))]
fn best<T: Real>(
    octant: &Octant<T>,
    rule: Rule,
    sent: &Sent<'_, T>,
    occluders: Option<&Transmittance>,
    under_way: &mut Vec<Lanes<T>>,
    got: &mut Got<'_, T>,
) {
    match rule {
        Rule::Donor => any::<T, true>(octant, sent, occluders, under_way, got),
        Rule::Faces => any::<T, false>(octant, sent, occluders, under_way, got),
    }
}

#[inline(always)]
fn any<T: Real, const DONOR: bool>(
    octant: &Octant<T>,
    sent: &Sent<'_, T>,
    occluders: Option<&Transmittance>,
    under_way: &mut Vec<Lanes<T>>,
    got: &mut Got<'_, T>,
) {
    let layout = sent.cells.layout();
    let n = layout.side();
    let groups = &octant.groups;
    let along = |axis: usize, i: usize| if octant.backwards[axis] { n - 1 - i } else { i };
    let dark = [T::ZERO; LANES];
    under_way.clear();
    under_way.resize((n * n + n + 1) * groups.len(), dark);
    let (by_z, rest) = under_way.split_at_mut(n * n * groups.len());
    let (by_y, by_x) = rest.split_at_mut(n * groups.len());
    let Got { arrived, receivers, received } = got;
    let sums = arrived.planes_mut();
    // From which cell on, in the order of the wind, the rows of the last slab may be lit.
    let mut slab_from = vec![n; n];
    for zi in 0..n {
        by_y.fill(dark);
        let mut row_from = n;
        for yi in 0..n {
            by_x.fill(dark);
            let by_z = &mut by_z[yi * n * groups.len()..][..n * groups.len()];
            let lit = &sent.lit[along(2, zi) * n + along(1, yi)];
            let own_from = match octant.backwards[0] {
                false => lit.start,
                true if lit.is_empty() => n,
                true => n - lit.end,
            };
            row_from = row_from.min(slab_from[yi]).min(own_from);
            slab_from[yi] = row_from;
            for xi in row_from..n {
                let cell = [along(0, xi), along(1, yi), along(2, zi)];
                let at = layout.index(cell);
                let number = (cell[2] * n + cell[1]) * n + cell[0];
                let light = if lit.contains(&cell[0]) { sent.cells.at(at) } else { Sh::ZERO };
                let (lit, sides) = (!light.is_zero(), sent.surfaces.of(number));
                let faces = receivers.of(number);
                let [enters, exits] =
                    occluders.map_or([[T::of(1.0); 3]; 2], |occluders| occluders.ends(cell, octant.backwards));
                let ahead = xi * groups.len()..(xi + 1) * groups.len();
                let under_way = by_x.iter_mut().zip(&mut by_y[ahead.clone()]).zip(&mut by_z[ahead]);
                let mut sum = [dark; 4];
                for (group, ((x, y), z)) in groups.iter().zip(under_way) {
                    let own = if lit { group.sent(light) } else { dark };
                    let (came, mut free) = ([*x, *y, *z], [dark; 3]);
                    let mut leaves = group.cross::<DONOR>(came, own, enters, &mut sum);
                    group.leave(sides, &mut free, &mut leaves);
                    receivers.receive(faces, octant.backwards, group, [&came, &leaves], received);
                    for (axis, ahead) in [x, y, z].into_iter().enumerate() {
                        for (l, ahead) in ahead.iter_mut().enumerate() {
                            *ahead = leaves[axis][l] * exits[axis] + free[axis][l];
                        }
                    }
                }
                sums[0][at] += T::of(K0) * total(sum[0]);
                for c in 1..4 {
                    sums[c][at] += T::of(K1) * total(sum[c]);
                }
            }
        }
    }
}

impl<T: Real> Group<T> {
    /// What a cell that holds `light` sends in each direction.
    #[inline(always)]
    pub(super) fn sent(&self, light: Sh<T>) -> Lanes<T> {
        let Sh([c00, x, y, z]) = light;
        let (mean, [x, y, z]) = (T::of(K0) * c00, [x, y, z].map(|c| T::of(K1) * c));
        let mut sent = [T::ZERO; LANES];
        for (l, sent) in sent.iter_mut().enumerate() {
            let value = mean + (x * self.way[0][l] + y * self.way[1][l] + z * self.way[2][l]);
            *sent = value.max(T::ZERO) * self.weight[l];
        }
        sent
    }

    /// Takes the flux that comes in by the low faces through a cell: adds it to `sum`, as Σ F and
    /// Σ F·u, and returns what leaves by the far faces.
    #[inline(always)]
    pub(super) fn cross<const DONOR: bool>(
        &self,
        came: [Lanes<T>; 3],
        sent: Lanes<T>,
        passes: [T; 3],
        sum: &mut [Lanes<T>; 4],
    ) -> [Lanes<T>; 3] {
        let mut leaves = [[T::ZERO; LANES]; 3];
        for l in 0..LANES {
            // The next cell along x waits for what comes of the first.
            let flux = came[0][l] + (came[1][l] + came[2][l]);
            sum[0][l] += flux;
            let passed = [0, 1, 2].map(|k: usize| came[k][l] * passes[k]);
            for j in 0..3 {
                sum[1 + j][l] += flux * self.way[j][l];
                let left = if DONOR {
                    self.start[j][l] * (passed[0] + (passed[1] + passed[2]) + sent[l])
                } else {
                    self.through[0][j][l] * passed[0]
                        + self.through[1][j][l] * passed[1]
                        + self.through[2][j][l] * passed[2]
                        + self.start[j][l] * sent[l]
                };
                // Beams fade sideways without end; denormal numbers would cost more than all the rest.
                leaves[j][l] = if left < T::of(FLOOR) { T::ZERO } else { left };
            }
        }
        leaves
    }
}

/// The sum over the lanes, in an order that every instruction set keeps.
#[inline(always)]
fn total<T: Real>(lanes: Lanes<T>) -> T {
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
