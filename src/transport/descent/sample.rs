//! Sampling leaves: what they hold inside, from their neighbours ([`sampling`]).

use crate::field::{Cell, Grid, Marks, Slabs};
use crate::scene::propagation::descent::Inside;
use crate::sh::{Real, Sh};
use crate::transport::lattice::exact::leaves::Leaves;
use crate::transport::lattice::exact::sampling::{self, Neighbour};
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::kernel::settle;
use crate::transport::lattice::kernel::step::pieces;
use crate::transport::team;

/// The light of leaves: by level and cell.
pub(super) trait Light<T>: Fn(usize, Cell) -> Sh<T> + Sync {}
impl<T, F: Fn(usize, Cell) -> Sh<T> + Sync> Light<T> for F {}

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

/// Splits the marked leaves of level `i`: stores what their children take of their means.
pub(super) fn split<T: Real>(
    leaves: &Leaves<T>,
    light: &impl Light<T>,
    (i, marks): (usize, &Marks),
    finer: &mut Grid<T>,
) {
    let width = f64::from(1u32 << i);
    // Slabs of children end with those of their parents.
    let ends: Vec<usize> = ends(finer.side() / 2).into_iter().map(|end| 2 * end).collect();
    team::share(finer.cut(&ends), |mut finer: Slabs<'_, T>| {
        let parents = finer.range().start / 2..finer.range().end / 2;
        for cell in marks.cells_of(parents) {
            let value = light(i, cell);
            let mean = value.0[0].to_f64();
            let halves = neighbours(leaves, light, (i, cell)).map(|sides| {
                if sides.iter().flatten().all(|there| there.width == width) {
                    sampling::halves_between(width, mean, sides.map(|side| side.map(|there| there.mean)))
                } else {
                    sampling::halves(sampling::slope(width, mean, sides), width)
                }
            });
            for (child, weight) in sampling::children(cell, halves) {
                finer.set(child, settle(value * T::of(weight)));
            }
        }
    });
}

/// Stores the light of leaves coarser than the finest cells in all of those.
pub(super) fn merge<T: Real>(leaves: &Leaves<T>, inside: Inside, light: &impl Light<T>, merged: &mut Grid<T>) {
    let ends = ends(merged.side());
    team::share(merged.cut(&ends), |mut merged: Slabs<'_, T>| {
        let mut room = Room::default();
        for i in leaves.levels().skip(1) {
            let slabs = merged.range().start >> i..((merged.range().end - 1) >> i) + 1;
            for cell in leaves.marks(i).cells_of(slabs) {
                fill(leaves, inside, light, (i, cell), &mut room, &mut merged);
            }
        }
    });
}

/// Room for what the planes of a leaf take of its mean, along each axis, and along x once more.
#[derive(Default)]
struct Room<T> {
    planes: [Vec<f64>; 3],
    along_x: Vec<T>,
}

/// Stores the light of a leaf of level `i` in those of its finest cells that lie in some slabs.
fn fill<T: Real>(
    leaves: &Leaves<T>,
    inside: Inside,
    light: &impl Light<T>,
    (i, cell): (usize, Cell),
    Room { planes, along_x }: &mut Room<T>,
    merged: &mut Slabs<'_, T>,
) {
    let width = 1usize << i;
    let value = light(i, cell);
    let slopes = match inside {
        Inside::Constant => [0.0; 3],
        Inside::Exponential => {
            let mean = value.0[0].to_f64();
            neighbours(leaves, light, (i, cell)).map(|sides| sampling::slope(width as f64, mean, sides))
        }
    };
    planes.iter_mut().zip(slopes).for_each(|(planes, s)| sampling::planes(s, width, planes));
    let [x, y, z] = planes;
    along_x.clear();
    along_x.extend(x.iter().map(|c| T::of(*c)));
    let [from_x, from_y, from_z] = cell.map(|c| c * width);
    let slabs = merged.range();
    for (dz, z) in z.iter().enumerate().filter(|(dz, _)| slabs.contains(&(from_z + dz))) {
        for (dy, y) in y.iter().enumerate() {
            let row = value * T::of(y * z);
            let planes = merged.row_mut(from_x..from_x + width, from_y + dy, from_z + dz);
            for (plane, c) in planes.into_iter().zip(row.0) {
                plane.iter_mut().zip(&*along_x).for_each(|(to, x)| *to = c * *x);
            }
        }
    }
}

/// Where runs of `n` slabs end that threads share: enough of them, as leaves lie anywhere.
fn ends(n: usize) -> Vec<usize> {
    let pieces = pieces(rayon::current_num_threads(), n.pow(3)).min(n);
    (1..=pieces).map(|k| k * n / pieces).collect()
}
