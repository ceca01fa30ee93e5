//! What takes longer than a frame and is asked for by what is on screen: what truly arrives, light along a line, run
//! time against error, critical factors, and whether a run will end well.

mod aside;
mod errand;
pub(crate) mod flaws;

use std::path::Path;
use std::sync::Arc;

use egui::Context;

pub use aside::Aside;
pub use errand::Watch;

use super::Session;
use super::plots::Tab;
use super::port::{Answer, Question};
use super::view::{Stage, Workspace};
use crate::app::worker::Order;
use crate::app::worker::rival::Rival;
use crate::scene::{Problem, Propagation};
use crate::study::expectation::Expectation;
use crate::study::identify::files::Role;
use crate::study::pareto::{self, Row};
use crate::study::profile::Policies;
use crate::study::stability::outlook::{self, Exceeded};
use crate::transport::ballistic::Ballistic;

/// Rounds over all ways when run time is set against error; medians are shown.
const ROUNDS: usize = 3;

/// A problem as a key: the same only if it is the very one.
#[derive(Clone, Debug)]
pub struct Very(pub Arc<Problem>);

impl PartialEq for Very {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// A problem as a key: the same where the same light takes the same ways; how it is propagated does not matter.
#[derive(Clone, Debug)]
pub struct Ways(Arc<Problem>);

impl PartialEq for Ways {
    fn eq(&self, Ways(b): &Self) -> bool {
        let Ways(a) = self;
        a.size == b.size && a.sources == b.sources && a.solids == b.solids && a.occlusion.mode == b.occlusion.mode
    }
}

/// What critical factors depend on: the document's own propagator first.
#[derive(Clone, Debug, PartialEq)]
pub struct Factors {
    propagators: Vec<Propagation>,
    size: usize,
    coarsest: usize,
}

/// All of them.
#[derive(Debug)]
pub struct Asides {
    /// What truly arrives in the problem that runs.
    pub truth: Aside<Ways, Arc<Ballistic>>,
    /// Whether the worker measures against it.
    handed: bool,
    /// The problem under each policy, up to an iteration.
    pub profiles: Aside<(Very, usize), Arc<Policies>>,
    /// Run time against error; the number tells measurements of the same problem apart.
    pub pareto: Aside<(Very, usize), Vec<Row>>,
    /// The measurement that is wanted.
    measurement: Option<(Very, usize)>,
    /// The level whose critical factor each propagator that is being edited exceeds.
    pub critical: Aside<Factors, Vec<Option<Exceeded>>>,
    /// What goes wrong with the light of the runs in the table.
    pub flaws: Aside<flaws::Runs, Vec<flaws::Flaws>>,
    /// What is found out about a port.
    pub port: Aside<Question, Arc<Answer>>,
    /// A line for a run that will not end well.
    outlook: Aside<(Very, Vec<Rival>), Option<String>>,
}

impl Default for Asides {
    fn default() -> Self {
        Asides {
            truth: Aside::new("straight lines"),
            handed: false,
            profiles: Aside::new("line of cells"),
            pareto: Aside::new("run time against error"),
            measurement: None,
            critical: Aside::new("critical factors"),
            flaws: Aside::new("leaks and jumps"),
            port: Aside::new("port"),
            outlook: Aside::new("outlook"),
        }
    }
}

impl Asides {
    /// Whether anything is being found out that is waited for; the outlook comes when it comes.
    pub fn are_underway(&self) -> bool {
        self.truth.is_underway()
            || self.profiles.is_underway()
            || self.pareto.is_underway()
            || self.critical.is_underway()
            || self.port.is_underway()
    }

    /// The level whose critical factor a propagator exceeds; 0 is the document's own, and rivals are counted from 1.
    pub fn exceeded(&self, propagator: usize) -> Option<Exceeded> {
        self.critical.latest().and_then(|(_, found)| found.get(propagator).copied().flatten())
    }

    /// Calls the measurement off, and forgets what was measured before it.
    pub fn cancel_measurement(&mut self) {
        self.measurement = None;
        self.pareto.keep_only(|_| false);
    }
}

impl Session {
    /// What was measured last.
    pub fn pareto_rows(&self) -> &[Row] {
        self.asides.pareto.latest().map_or(&[], |(_, rows)| rows)
    }

