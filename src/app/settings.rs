//! What the window remembers from one time to the next.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::errors::Plots;
use super::view::View;

/// How many recent presets are remembered.
const MOST_RECENT: usize = 8;

/// Remembered settings. What an older or newer program did not know takes its default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// How light is looked at.
    pub view: View,
    /// What the error plots show.
    pub plots: Plots,
    /// Presets opened or saved, the latest first.
    pub recent: Vec<PathBuf>,
    /// Memory for past iterations, in MiB.
    pub past_mib: usize,
    /// Iterations a second while playing.
    pub pace: f64,
    /// Whether edits run again by themselves.
    pub rerun: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            view: View::default(),
            plots: Plots::default(),
            recent: Vec::new(),
            past_mib: 512,
            pace: 4.0,
            rerun: false,
        }
    }
}

impl Settings {
    /// Memory for past iterations, in bytes.
    pub fn budget(&self) -> usize {
        self.past_mib << 20
    }

    /// Puts a preset first among the recent ones.
    pub fn remember(&mut self, path: &Path) {
        self.recent.retain(|known| known != path);
        self.recent.insert(0, path.to_path_buf());
        self.recent.truncate(MOST_RECENT);
    }
}
