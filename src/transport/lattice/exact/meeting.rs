//! What leaves at seams meet: what lies beyond their six faces, and what crosses those.
//!
//! Seams are many, and there are few sorts of them: what crosses a face depends on the sizes of the two leaves alone,
//! where no wall stands, and on what the walls on both sides of it pass. So all seams between the same sorts of neighbours
//! and walls share one [`Meeting`].

use std::collections::HashMap;

use super::crossing::{Crossing, Pass};
use super::decay::Decay;
use super::walls::Walls;
use super::within::{Own, Within};
use crate::field::{Cell, Layout, Marks};
use crate::sh::Real;
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::kernel::form::Share;

/// What leaves have in common that lie between the same sorts of neighbours.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting<T> {
    /// What lies beyond each face, in the order of [`Direction::ALL`].
    pub(super) beyond: [Beyond; 6],
    /// What comes in through each face: α, β, γ, δ and ε of the share, times what passes. β and γ go with the direction of
    /// the axis, not with that of the face.
    pub(super) shares: [Share<T>; 6],
    /// D.
    pub(super) within: Within<T>,
}

/// What lies beyond a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Beyond {
    Dark,
    Same,
    Coarser,
    /// Four leaves.
    Finer,
}

/// What lies beyond a face of a leaf.
pub(super) struct Face {
    pub(super) beyond: Beyond,
    /// Where, in the planes of its level; the first of four.
    pub(super) place: u32,
    /// The first of the cells there that touch the face.
    first: Cell,
}

impl Face {
    /// The face in direction `d` of a cell that `marks` has at `i`.
    pub(super) fn of(marks: &[Marks], i: usize, cell: Cell, d: Direction) -> Self {
        let at = |marks: &Marks, cell| Layout::new(marks.side()).index(cell) as u32;
        let Some(next) = d.neighbour(cell, marks[i].side()) else {
            return Face { beyond: Beyond::Dark, place: 0, first: cell };
        };
        if marks[i].get(next) {
            return Face { beyond: Beyond::Same, place: at(&marks[i], next), first: next };
        }
        let parent = next.map(|c| c / 2);
        if let Some(above) = marks.get(i + 1).filter(|above| above.get(parent)) {
            return Face { beyond: Beyond::Coarser, place: at(above, parent), first: parent };
        }
        let mut first = next.map(|c| 2 * c);
        first[d.axis()] += usize::from(!d.is_positive());
        Face { beyond: Beyond::Finer, place: at(&marks[i - 1], first), first }
    }

    /// The cells beyond a face across `axis` that touch it.
    fn touching(&self, axis: usize) -> impl Iterator<Item = Cell> + '_ {
        (0..self.beyond.count()).map(move |k| {
            let mut cell = self.first;
            cell[(axis + 1) % 3] += k & 1;
            cell[(axis + 2) % 3] += k >> 1;
            cell
        })
    }
}

impl Beyond {
    /// How many leaves.
    pub(super) fn count(self) -> usize {
        match self {
            Beyond::Dark => 0,
            Beyond::Same | Beyond::Coarser => 1,
            Beyond::Finer => 4,
        }
    }

    /// Their level, seen from `level`.
    pub(super) fn level(self, level: usize) -> usize {
        match self {
            Beyond::Dark | Beyond::Same => level,
            Beyond::Coarser => level + 1,
            Beyond::Finer => level - 1,
        }
    }
}

/// The meetings of a level, as they are come across.
pub(super) struct Meetings<'a, T> {
    share: &'a Share<f64>,
    decay: &'a Decay,
    level: usize,
    walls: &'a dyn Walls,
    open: Faces,
    pub(super) met: Vec<Meeting<T>>,
    /// Which of them has no wall and lies between such neighbours: two bits for each face.
    known: Vec<u32>,
    /// Which of them lies between such neighbours and walls.
    walled: HashMap<(usize, [[u64; 3]; 6]), u32>,
}

/// What walls do at a face.
#[derive(Clone, Copy, Debug, Default)]
struct Walled {
    /// The share of light that passes the cell, on its way in.
    enters: f64,
    /// The share that passes the cells beyond.
    leaves: f64,
    /// What of the light that would go there is mirrored.
    mirrored: f64,
}

impl Walled {
    fn bits(self) -> [u64; 3] {
        [self.enters, self.leaves, self.mirrored].map(f64::to_bits)
    }
}

/// What no meeting is called.
const UNKNOWN: u32 = u32::MAX;

impl<'a, T: Real> Meetings<'a, T> {
    pub(super) fn new(share: &'a Share<f64>, decay: &'a Decay, level: usize, walls: &'a dyn Walls) -> Self {
        let open = Faces::new(decay, level);
        let (met, known, walled) = (Vec::new(), vec![UNKNOWN; 1 << 12], HashMap::new());
        Meetings { share, decay, level, walls, open, met, known, walled }
    }

