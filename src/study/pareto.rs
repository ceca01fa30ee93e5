//! Time against error: every way to get at the light of a scene, how long it takes and how far off it is.
//!
//! The scene may be any; those of `bench` are made at any size ([`synthetic`]). The ways are each scheme with
//! each policy for its levels after 1, 2, 4 … iterations, and what finds all light of a kind at once. Errors
//! are L1 ratios of the merged light against two references:
//!
//! - *uniform*: the fixed point of the uniform volume under the same scheme and factor, what the scheme itself
//!   is after (a kind without levels is after something else);
//! - *ballistic*: what truly arrives, against the light that has moved;
//! - *surface*, where the scene has a mesh: what truly reaches its surfaces after one bounce.
//!
//! Times are medians over rounds in which all ways take turns. They hold all that is computed between the
//! injected and the merged light, but not the making of the grids.

pub(crate) mod synthetic;
mod way;

use super::expectation::Expectation;
use super::expectation::truths::SurfaceTruth;
use super::fit::{BestFit, l1};
use super::light::channel_scales;
use super::reference;
use crate::scene::propagation::Policy;
use crate::scene::{Problem, Propagation};
use crate::simulation::Refusal;
use crate::transport;
use crate::transport::ballistic::Ballistic;
use way::{Outcome, Start};

/// How a way gets at the light of the volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Treatment {
    /// The finest level alone.
    Uniform,
    /// All levels down to 1³ under a policy.
    Octree(Policy),
    /// All levels down to 1³, the coarse ones starting the fine ones: the descent that a scene asks for.
    Descent,
    /// The fixed point of the finest level, solved for.
    Converged,
}

impl Treatment {
    /// All there are.
    pub const ALL: [Treatment; 5] = [
        Treatment::Uniform,
        Treatment::Octree(Policy::Same),
        Treatment::Octree(Policy::Consistent),
        Treatment::Descent,
        Treatment::Converged,
    ];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Treatment::Uniform => "uniform",
            Treatment::Octree(policy) => policy.name(),
            Treatment::Descent => "descent",
            Treatment::Converged => "converged",
        }
    }
}

/// One way on one scene against one expectation.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The scene's name.
    pub preset: String,
    /// The kind of transport that takes its light.
    pub scheme: &'static str,
    /// Its setting.
    pub propagation: Propagation,
    /// How the volume is treated.
    pub treatment: Treatment,
    /// The side of the volume.
    pub size: usize,
    /// Iterations, or sweeps of what finds all light at once.
    pub iterations: usize,
    /// From injection to merged light, in the median of the rounds.
    pub seconds: f64,
    /// The same in the fastest and in the slowest round.
    pub spread: [f64; 2],
    /// [`Expectation::Merged`], the uniform volume being at its fixed point, [`Expectation::Ballistic`] or
    /// [`Expectation::Surface`].
    pub expectation: Expectation,
    /// The error as it is, and after the scalar that fits best.
    pub l1: BestFit,
}

impl Row {
    /// Its setting in a few words: scheme, iterations, factor.
    pub fn setting(&self) -> String {
        format!("{}, k = {}, p = {}", self.name(), self.iterations, self.propagation.factor)
    }

    /// How the levels are treated; of a descent, over what it goes.
    pub fn levels(&self) -> String {
        match self.treatment {
            Treatment::Descent => format!("{}-{}", self.treatment.name(), self.propagation.descent.name()),
            other => other.name().to_owned(),
        }
    }

    /// The setting's name in tables, as its kind has it.
    pub fn name(&self) -> String {
        transport::find(self.scheme).map_or_else(String::new, |kind| (kind.label)(&self.propagation))
    }
}

