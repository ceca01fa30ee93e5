//! A volume tiled by cells of an octree, and what one finest step is between them.
//!
//! Every point of the volume lies in one *leaf*, a cell of some level; leaves that share a face are of the same level
//! or of neighbouring ones. A leaf of V = 8^i finest cells holds the mean a of its light. One finest step, with the
//! planes next to each face as [`super::decay::Decay::face`] has them, is
//!
//! ```text
//! V·a' = V·T·a + Σ_faces A·(M_in·beyond − M_out·own)
//! ```
//!
//! A the face in finest faces and T = Σ_d M_d: what stays in the cell, plus what crosses. All leaves at level 0 is the
//! uniform volume; all at level i is P_i of [`super`]. [`super::crossing`] turns a face into four numbers, so that the
//! whole is, per leaf, a part D that stays in it and the rest from its neighbours:
//!
//! ```text
//! P·a = D·a + off·a            D = T + own parts of the faces
//! ```
//!
//! D couples c00 with the direction only (β and γ of the faces), so (I − D)⁻¹ is found by putting the directions into
//! the equation of c00.
//!
//! Most leaves have six neighbours of their own size: *inner* ones, for which D is a number for each band. They lie in
//! runs along x. The others, at the border of the volume, beside another level or a wall, are *seams*.

use std::ops::Range;

use super::crossing::{Crossing, Pass};
use super::decay::Decay;
use super::filter::cells;
use super::walls::{Open, Walls};
use super::within::{Own, Within};
use crate::field::{Cell, Layout, Marks, row_mask};
use crate::sh::Real;
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::kernel::form::Share;

/// How the fixed point a = q + P·a is iterated. Both ways lead to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// a ← q + P·a: every iteration is one finest step, on every level.
    InStep,
    /// a ← (I − D)⁻¹(q + off·a): light that stays in its leaf is summed up at once. Fewer iterations, and the light
    /// is ahead of what so many finest steps would give.
    Ahead,
}

/// The leaves of a volume, by level, with the operator between them.
#[derive(Clone, Debug)]
pub struct Leaves<T> {
    tiers: Vec<Tier<T>>,
    /// The level of the first of them.
    first: usize,
    way: Way,
    share: Share<T>,
}

/// The leaves of one level.
#[derive(Clone, Debug)]
pub struct Tier<T> {
    /// Where they are.
    pub(super) marks: Marks,
    pub(super) count: usize,
    /// All of them as runs.
    pub(super) all: Vec<Run>,
    pub(super) inner: Inner<T>,
    /// The inner ones.
    pub(super) runs: Vec<Run>,
    pub(super) seams: Vec<Seam<T>>,
}

/// What an inner leaf takes: a neighbour's share, and what stays, for c00 and for the direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inner<T> {
    pub(super) share: Share<T>,
    pub(super) stay: [T; 2],
    /// (I − D)⁻¹ when ahead, 1 in step: what a source is multiplied with.
    pub(super) residence: [T; 2],
}

/// Inner leaves in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) at: usize,
    pub(super) length: usize,
}

/// A leaf at the border of the volume or beside another level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seam<T> {
    /// Its place in the planes of its level.
    pub(super) at: u32,
    /// What lies beyond its faces, in the order of [`Direction::ALL`].
    pub(super) sides: [Side; 6],
    /// What of it comes in: the multiples of the even and of the odd numbers of the share.
    pub(super) passes: [[T; 2]; 6],
    /// D.
    pub(super) within: Within<T>,
}

/// What lies beyond a face; places are those in the planes of the neighbour's level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Dark,
    Same(u32),
    Coarser(u32),
    /// The first of four.
    Finer(u32),
}

impl<T: Real> Leaves<T> {
    /// All cells of level `level`, of the given side; no other level has leaves.
    pub fn uniform(share: &Share<f64>, way: Way, level: usize, side: usize, walls: &dyn Walls) -> Self {
        let mut all = Marks::new(side);
        all.words_mut().fill(row_mask(side));
        Self::from_level(share, way, level, vec![all], walls)
    }

    /// The leaves that `marks` tells, one set a level, the finest first: they must tile the volume, and leaves that
    /// share a face must be of the same level or of neighbouring ones. `share` is that of one finest step.
    pub fn new(share: &Share<f64>, way: Way, marks: Vec<Marks>) -> Self {
        Self::from_level(share, way, 0, marks, &Open)
    }

    /// As [`Self::new`], with walls that stand in the way.
    pub fn among(share: &Share<f64>, way: Way, marks: Vec<Marks>, walls: &dyn Walls) -> Self {
        Self::from_level(share, way, 0, marks, walls)
    }

