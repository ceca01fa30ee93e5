//! The loops on a single level that is lit everywhere: what a cell and iteration costs when nothing can
//! be skipped.

use std::time::Instant;

use super::Sample;
use super::aos::Aos;
use crate::field::{Grid, Marks};
use crate::sh::Sh;
use crate::transport::lattice::kernel::form::Form;
use crate::transport::lattice::kernel::{Instructions, Level, Order, blocked, plain, step};
use crate::transport::lattice::reach::everywhere;
use crate::transport::lattice::scheme::Scheme;
use crate::transport::lattice::stencil::Stencil;
use crate::transport::team;

/// Light that no clamp touches.
const LIGHT: Sh<f32> = Sh([1.0, 0.1, 0.2, -0.15]);
/// The factor of all dense runs. With it light stays far from the floor.
const FACTOR: f64 = 3.0;
/// Iterations of one sample of the fast loops.
pub const ITERATIONS: usize = 16;
/// Iterations of one sample of the slow ones, where a volume is large.
const FEW: usize = 2;

/// Which loop is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loop {
    /// The usual array of structures.
    Aos,
    /// The definition.
    Plain,
    /// The fast loop in its linear form, iteration by iteration.
    Fast,
    /// The fast loop in its clamped form.
    Clamped,
    /// The linear form, as many iterations a pass as the cache allows.
    Blocked,
}

impl Loop {
    /// All of them.
    pub const ALL: [Loop; 5] = [Loop::Aos, Loop::Plain, Loop::Fast, Loop::Clamped, Loop::Blocked];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Loop::Aos => "aos",
            Loop::Plain => "plain",
            Loop::Fast => "fast",
            Loop::Clamped => "fast-clamped",
            Loop::Blocked => "blocked",
        }
    }

    /// Whether it knows how to use more than one thread.
    pub fn is_threaded(self) -> bool {
        !matches!(self, Loop::Aos | Loop::Plain)
    }
}

/// One level, which all loops but the baseline share.
pub struct Dense {
    source: Grid<f32>,
    target: Grid<f32>,
    sum: Grid<f32>,
    marks: Marks,
    aos: Option<Aos>,
}

impl Dense {
    /// A level of side `n`.
    pub fn new(n: usize) -> Self {
        let grid = || Grid::new(n);
        Dense { source: grid(), target: grid(), sum: grid(), marks: Marks::new(n), aos: None }
    }

    /// Bytes that a loop holds.
    pub fn bytes(&self, which: Loop) -> usize {
        match (which, &self.aos) {
            (Loop::Aos, Some(aos)) => aos.bytes(),
            _ => 3 * self.source.bytes() + 3 * size_of_val(self.marks.words()),
        }
    }

    /// Times one loop on the current threads.
    pub fn sample(&mut self, which: Loop, scheme: &Scheme) -> Option<Sample> {
        let stencil = Stencil::<f32>::new(scheme, FACTOR, true);
        let n = self.source.side();
        let few = if n < 64 { ITERATIONS } else { FEW };
        let cells = n.pow(3);
        if which == Loop::Aos {
            let aos = self.aos.get_or_insert_with(|| Aos::new(n, &stencil));
            aos.fill(LIGHT);
            let started = Instant::now();
            (0..few).for_each(|_| aos.step());
            return Some(Sample::new(started, cells * few, cells * few));
        }
        for grid in [&mut self.source, &mut self.target, &mut self.sum] {
            fill(grid);
        }
        if which == Loop::Plain {
            let started = Instant::now();
            for _ in 0..few {
                plain::propagate(&stencil, &self.source, &mut self.target);
                self.sum.add_grid(&self.target);
                self.marks.mark_lit(&self.target);
                std::mem::swap(&mut self.source, &mut self.target);
            }
            return Some(Sample::new(started, cells * few, cells * few));
        }
        let form = Form::of(&stencil)?;
        let linear = which != Loop::Clamped;
        let order =
            Order { form, linear, drop_dark: true, cone: None, energy: false, instructions: Instructions::Best };
        let (mut lit, mut other) = (everywhere(n), everywhere(n));
        let threads = rayon::current_num_threads();
        let deepest = if which == Loop::Blocked { blocked::depth::<f32>(self.source.layout(), threads) } else { 1 };
        team::stay_awake();
        let (mut done, mut visited) = (0, 0);
        let started = Instant::now();
        while done < ITERATIONS {
            let mut level = Level {
                source: &mut self.source,
                source_lit: &mut lit,
                target: &mut self.target,
                target_lit: &mut other,
                sum: Some(&mut self.sum),
                marks: &mut self.marks,
            };
            let depth = deepest.min(ITERATIONS - done);
            let tally = if depth == 1 {
                step::step(&order, &mut level, step::pieces(threads, cells), None)
            } else {
                blocked::advance_many(&order, &mut level, depth, threads, None)
            };
            if depth % 2 == 1 {
                std::mem::swap(&mut self.source, &mut self.target);
                std::mem::swap(&mut lit, &mut other);
            }
            done += depth;
            visited += tally.visited;
        }
        Some(Sample::new(started, cells * ITERATIONS, visited))
    }
}

/// Gives every cell the light; the padding stays dark.
fn fill(grid: &mut Grid<f32>) {
    let n = grid.side();
    for row in 0..n * n {
        for (plane, c) in grid.row_mut(row % n, row / n).into_iter().zip(LIGHT.0) {
            plane.fill(c);
        }
    }
}
