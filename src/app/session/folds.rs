//! Which panels are folded away: as was chosen, else those that a small window has no room for.

use egui::Vec2;
use serde::{Deserialize, Serialize};

/// The width below which the scene's panel is folded, and the height below which the plots are, in points.
const NARROW: f32 = 860.0;
const SHORT: f32 = 560.0;

/// What was chosen; `None` where the window's size decides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Folds {
    /// Whether the scene's panel is folded.
    scene: Option<bool>,
    /// Whether the plots are folded.
    plots: Option<bool>,
}

impl Folds {
    /// Whether the scene's panel is folded in a window of this size, in points.
    pub fn scene(&self, size: Vec2) -> bool {
        self.scene.unwrap_or(size.x < NARROW)
    }

    /// Whether the plots are folded.
    pub fn plots(&self, size: Vec2) -> bool {
        self.plots.unwrap_or(size.y < SHORT)
    }

    /// Folds the scene's panel, or opens it.
    pub fn turn_scene(&mut self, size: Vec2) {
        self.scene = Some(!self.scene(size));
    }

    /// Folds the plots, or opens them.
    pub fn turn_plots(&mut self, size: Vec2) {
        self.plots = Some(!self.plots(size));
    }
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;

    #[test]
    fn small_windows_fold_what_was_not_chosen_to_stay() {
        let (small, large) = (vec2(640.0, 400.0), vec2(1280.0, 800.0));
        let mut folds = Folds::default();
        assert!(folds.scene(small) && folds.plots(small) && !folds.scene(large) && !folds.plots(large));
        folds.turn_scene(small);
        assert!(!folds.scene(small) && folds.plots(small));
    }
}
