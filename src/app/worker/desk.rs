//! The worker's own end: the tracks, the run in progress and the orders as they come in.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvError, RecvTimeoutError, Sender, TryRecvError};
use std::time::{Duration, Instant};

use crate::app::worker::branches::{Branch, Branches};
use crate::app::worker::cut;
use crate::app::worker::ledger::Ledger;
use crate::app::worker::look::{Look, Pin};
use crate::app::worker::orders::newest;
use crate::app::worker::peaks::Peaks;
use crate::app::worker::received::{self, Senders};
use crate::app::worker::track::{self, Track};
use crate::app::worker::{Load, News, Order, Progress, Start};
use crate::scene::Problem;
use crate::scene::path::Placing;
use crate::scene::stage::Cache;
use crate::simulation::{Action, Change};
use crate::study::expectation::{Expectation, References};
use crate::transport::ballistic::Ballistic;

/// The least time between two pictures of a run in progress.
const BETWEEN_PICTURES: Duration = Duration::from_millis(30);
/// Volumes up to this side are measured by every metric, so that curves are there when they are asked for; larger
/// ones only by the metric that is seen.
const MEASURED_BY_ALL: usize = 64;

/// How long no order comes before a large volume is measured.
const QUIET: Duration = Duration::from_millis(350);

/// A run in progress.
#[derive(Clone, Copy, Debug)]
struct Run {
    until: usize,
    merge: bool,
}

/// Where the worker works.
pub struct Desk {
    inbox: Receiver<(u64, Order)>,
    outbox: Sender<(u64, News)>,
    wake: Arc<dyn Fn() + Send + Sync>,
    generation: u64,
    tracks: Vec<Track>,
    run: Option<Run>,
    look: Option<Look>,
    pin: Option<Pin>,
    budget: usize,
    merged: bool,
    brightest: [usize; 3],
    seconds: f64,
    /// What the last action took with each propagator, in seconds.
    each: Vec<f64>,
    pictured: Option<Instant>,
    /// What is measured against; it is that of the scene that runs.
    references: References,
    /// The metric that is seen.
    metric: Option<Expectation>,
    /// The track that errors against a run are against.
    star: usize,
    measured: Ledger,
    /// What scenes with a mesh were made from: a light that moves makes nothing anew but its own map.
    cache: Cache,
    peaks: Peaks,
    /// What the window knows the present run by.
    tag: u64,
    branches: Branches,
}

impl Desk {
    /// An empty desk with `budget` bytes for the past.
    pub fn new(
        inbox: Receiver<(u64, Order)>,
        outbox: Sender<(u64, News)>,
        wake: Arc<dyn Fn() + Send + Sync>,
        budget: usize,
    ) -> Self {
        Desk {
            inbox,
            outbox,
            wake,
            generation: 0,
            tracks: Vec::new(),
            run: None,
            look: None,
            pin: None,
            budget,
            merged: false,
            brightest: [0; 3],
            seconds: 0.0,
            each: Vec::new(),
            pictured: None,
            references: References::default(),
            metric: None,
            star: 0,
            measured: Ledger::default(),
            cache: Cache::default(),
            peaks: Peaks::default(),
            tag: 0,
            branches: Branches::default(),
        }
    }

    /// Works until the window is gone.
    pub fn work(mut self) {
        while let Ok(orders) = self.wait() {
            let turn = || {
                self.turn(orders);
                (self.wake)();
            };
            if catch_unwind(AssertUnwindSafe(turn)).is_err() {
                // What the panic left half done is not to be shown.
                self.tracks.clear();
                self.run = None;
                self.tell(News::Failed("the computation broke down; edit the scene or run it again".to_owned()));
                (self.wake)();
            }
        }
    }

    /// The orders that are to be followed now; none while work in progress has nothing in its way.
    fn wait(&self) -> Result<Vec<(u64, Order)>, RecvError> {
        let mut orders = Vec::new();
        if self.run.is_none() && self.behind() == 0 {
            orders.push(self.inbox.recv()?);
        } else if self.run.is_none() && self.is_large() {
            // Whoever steps through a large volume is not to wait for its errors.
            match self.inbox.recv_timeout(QUIET) {
                Ok(order) => orders.push(order),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Err(RecvError),
            }
        }
        loop {
            match self.inbox.try_recv() {
                Ok(order) => orders.push(order),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return Err(RecvError),
            }
        }
        Ok(newest(orders))
    }

