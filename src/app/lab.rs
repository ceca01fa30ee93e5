//! The window's state. What commands do to it is in [`super::perform`], what news do in [`super::logic`], and
//! how it looks in [`super::layout`].

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::Context;

use crate::app::draw::glyphs::Scales;
use crate::app::draw::grids::{Grids, Pointed};
use crate::app::draw::space::Space;
use crate::app::draw::style;
use crate::app::files::dialog::Files;
use crate::app::files::home::Home;
use crate::app::files::recovery::Recovery;
use crate::app::panels::closing::Next;
use crate::app::panels::compare::{Comparison, Rival};
use crate::app::panels::errors::Run;
use crate::app::panels::line::Profiles;
use crate::app::panels::pareto::Pareto;
use crate::app::session::critical::Critical;
use crate::app::session::document::Document;
use crate::app::session::settings::Settings;
use crate::app::session::truth::Truth;
use crate::app::session::view::View;
use crate::app::worker::look::{Cloud, Look, Pin, PinSample, Shown};
use crate::app::worker::{Load, Order, Progress, Start, Worker};
use crate::field::Levels;
use crate::scene::{Preset, Problem};
use crate::simulation::Change;
use crate::study::error::Metric;
use crate::transport::preset;

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
    /// Where settings are kept, if they are.
    pub(super) home: Option<Home>,
    /// Where unsaved work is kept, if it is.
    pub(super) recovery: Option<Recovery>,
    /// What the present results were made from.
    pub(super) ran: Preset,
    /// What ran beside the preset's own propagator.
    pub(super) others: Vec<Rival>,
    /// The scene that runs, once the worker has it.
    pub(super) problem: Option<Arc<Problem>>,
    pub(super) truth: Truth,
    pub(super) profiles: Profiles,
    pub(super) pareto: Pareto,
    pub(super) critical: Critical,
    pub(super) progress: Progress,
    /// What the last action changed.
    pub(super) change: Option<Change>,
    /// The error curves of the present run, the document's own propagator first.
    pub(super) runs: Vec<Run>,
    /// The curves of earlier runs.
    pub(super) kept: Vec<Run>,
    pub(super) shown: Vec<Shown>,
    /// The scales of what is shown, with the way of looking that they belong to.
    pub(super) scales: Option<(View, Scales)>,
    pub(super) cloud: Option<Arc<Cloud>>,
    pub(super) asked: Option<Look>,
    /// The metric that the worker was told to measure by first.
    pub(super) measured_by: Option<Metric>,
    /// Whether the views show what was asked for, after the last action.
    pub(super) answered: bool,
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
    pub(super) centre: bool,
    /// When the next iteration is due, in seconds, while playing.
    pub(super) playing: Option<f64>,
    /// Since when an action's news are waited for, in seconds.
    pub(super) waiting: Option<f64>,
    pub(super) keys_open: bool,
    pub(super) window_title: String,
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
        style::apply(ctx);
        let files = Files::new(ctx);
        let mut lab = Lab {
            worker,
            settings,
            ran: preset.clone(),
            document: Document::new(preset, path),
            home: None,
            recovery: None,
            problem: None,
            truth: Truth::default(),
            profiles: Profiles::default(),
            pareto: Pareto::default(),
            critical: Critical::default(),
            progress: Progress::default(),
            change: None,
            runs: Vec::new(),
            kept: Vec::new(),
            shown: Vec::new(),
            scales: None,
            cloud: None,
            asked: None,
            measured_by: None,
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
            window_title: String::new(),
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
        let running = self.waiting.is_some() || self.progress.until.is_some() || self.playing.is_some();
        let aside = self.truth.is_underway()
            || self.profiles.is_underway()
            || self.pareto.is_underway()
            || self.critical.is_underway();
        self.answered && !running && !aside && self.progress.behind == 0
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
    pub(super) fn take(&mut self, document: Document) {
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
    pub(super) fn begin(&mut self) {
        self.load(Start::To { iteration: 0, merge: false });
    }

    /// Hands the document to the worker.
    pub(super) fn load(&mut self, start: Start) {
        if let Err(fault) = preset::check(&self.document.preset) {
            self.fail(fault.to_string());
            return;
        }
        self.ran = self.document.preset.clone();
        self.others.clone_from(&self.comparison.others);
        self.problem = None;
        let own = Rival::Propagator(self.document.preset.propagation.clone());
        let tracks = std::iter::once(&own).chain(&self.others).filter(|rival| rival.runs());
        let runs = tracks.zip(self.kept.len()..).map(|(rival, color)| Run::new(rival.describe(), color));
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

    pub(super) fn send(&mut self, order: Order) {
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
        match preset::read(path) {
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
}

/// What of a preset changes its results: all but its title and how far Run all goes.
fn essence(preset: &Preset) -> Preset {
    let mut essence = preset.clone();
    essence.title.clear();
    essence.propagation.iterations = 0;
    essence
}