    fn from_level(share: &Share<f64>, way: Way, first: usize, marks: Vec<Marks>, walls: &dyn Walls) -> Self {
        let decay = Decay::of(share);
        let tier = |at: usize| Tier::new((share, &decay, way), first + at, &marks, at, walls);
        Leaves { tiers: (0..marks.len()).map(tier).collect(), first, way, share: cast(share) }
    }

    /// The leaves of level `i`.
    pub fn marks(&self, i: usize) -> &Marks {
        &self.tier(i).marks
    }

    /// The levels that may have leaves.
    pub fn levels(&self) -> Range<usize> {
        self.first..self.first + self.tiers.len()
    }

    /// Whether a cell of level `i` is a leaf or lies in a coarser one.
    pub fn is_whole(&self, i: usize, cell: Cell) -> bool {
        (i..self.levels().end).any(|k| self.marks(k).get(cell.map(|c| c >> (k - i))))
    }

    /// How many leaves there are, on all levels.
    pub fn count(&self) -> usize {
        self.tiers.iter().map(|tier| tier.count).sum()
    }

    /// How it is iterated.
    pub fn way(&self) -> Way {
        self.way
    }

    pub(super) fn tier(&self, i: usize) -> &Tier<T> {
        &self.tiers[i - self.first]
    }

    pub(super) fn share(&self) -> &Share<T> {
        &self.share
    }

    /// Bytes that [`Self::uniform`] takes.
    pub fn bytes_of_uniform(level: usize, side: usize) -> u64 {
        // At level 0 there are no seams; above, the border of the cube is.
        let border = if level == 0 { 0 } else { side.pow(3) - side.saturating_sub(2).pow(3) };
        let rows = side * side;
        (border * size_of::<Seam<T>>() + rows * (2 * size_of::<Run>() + side.div_ceil(64) * size_of::<u64>())) as u64
    }

    /// Bytes of memory it holds.
    pub fn bytes(&self) -> usize {
        let tier = |tier: &Tier<T>| {
            size_of_val(tier.marks.words())
                + (tier.all.capacity() + tier.runs.capacity()) * size_of::<Run>()
                + tier.seams.capacity() * size_of::<Seam<T>>()
        };
        self.tiers.iter().map(tier).sum()
    }
}

impl<T: Real> Tier<T> {
    /// The leaves of level `level`, which `marks` has at `i`.
    fn new(
        (share, decay, way): (&Share<f64>, &Decay, Way),
        level: usize,
        marks: &[Marks],
        i: usize,
        walls: &dyn Walls,
    ) -> Self {
        let here = &marks[i];
        let open = Faces::new(decay, level);
        let inner = Inner::new(share, way, open.to[1]);
        let [mut enclosed, mut others] = split(here, level == 0);
        if walls.any() {
            for cell in cells(here).filter(|cell| is_walled(walls, level, *cell, here.side())) {
                enclosed.put(cell, false);
                others.set(cell);
            }
        }
        let seam = |cell| Seam::new((share, decay, &open), level, (marks, i), cell, walls);
        let seams = cells(&others).map(seam).collect();
        Tier { marks: here.clone(), count: here.count(), all: runs(here), inner, runs: runs(&enclosed), seams }
    }
}

/// What crosses the faces of a leaf where nothing stands in the way.
struct Faces {
    /// To a finer, an equal and a coarser leaf.
    to: [Crossing; 3],
    /// To the dark outside.
    outside: Crossing,
}

impl Faces {
    fn new(decay: &Decay, level: usize) -> Self {
        let h = width(level);
        // Level 0 has no finer one.
        let finer = if level == 0 { Crossing::default() } else { Crossing::between(decay, h, 0.5 * h) };
        let to = [finer, Crossing::between(decay, h, h), Crossing::between(decay, h, 2.0 * h)];
        Faces { to, outside: Crossing::open(decay, h) }
    }
}

/// The width of a cell of a level, in finest cells.
fn width(level: usize) -> f64 {
    f64::from(1u32 << level)
}

/// Whether anything stands in the way of light that enters a cell or one of its neighbours.
fn is_walled(walls: &dyn Walls, level: usize, cell: Cell, n: usize) -> bool {
    let shut = |cell| (0..3).any(|axis| walls.passes(level, cell, axis) < 1.0);
    shut(cell) || Direction::ALL.iter().any(|d| d.neighbour(cell, n).is_some_and(shut))
}

