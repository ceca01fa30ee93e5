//! Nested cascades as NVIDIA's sample has them: every grid is propagated by itself, and all of them alike.
//!
//! A grid is injected with what lies in it, downsampled; it takes every iteration with the scheme's own operator,
//! whatever its cells' width, and beyond its border all is dark. A cell shows the finest grid that covers it, blended
//! with the next over the last [`BLENDED`] of the finer one's cells. There is nothing that goes from grid to grid: the
//! two-way cascades ([`super::nest`] over [`super::Descent`]) are held against this.
//!
//! A grid is the part of an octree's level that lies in it: what leaves it in an iteration is forgotten right after.

use std::sync::Arc;

use super::nest::Nest;
use crate::field::{Cell, Grid, Marks};
use crate::scene::Problem;
use crate::scene::propagation::descent::Descent;
use crate::scene::propagation::{Policy, Propagation};
use crate::sh::{Real, Sh};
use crate::transport::divergence::Divergence;
use crate::transport::kind::{Setup, Transport};
use crate::transport::lattice::Lattice;
use crate::transport::options::Work;
use crate::transport::refusal::Refusal;
use crate::transport::state::State;

/// Cells at a grid's border over which it is blended with the next coarser one.
pub const BLENDED: f64 = 2.0;

/// Cascades that know nothing of each other, on their way.
#[derive(Clone, Debug)]
pub struct Alone<T> {
    nest: Nest,
    /// The cells of each level in its grid; none where the octree has coarser levels than there are grids.
    grids: Vec<Marks>,
    lattice: Lattice<T>,
}

impl<T: Real> Alone<T> {
    /// For the cascades of a problem.
    pub fn new(setup: &Setup) -> Result<Self, Refusal> {
        let Setup { problem, sizes, .. } = setup;
        let nest = super::nest_of(problem, *sizes)?;
        let levels = 0..sizes.count();
        let grids = levels.map(|i| if i < nest.count() { nest.cells(i) } else { Marks::new(sizes.side(i)) });
        let propagation = Propagation { descent: Descent::Off, levels: Policy::Same, ..problem.propagation.clone() };
        let each = Arc::new(Problem { propagation, ..Problem::clone(problem) });
        let lattice = Lattice::new(&Setup { problem: each, ..setup.clone() })?;
        Ok(Alone { nest, grids: grids.collect(), lattice })
    }

    /// Forgets the light outside of its grid, from level `first` on.
    fn confine(&self, state: &mut State<T>, first: usize) {
        for light in &mut state.lights {
            for octree in [&mut light.source, &mut light.accumulated] {
                for (grid, inside) in octree.levels_mut().iter_mut().zip(&self.grids).skip(first) {
                    confine(grid, inside);
                }
            }
        }
    }

    /// Marks what is sampled where.
    fn mark(&self, state: &mut State<T>) {
        for (i, inside) in self.grids.iter().enumerate() {
            state.index.level_mut(i).clone_from(inside);
        }
    }

    /// The finest grid that covers a finest cell, and the share that it has in what is shown; the next has the rest.
    fn covering(&self, cell: Cell) -> (usize, f64) {
        let sides = self.grids.iter().map(Marks::side);
        for (i, n) in sides.enumerate().take(self.nest.count() - 1) {
            if !self.grids[i].get(cell.map(|c| c >> i)) {
                continue;
            }
            let (corner, side) = (self.nest.corner(i), self.nest.side());
            let away = |k: usize| {
                let from_corner = (cell[k] as f64 + 0.5) / f64::from(1u32 << i) - corner[k] as f64;
                // The volume's border is no border between grids.
                let low = if corner[k] == 0 { f64::INFINITY } else { from_corner };
                let high = if corner[k] + side == n { f64::INFINITY } else { side as f64 - from_corner };
                low.min(high)
            };
            return (i, ((0..3).map(away).fold(f64::INFINITY, f64::min) / BLENDED).min(1.0));
        }
        (self.nest.count() - 1, 1.0)
    }
}

/// Makes all cells dark that are not marked.
fn confine<T: Real>(grid: &mut Grid<T>, inside: &Marks) {
    let n = grid.side();
    for (row, words) in inside.words().chunks_exact(inside.words_per_row()).enumerate() {
        let lit = |x: usize| words[x / 64] >> (x % 64) & 1 != 0;
        for plane in grid.row_mut(row % n, row / n) {
            plane.iter_mut().take(n).enumerate().filter(|(x, _)| !lit(*x)).for_each(|(_, c)| *c = T::ZERO);
        }
    }
}

impl<T: Real> Transport<T> for Alone<T> {
    fn start(&mut self, state: &mut State<T>) {
        self.lattice.start(state);
        self.mark(state);
    }

    fn inject(&mut self, state: &mut State<T>) {
        // What lies outside of the finest grid is still to be downsampled, and the index tells where it is.
        self.lattice.inject(state);
        self.confine(state, 1);
    }

    fn downsample(&mut self, state: &mut State<T>) {
        self.lattice.downsample(state);
        self.confine(state, 0);
        self.mark(state);
    }

    fn admit(&mut self, state: &State<T>) -> Result<(), Divergence> {
        self.lattice.admit(state)
    }

    fn step(&mut self, state: &mut State<T>) -> Work {
        self.confine(state, 0);
        self.mark(state);
        self.lattice.step(state);
        self.confine(state, 0);
        self.mark(state);
        let channels = state.lights.len();
        let visited = self.grids.iter().map(Marks::count).sum::<usize>();
        Work { visited: visited * channels, dark: 0, volume: state.sizes().cells() * channels }
    }

    fn sample(&self, state: &State<T>, channel: usize, merged: &mut Grid<T>) {
        let accumulated = &state.lights[channel].accumulated;
        let of = |i: usize, cell: Cell| accumulated.level(i).get(cell.map(|c| c >> i));
        for cell in merged.layout().cells() {
            let (i, share) = self.covering(cell);
            let rest = if share < 1.0 { of(i + 1, cell) * T::of(1.0 - share) } else { Sh::ZERO };
            merged.set(cell, of(i, cell) * T::of(share) + rest);
        }
    }

    fn bytes(&self) -> usize {
        self.lattice.bytes() + self.grids.iter().map(|inside| size_of_val(inside.words())).sum::<usize>()
    }

    fn shared_bytes(&self) -> usize {
        self.lattice.shared_bytes()
    }

    fn boxed_clone(&self) -> Box<dyn Transport<T>> {
        Box::new(self.clone())
    }
}
