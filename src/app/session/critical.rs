//! Whether a factor that is being edited is more than a level bears: found aside, shown beside its field.

use egui::{Context, RichText, Ui};

use crate::app::lab::Lab;
use crate::app::panels::compare::Rival;
use crate::app::session::errand::Errand;
use crate::app::session::view::Stage;
use crate::scene::Propagation;
use crate::study::stability::outlook::{self, Exceeded};

/// What critical factors depend on.
#[derive(Clone, Debug, Default, PartialEq)]
struct Settings {
    /// The document's own propagator first.
    propagators: Vec<Propagation>,
    size: usize,
    coarsest: usize,
}

/// What is known of the factors that are being edited.
#[derive(Debug, Default)]
pub struct Critical {
    of: Settings,
    found: Vec<Option<Exceeded>>,
    underway: Option<Errand<Vec<Option<Exceeded>>>>,
}

impl Critical {
    /// Whether it is being found out.
    pub fn is_underway(&self) -> bool {
        self.underway.is_some()
    }

    /// The level whose critical factor a propagator exceeds; 0 is the document's own, and rivals are counted from 1.
    pub fn exceeded(&self, propagator: usize) -> Option<Exceeded> {
        self.found.get(propagator).copied().flatten()
    }
}

/// The warning beneath a factor's field.
pub fn warning(ui: &mut Ui, exceeded: Option<Exceeded>) {
    let Some(Exceeded { level, side, critical }) = exceeded else { return };
    let text =
        format!("⚠ above {critical:.2}, the critical factor of level {level} ({side}³): its light grows without bound");
    ui.add(egui::Label::new(RichText::new(text).color(ui.visuals().warn_fg_color)).wrap());
}

impl Lab {
    /// Finds out anew where a setting has changed.
    pub(in crate::app) fn watch_factors(&mut self, ctx: &Context) {
        let preset = &self.document.preset;
        let rivals = if self.settings.view.stage == Stage::Compare { self.comparison.others.as_slice() } else { &[] };
        let of_rival = |rival: &Rival| match rival {
            Rival::Propagator(propagation) => propagation.clone(),
            Rival::Uniform | Rival::Ballistic => preset.propagation.clone(),
        };
        let own = preset.propagation.clone();
        let propagators = std::iter::once(own).chain(rivals.iter().map(of_rival)).collect();
        let now = Settings { propagators, size: preset.size, coarsest: preset.coarsest };
        // While a factor is dragged there is one errand at a time.
        if now != self.critical.of && self.critical.underway.is_none() {
            let asked = now.clone();
            let errand = Errand::start("critical factors", ctx, move |_| {
                let each = asked.propagators.iter();
                Ok(each.map(|propagation| outlook::exceeded(propagation, asked.size, asked.coarsest)).collect())
            });
            match errand {
                Ok(errand) => (self.critical.of, self.critical.underway) = (now, Some(errand)),
                Err(error) => self.fail(format!("no thread to find critical factors on: {error}")),
            }
        }
        if let Some(answer) = self.critical.underway.as_ref().and_then(Errand::answer) {
            self.critical.underway = None;
            match answer {
                Ok(found) => self.critical.found = found,
                Err(line) => self.fail(line),
            }
        }
    }
}