impl<T: Real> Inner<T> {
    fn new(share: &Share<f64>, way: Way, same: Crossing) -> Self {
        let Pass { even, odd } = same.beyond;
        // T·(1 − θe): of three axes, each with two faces.
        let stay = [6.0 * share.alpha, 2.0 * share.delta + 4.0 * share.epsilon].map(|t| t * (1.0 - even));
        let (residence, stay) = match way {
            Way::InStep => ([1.0; 2], stay),
            Way::Ahead => (stay.map(|s| 1.0 / (1.0 - s)), [0.0; 2]),
        };
        // The share is that of light on its way here: against the outward direction.
        let share = Share {
            alpha: even * share.alpha * residence[0],
            beta: -odd * share.beta * residence[0],
            gamma: -odd * share.gamma * residence[1],
            delta: even * share.delta * residence[1],
            epsilon: even * share.epsilon * residence[1],
        };
        Inner { share: cast(&share), stay: stay.map(T::of), residence: residence.map(T::of) }
    }
}

impl<T: Real> Seam<T> {
    /// A leaf of level `level`, which `marks` has at `i`.
    fn new(
        (share, decay, open): (&Share<f64>, &Decay, &Faces),
        level: usize,
        (marks, i): (&[Marks], usize),
        cell: Cell,
        walls: &dyn Walls,
    ) -> Self {
        let (here, h) = (&marks[i], width(level));
        let place = |marks: &Marks, cell| Layout::new(marks.side()).index(cell) as u32;
        let mut own = [Own::default(); 3];
        let faces = Direction::ALL.map(|d| {
            let (axis, up) = (d.axis(), d.is_positive());
            let own = &mut own[axis];
            let mut meets = |crossing: Crossing, times: f64| {
                own.even += times * crossing.own.even;
                own.odd += times * if up { crossing.own.odd } else { -crossing.own.odd };
                [T::of(crossing.beyond.even), T::of(crossing.beyond.odd)]
            };
            let Some(next) = d.neighbour(cell, here.side()) else {
                return (Side::Dark, meets(open.outside, 1.0));
            };
            // What lies beyond: its level, the cells that touch the face, and how the loops find them.
            let parent = next.map(|c| c / 2);
            let (coarser, touching, count, side) = if here.get(next) {
                (1, [next; 4], 1, Side::Same(place(here, next)))
            } else if let Some(above) = marks.get(i + 1).filter(|above| above.get(parent)) {
                (2, [parent; 4], 1, Side::Coarser(place(above, parent)))
            } else {
                let mut first = next.map(|c| 2 * c);
                first[axis] += usize::from(!up);
                let four = [0, 1, 2, 3].map(|k| {
                    let mut child = first;
                    child[(axis + 1) % 3] += k & 1;
                    child[(axis + 2) % 3] += k >> 1;
                    child
                });
                (0, four, 4, Side::Finer(place(&marks[i - 1], first)))
            };
            if !walls.any() {
                return (side, meets(open.to[coarser], f64::from(count)));
            }
            let (other, touching) = (level + coarser - 1, &touching[..count as usize]);
            let mean = |of: &dyn Fn(Cell) -> f64| touching.iter().map(|cell| of(*cell)).sum::<f64>() / f64::from(count);
            let enters = walls.passes(level, cell, axis);
            let leaves = mean(&|cell| walls.passes(other, cell, axis));
            let pass = meets(Crossing::behind(decay, h, width(other), [enters, leaves]), f64::from(count));
            if leaves < 1.0 {
                let mirrored = mean(&|cell| (1.0 - walls.passes(other, cell, axis)) * walls.mirrors(other, cell));
                own.mirrored[usize::from(!up)] = enters * mirrored * decay.border(h) / h;
            }
            (side, pass)
        });
        let within = Within::new(share, own);
        Seam { at: place(here, cell), sides: faces.map(|(side, _)| side), passes: faces.map(|(_, pass)| pass), within }
    }
}

/// The marked cells with six marked neighbours, and the other marked ones. At level 0 (`border_is_inner`) what lies
/// outside is as good as a marked neighbour: it is dark, and a finest cell loses the same to it.
fn split(marks: &Marks, border_is_inner: bool) -> [Marks; 2] {
    let (n, per_row) = (marks.side(), marks.words_per_row());
    let (mut inner, mut seams) = (Marks::new(n), Marks::new(n));
    let words = marks.words();
    let outside = if border_is_inner { u64::MAX } else { 0 };
    let word = |y: Option<usize>, z: Option<usize>, w: usize| match (y.filter(|y| *y < n), z.filter(|z| *z < n)) {
        (Some(y), Some(z)) => words[(z * n + y) * per_row + w],
        _ => outside,
    };
    for (row, (z, y)) in (0..n).flat_map(|z| (0..n).map(move |y| (z, y))).enumerate() {
        for w in 0..per_row {
            let here = word(Some(y), Some(z), w);
            if here == 0 {
                continue;
            }
            let (first, last) = (w == 0, w + 1 == per_row);
            let before = if first { outside } else { word(Some(y), Some(z), w - 1) };
            let after = if last { outside } else { word(Some(y), Some(z), w + 1) };
            let end = if last { (n - 1) % 64 } else { 63 };
            let below = here << 1 | before >> 63;
            let above = here >> 1 & !(1 << end) | (after & 1) << end;
            let beside = word(y.checked_sub(1), Some(z), w)
                & word(Some(y + 1), Some(z), w)
                & word(Some(y), z.checked_sub(1), w)
                & word(Some(y), Some(z + 1), w);
            let enclosed = here & below & above & beside;
            inner.words_mut()[row * per_row + w] = enclosed;
            seams.words_mut()[row * per_row + w] = here & !enclosed;
        }
    }
    [inner, seams]
}

