//! The window's state: the document, its run, what is looked at, and what is found out aside. It knows no panel:
//! panels read it and return [`ask::Ask`]s, which change it once the frame is drawn.

pub(crate) mod asides;
pub(crate) mod ask;
pub(crate) mod branches;
pub(crate) mod cell_files;
pub(crate) mod command;
pub(crate) mod comparison;
pub(crate) mod curves;
pub(crate) mod document;
pub(crate) mod folds;
pub(crate) mod format;
pub(crate) mod guide;
pub(crate) mod items;
pub(crate) mod line;
pub(crate) mod pareto;
pub(crate) mod picture;
pub(crate) mod pin;
pub(crate) mod place;
pub(crate) mod plots;
pub(crate) mod port;
pub(crate) mod purpose;
pub(crate) mod run;
pub(crate) mod settings;
pub(crate) mod sight;
pub(crate) mod steps;
pub(crate) mod titles;
pub(crate) mod unreadable;
pub(crate) mod view;

use std::path::{Path, PathBuf};

use egui::Context;

use self::asides::Asides;
use self::comparison::Comparison;
use self::document::Document;
use self::items::{Item, Tool};
use self::run::Run;
use self::settings::Settings;
use self::sight::Sight;
use super::worker::{News, Order, Progress, Start};
use crate::scene::doubts::doubts;
use crate::scene::{Preset, Problem, builtin};
use crate::simulation::Action;
use crate::transport::preset;

/// A line for whoever sits before the window.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// What it says.
    pub text: String,
    /// Whether something went wrong.
    pub error: bool,
}

/// The side of the largest volume that runs again after every edit where nothing else was chosen.
const RERUN_UP_TO: usize = 64;

/// The most messages that are remembered.
const MOST_MESSAGES: usize = 100;

/// The whole state.
pub struct Session {
    /// The preset that is being edited.
    pub document: Document,
    /// What is remembered from one time to the next.
    pub settings: Settings,
    /// What runs.
    pub run: Run,
    /// What is seen of it.
    pub sight: Sight,
    /// What is put side by side.
    pub comparison: Comparison,
    /// What is found out aside.
    pub asides: Asides,
    /// The port that is looked at.
    pub port: port::Port,
    /// How pictures are looked at.
    pub picture: picture::Glass,
    /// The window's size, in points.
    pub size: egui::Vec2,
    /// What the pointer does in the views.
    pub tool: Tool,
    /// The object that is chosen.
    pub selected: Option<Item>,
    /// The injector that waits for a click to be placed.
    pub placing: Option<usize>,
    /// What to look for in the preset, until it is dismissed.
    pub guide: Option<String>,
    /// What is to be said, until it is dismissed.
    pub notice: Option<Notice>,
    /// What is to be doubted in the preset that runs.
    doubts: Vec<String>,
    /// What was said so far, the latest last.
    pub messages: Vec<Notice>,
}

impl Session {
    /// A session on a preset, with its file if it has one.
    pub fn new(ctx: &Context, preset: Preset, path: Option<PathBuf>, settings: Settings) -> std::io::Result<Self> {
        let guide = guide::of_preset(&preset);
        let mut session = Session {
            run: Run::new(ctx, preset.clone(), settings.budget())?,
            document: Document::new(preset, path),
            settings,
            sight: Sight::default(),
            comparison: Comparison::default(),
            asides: Asides::default(),
            port: port::Port::default(),
            picture: picture::Glass::default(),
            size: egui::vec2(1280.0, 720.0),
            tool: Tool::default(),
            selected: None,
            placing: None,
            guide,
            notice: None,
            doubts: Vec::new(),
            messages: Vec::new(),
        };
        session.begin();
        Ok(session)
    }

    /// Takes in what the worker tells.
    pub fn listen(&mut self) {
        let news: Vec<News> = self.run.worker.news().collect();
        news.into_iter().for_each(|news| self.hear(news));
    }

    fn hear(&mut self, news: News) {
        match news {
            News::Loaded(problem) => {
                self.doubt(&problem);
                self.run.problem = Some(problem);
            }
            News::NotThere(why) => {
                self.settings.on_card = false;
                self.say(format!("The processor computes: {why}"));
            }
            News::Measured { iteration, metric, errors, behind } => {
                self.run.progress.behind = behind;
                for (curves, measured) in self.run.curves.iter_mut().zip(errors) {
                    curves.put(iteration, metric, measured);
                }
            }
            News::Done { change, progress, each } => {
                self.run.waiting = None;
                self.sight.answered = false;
                self.run.change = change.or(self.run.change);
                self.run.progress = progress;
                if self.sight.centre {
                    self.sight.centre = false;
                    self.settings.view.index = progress.brightest[self.settings.view.axis.across()];
                }
                if change.is_some_and(|change| change.action == Action::Propagate) {
                    self.run.curves.iter_mut().zip(each).for_each(|(curves, seconds)| curves.seconds.push(seconds));
                }
                let same = change.is_none_or(|change| change.action == Action::Merge);
                let from = progress.iteration + usize::from(same);
                self.run.curves.iter_mut().for_each(|curves| curves.forget_from(from));
            }
            News::Shown { look, panes, cloud } => self.sight.take(&look, panes, cloud),
            News::Pinned(pin, samples) => {
                if self.sight.pin == Some(pin) {
                    self.sight.pinned = samples;
                }
            }
            News::Branches(tags) => self.run.branches.keep(tags),
            News::Returned(tag) => self.run.turn_to(tag),
            News::Failed(line) => {
                self.run.waiting = None;
                self.sight.answered = true;
                self.run.progress.until = None;
                self.fail(line);
            }
        }
    }

