//! What stands over each view.

use super::Session;
use super::comparison::{Sides, letter};
use super::view::Stage;
use crate::app::worker::look::{Of, Pane, Shown};
use crate::app::worker::rival::sides;

impl Session {
    /// The titles of all views.
    pub fn titles(&self) -> Vec<String> {
        self.sight.shown.iter().map(|shown| self.title(shown)).collect()
    }

    fn title(&self, shown: &Shown) -> String {
        let Pane { light, state, minus } = shown.pane;
        let symbol = light.letter(shown.iteration);
        let forgotten = if shown.forgotten { " (iteration no longer kept)" } else { "" };
        let by_propagators = self.comparison.sides == Sides::Propagators;
        let others = &self.run.others;
        let letter = |of: Of| letter(sides(others).iter().position(|side| *side == of).unwrap_or_default());
        match (self.settings.view.stage, minus) {
            (Stage::Compare, None) if by_propagators => {
                let Of::Track(track) = state.of else {
                    return format!("{}  what truly arrives", letter(state.of));
                };
                let name = self.run.curves.get(track).map_or("", |curves| curves.name.as_str());
                format!("{}  {name}:  {symbol}{forgotten}", letter(state.of))
            }
            (Stage::Compare, Some(other)) if by_propagators => {
                let of = if shown.pane.moved() { "light that has moved".to_owned() } else { symbol };
                format!("{} − {}:  {of}", letter(state.of), letter(other.of))
            }
            (Stage::Compare, Some(other)) => {
                let latest = self.run.progress.iteration;
                format!("k = {} minus k = {}", shown.iteration, other.iteration.unwrap_or(latest))
            }
            (Stage::Compare, None) => format!("k = {}:  {} {symbol}{forgotten}", shown.iteration, light.name()),
            _ => format!("{}  {}{forgotten}  ·  {}", light.name(), light.symbol(shown.iteration), light.about()),
        }
    }
}
