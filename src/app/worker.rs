//! The thread that computes, and the window's end of it.
//!
//! One long-lived thread owns the simulations. Orders go to it and news come back through channels. Loading
//! a scene starts a new generation: orders and news of older ones are dropped, so that the newest request
//! wins and no stale answer is shown. A run is a chain of single iterations with a look at the orders after
//! each, so that it can be watched and stopped; when the window goes, the thread ends by itself. A panic in
//! here is caught and told, and the window lives on.

mod branches;
pub(crate) mod cut;
mod desk;
pub(crate) mod history;
mod ledger;
pub(crate) mod look;
mod orders;
pub(crate) mod peaks;
pub(crate) mod received;
pub(crate) mod rival;
pub(crate) mod track;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use self::look::{Cloud, Look, Pin, PinSample, Shown};
use self::rival::Rival;
use crate::scene::{Preset, Problem};
use crate::simulation::options::{Device, Stage, Work};
use crate::simulation::{Action, Change};
use crate::study::error::ErrorRow;
use crate::study::expectation::Expectation;
use crate::transport::ballistic::Ballistic;

/// What a newly loaded scene is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Stay dark.
    Dark,
    /// Inject, downsample and go on to this iteration; merge at the end if asked to.
    To {
        /// The iteration.
        iteration: usize,
        /// Whether to merge then.
        merge: bool,
    },
}

/// A scene to load, and what to run beside it.
#[derive(Clone, Debug)]
pub struct Load {
    /// The document.
    pub preset: Preset,
    /// The folder that its paths are relative to.
    pub folder: PathBuf,
    /// When, in seconds, injectors are where their paths have them; `None` where the document puts them.
    pub moment: Option<f64>,
    /// What its own propagator is compared with.
    pub others: Vec<Rival>,
    /// What to do at once.
    pub start: Start,
    /// What the run is known by, in [`News::Returned`].
    pub tag: u64,
    /// Whether the run that is left is kept, to be gone back to.
    pub leave: bool,
    /// What is to iterate; the processor does where that cannot.
    pub device: Device,
}

/// What the window asks for.
#[derive(Clone, Debug)]
pub enum Order {
    /// Take a new scene.
    Load(Box<Load>),
    /// Do one action with every propagator.
    Act(Action),
    /// End the run after the iteration that is being computed.
    Stop,
    /// Go on from this iteration, as the run of this tag; the run that is left can be gone back to.
    Restart(usize, u64),
    /// Go back to the run that was left last.
    Back,
    /// Go to the run that was last gone back from.
    Forward,
    /// Show this from now on.
    Look(Look),
    /// Follow this cell.
    Pin(Option<Pin>),
    /// Use this much memory, in bytes, for the past.
    Budget(usize),
    /// Measure by this metric before others, the past as well; errors against a run are against this track.
    Measure(Option<Expectation>, usize),
    /// Drop all tracks but the document's own.
    Alone,
    /// What truly arrives, to measure against; or no longer.
    Truth(Option<Arc<Ballistic>>),
    /// Break down, so that tests see what becomes of the window.
    #[cfg(test)]
    Panic,
}

/// How far the worker is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// The present iteration.
    pub iteration: usize,
    /// The oldest iteration that can still be shown.
    pub oldest: usize,
    /// Where a run ends, while there is one.
    pub until: Option<usize>,
    /// Cells, over all levels, that have received light.
    pub lit: usize,
    /// Cells over all levels.
    pub cells: usize,
    /// Levels of the octree.
    pub levels: usize,
    /// How far a descent has come down, if it is one.
    pub stage: Option<Stage>,
    /// Finest cells along a side.
    pub side: usize,
    /// Bytes that the present takes.
    pub now_bytes: usize,
    /// Bytes that the past takes.
    pub past_bytes: usize,
    /// Whether the accumulated light has been merged since it changed.
    pub merged: bool,
    /// On each axis, the slab of cells with the most injected light.
    pub brightest: [usize; 3],
    /// How long the last action took, in seconds.
    pub seconds: f64,
    /// How much the iterations so far had to compute.
    pub work: Work,
    /// Measurements that are still to come: iterations, once for each metric.
    pub behind: usize,
}