/// Of the ways on one scene and size against one reference those that no other beats in both time and error
/// after the best scalar, the fastest first.
///
/// ```
/// use lpv_lab::study::expectation::Expectation;
/// use lpv_lab::study::fit::BestFit;
/// use lpv_lab::scene::Propagation;
/// use lpv_lab::study::pareto::{Row, Treatment, front};
///
/// let row = |seconds: f64, error: f64| Row {
///     preset: "mixed".to_owned(),
///     scheme: "cascaded",
///     propagation: Propagation::default(),
///     treatment: Treatment::Uniform,
///     size: 32,
///     iterations: 4,
///     seconds,
///     spread: [seconds; 2],
///     expectation: Expectation::Merged,
///     l1: BestFit { raw: error, fitted: error, scale: 1.0 },
/// };
/// let rows = [row(1.0, 0.5), row(2.0, 0.6), row(3.0, 0.1)];
/// let best: Vec<f64> = front(&rows.each_ref()).iter().map(|row| row.seconds).collect();
/// assert_eq!(best, [1.0, 3.0]);
/// ```
pub fn front<'a>(rows: &[&'a Row]) -> Vec<&'a Row> {
    let mut sorted = rows.to_vec();
    sorted.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let mut least = f64::INFINITY;
    sorted.retain(|row| {
        let better = row.l1.fitted < least;
        least = least.min(row.l1.fitted);
        better
    });
    sorted
}

/// Measures every way on a scene, called `name` in the rows, at the scene's own factor; medians of `rounds`
/// are reported. `progress` hears of the share done, 0 to 1, from any thread, and returns whether to go on;
/// `None` if it did not want to. Ways that refuse the scene are left out.
pub fn measure(
    name: &str,
    problem: &Problem,
    rounds: usize,
    progress: &(dyn Fn(f64) -> bool + Sync),
) -> Result<Option<Vec<Row>>, Refusal> {
    let Some(truth) = Ballistic::new(problem, &|share| progress(TRUTH * share)) else { return Ok(None) };
    measure_against(name, problem, &truth, rounds, &|share| progress(TRUTH + (1.0 - TRUTH) * share))
}

/// The part of the work that the ballistic reference counts as in what is told of progress.
const TRUTH: f64 = 0.25;

