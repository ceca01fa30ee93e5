//! The window's state, and what each command does to it. How it looks is in [`super::layout`].

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::Context;

use super::closing::Next;
use super::command::{self, Command};
use super::compare::{Comparison, describe};
use super::controls::Wish;
use super::document::Document;
use super::errors::Run;
use super::files::{Files, Purpose};
use super::grids::{Grids, Pointed};
use super::look::{Cloud, CloudAsk, Layer, Light, Look, Pane, Pin, PinSample, Shown, State};
use super::settings::Settings;
use super::space::Space;
use super::view::Stage;
use super::worker::{Load, News, Order, Progress, Start, Worker};
use crate::field::Levels;
use crate::scene::{Preset, Propagation};
use crate::simulation::{Action, Change};

/// A line at the window's foot.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// What it says.
    pub text: String,
    /// Whether something went wrong.
    pub error: bool,
}

/// The whole window.
pub struct Lab {
    pub(super) worker: Worker,
    pub(super) settings: Settings,
    pub(super) document: Document,
    /// What the present results were made from.
    pub(super) ran: Preset,
    /// The propagators that ran beside the preset's own.
    others: Vec<Propagation>,
    pub(super) progress: Progress,
    /// What the last action changed.
    pub(super) change: Option<Change>,
    /// The error curves of the present run, the document's own propagator first.
    pub(super) runs: Vec<Run>,
    /// The curves of earlier runs.
    pub(super) kept: Vec<Run>,
    pub(super) shown: Vec<Shown>,
    pub(super) cloud: Option<Arc<Cloud>>,
    asked: Option<Look>,
    /// Whether the views show what was asked for, after the last action.
    answered: bool,
    /// The iteration that is seen; `None` follows the latest.
    pub(super) at: Option<usize>,
    pub(super) grids: Grids,
    pub(super) space: Space,
    pub(super) comparison: Comparison,
    pub(super) pointed: Option<Pointed>,
    pub(super) pin: Option<Pin>,
    pub(super) pinned: Vec<PinSample>,
    /// The injector that waits for a click to be placed.
    pub(super) placing: Option<usize>,
    pub(super) files: Files,
    pub(super) notice: Option<Notice>,
    /// Whether slices are still to be moved to where the light is.
    centre: bool,
    /// When the next iteration is due, in seconds, while playing.
    playing: Option<f64>,
    /// Since when an action's news are waited for, in seconds.
    pub(super) waiting: Option<f64>,
    pub(super) keys_open: bool,
    /// Whether the window may close although edits are not saved.
    pub(super) discard: bool,
    /// What waits for edits to be saved or given up.
    pub(super) next: Option<Next>,
}

impl Lab {
    /// A window on a preset, with its file if it has one.
    pub fn new(ctx: &Context, preset: Preset, path: Option<PathBuf>, settings: Settings) -> std::io::Result<Self> {
        let wake = ctx.clone();
        let worker = Worker::start(settings.budget(), move || wake.request_repaint())?;
        let files = Files::new(ctx);
        let mut lab = Lab {
            worker,
            settings,
            ran: preset.clone(),
            document: Document::new(preset, path),
            progress: Progress::default(),
            change: None,
            runs: Vec::new(),
            kept: Vec::new(),
            shown: Vec::new(),
            cloud: None,
            asked: None,
            answered: false,
            at: None,
            grids: Grids::default(),
            space: Space::default(),
            comparison: Comparison::default(),
            others: Vec::new(),
            pointed: None,
            pin: None,
            pinned: Vec::new(),
            placing: None,
            files,
            notice: None,
            centre: true,
            playing: None,
            waiting: None,
            keys_open: false,
            discard: false,
            next: None,
        };
        lab.begin();
        Ok(lab)
    }

    /// The preset as edited.
    pub fn preset(&self) -> &Preset {
        &self.document.preset
    }

    /// The present iteration.
    pub fn iteration(&self) -> usize {
        self.progress.iteration
    }

