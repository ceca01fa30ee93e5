//! What a transport is: the trait that every one of them has, and what is known of a kind before it runs.
//!
//! Everybody who runs light asks a [`Kind`] what it can do, and never its name. A new kind is a folder that
//! implements [`Transport`], and a line in [`super::kinds`].

use std::fmt;
use std::sync::Arc;

use super::arrivals::Arrivals;
use super::divergence::Divergence;
use super::options::{Device, Options, Stage, Wanted, Work};
use super::refusal::Refusal;
use super::solve::{NoFixedPoint, Solve};
use super::state::State;
use crate::field::{Cell, Channels, Grid, Levels};
use crate::scene::error::Fault;
use crate::scene::{Problem, Propagation};
use crate::sh::Real;

/// One way by which light travels, with what it keeps under way for one problem. The light that people see is in
/// the [`State`]; whoever changes that tells the transport by these functions and no others.
pub trait Transport<T: Real>: fmt::Debug + Send + Sync {
    /// Takes note that the state is dark, at the start and after every clear: forgets light under way, and marks cells
    /// that are to be sampled on the finest level whatever happens.
    fn start(&mut self, state: &mut State<T>);

    /// Adds the problem's light to the finest level.
    fn inject(&mut self, state: &mut State<T>);

    /// Fills the coarser levels from the finest.
    fn downsample(&mut self, state: &mut State<T>);

    /// Allows the next iteration if its light must stay in range. What is admitted is done next.
    fn admit(&mut self, state: &State<T>) -> Result<(), Divergence>;

    /// One iteration of every level, which was admitted. Everything in the state is up to date afterwards.
    fn step(&mut self, state: &mut State<T>) -> Work;

    /// So many iterations with nobody looking in between; fewer where nothing more is to come, or where one is not
    /// admitted. With [`Wanted::Merged`] only the merged light need be right afterwards.
    fn advance(
        &mut self,
        state: &mut State<T>,
        iterations: usize,
        wanted: Wanted,
        work: &mut Work,
    ) -> Result<(), Divergence> {
        let _ = wanted;
        let end = state.iteration + iterations;
        while state.iteration < end && !self.is_done() {
            self.admit(state)?;
            *work += self.step(state);
        }
        Ok(())
    }

    /// Takes the light that was injected all its way at once, where that is cheaper than iterating for ever; whether it
    /// did. The iteration stays what it was, and nothing is left under way.
    fn settle(&mut self, state: &mut State<T>) -> bool {
        let _ = state;
        false
    }

    /// Sets `merged` to what a channel's accumulated light is in every finest cell.
    fn sample(&self, state: &State<T>, channel: usize, merged: &mut Grid<T>) {
        state.sample(channel, merged);
    }

    /// How far a descent has come down; `None` where every iteration is one of all levels.
    fn stage(&self) -> Option<Stage> {
        None
    }

    /// Whether neighbouring levels are blended, so that a coarse cell is not shown as one.
    fn blends_levels(&self) -> bool {
        false
    }

    /// The level that a finest cell is sampled on; where levels are blended, the one with the largest share.
    fn sampled_level(&self, state: &State<T>, cell: Cell) -> usize {
        state.index.index(cell)
    }

    /// An upper bound on all light still to come, as a part of what has been accumulated; `None` while nothing is
    /// proved, or if no tolerance is set.
    fn still_to_come(&self) -> Option<f64> {
        None
    }

    /// By channel, what each of the problem's receivers has received so far: its irradiance times a cell's side squared.
    /// `None` where the transport does not know from where light comes.
    fn received(&self) -> Option<&[Vec<f64>]> {
        None
    }

    /// For each channel what has arrived at solids so far, in the cells of a level or in the finest cells as they are
    /// sampled; `None` where what arrives at a solid is in its cell.
    fn arrivals(&self, state: &State<T>, level: Option<usize>) -> Option<Vec<Arrivals>> {
        let _ = (state, level);
        None
    }

    /// Whether nothing more is to come, as far as anybody wants to know.
    fn is_done(&self) -> bool {
        false
    }

    /// Bytes that it keeps beside the state, and that a copy takes anew.
    fn bytes(&self) -> usize;

    /// Bytes that it keeps and that its copies share.
    fn shared_bytes(&self) -> usize {
        0
    }

    /// A copy in a box.
    fn boxed_clone(&self) -> Box<dyn Transport<T>>;
}

impl<T: Real> Clone for Box<dyn Transport<T>> {
    fn clone(&self) -> Self {
        self.boxed_clone()
    }
}

