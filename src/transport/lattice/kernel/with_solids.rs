//! One fast iteration among occluders: the fast loops for every cell, as if nothing stood there, then
//! [`super::occluded`] for the few cells that an occluder has a part in.

use rayon::prelude::*;

use super::occluded::{OcclusionLaw, Touched, Which};
use super::{Level, Order, Tally, step};
use crate::field::{Cell, Marks};
use crate::sh::{Real, Sh};
use crate::transport::lattice::stencil::Stencil;

/// Fewer cells than these are not worth waking another thread.
const SERIAL_BELOW: usize = 1000;

/// Occluders as they stand on one level.
#[derive(Clone, Copy, Debug)]
pub struct WithSolids<'a, T> {
    /// The occluders.
    pub occluders: &'a OcclusionLaw<T>,
    /// The level and colour.
    pub which: Which,
    /// The level's cells that they touch ([`OcclusionLaw::touched`]).
    pub touched: &'a Touched<T>,
    /// The scheme, which `order` has in its other form.
    pub stencil: &'a Stencil<T>,
}

/// [`super::pass::advance`] by one iteration among occluders. The order must be for the clamped form and drop nothing that looks dark,
/// as both are decided before the touched cells have their light.
pub fn advance<T: Real>(
    order: &Order<T>,
    level: &mut Level<'_, T>,
    threads: usize,
    need: Option<&[&Marks]>,
    solids: WithSolids<'_, T>,
) -> Tally {
    let WithSolids { occluders, which, touched, stencil } = solids;
    let pieces = step::pieces(threads, level.source_lit.cells_in_touched_words());
    let cells = &touched.cells;
    let receive = |i| occluders.receive_touched(stencil, which, level.source, touched, i);
    let received: Vec<Sh<T>> = if pieces == 1 || cells.len() < SERIAL_BELOW {
        (0..cells.len()).map(receive).collect()
    } else {
        (0..cells.len()).into_par_iter().map(receive).collect()
    };
    let before = |cell: &Cell| (level.marks.get(*cell), level.sum.as_ref().map(|sum| sum.get(*cell)));
    let before: Vec<(bool, Option<Sh<T>>)> = cells.iter().map(before).collect();
    let tally = step::step(order, level, pieces, need.map(|need| need[0]));
    for ((&cell, light), (was_lit, sum)) in cells.iter().zip(received).zip(before) {
        level.target.set(cell, light);
        if let (Some(grid), Some(sum)) = (&mut level.sum, sum) {
            grid.set(cell, sum + light);
        }
        level.marks.put(cell, was_lit || !light.is_zero());
    }
    level.turn(1);
    tally
}