    /// The views as they are.
    pub fn shown(&self) -> &[Shown] {
        &self.shown
    }

    /// The light in space, while it is shown.
    pub fn cloud(&self) -> Option<&Cloud> {
        self.cloud.as_deref()
    }

    /// The error curves: the present run's, then those kept.
    pub fn curves(&self) -> Vec<&Run> {
        self.runs.iter().chain(&self.kept).collect()
    }

    /// What is remembered.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Whether nothing is being computed or waited for.
    pub fn is_idle(&self) -> bool {
        self.answered && self.waiting.is_none() && self.progress.until.is_none() && self.playing.is_none()
    }

    /// Whether the results were made from the scene as it is now.
    pub fn is_stale(&self) -> bool {
        essence(&self.document.preset) != essence(&self.ran) || self.others != self.comparison.others
    }

    /// Whether iterations follow each other by themselves.
    pub fn is_playing(&self) -> bool {
        self.playing.is_some()
    }

    /// The iteration that is seen.
    pub fn seen(&self) -> usize {
        self.at.unwrap_or(self.progress.iteration)
    }

    /// Takes another document onto the desk; what was on it is gone.
    fn take(&mut self, document: Document) {
        self.document = document;
        if let Some(path) = self.document.path() {
            self.settings.remember(path);
        }
        self.kept.clear();
        self.pin = None;
        self.placing = None;
        self.centre = true;
        self.begin();
    }

    /// Shows the injected light of a document that was just opened.
    fn begin(&mut self) {
        self.load(Start::To { iteration: 0, merge: false });
    }

    /// Hands the document to the worker.
    fn load(&mut self, start: Start) {
        if let Err(problem) = self.document.preset.check() {
            self.fail(problem.to_string());
            return;
        }
        self.ran = self.document.preset.clone();
        self.others.clone_from(&self.comparison.others);
        let propagators = std::iter::once(&self.document.preset.propagation).chain(&self.others);
        let runs = propagators.enumerate().map(|(i, propagation)| Run {
            name: describe(propagation),
            rows: Vec::new(),
            color: self.kept.len() + i,
        });
        self.runs = runs.collect();
        self.at = None;
        self.playing = None;
        self.notice = None;
        let Preset { size, coarsest, .. } = self.document.preset;
        let levels = Levels::new(size, coarsest).map_or(1, |levels| levels.count());
        self.progress = Progress { side: size, levels, ..Progress::default() };
        let load = Load {
            preset: self.document.preset.clone(),
            folder: self.document.folder(),
            others: self.others.clone(),
            start,
        };
        self.send(Order::Load(Box::new(load)));
        // What is to be seen outlasts scenes, but the worker answers for the scene it was asked with.
        self.asked = None;
    }

    fn send(&mut self, order: Order) {
        self.worker.order(order);
        self.waiting = self.waiting.or(Some(f64::NAN));
    }

    pub(super) fn fail(&mut self, text: String) {
        self.notice = Some(Notice { text, error: true });
        self.playing = None;
    }

    pub(super) fn say(&mut self, text: String) {
        self.notice = Some(Notice { text, error: false });
    }

