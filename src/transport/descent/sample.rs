//! Sampling leaves: what they hold inside, from their neighbours ([`sampling`]).

use crate::field::{Cell, Grid};
use crate::scene::propagation::descent::Inside;
use crate::sh::{Real, Sh};
use crate::transport::lattice::exact::filter::cells;
use crate::transport::lattice::exact::leaves::Leaves;
use crate::transport::lattice::exact::sampling::{self, Neighbour};
use crate::transport::lattice::face::Direction;

/// The light of leaves: by level and cell.
pub(super) trait Light<T>: Fn(usize, Cell) -> Sh<T> {}
impl<T, F: Fn(usize, Cell) -> Sh<T>> Light<T> for F {}

/// What lies beside a leaf in a direction: its width in finest cells and its c00.
fn neighbour<T: Real>(
    leaves: &Leaves<T>,
    light: &impl Light<T>,
    (i, cell): (usize, Cell),
    d: Direction,
) -> Option<Neighbour> {
    let next = d.neighbour(cell, leaves.marks(i).side())?;
    let width = f64::from(1u32 << i);
    let mean = |level: usize, cell: Cell| light(level, cell).0[0].to_f64();
    if leaves.marks(i).get(next) {
        return Some(Neighbour { width, mean: mean(i, next) });
    }
    let parent = next.map(|c| c / 2);
    if i + 1 < leaves.levels().end && leaves.marks(i + 1).get(parent) {
        return Some(Neighbour { width: 2.0 * width, mean: mean(i + 1, parent) });
    }
    // The four children of `next` that touch the leaf.
    let below = i.checked_sub(1)?;
    let touching = (0..4).map(|k| {
        let mut child = next.map(|c| 2 * c);
        child[d.axis()] += usize::from(!d.is_positive());
        child[(d.axis() + 1) % 3] += k & 1;
        child[(d.axis() + 2) % 3] += k >> 1;
        mean(below, child)
    });
    Some(Neighbour { width: 0.5 * width, mean: 0.25 * touching.sum::<f64>() })
}

/// Along each axis the neighbours at smaller and at larger coordinates.
fn neighbours<T: Real>(leaves: &Leaves<T>, light: &impl Light<T>, leaf: (usize, Cell)) -> [[Option<Neighbour>; 2]; 3] {
    let [px, nx, py, ny, pz, nz] = Direction::ALL.map(|d| neighbour(leaves, light, leaf, d));
    [[nx, px], [ny, py], [nz, pz]]
}

/// What the eight children of a leaf take of its mean.
pub(super) fn children<T: Real>(
    leaves: &Leaves<T>,
    light: &impl Light<T>,
    (i, cell): (usize, Cell),
) -> impl Iterator<Item = (Cell, f64)> {
    let width = f64::from(1u32 << i);
    let mean = light(i, cell).0[0].to_f64();
    let halves = neighbours(leaves, light, (i, cell)).map(|sides| {
        if sides.iter().flatten().all(|there| there.width == width) {
            sampling::halves_between(width, mean, sides.map(|side| side.map(|there| there.mean)))
        } else {
            sampling::halves(sampling::slope(width, mean, sides), width)
        }
    });
    sampling::children(cell, halves)
}

/// Stores the light of leaves coarser than the finest cells in all of those.
pub(super) fn merge<T: Real>(leaves: &Leaves<T>, inside: Inside, light: &impl Light<T>, merged: &mut Grid<T>) {
    for i in leaves.levels().skip(1) {
        let width = 1usize << i;
        for cell in cells(leaves.marks(i)) {
            let value = light(i, cell);
            let slopes = match inside {
                Inside::Constant => [0.0; 3],
                Inside::Exponential => {
                    let mean = value.0[0].to_f64();
                    neighbours(leaves, light, (i, cell)).map(|sides| sampling::slope(width as f64, mean, sides))
                }
            };
            let [x, y, z] = slopes.map(|s| sampling::planes(s, width).collect::<Vec<f64>>());
            let along_x: Vec<T> = x.into_iter().map(T::of).collect();
            for (dz, z) in z.iter().enumerate() {
                for (dy, y) in y.iter().enumerate() {
                    let row = value * T::of(y * z);
                    let planes = merged.row_mut(cell[1] * width + dy, cell[2] * width + dz);
                    for (plane, c) in planes.into_iter().zip(row.0) {
                        let to = &mut plane[cell[0] * width..][..width];
                        to.iter_mut().zip(&along_x).for_each(|(to, x)| *to = c * *x);
                    }
                }
            }
        }
    }
}