    /// What a cell meets, on a level of `n` cells along a side.
    pub(super) fn of(&mut self, cell: Cell, faces: &[Face; 6], n: usize) -> u32 {
        let new = self.met.len() as u32;
        let sorts = faces.iter().fold(0, |sorts, face| sorts << 2 | face.beyond as usize);
        if self.walls.any() && is_walled(self.walls, self.level, cell, n) {
            let walled = Direction::ALL.map(|d| self.walled(cell, &faces[d.index()], d));
            let key = (sorts, walled.map(Walled::bits));
            if let Some(known) = self.walled.get(&key) {
                return *known;
            }
            self.walled.insert(key, new);
            self.met.push(self.meeting(faces, |face, d| self.behind(face, walled[d.index()])));
            return new;
        }
        if self.known[sorts] == UNKNOWN {
            self.known[sorts] = new;
            self.met.push(self.meeting(faces, |face, _| (self.open.crossing(face.beyond), 0.0)));
        }
        self.known[sorts]
    }

    /// `crossing` tells what crosses a face, for each leaf beyond it, and what is mirrored there.
    fn meeting(&self, faces: &[Face; 6], crossing: impl Fn(&Face, Direction) -> (Crossing, f64)) -> Meeting<T> {
        let mut own = [Own::default(); 3];
        let mut shares = [Share::default(); 6];
        for ((d, face), share) in Direction::ALL.into_iter().zip(faces).zip(&mut shares) {
            let (axis, up) = (d.axis(), d.is_positive());
            let (crossing, mirrored) = crossing(face, d);
            let times = face.beyond.count().max(1) as f64;
            own[axis].even += times * crossing.own.even;
            own[axis].odd += times * if up { crossing.own.odd } else { -crossing.own.odd };
            own[axis].mirrored[usize::from(!up)] = mirrored;
            *share = self.sent(crossing.beyond, up);
        }
        let beyond = faces.each_ref().map(|face| face.beyond);
        Meeting { beyond, shares, within: Within::new(self.share, own) }
    }

    /// What comes in through a face, an upper one if it is `up`.
    fn sent(&self, Pass { even, odd }: Pass, up: bool) -> Share<T> {
        let Share { alpha, beta, gamma, delta, epsilon } = *self.share;
        let odd = if up { odd } else { -odd };
        Share {
            alpha: T::of(even * alpha),
            beta: T::of(odd * beta),
            gamma: T::of(odd * gamma),
            delta: T::of(even * delta),
            epsilon: T::of(even * epsilon),
        }
    }

    /// What walls do at a face of a cell that has some in it or beside it.
    fn walled(&self, cell: Cell, face: &Face, d: Direction) -> Walled {
        let Meetings { level, walls, .. } = *self;
        if face.beyond == Beyond::Dark {
            return Walled::default();
        }
        let other = face.beyond.level(level);
        let mean = |of: &dyn Fn(Cell) -> f64| face.touching(d.axis()).map(of).sum::<f64>() / face.beyond.count() as f64;
        let enters = walls.passes(level, cell, d.axis());
        let leaves = mean(&|cell| walls.passes(other, cell, d.axis()));
        let mirrored = if leaves < 1.0 {
            mean(&|cell| (1.0 - walls.passes(other, cell, d.axis())) * walls.mirrors(other, cell))
        } else {
            0.0
        };
        Walled { enters, leaves, mirrored }
    }

    /// What crosses such a face, and what is mirrored.
    fn behind(&self, face: &Face, Walled { enters, leaves, mirrored }: Walled) -> (Crossing, f64) {
        let Meetings { decay, level, .. } = *self;
        if face.beyond == Beyond::Dark {
            return (self.open.outside, 0.0);
        }
        let (here, there) = (width(level), width(face.beyond.level(level)));
        let mirrored = enters * mirrored * decay.border(here) / here;
        (Crossing::behind(decay, here, there, [enters, leaves]), mirrored)
    }
}

/// What crosses the faces of a leaf where nothing stands in the way.
pub(super) struct Faces {
    /// To a finer, an equal and a coarser leaf.
    pub(super) to: [Crossing; 3],
    /// To the dark outside.
    outside: Crossing,
}

impl Faces {
    pub(super) fn new(decay: &Decay, level: usize) -> Self {
        let h = width(level);
        // Level 0 has no finer one.
        let finer = if level == 0 { Crossing::default() } else { Crossing::between(decay, h, 0.5 * h) };
        let to = [finer, Crossing::between(decay, h, h), Crossing::between(decay, h, 2.0 * h)];
        Faces { to, outside: Crossing::open(decay, h) }
    }

    fn crossing(&self, beyond: Beyond) -> Crossing {
        match beyond {
            Beyond::Dark => self.outside,
            Beyond::Finer => self.to[0],
            Beyond::Same => self.to[1],
            Beyond::Coarser => self.to[2],
        }
    }
}

/// The width of a cell of a level, in finest cells.
fn width(level: usize) -> f64 {
    f64::from(1u32 << level)
}

/// Whether anything stands in the way of light that enters a cell or one of its neighbours.
pub(super) fn is_walled(walls: &dyn Walls, level: usize, cell: Cell, n: usize) -> bool {
    let shut = |cell| (0..3).any(|axis| walls.passes(level, cell, axis) < 1.0);
    shut(cell) || Direction::ALL.iter().any(|d| d.neighbour(cell, n).is_some_and(shut))
}
