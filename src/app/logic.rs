//! What happens between frames: news from the worker, keys, play, files; and what is asked to be seen.

use std::path::Path;
use std::sync::Arc;

use egui::Context;

use crate::app::files::dialog::Purpose;
use crate::app::lab::Lab;
use crate::app::panels::closing::Next;
use crate::app::panels::errors::Tab;
use crate::app::session::command::{self, Command};
use crate::app::session::view::Stage;
use crate::app::worker::look::{Against, CloudAsk, Light, Look, Of, Pane, State};
use crate::app::worker::{News, Order};
use crate::simulation::Action;
use crate::study::error::Metric;
use crate::transport::preset;

impl Lab {
    /// Everything that happens between frames: news, keys, play.
    pub fn logic(&mut self, ctx: &Context) {
        let news: Vec<News> = self.worker.news().collect();
        news.into_iter().for_each(|news| self.hear(news));
        // While a question stands, keys are for answering it.
        if self.next.is_none() && !self.files.asks() {
            for command in command::pressed(ctx, |command| self.can(command)) {
                self.perform(command, ctx);
            }
        }
        let now = ctx.input(|input| input.time);
        if self.waiting.is_some_and(f64::is_nan) {
            self.waiting = Some(now);
        }
        self.play(ctx, now);
        if self.document.note(now) {
            ctx.request_repaint_after_secs(0.25);
        }
        self.keep_unsaved(ctx, now);
        if self.settings.rerun && self.is_stale() && self.is_idle() && preset::check(&self.document.preset).is_ok() {
            self.perform(Command::Rerun, ctx);
        }
        if let Some((purpose, path)) = self.files.chosen() {
            self.use_file(purpose, &path, ctx);
        }
        self.drop_files(ctx);
        self.choose_metric();
        self.seek_truth(ctx);
        self.seek_profiles(ctx);
        self.hear_pareto(ctx);
        self.watch_factors(ctx);
        let look = self.look();
        if self.asked.as_ref() != Some(&look) {
            self.worker.order(Order::Look(look.clone()));
            self.asked = Some(look);
            self.answered = false;
        }
    }

    /// Has measured first what the plots show.
    fn choose_metric(&mut self) {
        let plots = &self.settings.plots;
        let metric = (plots.tab == Tab::Errors).then(|| plots.metric());
        if self.measured_by != metric {
            self.measured_by = metric;
            self.answered = false;
            self.worker.order(Order::Measure(metric));
        }
    }

    fn play(&mut self, ctx: &Context, now: f64) {
        let Some(due) = self.playing else { return };
        if self.progress.iteration >= self.document.preset.propagation.iterations {
            self.playing = None;
            return;
        }
        if now >= due && self.waiting.is_none() {
            self.act(Action::Propagate);
            self.playing = Some(now + 1.0 / self.settings.pace.max(0.1));
        }
        ctx.request_repaint_after_secs((due - now).clamp(0.005, 1.0) as f32);
    }

    fn hear(&mut self, news: News) {
        match news {
            News::Loaded(problem) => {
                self.truth.turn_to(&problem);
                self.problem = Some(problem);
            }
            News::Measured { iteration, metric, errors, behind } => {
                self.progress.behind = behind;
                for (run, measured) in self.runs.iter_mut().zip(errors) {
                    run.put(iteration, metric, measured);
                }
            }
            News::Done { change, progress } => {
                self.waiting = None;
                self.answered = false;
                self.change = change.or(self.change);
                self.progress = progress;
                if self.centre {
                    self.centre = false;
                    self.settings.view.index = progress.brightest[self.settings.view.across.min(2)];
                }
                let same = change.is_none_or(|change| change.action == Action::Merge);
                let from = progress.iteration + usize::from(same);
                self.runs.iter_mut().for_each(|run| run.forget_from(from));
            }
            News::Shown { look, panes, cloud } => {
                if self.asked.as_ref() == Some(&look) {
                    self.answered = true;
                    self.shown = panes;
                    self.scales = None;
                    self.cloud = cloud.map(Arc::new);
                }
            }
            News::Pinned(pin, samples) => {
                if self.pin == Some(pin) {
                    self.pinned = samples;
                }
            }
            News::Warned(line) => self.say(line),
            News::Failed(line) => {
                self.waiting = None;
                self.answered = true;
                self.progress.until = None;
                self.fail(line);
            }
        }
    }

    /// Does with a file what it was chosen for.
    fn use_file(&mut self, purpose: Purpose, path: &Path, ctx: &Context) {
        match purpose {
            Purpose::Open => self.ask_to_lose(Next::Open(path.to_path_buf()), ctx),
            Purpose::SaveAs => self.save_as(Some(path.to_path_buf())),
            Purpose::Export(command) => self.export(command, path),
            Purpose::Injector(i) => self.injector_file(i, path),
            Purpose::Occluder(i) => self.occluder_file(i, path),
        }
    }

    /// What errors of cells are against: the same as in the plots.
    pub(super) fn against(&self) -> Against {
        match self.settings.plots.metric() {
            Metric::Thesis => Against::Children,
            Metric::Corrected | Metric::Merged => Against::Uniform,
            Metric::Ballistic => Against::Truth,
        }
    }

    /// What is to be seen.
    fn look(&self) -> Look {
        let view = &self.settings.view;
        let state = State { of: Of::Track(0), iteration: self.at };
        let pane = |light| Pane { light, state, minus: None };
        let (panes, cloud) = match view.stage {
            Stage::Grids => (Light::ALL.map(pane).to_vec(), None),
            Stage::Compare => (self.comparison.panes(self.at, &self.others), None),
            Stage::Space => {
                let ask = CloudAsk { pane: pane(self.comparison.light), threshold: self.space.eye.threshold };
                (vec![ask.pane], Some(ask))
            }
        };
        Look { panes, layer: view.layer, plane: view.plane(), against: self.against(), cloud }
    }
}
