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

use super::partition::Tiling;
use super::solids::Solids;
use crate::field::{Cell, Grid, Marks};
use crate::scene::propagation::Snapshots;
use crate::sh::{Real, Sh};
use crate::transport::lattice::exact::filter::cells;
use crate::transport::lattice::kernel::form::Form;
use crate::transport::lattice::kernel::occluded::{OcclusionLaw, Which};
use crate::transport::lattice::kernel::{Instructions, Level, Order, lies_in_cone, step};

/// Steps after which what is left of clamps is left alone.
const MOST_STEPS: usize = 4;

/// Where one cell in so many is lit, or fewer, a second step over leaves costs little.
const FEW: usize = 128;

/// How injected light takes its first steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Launch<'a, T> {
    pub(super) form: &'a Form<T>,
    pub(super) solids: Option<&'a Solids<T>>,
    pub(super) snapshots: Snapshots,
    /// What the volume is cut into.
    pub(super) tiling: Tiling,
}

/// One channel's light after its first steps.
#[derive(Debug)]
pub(super) struct FirstSteps<T> {
    /// The injected light.
    pub(super) taken: Vec<(Cell, Sh<T>)>,
    /// What of the light so far counts and stays where it is.
    pub(super) stays: Grid<T>,
    /// Where light has been.
    pub(super) lit: Marks,
    /// q, the last step.
    pub(super) moved: Grid<T>,
    /// Where q is.
    pub(super) reached: Marks,
}

impl<T: Real> Launch<'_, T> {
    /// Launches the light of a colour (0 red, 1 green, 2 blue).
    pub(super) fn run(&self, colour: usize, light: &Grid<T>) -> FirstSteps<T> {
        let n = light.side();
        let mut lit = Marks::new(n);
        lit.mark_lit(light);
        let taken: Vec<(Cell, Sh<T>)> = cells(&lit).map(|cell| (cell, light.get(cell))).collect();
        // Only what is lit is touched: the rest of a new grid costs nothing.
        let (mut source, mut stays) = (Grid::new(n), Grid::new(n));
        for (cell, value) in &taken {
            source.set(*cell, *value);
            if self.snapshots != Snapshots::WithoutInjected {
                stays.set(*cell, *value);
            }
        }
        // Where the first iteration sends the light twice, all that has moved counts twice.
        let times = T::of(if self.snapshots == Snapshots::CopyFirst { 2.0 } else { 1.0 });
        let (mut moved, mut reached) = self.step(colour, &mut source, &lit);
        let few = matches!(self.tiling, Tiling::Leaves { .. }) && taken.len() * FEW <= n.pow(3);
        let least = if few { 2 } else { 1 };
        for steps in 1..MOST_STEPS {
            if steps >= least && self.is_linear(&moved, &reached) {
                break;
            }
            for cell in cells(&reached) {
                stays.add(cell, moved.get(cell) * times);
                lit.set(cell);
            }
            (moved, reached) = self.step(colour, &mut moved, &reached);
        }
        cells(&reached).for_each(|cell| moved.set(cell, moved.get(cell) * times));
        FirstSteps { taken, stays, lit, moved, reached }
    }

    /// Whether no clamp acts on the light, now and in all steps to come, or clamps are left alone.
    fn is_linear(&self, light: &Grid<T>, lit: &Marks) -> bool {
        self.solids.is_some() || self.form.cone.is_none_or(|cone| cone.is_infinite() || lies_in_cone(light, lit, cone))
    }

    /// One step, and where it has gone.
    fn step(&self, colour: usize, source: &mut Grid<T>, lit: &Marks) -> (Grid<T>, Marks) {
        let n = source.side();
        let (mut moved, mut reached) = (Grid::new(n), Marks::new(n));
        if let Some(Solids { hard, stencil, .. }) = self.solids {
            let which = Which { level: 0, colour, blocks: true };
            OcclusionLaw::Hard(hard.clone()).propagate(stencil, which, source, &mut moved);
            reached.mark_lit(&moved);
            return (moved, reached);
        }
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
            target: &mut moved,
            target_lit: &mut Marks::new(n),
            sum: None,
            marks: &mut reached,
        };
        step::step(&order, &mut level, 1, None);
        (moved, reached)
    }
}
