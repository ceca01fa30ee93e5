//! Hard occluders: how much of the light that enters a cell goes on, on every level.
//!
//! On level 0 a cell passes 1 − opacity of the light that enters it, by the axis along which it does; the rest is
//! absorbed. Light that is
//! injected into an occupied cell leaves it: it sits on the surface.
//!
//! A coarse cell holds both sides of a wall, so coarse levels need two rules more:
//!
//! - Light along an axis passes what the lines of finest cells through the coarse cell along that axis
//!   pass: the product over each line, the mean over the lines. So a wall stops all light that crosses it
//!   on every level, however thin, and lets light pass alongside it.
//! - Cells that no light can reach through free cells, step by step from where it is injected, count as
//!   occupied. So behind a closed occluder every level is dark, and a finest cell there is sampled at
//!   level 0, not in a coarse cell that reaches around to the lit side.
//!
//! What remains: light that is injected into a coarse cell in front of an open wall inside that cell may
//! leave it behind the wall.

use crate::field::{Cell, Layout, Levels};
use crate::scene::Solid;
use crate::sh::Real;
use crate::transport::lattice::face::Direction;

/// How much of the light that enters a cell goes on.
#[derive(Clone, Debug, PartialEq)]
pub struct HardSolids<T> {
    levels: Vec<Passage<T>>,
}

/// For every cell of an n³ grid, x fastest, the share of light along x, y and z that passes.
#[derive(Clone, Debug, PartialEq)]
struct Passage<T> {
    n: usize,
    shares: Vec<[T; 3]>,
}

impl<T: Real> Passage<T> {
    fn at(&self, [x, y, z]: Cell) -> [T; 3] {
        self.shares[(z * self.n + y) * self.n + x]
    }

    /// What coarse cells of `width` finest cells along a side pass, `self` being the finest.
    fn coarser(&self, width: usize) -> Self {
        let n = self.n / width;
        let share = |cell: Cell, axis: usize| {
            let line = |u: usize, v: usize| {
                let mut at = cell.map(|c| c * width);
                at[(axis + 1) % 3] += u;
                at[(axis + 2) % 3] += v;
                let mut passed = T::of(1.0);
                for _ in 0..width {
                    passed *= self.at(at)[axis];
                    at[axis] += 1;
                }
                passed
            };
            let lines: T = (0..width).flat_map(|u| (0..width).map(move |v| (u, v))).map(|(u, v)| line(u, v)).sum();
            lines * T::of(1.0 / (width * width) as f64)
        };
        let shares = Layout::new(n).cells().map(|cell| [0, 1, 2].map(|axis| share(cell, axis))).collect();
        Passage { n, shares }
    }
}

impl<T: Real> HardSolids<T> {
    /// The hard_solids that `blockers` are to light injected into the finest cells `lit`.
    pub fn new(sizes: Levels, solids: &[Solid], lit: impl IntoIterator<Item = Cell>) -> Self {
        let n = sizes.finest();
        let index = |[x, y, z]: Cell| (z * n + y) * n + x;
        let mut free = vec![[1.0; 3]; n.pow(3)];
        for blocker in solids {
            free[index(blocker.cell)] = blocker.opacity.map(|opacity| 1.0 - opacity);
        }
        let mut reached = vec![false; n.pow(3)];
        let mut front: Vec<Cell> = lit.into_iter().collect();
        front.iter().for_each(|cell| reached[index(*cell)] = true);
        while let Some(cell) = front.pop() {
            for (axis, next) in neighbours(cell, n) {
                let i = index(next);
                if free[i][axis] > 0.0 && !std::mem::replace(&mut reached[i], true) {
                    front.push(next);
                }
            }
        }
        let passes = |(free, reached): (&[f64; 3], &bool)| free.map(|free| T::of(if *reached { free } else { 0.0 }));
        let finest = Passage { n, shares: free.iter().zip(&reached).map(passes).collect() };
        let coarser: Vec<Passage<T>> = (1..sizes.count()).map(|level| finest.coarser(1 << level)).collect();
        HardSolids { levels: std::iter::once(finest).chain(coarser).collect() }
    }

    /// The share of the light that enters a cell of a level along an axis (0 for x, 1 for y, 2 for z) that
    /// goes on, 0 to 1.
    pub fn passes(&self, level: usize, cell: Cell, axis: usize) -> T {
        self.levels[level].at(cell)[axis]
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|passage| size_of_val(passage.shares.as_slice())).sum()
    }

    /// The finest cells that no light can enter.
    pub fn shut(&self) -> impl Iterator<Item = Cell> + '_ {
        Layout::new(self.levels[0].n).cells().filter(|cell| (0..3).all(|axis| self.passes(0, *cell, axis) == T::ZERO))
    }
}

/// The cells that share a face with `cell` in an n³ grid, each with the axis across that face.
fn neighbours(cell: Cell, n: usize) -> impl Iterator<Item = (usize, Cell)> {
    Direction::ALL.into_iter().filter_map(move |d| d.neighbour(cell, n).map(|next| (d.axis(), next)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn wall(cells: impl Iterator<Item = Cell>) -> Vec<Solid> {
        cells.map(|cell| Solid::new(cell, DVec3::ZERO, 1.0, [0.0; 3])).collect()
    }

    #[test]
    fn a_thin_wall_with_a_hole_stops_what_crosses_it_on_every_level() {
        let plane = Layout::new(8).cells().filter(|c| c[0] == 5 && *c != [5, 7, 7]);
        let hard_solids = HardSolids::<f64>::new(Levels::new(8, 1).unwrap(), &wall(plane), [[0, 0, 0]]);
        assert_eq!((0..3).map(|axis| hard_solids.passes(0, [5, 0, 0], axis)).sum::<f64>(), 0.0);
        for (level, cell, alongside) in [(1, [2, 0, 0], 0.5), (2, [1, 0, 0], 0.75)] {
            assert_eq!(hard_solids.passes(level, cell, 0), 0.0);
            assert_eq!(hard_solids.passes(level, cell, 1), alongside);
        }
        // The hole is one of four lines through its parent.
        assert_eq!(hard_solids.passes(1, [2, 3, 3], 0), 0.25);
        assert_eq!(hard_solids.passes(1, [3, 0, 0], 0), 1.0);
        assert_eq!(hard_solids.shut().count(), 63);
    }

    #[test]
    fn behind_a_closed_wall_nothing_enters_on_any_level() {
        let plane = Layout::new(8).cells().filter(|c| c[0] == 4);
        let hard_solids = HardSolids::<f64>::new(Levels::new(8, 1).unwrap(), &wall(plane), [[0, 3, 0]]);
        for level in 0..3 {
            for cell in Layout::new(8 >> level).cells().filter(|c| c[0] << level >= 4) {
                assert!((0..3).all(|axis| hard_solids.passes(level, cell, axis) == 0.0), "level {level}, {cell:?}");
            }
        }
        assert_eq!(hard_solids.shut().count(), 4 * 64);
    }
}