    /// Whether what was measured is of another problem than the one that runs.
    pub fn pareto_is_old(&self) -> bool {
        let now = self.run.problem.as_ref();
        self.asides.pareto.latest().zip(now).is_some_and(|(((Very(of), _), _), now)| !Arc::ptr_eq(of, now))
    }

    /// Whether something on screen is measured against what truly arrives.
    pub fn wants_truth(&self) -> bool {
        let seen = self.settings.view.stage == Stage::Compare && self.run.others.contains(&Rival::Ballistic);
        seen || self.metric() == Expectation::Ballistic
    }

    /// Whether what truly arrives was given up for the problem that runs.
    pub fn truth_is_given_up(&self) -> bool {
        self.run.problem.as_ref().is_some_and(|problem| self.asides.truth.is_given_up(&Ways(Arc::clone(problem))))
    }

    /// Whether the light along the line could not be computed.
    pub fn profiles_are_given_up(&self) -> bool {
        let problem = self.run.problem.as_ref();
        problem.is_some_and(|problem| self.asides.profiles.is_given_up(&(Very(Arc::clone(problem)), self.seen())))
    }

    /// Starts to measure the problem that runs, once more if it was measured before.
    pub fn measure(&mut self) {
        let Some(problem) = &self.run.problem else { return };
        let before = self.asides.measurement.as_ref().map_or(0, |(_, number)| *number);
        self.asides.pareto.keep_only(|_| false);
        self.asides.measurement = Some((Very(Arc::clone(problem)), before + 1));
    }

    /// Has found out what is wanted, and takes in what was found.
    pub(super) fn seek(&mut self, ctx: &Context) {
        let told = [
            self.seek_truth(ctx),
            self.seek_profiles(ctx),
            self.seek_pareto(ctx),
            self.seek_factors(ctx),
            self.seek_flaws(ctx),
            self.seek_port(ctx),
            self.seek_outlook(ctx),
        ];
        told.into_iter().filter_map(Result::err).for_each(|line| self.fail(line));
    }

    fn seek_truth(&mut self, ctx: &Context) -> Result<(), String> {
        let wanted = self.wants_truth();
        let problem = self.run.problem.as_ref().map(|problem| Ways(Arc::clone(problem)));
        let truth = &mut self.asides.truth;
        let mut begun = Ok(());
        if let Some(key) = &problem {
            truth.keep_only(|known| known == key);
            if wanted {
                begun = truth.want(key, ctx, |_| {
                    let Ways(ours) = key.clone();
                    move |watch: &errand::Watch| {
                        let found = Ballistic::new(&ours, &|share| watch.go_on(share));
                        found.map(Arc::new).ok_or_else(|| "the straight lines were given up".to_owned())
                    }
                });
            }
        }
        let heard = truth.hear(ctx);
        let known = problem.as_ref().and_then(|key| truth.known(key)).filter(|_| wanted).cloned();
        if known.is_some() != self.asides.handed {
            self.asides.handed = known.is_some();
            self.sight.answered = false;
            self.run.worker.order(Order::Truth(known));
        }
        begun.and(heard)
    }

    /// Has the light along the line computed while it is looked at, going on from what is known where it can.
    fn seek_profiles(&mut self, ctx: &Context) -> Result<(), String> {
        let wanted = self.settings.plots.tab == Tab::Line;
        let iteration = self.seen();
        let profiles = &mut self.asides.profiles;
        let Some(problem) = self.run.problem.as_ref().filter(|_| wanted) else {
            profiles.give_up();
            profiles.try_again();
            return Ok(());
        };
        let key = (Very(Arc::clone(problem)), iteration);
        profiles.keep_only(|(of, _)| *of == key.0);
        let begun = profiles.want(&key, ctx, |known| {
            let start = known.filter(|((_, asked), _)| *asked < iteration).map(|(_, policies)| Arc::clone(policies));
            let problem = Arc::clone(problem);
            move |watch: &errand::Watch| {
                let mut policies = match start {
                    Some(start) => Arc::unwrap_or_clone(start),
                    None => Policies::new(&problem).map_err(|error| error.to_string())?,
                };
                policies.advance(iteration, |k| watch.go_on(k as f64 / iteration.max(1) as f64));
                Ok(Arc::new(policies))
            }
        });
        begun.and(profiles.hear(ctx))
    }