/// The marked cells as runs along x, in the order of memory.
fn runs(marks: &Marks) -> Vec<Run> {
    let (n, per_row) = (marks.side(), marks.words_per_row());
    let layout = Layout::new(n);
    let mut runs: Vec<Run> = Vec::new();
    for (i, word) in marks.words().iter().enumerate() {
        let (row, w) = (i / per_row, i % per_row);
        let mut left = *word;
        while left != 0 {
            let from = left.trailing_zeros();
            let length = (left >> from).trailing_ones();
            left &= if from + length == 64 { 0 } else { u64::MAX << (from + length) };
            let at = layout.index([64 * w + from as usize, row % n, row / n]);
            match runs.last_mut() {
                // The next word goes on where this one ended.
                Some(run) if from == 0 && w > 0 && run.at + run.length == at => run.length += length as usize,
                _ => runs.push(Run { at, length: length as usize }),
            }
        }
    }
    runs
}

fn cast<T: Real>(share: &Share<f64>) -> Share<T> {
    Share {
        alpha: T::of(share.alpha),
        beta: T::of(share.beta),
        gamma: T::of(share.gamma),
        delta: T::of(share.delta),
        epsilon: T::of(share.epsilon),
    }
}

#[cfg(test)]
mod tests {
    use super::super::decay::Face;
    use super::*;
    use crate::scene::propagation::Policy;
    use crate::transport::lattice::kernel::form::Form;
    use crate::transport::lattice::levels;
    use crate::transport::lattice::schemes::cascaded;

    #[test]
    fn planes_that_hold_their_cells_mean_give_the_consistent_levels() {
        let consistent = levels::operators::<f64>(&cascaded::scheme(), 3.0, false, Policy::Consistent, 5).unwrap();
        let share = Form::of(&consistent[0].stencil).unwrap().share;
        let even = Face { left: [1.0, 0.0], right: [0.0, 1.0] };
        for (i, level) in consistent.iter().enumerate() {
            let h = f64::from(1u32 << i);
            let inner = Inner::<f64>::new(&share, Way::Ahead, Crossing::through(even, h, h));
            let wanted = Form::of(&level.stencil).unwrap().share;
            let numbers = |s: Share<f64>| [s.alpha, s.beta, s.gamma, s.delta, s.epsilon];
            for (found, wanted) in numbers(inner.share).iter().zip(numbers(wanted)) {
                assert!((found - wanted).abs() < 1e-15, "level {i}: {found}, {wanted}");
            }
            assert!((0..2).all(|band| (inner.residence[band] - level.residence[band]).abs() < 1e-14));
        }
    }

    #[test]
    fn runs_and_seams_are_all_leaves_and_runs_have_six_neighbours() {
        for n in [1usize, 4, 16, 128] {
            let mut marks = Marks::new(n);
            let layout = Layout::new(n);
            for cell in layout.cells().filter(|[x, y, z]| (x * 7 + y * y + z) % 11 != 3) {
                marks.set(cell);
            }
            let mut covered = vec![false; layout.plane_len()];
            for run in runs(&marks) {
                covered[run.at..run.at + run.length].fill(true);
            }
            assert!(layout.cells().all(|cell| covered[layout.index(cell)] == marks.get(cell)));
            assert_eq!(covered.iter().filter(|c| **c).count(), marks.count());
            for border_is_inner in [false, true] {
                let [inner, seams] = split(&marks, border_is_inner);
                for cell in layout.cells() {
                    let enclosed = Direction::ALL
                        .iter()
                        .all(|d| d.neighbour(cell, n).map_or(border_is_inner, |next| marks.get(next)));
                    assert_eq!(inner.get(cell), marks.get(cell) && enclosed, "n = {n}, {cell:?}");
                    assert_eq!(seams.get(cell), marks.get(cell) && !enclosed);
                }
            }
        }
    }
}