    /// Tells what the preset that runs may say and hardly means; what was told already is not told again.
    fn doubt(&mut self, problem: &Problem) {
        let doubts: Vec<String> = doubts(self.run.preset(), problem).iter().map(ToString::to_string).collect();
        let before = std::mem::replace(&mut self.doubts, doubts.clone());
        doubts.iter().filter(|line| !before.contains(line)).for_each(|line| self.say(format!("⚠ {line}")));
    }

    /// Moves on by a frame: plays, runs edits again, and asks for what is to be seen and found out.
    pub fn advance(&mut self, ctx: &Context, now: f64) {
        if self.run.waiting.is_some_and(f64::is_nan) {
            self.run.waiting = Some(now);
        }
        self.play(ctx, now);
        if self.document.note(now) {
            ctx.request_repaint_after_secs(0.25);
        }
        if self.reruns() && self.is_stale() && self.is_idle() && preset::check(&self.document.preset).is_ok() {
            self.run_again_by_itself();
        }
        self.choose_metric();
        self.seek(ctx);
        let look = self.look();
        if self.sight.asked.as_ref() != Some(&look) {
            self.run.worker.order(Order::Look(look.clone()));
            self.sight.asked = Some(look);
            self.sight.answered = false;
        }
    }

    /// Whether edits run again by themselves: as was chosen, else where it takes no time to speak of.
    pub fn reruns(&self) -> bool {
        self.settings.rerun.unwrap_or(self.document.preset.size <= RERUN_UP_TO)
    }

    /// Whether nothing is being computed or waited for.
    pub fn is_idle(&self) -> bool {
        self.sight.answered && !self.run.is_underway() && !self.asides.are_underway()
    }

    /// Whether the results were made from the scene as it is now.
    pub fn is_stale(&self) -> bool {
        self.run.differs(&self.document.preset) || self.run.others != self.comparison.others
    }

    /// The iteration that is seen.
    pub fn seen(&self) -> usize {
        self.run.at.unwrap_or(self.run.progress.iteration)
    }

    /// Says that something went wrong; what plays stops.
    pub fn fail(&mut self, text: String) {
        self.tell(Notice { text, error: true });
        self.run.playing = None;
    }

    /// Says something.
    pub fn say(&mut self, text: String) {
        self.tell(Notice { text, error: false });
    }

    fn tell(&mut self, notice: Notice) {
        if self.messages.len() == MOST_MESSAGES {
            self.messages.remove(0);
        }
        self.messages.push(notice.clone());
        self.notice = Some(notice);
    }

    /// Takes another document onto the desk; what was on it is gone.
    pub fn take(&mut self, document: Document) {
        self.document = document;
        if let Some(path) = self.document.path() {
            self.settings.remember(path);
        }
        self.run.kept.clear();
        self.sight.pin = None;
        self.placing = None;
        self.selected = None;
        self.guide = None;
        self.sight.centre = true;
        self.begin();
    }

    /// Opens a preset, or tells why it cannot be.
    pub fn open(&mut self, path: &Path) {
        match preset::read(path) {
            Ok(preset) => {
                self.take(Document::new(preset, Some(path.to_path_buf())));
                // It was just read; what has changed since is told when it is opened again.
                self.guide = std::fs::read_to_string(path).ok().map(|text| guide::of_text(&text));
                self.guide.take_if(|guide| guide.is_empty());
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Opens a preset that the program brings along.
    pub fn open_built_in(&mut self, name: &str) {
        match Document::built_in(name) {
            Ok(document) => {
                self.take(document);
                self.guide = builtin::find(name).map(guide::of_text);
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Saves to the document's file, or to another that becomes its file.
    pub fn save(&mut self, path: Option<PathBuf>) {
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

    /// Changes the memory for past iterations, in MiB.
    pub fn set_past(&mut self, mib: usize) {
        self.settings.past_mib = mib;
        self.run.worker.order(Order::Budget(self.settings.budget()));
    }

    /// Shows the injected light of a document that was just opened.
    fn begin(&mut self) {
        self.load(Start::To { iteration: 0, merge: false });
    }

    /// Hands the document to the worker; the run that is left can be gone back to.
    pub(super) fn load(&mut self, start: Start) {
        self.load_and(start, true);
    }

    /// The same, where an edit runs again by itself: a way of many small steps is no way that anybody goes back.
    fn run_again_by_itself(&mut self) {
        let Progress { iteration, merged, .. } = self.run.progress;
        self.load_and(Start::To { iteration, merge: merged }, false);
    }

    /// Hands the document to the worker; `leave` keeps the run that is left.
    fn load_and(&mut self, start: Start, leave: bool) {
        if let Err(fault) = preset::check(&self.document.preset) {
            self.fail(fault.to_string());
            return;
        }
        self.notice = None;
        self.run.load(&self.document, self.comparison.others.clone(), start, leave, self.settings.device());
        // What is to be seen outlasts scenes, but the worker answers for the scene it was asked with.
        self.sight.asked = None;
    }
}
