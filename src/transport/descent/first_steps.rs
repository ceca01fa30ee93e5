//! The first steps of injected light, clamps and all, until no clamp acts any more.
//!
//! What is solved for is linear, B = q + P·B. From lobes along the axes that holds after one step; oblique ones take up to
//! four ([`crate::transport::lattice::kernel::form`] tells from the light itself). The steps before the last count as
//! light that stays where it is, like the injected light: S + S_1 + … . Schemes whose clamp never ceases to act are
//! given as few steps as may be.
//!
//! **Leaves** begin to coarsen beside the light, where it is steepest. Of a lone lobe they keep an error that no iteration
//! mends: at p = 3.8 and r = 2 that is 0.13 of all light, and 0.23 where an oblique one sits in a corner (the formulas of
//! [`crate::transport::lattice::exact`] in double precision, by another program, give 0.1280 and 0.2341). With a second
//! step cell by cell, and leaves as far from where the first has been, it is 0.07 in both (0.0686 and 0.0745). That
//! takes two more layers of finest cells; where whole walls are lit and little is to be gained they are not worth it.
//! Over all cells of a level, and in nested cascades, the second step takes next to nothing: over all cells the lobe in the
//! corner is off by 0.039 after four iterations, in place of 0.055.
//!
//! **Fuzzy occluders** stop light from a certain iteration on. Steps are linear from there, so all before it are first steps.

use std::cmp::Ordering;

use crate::field::{Cell, CellList, Grid, Marks, memory_order};
use crate::scene::propagation::Snapshots;
use crate::sh::{Real, Sh};
use crate::transport::lattice::kernel::form::Form;
use crate::transport::lattice::kernel::step::{self, pieces};
use crate::transport::lattice::kernel::{Instructions, Level, Order, lies_in_cone, with_solids};
use crate::transport::lattice::obstacles::Obstacles;

/// Steps after which what is left of clamps is left alone.
pub(super) const MOST_STEPS: usize = 4;

/// Where one cell in so many is lit, or fewer, a second step costs little.
const FEW: usize = 128;

/// How injected light takes its first steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Launch<'a, T> {
    pub(super) form: &'a Form<T>,
    pub(super) obstacles: Option<&'a Obstacles<T>>,
    pub(super) snapshots: Snapshots,
}

/// One channel's light, to be taken up.
#[derive(Debug)]
pub struct Injected<'a, T> {
    /// The injected light, which is left as it is.
    pub light: &'a mut Grid<T>,
    /// A dark grid of the same side, which is left dark.
    pub room: &'a mut Grid<T>,
}

/// One channel's light after its first steps.
#[derive(Debug)]
pub(super) struct FirstSteps<T> {
    /// The injected light.
    pub(super) taken: CellList<T>,
    /// What of the light so far counts and stays where it is.
    pub(super) stays: CellList<T>,
    /// Where light has been.
    pub(super) lit: Marks,
    /// q, the last step.
    pub(super) moved: CellList<T>,
    /// Where q is.
    pub(super) reached: Marks,
}

impl<T: Real> Launch<'_, T> {
    /// Launches the light of a colour (0 red, 1 green, 2 blue).
    pub(super) fn run(&self, colour: usize, Injected { light, room }: &mut Injected<'_, T>) -> FirstSteps<T> {
        let n = light.side();
        let mut lit = Marks::new(n);
        lit.mark_lit(light);
        let taken: CellList<T> = lit.light_in(light).collect();
        let mut stays = if self.snapshots == Snapshots::WithoutInjected { Vec::new() } else { taken.clone() };
        // Where the first iteration sends the light twice, all that has moved counts twice.
        let times = T::of(if self.snapshots == Snapshots::CopyFirst { 2.0 } else { 1.0 });
        let mut reached = self.step((colour, 1), light, &lit, room);
        let mut next: Option<Grid<T>> = None;
        let least = if taken.len() * FEW <= n.pow(3) { 2 } else { 1 };
        // Steps are linear from where occluders stop light on.
        let least = self.obstacles.map_or(least, |obstacles| obstacles.passing().max(least));
        for steps in 1..MOST_STEPS.max(least) {
            let moved = next.as_mut().unwrap_or(room);
            if steps >= least && self.is_linear(moved, &reached) {
                break;
            }
            stays = sum(stays, reached.light_in(moved).map(|(cell, light)| (cell, light * times)));
            lit.words_mut().iter_mut().zip(reached.words()).for_each(|(lit, reached)| *lit |= reached);
            let mut further = Grid::new(n);
            let got_to = self.step((colour, steps + 1), moved, &reached, &mut further);
            if next.is_none() {
                reached.cells().for_each(|cell| room.set(cell, Sh::ZERO));
            }
            (next, reached) = (Some(further), got_to);
        }
        let last = next.as_ref().unwrap_or(room);
        let moved: CellList<T> = reached.light_in(last).map(|(cell, light)| (cell, light * times)).collect();
        if next.is_none() {
            moved.iter().for_each(|(cell, _)| room.set(*cell, Sh::ZERO));
        }
        FirstSteps { taken, stays, lit, moved, reached }
    }

    /// Whether no clamp acts on the light, now and in all steps to come, or clamps are left alone.
    fn is_linear(&self, light: &Grid<T>, lit: &Marks) -> bool {
        self.obstacles.is_some()
            || self.form.cone.is_none_or(|cone| cone.is_infinite() || lies_in_cone(light, lit, cone))
    }

    /// Step number `step`, from 1, of light of a colour into a dark grid; returns where it has gone.
    fn step(&self, (colour, step): (usize, usize), source: &mut Grid<T>, lit: &Marks, moved: &mut Grid<T>) -> Marks {
        let n = source.side();
        let threads = rayon::current_num_threads();
        let pieces = pieces(threads, lit.cells_in_touched_words());
        let mut reached = Marks::new(n);
        let order = Order {
            form: *self.form,
            linear: false,
            drop_dark: false,
            cone: None,
            energy: false,
            instructions: Instructions::Best,
        };
        let mut level = Level {
            source,
            source_lit: &mut lit.clone(),
            target: moved,
            target_lit: &mut Marks::new(n),
            sum: None,
            marks: &mut reached,
        };
        match self.obstacles {
            None => {
                step::step(&order, &mut level, pieces, None);
            }
            Some(obstacles) => {
                with_solids::advance(&order, &mut level, threads, None, obstacles.at_finest(colour, step));
                // They were exchanged.
                std::mem::swap(level.source, level.target);
            }
        }
        reached
    }
}

/// The sum of two lists in the order of memory.
fn sum<T: Real>(a: CellList<T>, b: impl Iterator<Item = (Cell, Sh<T>)>) -> CellList<T> {
    let mut sum: CellList<T> = Vec::with_capacity(a.len());
    let (mut a, mut b) = (a.into_iter().peekable(), b.peekable());
    loop {
        let next = match (a.peek(), b.peek()) {
            (Some((here, _)), Some((there, _))) => memory_order(*here).cmp(&memory_order(*there)),
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (None, None) => return sum,
        };
        let first = if next == Ordering::Greater { None } else { a.next() };
        let second = if next == Ordering::Less { None } else { b.next() };
        match (first, second) {
            (Some((cell, one)), Some((_, other))) => sum.push((cell, one + other)),
            (first, second) => sum.extend(first.or(second)),
        }
    }
}