    fn turn(&mut self, orders: Vec<(u64, Order)>) {
        for (generation, order) in orders {
            self.generation = generation;
            self.follow(order);
        }
        let Some(run) = self.run else { return self.catch_up() };
        if self.iteration() < run.until {
            // The past may not be remembered when the run is over.
            if let Some(metric) = self.metric {
                self.measure(metric, self.iteration());
            }
            self.act(Action::Propagate);
            if self.run.is_none() {
                return self.picture(false);
            }
        }
        if self.iteration() >= run.until {
            self.run = None;
            if run.merge {
                self.act(Action::Merge);
            } else {
                self.tell_progress(None);
            }
            self.picture(false);
        } else {
            self.picture(true);
        }
    }

    fn follow(&mut self, order: Order) {
        match order {
            Order::Load(load) => self.load(&load),
            Order::Act(action) => {
                self.run = None;
                self.act(action);
                self.picture(false);
            }
            Order::Stop => {
                self.run = None;
                self.tell_progress(None);
                self.picture(false);
            }
            Order::Restart(k, tag) => {
                self.run = None;
                self.branch(tag);
                let back = self.tracks.iter_mut().all(|track| track.restart(k));
                if !back {
                    self.tell(News::Failed(format!("iteration {k} is no longer remembered; run the scene again")));
                }
                self.merged = false;
                self.measured.forget_from(self.iteration() + 1);
                self.peaks.forget_from(self.iteration() + 1);
                self.tell_progress(None);
                self.picture(false);
            }
            Order::Back => self.exchange(Branches::back),
            Order::Forward => self.exchange(Branches::forward),
            Order::Look(look) => {
                self.look = Some(look);
                self.picture(false);
            }
            Order::Pin(pin) => {
                self.pin = pin;
                self.tell_pin();
            }
            #[cfg(test)]
            Order::Panic => panic!("as ordered"),
            Order::Measure(metric, star) => {
                self.metric = metric;
                if star != self.star {
                    self.star = star;
                    self.measured.forget(Expectation::Run);
                }
                self.tell_progress(None);
                self.picture(false);
            }
            Order::Truth(truth) => {
                self.measure_against(truth);
                self.tell_progress(None);
                self.picture(false);
            }
            Order::Alone => {
                self.tracks.truncate(1);
                self.each.truncate(1);
                self.share_budget();
                self.tell_progress(None);
                self.picture(false);
            }
            Order::Budget(bytes) => {
                self.budget = bytes;
                self.share_budget();
                self.tell_progress(None);
                self.picture(false);
            }
        }
    }

    /// Takes a reference, if it is that of the scene that runs.
    fn measure_against(&mut self, truth: Option<Arc<Ballistic>>) {
        self.references.ballistic = truth;
        match self.tracks.first() {
            Some(track) => self.references.turn_to(track.now().problem()),
            None => self.references = References::default(),
        }
        self.measured.forget(Expectation::Ballistic);
    }

    /// Whether measuring takes longer than the eye waits.
    fn is_large(&self) -> bool {
        self.tracks.first().is_some_and(|track| track.now().sizes().finest() > MEASURED_BY_ALL)
    }

    /// What is measured, what is seen first.
    fn metrics(&self) -> Vec<Expectation> {
        let small = !self.is_large();
        let others = Expectation::ALL.into_iter().filter(|metric| small && Some(*metric) != self.metric);
        // A run is had from the star's track when it is measured.
        let possible = |metric: &Expectation| match metric {
            Expectation::Run => self.star < self.tracks.len() && self.tracks.len() > 1,
            _ => metric.is_ready(&self.references),
        };
        self.metric.into_iter().chain(others).filter(possible).collect()
    }

    /// The iterations that are still to be measured, oldest first.
    fn unmeasured(&self, metric: Expectation) -> impl DoubleEndedIterator<Item = usize> {
        self.measured.open(metric, self.oldest()..=self.iteration())
    }