/// What the worker tells.
#[derive(Clone, Debug)]
pub enum News {
    /// The scene that is run from now on.
    Loaded(Arc<Problem>),
    /// Why the processor iterates, where something else was to.
    NotThere(String),
    /// An action is done. What was measured of later iterations no longer holds, nor does what was measured of the
    /// present one if its light changed.
    Done {
        /// What changed, if an action did it.
        change: Option<Change>,
        /// How far the worker is.
        progress: Progress,
        /// What the action took with each propagator, in seconds.
        each: Vec<f64>,
    },
    /// An iteration has been measured.
    Measured {
        /// The iteration.
        iteration: usize,
        /// By what.
        metric: Expectation,
        /// Its errors for each propagator.
        errors: Vec<Vec<ErrorRow>>,
        /// How many are still to come.
        behind: usize,
    },
    /// What is to be seen, as it is.
    Shown {
        /// What was asked for.
        look: Look,
        /// The flat views.
        panes: Vec<Shown>,
        /// The three-dimensional view.
        cloud: Option<Cloud>,
    },
    /// What the pinned cell has held so far, iteration by iteration.
    Pinned(Pin, Vec<PinSample>),
    /// The tags of the runs before and after the present one, the nearest last.
    Branches([Vec<u64>; 2]),
    /// The run that is present again; what follows is about it.
    Returned(u64),
    /// The scene or an action failed; one line that says why and what would be right.
    Failed(String),
}

/// The window's end of the worker.
#[derive(Debug)]
pub struct Worker {
    orders: Sender<(u64, Order)>,
    news: Receiver<(u64, News)>,
    generation: u64,
}

impl Worker {
    /// Starts the thread, one of a pool of its own so that the others can help it at once; `wake` is called after
    /// each of its news.
    pub fn start(budget: usize, wake: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let (orders, inbox) = channel();
        let (outbox, news) = channel();
        let pool = rayon::ThreadPoolBuilder::new().thread_name(|i| format!("worker {i}")).build();
        let pool = pool.map_err(std::io::Error::other)?;
        pool.spawn(move || desk::Desk::new(inbox, outbox, Arc::new(wake), budget).work());
        Ok(Worker { orders, news, generation: 0 })
    }

    /// Hands an order over.
    pub fn order(&mut self, order: Order) {
        if matches!(order, Order::Load(_)) {
            self.generation += 1;
        }
        // The thread catches its panics, so it outlives this end of the channel.
        let _ = self.orders.send((self.generation, order));
    }

