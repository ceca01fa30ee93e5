//! What commands do to the session, and which can be given.

use egui::Context;

use super::Session;
use super::command::Command;
use super::items::Tool;
use super::plots::Tab;
use super::view::{Stage, Workspace};
use crate::app::worker::look::Layer;
use crate::app::worker::{Order, Progress, Start};
use crate::report::colour::Paint;
use crate::report::slice::Axis;
use crate::simulation::Action;

impl Session {
    /// Whether a command can be given now.
    pub fn can(&self, command: Command) -> bool {
        let run = &self.run;
        if let Some(workspace) = command.workspace() {
            return Workspace::FILLED.contains(&workspace);
        }
        match command {
            Command::Undo => self.document.can_undo(),
            Command::Redo => self.document.can_redo(),
            Command::Stop => run.progress.until.is_some() || run.is_playing(),
            Command::Back | Command::First => self.seen() > run.progress.oldest,
            Command::Forward | Command::Last => run.at.is_some(),
            Command::Restart => run.at.is_some_and(|k| k < run.progress.iteration),
            Command::RunBefore => run.branches.around()[0],
            Command::RunAfter => run.branches.around()[1],
            Command::Measure => run.problem.is_some() && !self.asides.pareto.is_underway(),
            Command::ExportSheet => self.document.preset.scene.is_some(),
            Command::KeepRun => run.curves.iter().any(|curves| !curves.rows.is_empty()),
            _ => true,
        }
    }

    /// Does what a command says to the session; false where it is not the session's to do.
    pub fn perform(&mut self, command: Command) -> bool {
        let side = self.run.progress.side.max(1);
        let levels = self.run.progress.levels.max(1);
        let view = &mut self.settings.view;
        let level = if let Layer::Level(level) = view.layer { level } else { 0 };
        if let Some(workspace) = command.workspace() {
            self.settings.workspace = workspace;
            return true;
        }
        match command {
            Command::Undo => self.document.undo(),
            Command::Redo => self.document.redo(),
            Command::Clear => self.load(Start::Dark),
            Command::Inject => self.act(Action::Inject),
            Command::Downsample => self.act(Action::Downsample),
            Command::Propagate => self.next(),
            Command::Merge => self.act(Action::Merge),
            Command::RunAll => {
                let iteration = self.document.preset.actions();
                self.load(Start::To { iteration, merge: true });
            }
            Command::Rerun => self.run_again(),
            Command::Play => self.start_or_pause(),
            Command::Loop => self.settings.looping = !self.settings.looping,
            Command::Stop => {
                self.run.playing = None;
                self.run.send(Order::Stop);
            }
            Command::Back => self.run.at = Some(self.seen() - 1),
            Command::Forward => self.scrub(self.seen() + 1),
            Command::First => self.run.at = Some(self.run.progress.oldest),
            Command::Last => self.run.at = None,
            Command::Restart => {
                let k = self.seen();
                self.run.restart(k);
            }
            Command::RunBefore => self.run.send(Order::Back),
            Command::RunAfter => self.run.send(Order::Forward),
            Command::SliceDown => view.index = view.index.saturating_sub(1),
            Command::SliceUp => view.index = (view.index + 1).min(side - 1),
            Command::NextAxis => view.axis = Axis::ALL[(view.axis.across() + 1) % 3],
            Command::Finer => view.layer = Layer::Level(level.saturating_sub(1)),
            Command::Coarser => {
                let coarser = if view.layer == Layer::Merged { 0 } else { level + 1 };
                view.layer = Layer::Level(coarser.min(levels - 1));
            }
            Command::Merged => {
                view.layer = if view.layer == Layer::Merged { Layer::Level(0) } else { Layer::Merged };
            }
            Command::NextPaint => {
                let at = Paint::ALL.iter().position(|paint| *paint == view.paint).unwrap_or_default();
                view.paint = Paint::ALL[(at + 1) % Paint::ALL.len()];
            }
            Command::Grids => self.turn_to(Stage::Grids),
            Command::Compare => self.compare(),
            Command::Space => self.turn_to(Stage::Space),
            Command::Errors => self.settings.plots.tab = Tab::Errors,
            Command::Line => self.settings.plots.tab = Tab::Line,
            Command::RunTime => self.settings.plots.tab = Tab::Pareto,
            Command::Measure => {
                self.settings.plots.tab = Tab::Pareto;
                self.measure();
            }
            Command::KeepRun => self.run.keep(),
            Command::SelectTool => self.tool = Tool::Select,
            Command::LightTool => self.tool = Tool::Light,
            Command::OccluderTool => self.tool = Tool::Occluder,
            Command::ProbeTool => self.tool = Tool::Probe,
            Command::SplitPicture => self.picture.turn_split(),
            Command::FalseColour => self.picture.false_colour = !self.picture.false_colour,
            Command::RefineTruth => self.picture.refine = !self.picture.refine,
            Command::FoldScene => self.settings.folds.turn_scene(self.size),
            Command::FoldPlots => self.settings.folds.turn_plots(self.size),
            _ => return false,
        }
        true
    }