    /// How many measurements are still to come.
    fn behind(&self) -> usize {
        if self.tracks.is_empty() {
            return 0;
        }
        self.metrics().into_iter().map(|metric| self.unmeasured(metric).count()).sum()
    }

    /// Measures the newest iteration that has not been.
    fn catch_up(&mut self) {
        if self.tracks.is_empty() {
            return;
        }
        let next = self.metrics().into_iter().find_map(|metric| Some((metric, self.unmeasured(metric).next_back()?)));
        if let Some((metric, iteration)) = next {
            self.measure(metric, iteration);
        }
    }

    fn measure(&mut self, metric: Expectation, iteration: usize) {
        let mut references = self.references.clone();
        if metric == Expectation::Run {
            references.run = track::merged(&mut self.tracks, self.star, Some(iteration));
        }
        let errors = self.tracks.iter_mut().map(|track| {
            let state = track.at(Some(iteration));
            state.map(|state| track::errors(state, metric, &references)).unwrap_or_default()
        });
        let errors = errors.collect();
        self.measured.enter(metric, iteration);
        self.tell(News::Measured { iteration, metric, errors, behind: self.behind() });
    }

    /// The present run, out of the way.
    fn take_present(&mut self) -> Branch {
        Branch {
            tag: self.tag,
            tracks: std::mem::take(&mut self.tracks),
            measured: std::mem::take(&mut self.measured),
            merged: std::mem::take(&mut self.merged),
            brightest: self.brightest,
        }
    }

    /// Goes on as the run `tag`; what is there stays as the branch that is left.
    fn branch(&mut self, tag: u64) {
        let (tracks, measured) = (self.tracks.clone(), self.measured.clone());
        let left = self.take_present();
        (self.tracks, self.measured, self.tag) = (tracks, measured, tag);
        self.branches.leave(left, self.budget);
        self.tell(News::Branches(self.branches.tags()));
    }

    /// Exchanges the present run for the one before or after it.
    fn exchange(&mut self, with: impl FnOnce(&mut Branches, Branch) -> Branch) {
        self.run = None;
        let present = self.take_present();
        let Branch { tag, tracks, measured, merged, brightest } = with(&mut self.branches, present);
        (self.tag, self.tracks, self.measured) = (tag, tracks, measured);
        (self.merged, self.brightest) = (merged, brightest);
        self.peaks = Peaks::default();
        self.share_budget();
        self.tell(News::Returned(tag));
        self.tell(News::Branches(self.branches.tags()));
        self.turn_to();
        self.tell_progress(None);
        self.picture(false);
    }

    /// Gives every track its share of the memory for the past.
    fn share_budget(&mut self) {
        let each = self.budget / self.tracks.len().max(1);
        self.tracks.iter_mut().for_each(|track| track.set_budget(each));
    }

    /// Turns to the problem of the present run: what truly arrives in another is of no use to it.
    fn turn_to(&mut self) {
        let Some(track) = self.tracks.first() else { return };
        let problem = Arc::clone(track.now().problem());
        self.references.turn_to(&problem);
        self.tell(News::Loaded(problem));
    }

    fn load(&mut self, load: &Load) {
        let left = self.take_present();
        self.tag = load.tag;
        if load.leave {
            self.branches.leave(left, self.budget);
            self.tell(News::Branches(self.branches.tags()));
        } else {
            drop(left);
        }
        self.peaks = Peaks::default();
        self.run = None;
        match self.tracks_of(load) {
            Ok(tracks) => self.tracks = tracks,
            Err(line) => return self.tell(News::Failed(line)),
        }
        self.brightest = std::array::from_fn(|axis| self.tracks[0].now().problem().brightest_slab(axis));
        self.turn_to();
        match load.start {
            Start::Dark => self.tell_progress(None),
            Start::To { iteration, merge } => {
                self.run = Some(Run { until: iteration, merge });
                self.act(Action::Inject);
                self.act(Action::Downsample);
            }
        }
        self.picture(false);
    }

