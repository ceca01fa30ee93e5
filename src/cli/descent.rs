//! The descent that a command line asks for.

use clap::{Args, ValueEnum};

use super::CliError;
use super::numbers::whole;
use crate::scene::propagation::descent::Descent;

/// How coarse levels start fine ones, if a command line says so.
#[derive(Args, Debug, Clone, Default)]
pub struct DescentArgs {
    /// Let the coarse levels start the fine ones: over all cells of a level, over leaves, or over nested cascades;
    /// --iterations are then those of every level
    #[arg(long, value_name = "TILING")]
    pub descent: Option<DescentArg>,
    /// How far leaves are from injected light, in halves of their width
    #[arg(long, value_name = "R", value_parser = super::octree::distance)]
    pub leaf_distance: Option<f64>,
    /// Cells along a side of every nested cascade
    #[arg(long, value_name = "C", value_parser = whole, allow_negative_numbers = true)]
    pub cascade_side: Option<usize>,
}

/// What a descent goes over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DescentArg {
    /// No descent: every level is propagated by itself
    Off,
    /// All cells of one level after the other
    Cells,
    /// Leaves, the larger the farther from injected light
    Leaves,
    /// Nested cascades about the preset's point, or the volume's middle, that exchange light across their borders
    Cascades,
    /// Nested cascades that are propagated each by itself, all at once: no descent
    CascadesAlone,
}

impl DescentArgs {
    /// The descent asked for, where the preset's own is `preset`.
    pub fn of(&self, preset: Descent) -> Result<Descent, CliError> {
        let distance = match preset {
            Descent::Leaves { distance } => distance,
            _ => Descent::DISTANCE,
        };
        let (side, center) = match preset {
            Descent::Cascades { side, center, .. } => (side, center),
            _ => (Descent::SIDE, None),
        };
        let distance = self.leaf_distance.unwrap_or(distance);
        let side = self.cascade_side.unwrap_or(side);
        let descent = match (self.descent, preset) {
            (Some(DescentArg::Off), _) => Descent::Off,
            (Some(DescentArg::Cells), _) => Descent::Cells,
            (Some(DescentArg::Leaves), _) | (None, Descent::Leaves { .. }) => Descent::Leaves { distance },
            (Some(DescentArg::Cascades), _) => Descent::Cascades { side, center, alone: false },
            (Some(DescentArg::CascadesAlone), _) => Descent::Cascades { side, center, alone: true },
            (None, Descent::Cascades { alone, .. }) => Descent::Cascades { side, center, alone },
            (None, other) => other,
        };
        if self.leaf_distance.is_some() && !matches!(descent, Descent::Leaves { .. }) {
            return Err(CliError::Input("--leaf-distance is for leaves: write --descent leaves, too".to_owned()));
        }
        if self.cascade_side.is_some() && !matches!(descent, Descent::Cascades { .. }) {
            return Err(CliError::Input("--cascade-side is for cascades: write --descent cascades, too".to_owned()));
        }
        Ok(descent)
    }
}