    /// Shows propagators side by side; the first time it finds one to compare with.
    fn compare(&mut self) {
        self.settings.view.stage = Stage::Compare;
        if self.comparison.others.is_empty() {
            let stale = self.is_stale();
            self.comparison.begin(&self.document.preset);
            // Edits that wait to be run are not run behind the researcher's back.
            if !stale {
                self.run_again();
            }
        }
    }

    /// Shows something else; a run that was begun to be looked at side by side ends with that.
    fn turn_to(&mut self, stage: Stage) {
        self.settings.view.stage = stage;
        if std::mem::take(&mut self.comparison.begun) {
            self.comparison.others.clear();
            self.comparison.star = 0;
            self.run.go_alone();
        }
    }

    /// Runs the scene as edited, as far as the present run has come, or is to come while it is under way.
    pub(super) fn run_again(&mut self) {
        let Progress { iteration, until, merged, .. } = self.run.progress;
        self.load(Start::To { iteration: until.unwrap_or(iteration), merge: merged });
    }

    /// Has a graphics card iterate from now on, or the processor, and runs again.
    pub fn compute_on(&mut self, card: bool) {
        self.settings.on_card = card;
        self.run_again();
    }

    /// Does one action with every propagator.
    pub(super) fn act(&mut self, action: Action) {
        self.run.at = None;
        self.run.send(Order::Act(action));
    }

    /// Shows iteration `k`; the latest is followed.
    pub fn scrub(&mut self, k: usize) {
        let progress = &self.run.progress;
        self.run.at = (k < progress.iteration).then_some(k.max(progress.oldest));
    }

    /// Shows the iteration after the one that is seen; computes it where it is not there yet.
    fn next(&mut self) {
        match self.run.at {
            Some(k) => self.scrub(k + 1),
            None => self.act(Action::Propagate),
        }
    }

    /// Begins to play, from the start where the end is seen; or pauses.
    fn start_or_pause(&mut self) {
        let progress = &self.run.progress;
        let ended = self.run.at.is_none() && progress.iteration >= self.document.preset.actions();
        if self.run.is_playing() {
            self.run.playing = None;
            return;
        }
        if ended && progress.oldest < progress.iteration {
            self.run.at = Some(progress.oldest);
        }
        self.run.playing = Some(0.0);
    }

    /// Takes the next step of what plays, once it is due and the one before has been seen: iterations that are there
    /// are replayed, then it computes on.
    pub(super) fn play(&mut self, ctx: &Context, now: f64) {
        let Some(due) = self.run.playing else { return };
        if now < due {
            ctx.request_repaint_after_secs((due - now).min(1.0) as f32);
            return;
        }
        if self.run.waiting.is_some() || !self.sight.answered {
            // News wake the window.
            return;
        }
        let progress = &self.run.progress;
        let (oldest, latest) = (progress.oldest, progress.iteration);
        match self.run.at {
            Some(k) => self.scrub(k + 1),
            None if latest < self.document.preset.actions() => self.act(Action::Propagate),
            None if self.settings.looping && oldest < latest => self.run.at = Some(oldest),
            None => {
                self.run.playing = None;
                return;
            }
        }
        let pause = 1.0 / self.settings.pace.max(0.1);
        self.run.playing = Some(now + pause);
        ctx.request_repaint_after_secs(pause as f32);
    }
}