    fn tracks_of(&mut self, load: &Load) -> Result<Vec<Track>, String> {
        let problem = Problem::build_with(&load.preset, &load.folder, &self.cache, &mut |_| {})
            .map_err(|error| error.to_string())?;
        let problem = match load.moment {
            Some(time) => problem.at_time(&load.preset.paths(), time, Placing::Split),
            None => problem,
        };
        let others = load.others.iter().filter_map(|rival| rival.problem(&problem));
        let problems: Vec<Problem> = std::iter::once(problem.clone()).chain(others).collect();
        let budget = self.budget / problems.len();
        let mut tracks = Vec::new();
        for problem in problems {
            let (track, why) = Track::on(load.device, problem, budget).map_err(|error| error.to_string())?;
            tracks.push(track);
            if let Some(why) = why {
                self.tell(News::NotThere(why));
            }
        }
        Ok(tracks)
    }

    fn iteration(&self) -> usize {
        self.tracks.first().map_or(0, |track| track.now().iteration())
    }

    /// The oldest iteration that every propagator remembers.
    fn oldest(&self) -> usize {
        self.tracks.iter().map(Track::oldest).max().unwrap_or(0)
    }

    fn act(&mut self, action: Action) {
        let started = Instant::now();
        let mut first = None;
        let mut each = Vec::with_capacity(self.tracks.len());
        for track in &mut self.tracks {
            let begun = Instant::now();
            let change = track.act(action);
            each.push(begun.elapsed().as_secs_f64());
            first = first.or(Some(change));
        }
        self.each = each;
        self.seconds = started.elapsed().as_secs_f64();
        let Some(change) = first else { return };
        // A propagator whose light diverges keeps its last good state, and the run ends there.
        let divergence = self.tracks.iter().find_map(|track| track.now().divergence());
        if let Some(divergence) = divergence {
            self.run = None;
            self.tell(News::Failed(format!("{divergence}; use a smaller factor")));
        }
        if action != Action::Merge {
            self.measured.forget_from(self.iteration());
            self.peaks.forget_from(self.iteration());
        }
        self.merged = action == Action::Merge || (self.merged && !change.accumulated);
        self.tell_progress(Some(change));
    }

    fn tell_progress(&mut self, change: Option<Change>) {
        let Some(track) = self.tracks.first() else { return };
        let sizes = track.now().sizes();
        let index = track.now().index();
        let progress = Progress {
            iteration: track.now().iteration(),
            oldest: self.oldest(),
            until: self.run.map(|run| run.until),
            lit: (0..sizes.count()).map(|i| index.level(i).count()).sum(),
            cells: sizes.cells(),
            levels: sizes.count(),
            stage: track.now().stage(),
            side: sizes.finest(),
            now_bytes: self.tracks.iter().map(Track::now_bytes).sum(),
            past_bytes: self.tracks.iter().map(Track::past_bytes).sum(),
            merged: self.merged,
            brightest: self.brightest,
            seconds: self.seconds,
            work: track.now().work(),
            behind: self.behind(),
        };
        let each = if change.is_some() { self.each.clone() } else { Vec::new() };
        self.tell(News::Done { change, progress, each });
    }

    /// Sends what is to be seen; a run in progress does not send more pictures than can be watched.
    fn picture(&mut self, in_passing: bool) {
        if in_passing && self.pictured.is_some_and(|last| last.elapsed() < BETWEEN_PICTURES) {
            return;
        }
        self.tell_pin();
        let Some(look) = self.look.clone() else { return };
        let mut panes = cut::panes(&mut self.tracks, &self.references, self.star, &look);
        for shown in &mut panes {
            shown.of_run = self.peaks.of_run(&self.tracks, shown.pane, &look);
        }
        let cloud = cut::cloud(&mut self.tracks, &look);
        self.pictured = Some(Instant::now());
        self.tell(News::Shown { look, panes, cloud });
    }

    fn tell_pin(&mut self) {
        let (Some(pin), Some(track)) = (self.pin, self.tracks.first()) else { return };
        let senders = Senders::of(track.now().problem(), track.now().sizes().count());
        let samples = track.states().filter_map(|state| received::sample(state, pin, senders.as_ref())).collect();
        self.tell(News::Pinned(pin, samples));
    }

    /// Tells something; the window is woken at the end of the turn, so that it draws once for all that it heard.
    fn tell(&self, news: News) {
        // Without a window there is nobody to tell; the next wait ends the work.
        let _ = self.outbox.send((self.generation, news));
    }
}