    /// Opens a preset, or tells why it cannot be.
    pub fn open(&mut self, path: &Path) {
        match Preset::load(path) {
            Ok(preset) => self.take(Document::new(preset, Some(path.to_path_buf()))),
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Opens a preset that the program brings along.
    pub fn open_built_in(&mut self, name: &str) {
        match Document::built_in(name) {
            Ok(document) => self.take(document),
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Whether a command can be given now.
    pub fn can(&self, command: Command) -> bool {
        match command {
            Command::Undo => self.document.can_undo(),
            Command::Redo => self.document.can_redo(),
            Command::Stop => self.progress.until.is_some() || self.is_playing(),
            Command::Back | Command::First => self.seen() > self.progress.oldest,
            Command::Forward | Command::Last => self.at.is_some(),
            Command::Restart => self.at.is_some_and(|k| k < self.progress.iteration),
            Command::KeepRun => self.runs.iter().any(|run| !run.rows.is_empty()),
            _ => true,
        }
    }

    /// Does what a command says.
    pub fn perform(&mut self, command: Command, ctx: &Context) {
        if !self.can(command) {
            return;
        }
        let level = self.level();
        let view = &mut self.settings.view;
        match command {
            Command::Open => self.files.ask(Purpose::Open, self.document.path()),
            Command::Save => self.save(),
            Command::SaveAs => self.files.ask(Purpose::SaveAs, self.document.path()),
            Command::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            Command::Undo => self.document.undo(),
            Command::Redo => self.document.redo(),
            Command::Clear => self.load(Start::Dark),
            Command::Inject => self.act(Action::Inject),
            Command::Downsample => self.act(Action::Downsample),
            Command::Propagate => self.act(Action::Propagate),
            Command::Merge => self.act(Action::Merge),
            Command::RunAll => {
                let iteration = self.document.preset.propagation.iterations;
                self.load(Start::To { iteration, merge: true });
            }
            Command::Rerun => {
                let Progress { iteration, merged, .. } = self.progress;
                self.load(Start::To { iteration, merge: merged });
            }
            Command::Play => self.playing = if self.is_playing() { None } else { Some(0.0) },
            Command::Stop => {
                self.playing = None;
                self.send(Order::Stop);
            }
            Command::Back => self.at = Some(self.seen() - 1),
            Command::Forward => self.scrub(self.seen() + 1),
            Command::First => self.at = Some(self.progress.oldest),
            Command::Last => self.at = None,
            Command::Restart => {
                let k = self.seen();
                self.at = None;
                self.send(Order::Restart(k));
            }
            Command::SliceDown => view.index = view.index.saturating_sub(1),
            Command::SliceUp => view.index = (view.index + 1).min(self.progress.side.max(1) - 1),
            Command::NextAxis => view.across = (view.across + 1) % 3,
            Command::Finer => view.layer = Layer::Level(level.saturating_sub(1)),
            Command::Coarser => {
                let coarser = if view.layer == Layer::Merged { 0 } else { level + 1 };
                view.layer = Layer::Level(coarser.min(self.progress.levels.max(1) - 1));
            }
            Command::Merged => {
                view.layer = if view.layer == Layer::Merged { Layer::Level(0) } else { Layer::Merged };
            }
            Command::WholeSlice => self.grids.whole(),
            Command::Grids => view.stage = Stage::Grids,
            Command::Compare => self.compare(ctx),
            Command::Space => view.stage = Stage::Space,
            Command::KeepRun => self.keep_run(),
            Command::ExportCsv | Command::ExportSvg | Command::ExportPng | Command::ExportGrids => {
                self.files.ask(Purpose::Export(command), self.document.path());
            }
            Command::CopyCurves => self.copy_curves(ctx),
            Command::Keys => self.keys_open = !self.keys_open,
        }
    }

    /// Shows propagators side by side; the first time it finds one to compare with.
    fn compare(&mut self, ctx: &Context) {
        self.settings.view.stage = Stage::Compare;
        if self.comparison.others.is_empty() {
            let stale = self.is_stale();
            self.comparison.add(&self.document.preset.propagation);
            // Edits that wait to be run are not run behind the researcher's back.
            if !stale {
                self.perform(Command::Rerun, ctx);
            }
        }
    }

    fn level(&self) -> usize {
        match self.settings.view.layer {
            Layer::Level(level) => level,
            Layer::Merged => 0,
        }
    }

    fn act(&mut self, action: Action) {
        self.at = None;
        self.send(Order::Act(action));
    }

    /// Shows iteration `k`; the latest is followed.
    pub fn scrub(&mut self, k: usize) {
        self.at = (k < self.progress.iteration).then_some(k.max(self.progress.oldest));
    }

    fn keep_run(&mut self) {
        self.kept.append(&mut self.runs.clone());
        for run in &mut self.runs {
            run.color += 1;
        }
    }

    fn save(&mut self) {
        if self.document.path().is_none() {
            self.files.ask(Purpose::SaveAs, None);
        } else {
            self.save_as(None);
        }
    }

    /// Saves to the document's file, or to another that becomes its file.
    pub(super) fn save_as(&mut self, path: Option<PathBuf>) {
        match self.document.save(path) {
            Ok(()) => {
                if let Some(path) = self.document.path().map(Path::to_path_buf) {
                    self.settings.remember(&path);
                    self.say(format!("Saved {}", path.display()));
                }
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Everything that happens between frames: news, keys, play.
    pub fn logic(&mut self, ctx: &Context) {
        let news: Vec<News> = self.worker.news().collect();
        news.into_iter().for_each(|news| self.hear(news));
        for command in command::pressed(ctx) {
            self.perform(command, ctx);
        }
        let now = ctx.input(|input| input.time);
        if self.waiting.is_some_and(f64::is_nan) {
            self.waiting = Some(now);
        }
        self.play(ctx, now);
        if self.document.note(now) {
            ctx.request_repaint_after_secs(0.25);
        }
        if self.settings.rerun && self.is_stale() && self.is_idle() && self.document.preset.check().is_ok() {
            self.perform(Command::Rerun, ctx);
        }
        if let Some((purpose, path)) = self.files.chosen() {
            self.use_file(purpose, &path, ctx);
        }
        self.drop_files(ctx);
        let look = self.look();
        if self.asked.as_ref() != Some(&look) {
            self.worker.order(Order::Look(look.clone()));
            self.asked = Some(look);
            self.answered = false;
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
            News::Done { change, progress, errors } => {
                self.waiting = None;
                self.answered = false;
                self.change = change.or(self.change);
                self.progress = progress;
                if self.centre {
                    self.centre = false;
                    self.settings.view.index = progress.brightest[self.settings.view.across.min(2)];
                }
                for (run, rows) in self.runs.iter_mut().zip(errors) {
                    run.update(progress.iteration, rows);
                }
            }
            News::Shown { look, panes, cloud } => {
                if self.asked.as_ref() == Some(&look) {
                    self.answered = true;
                    self.shown = panes;
                    self.cloud = cloud.map(Arc::new);
                }
            }
            News::Pinned(pin, samples) => {
                if self.pin == Some(pin) {
                    self.pinned = samples;
                }
            }
            News::Failed(line) => {
                self.waiting = None;
                self.answered = true;
                self.progress.until = None;
                self.fail(line);
            }
        }
    }

    /// Changes the memory for past iterations, in MiB.
    pub(super) fn set_past(&mut self, mib: usize) {
        self.settings.past_mib = mib;
        self.worker.order(Order::Budget(self.settings.budget()));
    }

    /// Does what the scene's panel asks for.
    pub(super) fn grant(&mut self, wish: Wish) {
        if let Some(place) = wish.place {
            self.placing = place;
        }
        if let Some(i) = wish.injector_file {
            self.files.ask(Purpose::Injector(i), None);
        }
        if let Some(i) = wish.occluder_file {
            self.files.ask(Purpose::Occluder(i), None);
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

    /// What is to be seen.
    fn look(&self) -> Look {
        let view = &self.settings.view;
        let state = State { track: 0, iteration: self.at };
        let pane = |light| Pane { light, state, minus: None };
        let (panes, cloud) = match view.stage {
            Stage::Grids => (Light::ALL.map(pane).to_vec(), None),
            Stage::Compare => (self.comparison.panes(self.at, self.runs.len()), None),
            Stage::Space => {
                let ask = CloudAsk { pane: pane(self.comparison.light), threshold: self.space.eye.threshold };
                (vec![ask.pane], Some(ask))
            }
        };
        Look { panes, layer: view.layer, plane: view.plane(), cloud }
    }
}

/// What of a preset changes its results: all but its title and how far Run all goes.
fn essence(preset: &Preset) -> Preset {
    let mut essence = preset.clone();
    essence.title.clear();
    essence.propagation.iterations = 0;
    essence
}
