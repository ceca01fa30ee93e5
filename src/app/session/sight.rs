//! What is seen: the views as they came from the worker, and what was asked for.

use std::sync::Arc;

use super::Session;
use super::plots::{Plots, Tab};
use super::view::{Scaling, Stage, Workspace};
use crate::app::worker::Order;
use crate::app::worker::look::{Brightest, Cloud, CloudAsk, Light, Look, Of, Pane, Pin, PinSample, Shown, State};
use crate::app::worker::rival::sides;
use crate::study::expectation::Expectation;

/// The part of the largest glyphs that may be cut off by their cells on a linear scale.
pub const LINEAR_QUANTILE: f32 = 0.99;

/// How light in space is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceLook {
    /// Lobes in place of cubes.
    pub lobes: bool,
    /// The share of the strongest light below which cells are left out.
    pub threshold: f32,
    /// Whether it is drawn over the mesh, too.
    pub over_mesh: bool,
}

impl Default for SpaceLook {
    fn default() -> Self {
        SpaceLook { lobes: false, threshold: 0.01, over_mesh: true }
    }
}

/// What is seen.
#[derive(Debug)]
pub struct Sight {
    /// The flat views.
    pub shown: Vec<Shown>,
    /// The light in space, while it is shown.
    pub cloud: Option<Arc<Cloud>>,
    /// Counts what came from the worker, so that what was drawn of it can be told to be out of date.
    pub edition: u64,
    /// What was asked for.
    pub asked: Option<Look>,
    /// Whether the views show it, after the last action.
    pub answered: bool,
    /// The metric that the worker was told to measure by first.
    measured_by: Option<(Option<Expectation>, usize)>,
    /// How light in space is looked at.
    pub space: SpaceLook,
    /// The cell that stays in sight.
    pub pin: Option<Pin>,
    /// What it has held so far.
    pub pinned: Vec<PinSample>,
    /// Whether slices are still to be moved to where the light is.
    pub centre: bool,
}

impl Default for Sight {
    fn default() -> Self {
        Sight {
            shown: Vec::new(),
            cloud: None,
            edition: 0,
            asked: None,
            answered: false,
            measured_by: None,
            space: SpaceLook::default(),
            pin: None,
            pinned: Vec::new(),
            centre: true,
        }
    }
}

impl Sight {
    /// Takes views in, if they are what was last asked for.
    pub fn take(&mut self, look: &Look, panes: Vec<Shown>, cloud: Option<Cloud>) {
        if self.asked.as_ref() == Some(look) {
            self.answered = true;
            self.shown = panes;
            self.edition += 1;
            self.cloud = cloud.map(Arc::new);
        }
    }
}

impl Session {
    /// Has measured first what the plots show.
    pub(super) fn choose_metric(&mut self) {
        let metric = (self.settings.plots.tab == Tab::Errors).then_some(self.metric());
        let Of::Track(star) = self.star() else { return self.measure_by(metric, 0) };
        self.measure_by(metric, star);
    }

    fn measure_by(&mut self, metric: Option<Expectation>, star: usize) {
        let before = self.sight.measured_by.replace((metric, star));
        if before == Some((metric, star)) {
            return;
        }
        if before.is_some_and(|(_, old)| old != star) {
            let curves = self.run.curves.iter_mut();
            curves.for_each(|curves| curves.rows.retain(|row| row.expectation != Expectation::Run));
        }
        self.sight.answered = false;
        self.run.worker.order(Order::Measure(metric, star));
    }

    /// Whose light the others are held against, of what runs.
    pub fn star(&self) -> Of {
        sides(&self.run.others).get(self.comparison.star).copied().unwrap_or(Of::Track(0))
    }

    /// What errors are against: where that is the run with the star, a run by itself is held against its uniform volume,
    /// and what truly arrives is a metric of its own.
    pub fn metric(&self) -> Expectation {
        match self.settings.plots.metric {
            Expectation::Run if self.star() == Of::Truth => Expectation::Ballistic,
            Expectation::Run if self.run.curves.len() < 2 => Expectation::Merged,
            metric => metric,
        }
    }

    /// What the plots show, with what errors are against in the place of the choice of the star.
    pub fn plots(&self) -> Plots {
        Plots { metric: self.metric(), ..self.settings.plots.clone() }
    }

    /// What errors of cells are against: the same as in the plots.
    pub fn against(&self) -> Expectation {
        self.metric()
    }

    /// What is to be seen.
    pub(super) fn look(&self) -> Look {
        let view = &self.settings.view;
        let state = State { of: Of::Track(0), iteration: self.run.at };
        let pane = |light| Pane { light, state, minus: None };
        let over_mesh = self.settings.workspace == Workspace::Scene && self.sight.space.over_mesh;
        let (panes, cloud) = match view.stage {
            _ if over_mesh && self.document.preset.scene.is_some() => {
                let ask = CloudAsk { pane: pane(self.comparison.light), threshold: self.sight.space.threshold };
                (vec![ask.pane], Some(ask))
            }
            Stage::Grids => (Light::ALL.map(pane).to_vec(), None),
            Stage::Compare => (self.comparison.panes(self.run.at, &self.run.others), None),
            Stage::Space => {
                let ask = CloudAsk { pane: pane(self.comparison.light), threshold: self.sight.space.threshold };
                (vec![ask.pane], Some(ask))
            }
        };
        // Of a linear scale a few of the largest glyphs may be cut off by their cells.
        let quantile = if view.scaling == Scaling::Linear { LINEAR_QUANTILE } else { 1.0 };
        let brightest = Brightest { hue: view.hue, quantile };
        Look { panes, layer: view.layer, plane: view.plane(), against: self.against(), brightest, cloud }
    }

    /// Why nothing is to be seen, where that is so.
    pub fn why_dark(&self) -> Option<&'static str> {
        let problem = self.run.problem.as_ref()?;
        if !self.sight.answered || self.run.progress.lit > 0 {
            return None;
        }
        Some(match problem.sources.is_empty() {
            true => "No light: add an injector, or switch one on.",
            false => "Dark: inject the light (I), or run it all (R).",
        })
    }

    /// Keeps a cell in sight, or none.
    pub fn set_pin(&mut self, pin: Option<Pin>) {
        self.sight.pin = pin;
        self.sight.pinned.clear();
        self.run.worker.order(Order::Pin(pin));
    }
}