    /// What has come in and still counts.
    pub fn news(&self) -> impl Iterator<Item = News> {
        let newest = self.generation;
        self.news.try_iter().filter(move |(generation, _)| *generation == newest).map(|(_, news)| news)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::time::Duration;

    use super::*;
    use crate::app::worker::look::{Layer, Light, Of, Pane, State};
    use crate::report::slice::Plane;

    fn load(size: usize, start: Start) -> Order {
        let text = format!("(version: 1, size: {size}, injectors: [(kind: Single(cell: (0, 1, 2)))])");
        let preset = Preset::parse(&text, Path::new("test")).unwrap();
        Order::Load(Box::new(Load {
            moment: None,
            preset,
            folder: PathBuf::new(),
            others: Vec::new(),
            start,
            tag: 0,
            leave: true,
            device: Device::Cpu,
        }))
    }

    fn look(iteration: Option<usize>) -> Order {
        let state = State { of: Of::Track(0), iteration };
        let pane = Pane { light: Light::Accumulated, state, minus: None };
        Order::Look(Look {
            panes: vec![pane],
            layer: Layer::Merged,
            plane: Plane::default(),
            against: Expectation::Thesis,
            brightest: Default::default(),
            cloud: None,
        })
    }

    /// The first of the news that `pick` takes; waits for it.
    fn wait<T>(worker: &Worker, pick: impl Fn(&News) -> Option<T>) -> T {
        for _ in 0..2000 {
            if let Some(found) = worker.news().find_map(|news| pick(&news)) {
                return found;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        panic!("no such news");
    }

    #[test]
    fn a_run_reaches_its_end_and_tells_every_iteration_once() {
        let mut worker = Worker::start(1 << 20, || ()).unwrap();
        worker.order(load(8, Start::To { iteration: 5, merge: true }));
        let mut told = Vec::new();
        loop {
            let (change, progress) = wait(&worker, |news| match news {
                News::Done { change, progress, .. } => Some((*change, *progress)),
                _ => None,
            });
            if change.is_some_and(|change| change.action == Action::Propagate) {
                told.push(progress.iteration);
            }
            if progress.until.is_none() {
                assert!(progress.merged);
                break;
            }
        }
        assert_eq!(told, [1, 2, 3, 4, 5]);
    }

    #[test]
    fn news_of_an_older_scene_are_dropped() {
        let mut worker = Worker::start(1 << 20, || ()).unwrap();
        for size in [4, 8, 4, 8, 16] {
            worker.order(load(size, Start::To { iteration: 30, merge: false }));
        }
        loop {
            let progress = wait(&worker, |news| match news {
                News::Done { progress, .. } => Some(*progress),
                _ => None,
            });
            assert_eq!(progress.side, 16);
            if progress.until.is_none() && progress.iteration == 30 {
                break;
            }
        }
    }

    #[test]
    fn any_iteration_can_be_seen_again() {
        let mut worker = Worker::start(1 << 16, || ()).unwrap();
        worker.order(load(8, Start::To { iteration: 9, merge: false }));
        for k in [3, 7, 0] {
            worker.order(look(Some(k)));
            let shown = wait(&worker, |news| match news {
                News::Shown { look, panes, .. } if look.panes[0].state.iteration == Some(k) => Some(panes[0].iteration),
                _ => None,
            });
            assert!(shown == k || shown < 9, "asked for {k}, got {shown}");
        }
    }

    #[test]
    fn light_that_diverges_is_told_and_kept_as_it_was() {
        let mut worker = Worker::start(1 << 20, || ()).unwrap();
        let text = "(version: 1, size: 4, injectors: [(kind: Single(cell: (0, 1, 2)))], propagation: (factor: 50))";
        let preset = Preset::parse(text, Path::new("test")).unwrap();
        let start = Start::To { iteration: 1000, merge: true };
        worker.order(Order::Load(Box::new(Load {
            moment: None,
            preset,
            folder: PathBuf::new(),
            others: Vec::new(),
            start,
            tag: 0,
            leave: true,
            device: Device::Cpu,
        })));
        let (mut failure, mut reached) = (None, 0);
        while failure.is_none() {
            let news = wait(&worker, |news| Some(news.clone()));
            match news {
                News::Done { progress, .. } => reached = progress.iteration,
                News::Failed(line) => failure = Some(line),
                _ => {}
            }
        }
        let line = failure.unwrap();
        assert!(line.contains(&format!("iteration {} could take level 0", reached + 1)), "{line}");
        // The window lives on: another factor from the same light.
        worker.order(load(4, Start::To { iteration: 3, merge: false }));
        wait(&worker, |news| matches!(news, News::Done { progress, .. } if progress.iteration == 3).then_some(()));
    }

    #[test]
    fn fifty_panics_leave_the_window_its_worker() {
        let mut worker = Worker::start(1 << 20, || ()).unwrap();
        for _ in 0..50 {
            worker.order(Order::Panic);
            let line = wait(&worker, |news| match news {
                News::Failed(line) => Some(line.clone()),
                _ => None,
            });
            assert!(line.contains("broke down") && !line.contains('\n'), "{line}");
            worker.order(load(4, Start::To { iteration: 2, merge: false }));
            wait(&worker, |news| matches!(news, News::Done { progress, .. } if progress.iteration == 2).then_some(()));
        }
    }

    #[test]
    fn a_scene_that_cannot_be_is_told_in_one_line_and_the_next_one_works() {
        let mut worker = Worker::start(1 << 20, || ()).unwrap();
        let mut preset = Preset::default();
        preset.propagation.scheme = "no such".to_owned();
        let others = Vec::new();
        worker.order(Order::Load(Box::new(Load {
            moment: None,
            preset,
            folder: PathBuf::new(),
            others,
            start: Start::Dark,
            tag: 0,
            leave: true,
            device: Device::Cpu,
        })));
        let line = wait(&worker, |news| match news {
            News::Failed(line) => Some(line.clone()),
            _ => None,
        });
        assert!(line.contains("no such") && line.contains("cascaded") && !line.contains('\n'), "{line}");
        worker.order(load(4, Start::Dark));
        wait(&worker, |news| matches!(news, News::Done { .. }).then_some(()));
    }
}
