//! What goes wrong with light that is kept in cells, in numbers: leaks through walls, light behind its own
//! source, jumps between levels, negative light.
//!
//! All are told of the merged light, which is what people see, and where a level can be blamed of each level by
//! itself. Each is a ratio with a value that says "nothing is wrong": see [`leak`], [`back_bleeding`] and
//! [`jump`]. Light is measured by its c00, summed over red, green and blue ([`Brightness`]).

pub mod back_bleeding;
pub(crate) mod behind;
pub mod jump;
pub mod leak;
mod nearest;

use crate::field::{Cell, Layout, Marks};
use crate::sh::Real;
use crate::simulation::{Refusal, Simulation};
use crate::study::light::{Brightness, sampled};
use crate::transport::kind::Precision;

/// A share of the light of some cells, as it is seen and level by level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shares {
    /// In the merged light; `None` where there is no light to be a share of.
    pub merged: Option<f64>,
    /// On each level, from the finest on; `None` where no cell of the level lies wholly in the place that is asked
    /// about, or has light there to be a share of.
    pub levels: Vec<Option<f64>>,
}

impl Shares {
    /// On the finest level: what is the scheme's own, wherever in the octree the scene lies.
    pub fn finest(&self) -> Option<f64> {
        self.levels.first().copied().flatten()
    }
}

/// All that is told of one state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Artefacts {
    /// Light behind occluders over light there without them; `None` where nothing lies behind any.
    pub leak: Option<Shares>,
    /// Light behind its own source over light before it; `None` where sources have no direction.
    pub back_bleeding: Option<Shares>,
    /// What is wrong where the sample goes over from one level to the next; `None` where it does not.
    pub jump: Option<jump::Jump>,
    /// Finest cells whose merged light is negative in the mean over all directions, in any colour.
    pub negative: usize,
}

impl Artefacts {
    /// Of a state that was reached from the injection by its problem's own iterations, with what jumps are held
    /// against. The leak takes the same iterations once more without occluders.
    ///
    /// # Errors
    /// Where memory is short.
    pub fn of<T: Precision>(state: &Simulation<T>, steady: Option<&jump::Steady>) -> Result<Self, Refusal> {
        Ok(Artefacts {
            leak: leak::of(state)?,
            back_bleeding: back_bleeding::of(state),
            jump: steady.and_then(|steady| steady.jump(state)),
            negative: negative(state),
        })
    }
}

/// Finest cells whose merged light is negative in any colour.
pub fn negative<T: Real>(state: &Simulation<T>) -> usize {
    let (shares, merged) = (state.channels().rgb(), sampled(state));
    let is_negative =
        |cell: &Cell| shares.iter().any(|share| share.scale * merged[share.channel].get(*cell).0[0].to_f64() < 0.0);
    Layout::new(state.sizes().finest()).cells().filter(is_negative).count()
}

/// Cells of every level of an octree that lie in one place.
#[derive(Clone, Debug)]
struct Region {
    levels: Vec<Marks>,
}

impl Region {
    /// The finest cells `marked`, and of each coarser level the cells that hold one of them and none of `others`.
    fn new(marked: Marks, others: &Marks, levels: usize) -> Self {
        let mut spoilt = others.clone();
        let mut all = vec![marked];
        for i in 1..levels {
            spoilt = spoilt.parents();
            let mut coarser = all[i - 1].parents();
            let mixed = Layout::new(coarser.side()).cells().filter(|cell| spoilt.get(*cell));
            mixed.for_each(|cell| coarser.put(cell, false));
            all.push(coarser);
        }
        Region { levels: all }
    }

    /// The merged light of the finest cells.
    fn merged<T: Real>(&self, state: &Simulation<T>, brightness: &Brightness) -> f64 {
        let (n, light) = (self.levels[0].side(), brightness.merged(state));
        self.cells(0).map(|[x, y, z]| light[(z * n + y) * n + x]).sum()
    }

    /// The accumulated light of a level; `None` where it has no cell of the region.
    fn level<T: Real>(&self, state: &Simulation<T>, brightness: &Brightness, level: usize) -> Option<f64> {
        let light = |cell: Cell| brightness.of(|channel| state.lights()[channel].accumulated.level(level).get(cell));
        (self.levels[level].count() > 0).then(|| self.cells(level).map(light).sum())
    }

    fn cells(&self, level: usize) -> impl Iterator<Item = Cell> {
        Layout::new(self.levels[level].side()).cells().filter(move |cell| self.levels[level].get(*cell))
    }
}

/// `a` over `b` where that is a share of something.
fn share(a: f64, b: f64) -> Option<f64> {
    (b > 0.0).then(|| a / b)
}
