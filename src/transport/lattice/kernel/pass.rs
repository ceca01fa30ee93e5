//! One pass over the memory of a level: one iteration, or several.

use super::{Level, Order, Tally, blocked, step};
use crate::field::Marks;
use crate::sh::Real;

/// Takes the level `depth` iterations further, by so many threads; the newest light is in the source afterwards, the
/// light before it in the target. Where `need` is given, cells outside its t-th entry may be left out in iteration t.
pub fn advance<T: Real>(
    order: &Order<T>,
    level: &mut Level<'_, T>,
    depth: usize,
    threads: usize,
    need: Option<&[&Marks]>,
) -> Tally {
    let tally = if depth == 1 {
        let pieces = step::pieces(threads, level.source_lit.cells_in_touched_words());
        step::step(order, level, pieces, need.map(|need| need[0]))
    } else {
        blocked::advance_many(order, level, depth, threads, need)
    };
    level.turn(depth);
    tally
}
