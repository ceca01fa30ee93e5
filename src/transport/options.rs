//! How iterations are carried out. None of it changes a bit of the light, but for the choice of kernel
//! (rounding) and the tolerance (iterations left out).

use std::fmt;

pub use crate::transport::lattice::kernel::Instructions;

/// How a simulation carries its iterations out. It does so on the threads of the rayon pool that it is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The loops to use.
    pub kernel: Kernel,
    /// The instruction set of the fast loops.
    pub instructions: Instructions,
    /// Whether several iterations may share one pass over memory where nobody looks in between.
    pub blocked: bool,
    /// What is left out because it cannot matter.
    pub skip: Skip,
    /// What computes them.
    pub device: Device,
    /// Stop a run once [`super::Transport::still_to_come`] is at most this; `None` to do every iteration.
    pub tolerance: Option<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            kernel: Kernel::Fast,
            instructions: Instructions::Best,
            blocked: true,
            skip: Skip::default(),
            device: Device::Cpu,
            tolerance: None,
        }
    }
}

/// What carries iterations out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Device {
    /// The processor.
    #[default]
    Cpu,
    /// A graphics card; the light is the same to the last bit.
    Gpu,
}

/// Which loops carry an iteration out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kernel {
    /// The fast ones wherever the scheme has the shape for them.
    #[default]
    Fast,
    /// The definition, always.
    Plain,
}

/// What is left out because it cannot matter. Each changes no bit of what is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skip {
    /// Cells that light cannot have reached yet.
    pub reach: bool,
    /// Rows, or their ends, that have gone dark again.
    pub dark: bool,
    /// Where only the merged light is wanted: levels and coarse cells that no sample can depend on.
    pub unmerged: bool,
    /// Colours that are multiples of others. Takes effect when a simulation is made.
    pub channels: bool,
}

impl Default for Skip {
    fn default() -> Self {
        Skip { reach: true, dark: true, unmerged: true, channels: true }
    }
}

impl Skip {
    /// Everything is computed.
    pub const NOTHING: Skip = Skip { reach: false, dark: false, unmerged: false, channels: false };
}

/// What a run has to leave behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// All light on all levels.
    Everything,
    /// The merged light; what the levels hold where no sample looks is left open.
    Merged,
}

/// How many cells were computed since the last clear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Cells that were computed, over all iterations, levels and channels.
    pub visited: usize,
    /// Cells that were left out though they had light once: it has gone dark. At least so many, as cells are
    /// computed by the chunk; the rest of what was left out had none yet.
    pub dark: usize,
    /// Cells there are, counted once for each iteration, level and colour that is carried.
    pub volume: usize,
}

impl Work {
    /// The part of the volume that was computed, 0 to 1; 1 if nothing was to be done.
    pub fn share(&self) -> f64 {
        if self.volume == 0 { 1.0 } else { self.visited as f64 / self.volume as f64 }
    }

    /// The part of the volume that was left out because its light has gone dark, 0 to 1.
    pub fn dark_share(&self) -> f64 {
        if self.volume == 0 { 0.0 } else { self.dark as f64 / self.volume as f64 }
    }
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Work) {
        self.visited += other.visited;
        self.dark += other.dark;
        self.volume += other.volume;
    }
}

/// In per cent, what was computed and why the rest was not.
impl fmt::Display for Work {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let volume = self.volume.max(1) as f64;
        let per_cent = |cells: usize| 100.0 * cells as f64 / volume;
        write!(f, "{:.1} % of the cells visited", 100.0 * self.share())?;
        let unreached = self.volume.saturating_sub(self.visited + self.dark);
        let reasons = [(unreached, "not reached yet"), (self.dark, "dark again")].map(|(c, why)| (per_cent(c), why));
        // What would be written as nothing is not worth a word.
        let told: Vec<String> = reasons
            .iter()
            .filter(|(share, _)| *share >= 0.05)
            .map(|(share, why)| format!("{share:.1} % {why}"))
            .collect();
        if told.is_empty() { Ok(()) } else { write!(f, " ({})", told.join(", ")) }
    }
}

/// How far a descent has come down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stage {
    /// The level that is worked on, 0 the finest.
    pub level: usize,
    /// Iterations of it that are done.
    pub done: usize,
    /// Iterations of every level.
    pub each: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_computed_is_told_with_the_reasons_for_the_rest() {
        let told = |visited, dark, volume| Work { visited, dark, volume }.to_string();
        assert_eq!(told(0, 0, 0), "100.0 % of the cells visited");
        assert_eq!(told(99_999, 1, 100_000), "100.0 % of the cells visited");
        assert_eq!(told(250, 0, 1000), "25.0 % of the cells visited (75.0 % not reached yet)");
        assert_eq!(told(250, 150, 1000), "25.0 % of the cells visited (60.0 % not reached yet, 15.0 % dark again)");
    }
}
