//! One iteration of a level in one pass over memory.

use std::ops::Range;

use super::form::Form;
use super::inspect::Run;
use super::slab::{Source, Work, advance};
use super::split::{Planes, Tied, cut_marks, runs, slab_of};
use super::{Instructions, Level, Order, Tally};
use crate::field::{Grid, Marks};
use crate::sh::Real;
use crate::transport::lattice::reach::everywhere;
use crate::transport::team::share;

/// Fewer cells than these are not worth waking another thread: about a 32³ grid.
const SERIAL_BELOW: usize = 20_000;

/// Pieces of work a thread, so that one that was late does not keep the others waiting.
const PIECES: usize = 8;

/// In how many pieces an iteration that visits so many `cells` is best cut.
pub fn pieces(threads: usize, cells: usize) -> usize {
    if threads <= 1 || cells < SERIAL_BELOW { 1 } else { PIECES * threads }
}

/// Sets the target to what the source sends, adds it to the sum and marks where it is not dark. Where
/// `need` is given, cells outside it may be left out. The result does not depend on the `pieces` that
/// threads share.
pub fn step<T: Real>(order: &Order<T>, level: &mut Level<'_, T>, pieces: usize, need: Option<&Marks>) -> Tally {
    let n = level.source.side();
    let pieces = pieces.clamp(1, n);
    let ends: Vec<usize> = (1..=pieces).map(|i| i * n / pieces).collect();
    over(order, level, &ends, |_| true, need)
}

/// [`step`] over those of the pieces between consecutive `ends` that are `wanted`.
pub(super) fn over<T: Real>(
    order: &Order<T>,
    level: &mut Level<'_, T>,
    ends: &[usize],
    wanted: impl Fn(&Range<usize>) -> bool,
    need: Option<&Marks>,
) -> Tally {
    let layout = level.source.layout();
    let rows = Run { start: 0, end: layout.side() };
    let source = whole(level.source, level.source_lit);
    let light = Planes::cut(level.target, ends);
    let lit = cut_marks(level.target_lit, ends);
    let tied = Tied::cut(level.sum.as_deref_mut(), level.marks, ends);
    let parts = light.into_iter().zip(lit).zip(tied).map(|((light, lit), tied)| Part { light, lit, tied });
    let work: Vec<(Range<usize>, Part<'_, T>)> = runs(ends).zip(parts).filter(|(slabs, _)| wanted(slabs)).collect();
    let run = |(slabs, mut part): (Range<usize>, Part<'_, T>)| -> Vec<Tally> {
        let one = |z: usize| {
            let need = need.map(|need| slab_of(need, z));
            let mut target = part.tied.target(layout, z - slabs.start, &mut part.light, part.lit);
            advance(Work { order, layout, source, z, rows, need }, &mut target)
        };
        slabs.clone().map(one).collect()
    };
    // A tally a slab, summed in order: so many threads, the same sum.
    share(work, run).into_iter().flatten().fold(Tally::NONE, Tally::and)
}

/// What all cells of `source` send to their neighbours, clamps and all, with nothing left out: an iteration
/// outside of any run.
pub fn once<T: Real>(form: &Form<T>, mut source: Grid<T>) -> Grid<T> {
    let n = source.side();
    let mut target = Grid::new(n);
    let order = Order {
        form: *form,
        linear: false,
        drop_dark: false,
        cone: None,
        energy: false,
        instructions: Instructions::Best,
    };
    let mut level = Level {
        source: &mut source,
        source_lit: &mut everywhere(n),
        target: &mut target,
        target_lit: &mut Marks::new(n),
        sum: None,
        marks: &mut Marks::new(n),
    };
    step(&order, &mut level, pieces(rayon::current_num_threads(), n.pow(3)), None);
    target
}

/// What one piece of work writes.
struct Part<'a, T> {
    light: Planes<'a, T>,
    lit: &'a mut [u64],
    tied: Tied<'a, T>,
}

fn whole<'a, T: Real>(grid: &'a Grid<T>, lit: &'a Marks) -> Source<'a, T> {
    let planes = grid.planes().each_ref().map(Vec::as_slice);
    Source { planes, lit: lit.words(), first: grid.layout().row_start(0, 0) }
}
