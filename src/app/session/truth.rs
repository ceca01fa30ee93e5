//! What truly arrives in the scene: computed aside where somebody wants to see it, and kept while the scene's
//! light and occluders stay as they are.

use std::sync::Arc;

use egui::{Context, Ui};

use crate::app::lab::Lab;
use crate::app::panels::compare::Rival;
use crate::app::panels::controls;
use crate::app::session::errand::Errand;
use crate::app::session::view::Stage;
use crate::app::worker::Order;
use crate::scene::Problem;
use crate::study::error::Metric;
use crate::transport::ballistic::Ballistic;

/// The ballistic reference of the scene that runs, as far as it is known.
#[derive(Debug, Default)]
pub struct Truth {
    state: State,
    /// Whether the worker measures against it.
    handed: bool,
}

#[derive(Debug, Default)]
enum State {
    #[default]
    Unknown,
    Underway(Arc<Problem>, Errand<Arc<Ballistic>>),
    Known(Arc<Ballistic>),
    /// Called off, or failed, for this scene.
    GivenUp(Arc<Problem>),
}

impl Truth {
    /// Whether it is being computed.
    pub fn is_underway(&self) -> bool {
        matches!(self.state, State::Underway(..))
    }

    /// What is known.
    pub fn known(&self) -> Option<&Arc<Ballistic>> {
        match &self.state {
            State::Known(truth) => Some(truth),
            _ => None,
        }
    }

    /// Forgets what is not about `problem`.
    pub fn turn_to(&mut self, problem: &Problem) {
        let fits = match &self.state {
            State::Unknown => true,
            State::Known(truth) => truth.is_of(problem),
            State::Underway(other, _) | State::GivenUp(other) => alike(other, problem),
        };
        if !fits {
            *self = Truth::default();
        }
    }

    /// Starts to compute it, if nothing is known or under way.
    fn seek(&mut self, problem: &Arc<Problem>, ctx: &Context) -> std::io::Result<()> {
        if matches!(self.state, State::Unknown) {
            let ours = Arc::clone(problem);
            let errand = Errand::start("straight lines", ctx, move |watch| {
                let found = Ballistic::new(&ours, &|share| watch.go_on(share));
                found.map(Arc::new).ok_or_else(|| "the straight lines were given up".to_owned())
            })?;
            self.state = State::Underway(Arc::clone(problem), errand);
        }
        Ok(())
    }
}

/// Whether the same light takes the same ways; how it is propagated does not matter.
fn alike(a: &Problem, b: &Problem) -> bool {
    a.size == b.size && a.sources == b.sources && a.solids == b.solids && a.occlusion.mode == b.occlusion.mode
}

impl Lab {
    /// Whether something on screen is measured against what truly arrives.
    pub(in crate::app) fn wants_truth(&self) -> bool {
        let seen = self.settings.view.stage == Stage::Compare && self.others.contains(&Rival::Ballistic);
        seen || self.settings.plots.metric() == Metric::Ballistic
    }

    /// Has what truly arrives computed where it is wanted, and hands it to the worker.
    pub(in crate::app) fn seek_truth(&mut self, ctx: &Context) {
        let wanted = self.wants_truth();
        if let (true, Some(problem)) = (wanted, &self.problem)
            && let Err(error) = self.truth.seek(problem, ctx)
        {
            self.truth.state = State::GivenUp(Arc::clone(problem));
            self.fail(format!("no thread for the straight lines: {error}"));
        }
        if let State::Underway(problem, errand) = &self.truth.state {
            match errand.answer() {
                Some(Ok(truth)) => self.truth.state = State::Known(truth),
                Some(Err(line)) => {
                    self.truth.state = State::GivenUp(Arc::clone(problem));
                    self.fail(line);
                }
                None => ctx.request_repaint_after_secs(0.1),
            }
        }
        let known = self.truth.known().filter(|_| wanted).cloned();
        if known.is_some() != self.truth.handed {
            self.truth.handed = known.is_some();
            self.answered = false;
            self.worker.order(Order::Truth(known));
        }
    }

    /// How far what truly arrives is, and a way to call it off or begin again; nothing once it is known.
    pub(in crate::app) fn truth_progress(&mut self, ui: &mut Ui) {
        match &self.truth.state {
            State::Underway(problem, errand) => {
                let problem = Arc::clone(problem);
                let bar = egui::ProgressBar::new(errand.share() as f32).desired_width(140.0).show_percentage();
                ui.label("Straight lines");
                controls::name(&ui.add(bar), "Progress of the straight lines");
                let cancel = ui.button("Cancel").on_hover_text("Do without what truly arrives");
                controls::name(&cancel, "Cancel the straight lines");
                if cancel.clicked() {
                    self.truth.state = State::GivenUp(problem);
                }
            }
            State::GivenUp(_) => {
                ui.label("What truly arrives was not computed.");
                if ui.button("Compute it").clicked() {
                    self.truth.state = State::Unknown;
                }
            }
            State::Unknown | State::Known(_) => {}
        }
    }
}
