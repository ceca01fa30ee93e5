//! What a preset says of how light is propagated.

pub mod descent;
pub mod directions;

use std::fmt;

use serde::{Deserialize, Serialize};

use super::error::{Fault, Step};
use super::value::not_negative;
use descent::{Descent, Inside};
use directions::{MOST_DIRECTIONS, Setting};

/// The most iterations of one run.
pub const MOST_ITERATIONS: usize = 1_000_000;

/// How light is propagated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Propagation {
    /// The propagator's name, as `lpv-lab schemes` lists it, or `ordinates`; `cascaded`.
    pub scheme: String,
    /// The propagation factor p, finite, ≥ 0; 3. With `cascaded` and `ordinates` 4 keeps the energy (000, 3.2.3).
    pub factor: f64,
    /// Iterations of a whole run, up to [`MOST_ITERATIONS`]; 16.
    pub iterations: usize,
    /// What is summed; `Thesis`.
    pub snapshots: Snapshots,
    /// Whether negative flux counts as none; true. Off, every iteration is linear.
    pub clamp: bool,
    /// How the operator follows from the level of the octree; `Same`.
    pub levels: Policy,
    /// Which level is sampled where; `Thesis`. It does not matter to a descent, which samples its leaves, nor to light
    /// that keeps its direction, whose levels agree.
    #[serde(skip_serializing_if = "is_default")]
    pub index: Index,
    /// Whether the coarse levels start the fine ones; `Off`. If they do, `iterations` are those of every level, and
    /// `levels` does not matter.
    #[serde(skip_serializing_if = "is_default")]
    pub descent: Descent,
    /// How a descent shows the light of coarse cells in the finest; `Exponential`.
    #[serde(skip_serializing_if = "is_default")]
    pub inside: Inside,
    /// The directions of the propagator `ordinates`; the others have none.
    #[serde(skip_serializing_if = "is_default")]
    pub ordinates: Setting,
}

/// What the accumulated grid sums, and what the first iteration sends on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Snapshots {
    /// S_0 + … + S_k (000, 3.2.3).
    #[default]
    Thesis,
    /// NVIDIA's sample: S_1 := S_0 + p·P(S_0), so the source is propagated twice; S_1 + … + S_k.
    CopyFirst,
    /// The light that has moved and no other: S_1 + … + S_k, with S_1 = p·P(S_0) as in the thesis.
    WithoutInjected,
}

/// How the operator follows from the level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Policy {
    /// One factor for all levels, as in the thesis (000, 4.2).
    #[default]
    Same,
    /// Each level's operator keeps the light that stays in its larger cells; see `transport::lattice::levels`.
    Consistent,
    /// Each level takes finest steps, by an operator that treats light exactly which depends on one coordinate alone;
    /// see `transport::lattice::exact`.
    Exact,
    /// As `Exact`, with the light that stays in a cell summed up at once: the coarser a level is, the farther it runs
    /// ahead of the finest, to the same end.
    Ahead,
}

impl Policy {
    /// All policies, the default first.
    pub const ALL: [Policy; 4] = [Policy::Same, Policy::Consistent, Policy::Exact, Policy::Ahead];

    /// Its name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Policy::Same => "same",
            Policy::Consistent => "consistent",
            Policy::Exact => "exact",
            Policy::Ahead => "ahead",
        }
    }

    /// Whether the coarser levels go by what plane light does ([`Policy::Exact`], [`Policy::Ahead`]).
    pub fn is_exact(self) -> bool {
        matches!(self, Policy::Exact | Policy::Ahead)
    }
}

/// Which level of the octree is sampled where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Index {
    /// The finest level that has received light (000, 4.2).
    #[default]
    Thesis,
    /// The coarser, the farther injected light is; neighbouring levels are blended. See `transport::lattice::radial`.
    Radial {
        /// How far from injected light the finest level alone is sampled, in cells; above 0. What comes next is on level 1
        /// alone twice as far away.
        reach: f64,
    },
}

impl Index {
    /// The reach where none is asked for.
    pub const REACH: f64 = 2.0;

    fn check(self) -> Result<(), Fault> {
        match self {
            Index::Radial { reach } if !(reach > 0.0 && reach.is_finite()) => {
                let fault = Fault::new(format!("a radial index cannot reach {reach} cells"), "a number above 0");
                Err(fault.field("reach"))
            }
            _ => Ok(()),
        }
    }
}

impl fmt::Display for Policy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Default for Propagation {
    fn default() -> Self {
        Propagation {
            scheme: "cascaded".to_owned(),
            factor: 3.0,
            iterations: 16,
            snapshots: Snapshots::Thesis,
            clamp: true,
            levels: Policy::Same,
            index: Index::Thesis,
            descent: Descent::Off,
            inside: Inside::Exponential,
            ordinates: Setting::default(),
        }
    }
}

impl Propagation {
    /// How often a whole run propagates an octree from side `size` down to side `coarsest`: as often as `iterations`
    /// says, and in a descent so often on every level.
    pub fn actions(&self, size: usize, coarsest: usize) -> usize {
        let levels = 1 + (size / coarsest.max(1)).max(1).ilog2() as usize;
        if self.descent.goes_down() { self.iterations * levels } else { self.iterations }
    }

    /// Whether every value can be run in a volume of side `size`.
    pub(super) fn check(&self, size: usize) -> Result<(), Fault> {
        not_negative(self.factor, "the factor").map_err(|p| p.field("factor"))?;
        if self.iterations > MOST_ITERATIONS {
            let what = format!("{} iterations are too many", self.iterations);
            return Err(Fault::new(what, format!("at most {MOST_ITERATIONS} are run")).field("iterations"));
        }
        self.index.check().map_err(|p| p.within(Step::Field("index")))?;
        self.descent.check(size).map_err(|p| p.within(Step::Field("descent")))?;
        let directions = self.ordinates.directions;
        if !(1..=MOST_DIRECTIONS).contains(&directions) {
            let fault =
                Fault::new(format!("there cannot be {directions} directions"), format!("from 1 to {MOST_DIRECTIONS}"));
            return Err(fault.field("directions").within(Step::Field("ordinates")));
        }
        Ok(())
    }
}

/// Whether a value is its type's default, which documents leave out.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