/// What a transport is made from.
#[derive(Clone, Debug)]
pub struct Setup {
    /// What is to be simulated.
    pub problem: Arc<Problem>,
    /// The levels of the state.
    pub sizes: Levels,
    /// The channels of the state.
    pub channels: Channels,
    /// How iterations are carried out.
    pub options: Options,
}

/// What a kind of transport can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities {
    /// Whether coarser levels propagate light of their own; where not, they hold the mean of the finest.
    pub levels: bool,
    /// Whether occluders stand in its way.
    pub occluders: bool,
    /// Whether the clamp of negative flux can be switched off, so that iterations are linear.
    pub clamp: bool,
    /// Whether light can grow without bound, so that there is a critical factor.
    pub grows: bool,
}

/// A law that light obeys under a transport, for the suite that holds every kind against all that it claims.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// A problem without occluders, turned or mirrored by one of the 48 symmetries of the cube, gives its light turned
    /// or mirrored.
    Symmetry,
    /// The light of two injections into different cells is the sum of the light of each.
    Superposition,
    /// After k iterations the finest level is lit only where k steps lead from the injected light: in reach, and of its
    /// parity.
    Reach,
    /// At the factor [`Kind::conserving`] Σ c00 of the finest level stays what it is after the first iteration, until
    /// light reaches the border.
    Conservation,
    /// Without occluders [`Kind::solver`] finds what iterating for ever gives.
    FixedPoint,
    /// A closed wall of hard occluders lets no light pass.
    Shutters,
    /// Single precision keeps within rounding of double precision.
    Precision,
}

/// Makes a transport.
pub type Make<T> = fn(&Setup) -> Result<Box<dyn Transport<T>>, Refusal>;

/// Makes what finds all light at once.
pub type MakeSolver = fn(&Problem) -> Result<Box<dyn Solve>, NoFixedPoint>;

/// What is known of a kind of transport before it runs.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// The name by which presets and the command line call it.
    pub name: &'static str,
    /// A line that says what it is.
    pub summary: &'static str,
    /// Where it was published.
    pub source: &'static str,
    /// What it is known to get wrong.
    pub flaws: &'static str,
    /// What it can do.
    pub can: Capabilities,
    /// The factor at which light inside an open volume is neither lost nor gained, clamps aside.
    pub conserving: f64,
    /// The laws that it obeys under a setting.
    pub laws: fn(&Propagation) -> Vec<Law>,
    /// Whether it can run a setting of its own.
    pub check: fn(&Propagation) -> Result<(), Fault>,
    /// The name of a setting in tables: the kind's, with what it takes from the preset besides.
    pub label: fn(&Propagation) -> String,
    /// Bytes that it will keep beside the state: for a problem on levels of these sizes, in numbers of so many bytes.
    pub bytes: fn(&Problem, Levels, usize, usize) -> u64,
    /// Makes what finds all its light on the finest level at once, for problems where there is such a thing.
    pub solver: MakeSolver,
    /// Relative residuals to which it is worth solving; one where it is exact whatever is asked for.
    pub tolerances: &'static [f64],
    /// The settings that are worth measuring beside others, all else being as in what is given.
    pub variants: fn(&Propagation) -> Vec<Propagation>,
    /// Makes one in single precision.
    pub single: Make<f32>,
    /// Makes one in double precision, where there is one.
    pub double: Option<Make<f64>>,
    /// Makes one on a graphics card, in single precision, where there is one.
    pub card: Option<Make<f32>>,
}

impl Kind {
    /// Why there is none of this kind in a precision, or on a device.
    pub fn refusal(&self, device: Device) -> Refusal {
        match device {
            Device::Cpu => Refusal::Precision { name: self.name },
            Device::Gpu if cfg!(feature = "gpu") => Refusal::Device {
                what: format!(
                    "\"{}\" is not computed by a graphics card, nor anything in double precision; use --device cpu",
                    self.name
                ),
            },
            Device::Gpu => Refusal::Device {
                what:
                    "this program was built without the feature `gpu`; build it with --features gpu, or use --device \
                       cpu"
                    .to_owned(),
            },
        }
    }
}

/// A precision in which transports are made.
pub trait Precision: Real {
    /// What makes transports of a kind in this precision on a device.
    fn maker(kind: &Kind, device: Device) -> Option<Make<Self>>;
}

impl Precision for f32 {
    fn maker(kind: &Kind, device: Device) -> Option<Make<Self>> {
        match device {
            Device::Cpu => Some(kind.single),
            Device::Gpu => kind.card,
        }
    }
}

impl Precision for f64 {
    fn maker(kind: &Kind, device: Device) -> Option<Make<Self>> {
        kind.double.filter(|_| device == Device::Cpu)
    }
}