    fn seek_port(&mut self, ctx: &Context) -> Result<(), String> {
        let question = &self.port.question;
        let port = &mut self.asides.port;
        port.keep_only(|asked| asked == question);
        if self.settings.workspace != Workspace::Study || !question.is_complete() {
            return Ok(());
        }
        let begun = port.want(question, ctx, |_| {
            let question = question.clone();
            move |_: &errand::Watch| question.answer().map(Arc::new)
        });
        begun.and(port.hear(ctx))
    }

    /// What is found out about the port, once it is.
    pub fn answer(&self) -> Option<&Arc<Answer>> {
        self.asides.port.known(&self.port.question)
    }

    /// What the verdict on the port waits for, in words.
    pub fn port_is_waiting_for(&self) -> &'static str {
        let question = &self.port.question;
        if self.asides.port.is_underway() {
            "Looking at the dumps…"
        } else if self.asides.port.is_given_up(question) {
            "These dumps cannot be looked at."
        } else if !question.is_complete() && !question.files.is_empty() {
            "The grid after injection and the one after iteration 1 are needed."
        } else {
            ""
        }
    }

    /// Takes a dump of a port.
    pub fn add_dump(&mut self, path: &Path) {
        let files = &mut self.port.question.files;
        let role = Role::guess(path);
        files.retain(|(_, other)| *other != role);
        files.push((path.to_path_buf(), role));
        files.sort_by_key(|(_, role)| *role);
    }

    fn seek_pareto(&mut self, ctx: &Context) -> Result<(), String> {
        let Some(key) = self.asides.measurement.clone() else { return Ok(()) };
        let title = self.document.name();
        let truth = self.asides.truth.latest().map(|(_, truth)| truth).filter(|truth| truth.is_of(&key.0.0)).cloned();
        let begun = self.asides.pareto.want(&key, ctx, |_| {
            let Very(problem) = key.0.clone();
            move |watch: &errand::Watch| {
                let go_on = |share| watch.go_on(share);
                let rows = match truth {
                    Some(truth) => pareto::measure_against(&title, &problem, &truth, ROUNDS, &go_on),
                    None => pareto::measure(&title, &problem, ROUNDS, &go_on),
                };
                let rows = rows.map_err(|error| error.to_string())?;
                rows.ok_or_else(|| "the measurement was called off".to_owned())
            }
        });
        begun.and(self.asides.pareto.hear(ctx))
    }

    /// Finds out anew where a factor has changed; while one is dragged there is one errand at a time.
    fn seek_factors(&mut self, ctx: &Context) -> Result<(), String> {
        let preset = &self.document.preset;
        let own = &preset.propagation;
        let rivals = &self.comparison.others;
        let of_rival = |rival: &Rival| match rival {
            Rival::Propagator(propagation) => propagation.clone(),
            Rival::Uniform | Rival::Ballistic => own.clone(),
        };
        let propagators = std::iter::once(own.clone()).chain(rivals.iter().map(of_rival)).collect();
        let key = Factors { propagators, size: preset.size, coarsest: preset.coarsest };
        let begun = self.asides.critical.want(&key, ctx, |_| {
            let Factors { propagators, size, coarsest } = key.clone();
            move |_: &errand::Watch| {
                Ok(propagators.iter().map(|propagation| outlook::exceeded(propagation, size, coarsest)).collect())
            }
        });
        begun.and(self.asides.critical.hear(ctx))
    }

    /// Tells if light will not end well. That takes longer than many a run, so it holds none up.
    fn seek_outlook(&mut self, ctx: &Context) -> Result<(), String> {
        let Some(problem) = &self.run.problem else { return Ok(()) };
        let key = (Very(Arc::clone(problem)), self.run.others.clone());
        let outlook = &mut self.asides.outlook;
        let before = outlook.known(&key).is_some();
        let begun = outlook.want(&key, ctx, |_| {
            let (Very(own), others) = key.clone();
            move |_: &errand::Watch| {
                let others = others.iter().filter_map(|rival| rival.problem(&own));
                Ok(std::iter::once((*own).clone()).chain(others).find_map(|problem| outlook::warning(&problem)))
            }
        });
        let heard = outlook.hear(ctx);
        let warning = outlook.known(&key).filter(|_| !before).cloned().flatten();
        if let Some(line) = warning {
            self.say(line);
        }
        begun.and(heard)
    }
}
