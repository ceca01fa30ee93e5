//! What runs: the worker, how far it is, and the curves of what it has measured.

use std::sync::Arc;

use egui::Context;

use super::branches::{Branches, Record};
use super::curves::Curves;
use super::document::Document;
use super::items::Item;
use crate::app::worker::rival::Rival;
use crate::app::worker::{Load, Order, Progress, Start, Worker};
use crate::field::Levels;
use crate::scene::{Preset, Problem};
use crate::simulation::Change;
use crate::simulation::options::Device;

/// The run in progress, or the last one.
pub struct Run {
    /// The thread that computes.
    pub worker: Worker,
    /// The runs before and after this one.
    pub branches: Branches,
    /// What the present results were made from.
    ran: Preset,
    /// When, in seconds, injectors are to be seen where their paths have them; `None` where the preset puts them.
    pub moment: Option<f64>,
    /// When they were, in the present results.
    ran_at: Option<f64>,
    /// What ran beside the preset's own propagator.
    pub others: Vec<Rival>,
    /// What runs, once the worker has it.
    pub problem: Option<Arc<Problem>>,
    /// How far the worker is.
    pub progress: Progress,
    /// What the last action changed.
    pub change: Option<Change>,
    /// The error curves of the present run, the document's own propagator first.
    pub curves: Vec<Curves>,
    /// The curves of earlier runs.
    pub kept: Vec<Curves>,
    /// The iteration that is seen; `None` follows the latest.
    pub at: Option<usize>,
    /// When the next iteration is due, in seconds, while playing.
    pub playing: Option<f64>,
    /// Since when an action's news are waited for, in seconds; not a number until the next frame tells the time.
    pub waiting: Option<f64>,
}

impl Run {
    /// A worker without anything to do, with `budget` bytes for past iterations.
    pub fn new(ctx: &Context, preset: Preset, budget: usize) -> std::io::Result<Self> {
        let wake = ctx.clone();
        Ok(Run {
            worker: Worker::start(budget, move || wake.request_repaint())?,
            branches: Branches::default(),
            ran: preset,
            moment: None,
            ran_at: None,
            others: Vec::new(),
            problem: None,
            progress: Progress::default(),
            change: None,
            curves: Vec::new(),
            kept: Vec::new(),
            at: None,
            playing: None,
            waiting: None,
        })
    }

    /// Hands a document to the worker, with what is to run beside it; `leave` keeps the run that is left.
    pub fn load(&mut self, document: &Document, others: Vec<Rival>, start: Start, leave: bool, device: Device) {
        let tag = self.branches.begin(self.record());
        let preset = &document.preset;
        self.ran = preset.clone();
        // What does not move is always where it is.
        self.moment = self.moment.zip(preset.times()).map(|(time, [first, last])| time.clamp(first, last));
        self.ran_at = self.moment;
        self.others = others;
        self.problem = None;
        let own = Rival::Propagator(preset.propagation.clone());
        let tracks = std::iter::once(&own).chain(&self.others).filter(|rival| rival.runs());
        let curves = tracks.zip(self.kept.len()..).map(|(rival, color)| Curves::new(rival.describe(), color));
        self.curves = curves.collect();
        self.at = None;
        self.playing = None;
        let levels = Levels::new(preset.size, preset.coarsest).map_or(1, |levels| levels.count());
        self.progress = Progress { side: preset.size, levels, ..Progress::default() };
        let (preset, folder, others) = (preset.clone(), document.folder(), self.others.clone());
        let load = Load { preset, folder, moment: self.moment, others, start, tag, leave, device };
        self.send(Order::Load(Box::new(load)));
    }

    /// Goes on from iteration `k`; the run that is left can be gone back to.
    pub fn restart(&mut self, k: usize) {
        self.at = None;
        let tag = self.branches.begin(self.record());
        self.send(Order::Restart(k, tag));
    }

    /// Ends what runs beside the document's own propagator.
    pub fn go_alone(&mut self) {
        self.others.clear();
        self.curves.truncate(1);
        self.worker.order(Order::Alone);
    }

    /// Takes up what is known of the run that the worker has turned to.
    pub fn turn_to(&mut self, tag: u64) {
        let left = self.record();
        if let Some(Record { ran, ran_at, others, problem, curves }) = self.branches.turn_to(tag, left) {
            (self.ran, self.ran_at, self.others, self.problem, self.curves) = (ran, ran_at, others, problem, curves);
            self.moment = ran_at;
        }
        self.at = None;
        self.playing = None;
    }

    /// What is known of the present run.
    fn record(&self) -> Record {
        let (ran, others) = (self.ran.clone(), self.others.clone());
        Record { ran, ran_at: self.ran_at, others, problem: self.problem.clone(), curves: self.curves.clone() }
    }

    /// Gives an order whose news are waited for.
    pub fn send(&mut self, order: Order) {
        self.worker.order(order);
        self.waiting = self.waiting.or(Some(f64::NAN));
    }

    /// The preset that runs.
    pub fn preset(&self) -> &Preset {
        &self.ran
    }

    /// Whether the results are of another preset than this one.
    pub fn differs(&self, preset: &Preset) -> bool {
        self.moment != self.ran_at || essence(preset) != essence(&self.ran)
    }

    /// Whether an object is in the run as it is in the preset.
    pub fn has_run(&self, item: Item, preset: &Preset) -> bool {
        item.is_same(preset, &self.ran)
    }

    /// Whether iterations follow each other by themselves.
    pub fn is_playing(&self) -> bool {
        self.playing.is_some()
    }

    /// Whether something is computed or waited for.
    pub fn is_underway(&self) -> bool {
        self.waiting.is_some() || self.progress.until.is_some() || self.is_playing() || self.progress.behind > 0
    }

    /// The error curves: the present run's, then those kept.
    pub fn all_curves(&self) -> Vec<&Curves> {
        self.curves.iter().chain(&self.kept).collect()
    }

    /// Keeps the present run's curves beside those of runs to come.
    pub fn keep(&mut self) {
        self.kept.append(&mut self.curves.clone());
        for curves in &mut self.curves {
            curves.color += 1;
        }
    }
}

/// What of a preset changes its results: all but its title, how far Run all goes and who looks at it.
fn essence(preset: &Preset) -> Preset {
    let mut essence = preset.clone();
    essence.title.clear();
    essence.propagation.iterations = 0;
    essence.scene.iter_mut().for_each(|scene| scene.camera = None);
    essence
}