/// [`measure`], where the ballistic reference of the scene is there already.
pub fn measure_against(
    name: &str,
    problem: &Problem,
    truth: &Ballistic,
    rounds: usize,
    progress: &dyn Fn(f64) -> bool,
) -> Result<Option<Vec<Row>>, Refusal> {
    let mut ways = way::all(&problem.propagation);
    let levelled: Vec<&str> = transport::kinds().iter().filter(|kind| kind.can.levels).map(|kind| kind.name).collect();
    let steps = (levelled.len() + ways.len() * (1 + rounds)) as f64;
    let mut done = 0;
    let mut go_on = || {
        done += 1;
        progress(f64::from(done) / steps)
    };
    let start = Start::new(problem)?;
    let surfaces = SurfaceTruth::of(problem, &|_| true);
    let mut fixed_points = Vec::new();
    for name in levelled {
        fixed_points.push((name, reference::fixed_point(&way::with(problem, name, Treatment::Uniform, 0))?));
        if !go_on() {
            return Ok(None);
        }
    }
    let mut outcomes: Vec<Option<Outcome>> = Vec::new();
    for way in &ways {
        outcomes.push(way.go(&start).ok());
        if !go_on() {
            return Ok(None);
        }
    }
    let mut kept = outcomes.iter().map(Option::is_some);
    ways.retain(|_| kept.next().unwrap_or_default());
    let outcomes: Vec<Outcome> = outcomes.into_iter().flatten().collect();
    let mut times = vec![Vec::new(); ways.len()];
    for _ in 0..rounds {
        for (way, times) in ways.iter().zip(&mut times) {
            times.extend(way.go(&start).map(|outcome| outcome.seconds));
            if !go_on() {
                return Ok(None);
            }
        }
    }
    let scales = channel_scales(start.injected.channels());
    let mut rows = Vec::new();
    for ((way, outcome), mut times) in ways.iter().zip(&outcomes).zip(times) {
        times.sort_by(f64::total_cmp);
        let seconds = times.get(times.len() / 2).copied().unwrap_or_default();
        let spread = [times.first(), times.last()].map(|time| time.copied().unwrap_or(seconds));
        let row = |expectation, l1| Row {
            preset: name.to_owned(),
            scheme: way.kind().name,
            propagation: way.propagation().clone(),
            treatment: way.treatment(),
            size: problem.size,
            iterations: outcome.iterations,
            seconds,
            spread,
            expectation,
            l1,
        };
        let fixed_point = fixed_points.iter().find(|(name, _)| *name == way.kind().name);
        if let Some((_, Some(uniform))) = fixed_point {
            rows.push(row(Expectation::Merged, l1(&scales, &outcome.all, uniform)));
        }
        rows.push(row(Expectation::Ballistic, l1(&scales, &outcome.moved, truth.light())));
        if let Some(surfaces) = &surfaces {
            let found = way.on_surfaces(&start, surfaces)?;
            rows.push(row(
                Expectation::Surface,
                BestFit { raw: found.l1, fitted: found.l1_fitted, scale: found.scale },
            ));
        }
    }
    Ok(Some(rows))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Solid;
    use crate::scene::occluder::OcclusionMode;
    use glam::DVec3;

    #[test]
    fn every_way_is_measured_against_what_it_can_be_and_errors_fall() {
        let [(name, problem), ..] = synthetic::scenes(8, 3.0);
        let rows = measure(name, &problem, 1, &|_| true).unwrap().unwrap();
        let of = |treatment: Treatment, expectation: Expectation| -> Vec<&Row> {
            let rows = rows.iter().filter(|row| row.preset == "one-wall" && row.scheme == "cascaded");
            rows.filter(|row| row.treatment == treatment && row.expectation == expectation).collect()
        };
        let uniform = of(Treatment::Uniform, Expectation::Merged);
        assert_eq!(uniform.iter().map(|row| row.iterations).collect::<Vec<_>>(), way::ITERATIONS);
        assert!(uniform.windows(2).all(|pair| pair[1].l1.raw < pair[0].l1.raw));
        assert!(uniform[5].l1.raw < 1e-3);
        let consistent = of(Treatment::Octree(Policy::Consistent), Expectation::Ballistic);
        assert_eq!(consistent.len(), way::ITERATIONS.len());
        assert!(of(Treatment::Converged, Expectation::Merged)[1].l1.raw < 1e-3);
        assert!(rows.iter().all(|row| row.l1.fitted <= row.l1.raw));
        assert!(rows.iter().all(|row| row.spread[0] <= row.seconds && row.seconds <= row.spread[1]));
        let directed = |row: &&Row| transport::find(row.scheme).is_some_and(|kind| !kind.can.levels);
        assert!(rows.iter().filter(directed).all(|row| row.expectation == Expectation::Ballistic));
    }

    #[test]
    fn occluders_and_colours_are_measured_too_and_nobody_has_to_wait() {
        let [_, _, (_, mut problem)] = synthetic::scenes(8, 3.0);
        problem.sources[0].color = [1.0, 0.5, 0.0];
        problem.occlusion.mode = OcclusionMode::Hard;
        problem.solids = vec![Solid::new([6, 4, 4], DVec3::NEG_X, 1.0, [0.5, 0.0, 0.0])];
        let rows = measure("walled", &problem, 1, &|share| (0.0..=1.0).contains(&share)).unwrap().unwrap();
        // The lattices' solver refuses occluders, the others' does not.
        assert!(rows.iter().all(|row| row.treatment != Treatment::Converged && row.preset == "walled"));
        assert!(rows.iter().any(|row| row.treatment == Treatment::Uniform && row.name().contains("faces")));
        assert_eq!(measure("walled", &problem, 1, &|share| share < 0.5).unwrap(), None);
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let row = |seconds: f64, fitted: f64| Row {
            preset: "one-wall".to_owned(),
            scheme: "cascaded",
            propagation: Propagation::default(),
            treatment: Treatment::Octree(Policy::Same),
            size: 8,
            iterations: 1,
            seconds,
            spread: [seconds; 2],
            expectation: Expectation::Merged,
            l1: BestFit { raw: fitted, fitted, scale: 1.0 },
        };
        let rows = [row(3.0, 0.1), row(1.0, 0.5), row(2.0, 0.6), row(4.0, 0.1), row(5.0, 0.05)];
        let all: Vec<&Row> = rows.iter().collect();
        let times: Vec<f64> = front(&all).iter().map(|row| row.seconds).collect();
        assert_eq!(times, [1.0, 3.0, 5.0]);
    }
}
