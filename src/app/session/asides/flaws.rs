//! What goes wrong with the light of the runs in the table, as its columns have it: leaks and jumps. Each takes other
//! runs of the same scene, so that it is found out aside, for volumes in which that takes no time to speak of.

use egui::Context;

use super::{Very, Watch};
use crate::app::session::Session;
use crate::app::session::plots::Tab;
use crate::app::session::view::Workspace;
use crate::app::worker::rival::Rival;
use crate::scene::Problem;
use crate::simulation::options::Wanted;
use crate::simulation::{Action, Refusal, Simulation};
use crate::study::artefacts::{jump, leak};

/// The side of the largest volume whose leaks and jumps are found out.
pub const UP_TO: usize = 64;

/// What goes wrong with the light of one run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flaws {
    /// The merged light behind occluders over that without them; `None` where nothing lies behind any.
    pub leak: Option<f64>,
    /// The mean jump between levels; `None` where there is no border between levels in the light.
    pub jump: Option<f64>,
}

impl Flaws {
    /// Those of a problem after `k` of its own iterations.
    fn of(problem: Problem, k: usize) -> Result<Self, String> {
        let told = |refusal: Refusal| refusal.to_string();
        let mut state = Simulation::<f32>::new(problem).map_err(told)?;
        for action in [Action::Clear, Action::Inject, Action::Downsample] {
            state.act(action);
        }
        state.advance(k, Wanted::Everything);
        if state.divergence().is_some() {
            return Ok(Flaws::default());
        }
        let leak = leak::of(&state).map_err(told)?.and_then(|leak| leak.merged);
        let jump = jump::of(&state).map_err(told)?.filter(|jump| jump.pairs > 0).map(|jump| jump.mean);
        Ok(Flaws { leak, jump })
    }
}

/// The runs whose flaws are asked for: the document's problem, what runs beside it, and after how many iterations.
pub type Runs = (Very, Vec<Rival>, usize);

impl Session {
    /// The flaws of the runs in the order of their curves, once they are found out.
    pub fn flaws(&self) -> Option<&[Flaws]> {
        self.asides.flaws.known(&self.runs_seen()?).map(Vec::as_slice)
    }

    fn runs_seen(&self) -> Option<Runs> {
        let problem = self.run.problem.as_ref().filter(|problem| problem.size <= UP_TO)?;
        Some((Very(problem.clone()), self.run.others.clone(), self.seen()))
    }

    /// Has them found out while the table is there and nothing else is computed.
    pub(super) fn seek_flaws(&mut self, ctx: &Context) -> Result<(), String> {
        let settings = &self.settings;
        let is_seen = settings.workspace == Workspace::Light && settings.plots.tab == Tab::Errors;
        let wanted = is_seen && !self.run.others.is_empty() && !self.run.is_underway();
        let mut begun = Ok(());
        if let Some(key) = self.runs_seen().filter(|_| wanted) {
            begun = self.asides.flaws.want(&key, ctx, |_| {
                let (Very(own), others, k) = key.clone();
                move |watch: &Watch| {
                    let problems = others.iter().filter_map(|rival| rival.problem(&own));
                    let all: Vec<Problem> = std::iter::once((*own).clone()).chain(problems).collect();
                    let count = all.len() as f64;
                    let each = all.into_iter().enumerate().map(|(i, problem)| match watch.go_on(i as f64 / count) {
                        true => Flaws::of(problem, k),
                        false => Err("leaks and jumps are no longer wanted".to_owned()),
                    });
                    each.collect()
                }
            });
        }
        begun.and(self.asides.flaws.hear(ctx))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::Preset;

    fn flaws(occlusion: &str, coarsest: usize, k: usize) -> Flaws {
        let text = format!(
            "(version: 1, size: 8, coarsest: {coarsest}, injectors: [(kind: Wall(side: NegX))], \
             occluders: [(kind: Plane(axis: X, at: 4), normal: (-1, 0, 0))], occlusion: (mode: {occlusion}))"
        );
        let preset = Preset::parse(&text, Path::new("wall")).unwrap();
        Flaws::of(Problem::build(&preset, Path::new("")).unwrap(), k).unwrap()
    }

    #[test]
    fn a_wall_that_holds_nothing_back_leaks_all_and_one_level_has_no_jumps() {
        assert_eq!(flaws("Off", 8, 6), Flaws { leak: Some(1.0), jump: None });
        assert_eq!(flaws("Hard", 8, 6), Flaws { leak: Some(0.0), jump: None });
        // Light has not come all the way yet: coarse levels are sampled before it.
        assert!(flaws("Off", 1, 2).jump.is_some_and(|jump| jump > 0.0));
    }
}
