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
//! runs along x. The others, at the border of the volume, beside another level or a wall, are *seams*. Of those too there
//! are few sorts: what comes in through a face and what stays depends on what lies beyond the six faces, not on where.
//! A seam therefore names its [`Meeting`], which it shares with all that meet the same. Leaves that fuzzy occluders touch
//! have matrices of their own ([`super::touched`]).

use std::ops::Range;

use super::crossing::{Crossing, Pass};
use super::decay::Decay;
use super::meeting::{Face, Faces, Meeting, Meetings, is_walled};
use super::touched::{Around, Touched};
use super::walls::{Open, Walls};
use crate::field::{Cell, Layout, Marks, row_mask};
use crate::sh::Real;
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::kernel::form::Share;
use crate::transport::lattice::kernel::step::pieces;
use crate::transport::team;

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
    /// The others, in the order of memory.
    pub(super) seams: Vec<Seam>,
    /// Those that fuzzy occluders touch, which are neither inner ones nor seams, in the order of memory.
    pub(super) touched: Vec<Touched<T>>,
    /// What seams meet.
    pub(super) meetings: Vec<Meeting<T>>,
    /// How much there is to do up to the end of every slab of the level, in inner leaves' worth.
    pub(super) work: Vec<usize>,
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

/// A leaf at the border of the volume, beside another level or a wall. Places are those in the planes of a level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seam {
    pub(super) at: u32,
    /// Which of the tier's meetings it is.
    pub(super) meeting: u32,
    /// Where the light beyond its faces is, in the planes of that level; of four finer leaves the first. In the order of
    /// [`Direction::ALL`].
    pub(super) sides: [u32; 6],
}

/// How many inner leaves take the time of a seam, or of one that is touched, about.
const SEAM: usize = 16;

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
        Self::from_level(share, way, 0, marks, &Open(None))
    }

    /// As [`Self::new`], with walls that stand in the way.
    pub fn among(share: &Share<f64>, way: Way, marks: Vec<Marks>, walls: &dyn Walls) -> Self {
        Self::from_level(share, way, 0, marks, walls)
    }

    fn from_level(share: &Share<f64>, way: Way, first: usize, marks: Vec<Marks>, walls: &dyn Walls) -> Self {
        let decay = Decay::of(share);
        let tier = |at: usize| Tier::new((share, &decay, way), first + at, &marks, at, walls);
        Leaves { tiers: (0..marks.len()).map(tier).collect(), first, way }
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

    /// Bytes that [`Self::uniform`] takes.
    pub fn bytes_of_uniform(level: usize, side: usize) -> u64 {
        // At level 0 there are no seams; above, the border of the cube is.
        let border = if level == 0 { 0 } else { side.pow(3) - side.saturating_sub(2).pow(3) };
        let rows = side * side;
        (border * size_of::<Seam>() + rows * (2 * size_of::<Run>() + side.div_ceil(64) * size_of::<u64>())) as u64
    }

    /// Bytes of memory it holds.
    pub fn bytes(&self) -> usize {
        let tier = |tier: &Tier<T>| {
            size_of_val(tier.marks.words())
                + (tier.all.capacity() + tier.runs.capacity()) * size_of::<Run>()
                + tier.seams.capacity() * size_of::<Seam>()
                + tier.touched.capacity() * size_of::<Touched<T>>()
                + tier.meetings.capacity() * size_of::<Meeting<T>>()
                + tier.work.capacity() * size_of::<usize>()
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
        let inner = Inner::new(share, way, Faces::new(decay, level).to[1]);
        let [mut enclosed, mut others] = split(here, level == 0);
        if walls.any() {
            for cell in here.cells().filter(|cell| is_walled(walls, level, *cell, here.side())) {
                enclosed.put(cell, false);
                others.set(cell);
            }
        }
        let layout = Layout::new(here.side());
        let faces = |cell| Direction::ALL.map(|d| Face::of(marks, i, cell, d));
        let is_touched: Vec<Cell> = match walls.blockers() {
            Some(blockers) => blockers.touched(level).iter().copied().filter(|cell| here.get(*cell)).collect(),
            None => Vec::new(),
        };
        for cell in &is_touched {
            enclosed.put(*cell, false);
            others.set(*cell);
        }
        let work = work(&enclosed, &others);
        is_touched.iter().for_each(|cell| others.put(*cell, false));
        let longest = inner.residence.map(T::to_f64).into_iter().fold(1.0, f64::max);
        let residence = (way == Way::Ahead).then_some(longest);
        let touched = walls.blockers().map(|blockers| {
            let around = Around { blockers, decay, level, residence };
            let leaf = |cell: &Cell| around.leaf(*cell, layout.index(*cell) as u32, &faces(*cell));
            is_touched.iter().filter_map(leaf).collect()
        });
        let touched = touched.unwrap_or_default();
        let meetings = || Meetings::new(share, decay, level, walls);
        let (seams, meetings) = seams(&others, &faces, &meetings);
        let (count, all, runs) = (here.count(), runs(here), runs(&enclosed));
        Tier { marks: here.clone(), count, all, inner, runs, seams, touched, meetings, work }
    }
}

/// The marked leaves as seams, with what they meet. Threads go through them slab by slab, and what two of them meet alike
/// is kept twice.
fn seams<'a, T: Real>(
    marks: &Marks,
    faces: &(impl Fn(Cell) -> [Face; 6] + Sync),
    meetings: &(impl Fn() -> Meetings<'a, T> + Sync),
) -> (Vec<Seam>, Vec<Meeting<T>>) {
    let (n, count) = (marks.side(), marks.count());
    let layout = Layout::new(n);
    let of_slabs = |slabs: Range<usize>| {
        let mut meetings = meetings();
        let seam = |cell| {
            let faces = faces(cell);
            let meeting = meetings.of(cell, &faces, n);
            Seam { at: layout.index(cell) as u32, meeting, sides: faces.map(|face| face.place) }
        };
        let seams: Vec<Seam> = marks.cells_of(slabs).map(seam).collect();
        (seams, meetings.met)
    };
    let (mut seams, mut met) = (Vec::with_capacity(count), Vec::new());
    for (built, others) in team::share(slabs(n, SEAM * count), of_slabs) {
        let first = met.len() as u32;
        seams.extend(built.into_iter().map(|seam| Seam { meeting: first + seam.meeting, ..seam }));
        met.extend(others);
    }
    (seams, met)
}

/// The `n` slabs of a level in runs that threads share, if there is as much to do as in so many inner leaves.
fn slabs(n: usize, work: usize) -> Vec<Range<usize>> {
    let pieces = pieces(rayon::current_num_threads(), work).min(n);
    (0..pieces).map(|k| k * n / pieces..(k + 1) * n / pieces).collect()
}

/// How much there is to do up to the end of every slab.
fn work(inner: &Marks, seams: &Marks) -> Vec<usize> {
    let slab = inner.side() * inner.words_per_row();
    let count = |words: &[u64]| words.iter().map(|word| word.count_ones() as usize).sum::<usize>();
    let slabs = inner.words().chunks_exact(slab).zip(seams.words().chunks_exact(slab));
    let sum = |so_far: &mut usize, (inner, seams): (&[u64], &[u64])| {
        *so_far += count(inner) + SEAM * count(seams);
        Some(*so_far)
    };
    slabs.scan(0, sum).collect()
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
