//! What must be true of every scene, and the check of one preset against all of it.

mod again;
mod steps;

use std::fmt;
use std::path::Path;

use crate::scene::occluder::OcclusionMode;
use crate::scene::propagation::descent::Descent;
use crate::scene::{Preset, Problem, Propagation};
use crate::simulation::{Action, Refusal, Simulation};
use crate::transport::kind::Law;
use crate::transport::lattice::levels::operators;
use crate::transport::lattice::scheme::{Scheme, Surface};
use crate::transport::lattice::schemes;
use crate::transport::lattice::stencil::Stencil;
use crate::transport::{self, Kind};

/// A rule that no scene may break.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Invariant {
    /// A preset that passes its check can be run.
    Runs,
    /// No coefficient is NaN or infinite, and after an iteration none is denormal, which would be slow.
    Finite,
    /// With every face clamped no cell holds negative energy.
    NonNegative,
    /// With every face clamped an iteration gains no more than it would from the lone lobe it gains most from.
    Energy,
    /// With every face clamped accumulated light never becomes less.
    Accumulates,
    /// [`crate::study::laws::Reach`]: after k iterations light is only where k steps lead from its source, and of its parity.
    Reach,
    /// Single precision keeps within its bound of double precision.
    Precision,
    /// [`crate::study::laws::again`]: a run in one go gives the bits that single steps give.
    Again,
    /// [`crate::study::laws::symmetry`]: a scene without occluders, turned or mirrored, gives its light turned or mirrored.
    Symmetry,
    /// [`crate::study::laws::superposition`]: the light of two injections is the sum of the light of each.
    Superposition,
    /// [`crate::study::laws::fixed_point`]: what is solved for is what iterating comes to.
    FixedPoint,
    /// Below the critical factor light dies away, in the end steadily.
    Converges,
}

impl Invariant {
    /// Every rule.
    pub const ALL: [Invariant; 12] = [
        Invariant::Runs,
        Invariant::Finite,
        Invariant::NonNegative,
        Invariant::Energy,
        Invariant::Accumulates,
        Invariant::Reach,
        Invariant::Precision,
        Invariant::Again,
        Invariant::Symmetry,
        Invariant::Superposition,
        Invariant::FixedPoint,
        Invariant::Converges,
    ];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Invariant::Runs => "runs",
            Invariant::Finite => "finite",
            Invariant::NonNegative => "non-negative",
            Invariant::Energy => "energy",
            Invariant::Accumulates => "accumulates",
            Invariant::Reach => "reach and parity",
            Invariant::Precision => "f32 near f64",
            Invariant::Again => "steps = run",
            Invariant::Symmetry => "symmetry",
            Invariant::Superposition => "superposition",
            Invariant::FixedPoint => "solved = iterated",
            Invariant::Converges => "converges",
        }
    }
}

/// A rule that was broken, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Broken {
    /// The rule.
    pub invariant: Invariant,
    /// Where, and by how much.
    pub how: String,
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.invariant.name(), self.how)
    }
}

/// What a check found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Iterations done in single precision.
    pub iterations: usize,
    /// Whether the run was stopped because its light would have overflowed.
    pub stopped: bool,
    /// The rules that this scene was held against.
    pub checked: Vec<Invariant>,
    /// The first rule that it broke.
    pub broken: Option<Broken>,
}

/// A scene and what is known of it before it runs.
struct Case {
    problem: Problem,
    /// The kind of transport.
    kind: &'static Kind,
    /// Its scheme, where it is a lattice's.
    scheme: Option<Scheme>,
    /// Every face of every level is clamped, so that light is a sum of lobes with weights of zero or more. Exact levels
    /// and descents have none.
    clamped: bool,
    /// Nothing stands in the light's way.
    free: bool,
}

impl Case {
    fn new(preset: &Preset) -> Result<Self, String> {
        let problem = Problem::build(preset, Path::new("")).map_err(|error| error.to_string())?;
        let kind = transport::known(&problem.propagation.scheme).map_err(|error| error.to_string())?;
        let scheme = schemes::find(kind.name);
        let all_clamp = scheme.as_ref().is_some_and(|scheme| scheme.faces.iter().all(|face| face.clamp));
        let Propagation { clamp, levels, descent, .. } = problem.propagation;
        let clamped = clamp && all_clamp && !levels.is_exact() && descent == Descent::Off;
        let free = problem.solids.is_empty() || problem.occlusion.mode == OcclusionMode::Off;
        Ok(Case { problem, kind, scheme, clamped, free })
    }

    /// The operator of every level, of a lattice.
    fn stencils(&self) -> Result<Vec<Stencil<f64>>, Refusal> {
        let Some(scheme) = &self.scheme else { return Ok(Vec::new()) };
        let Propagation { factor, clamp, levels, .. } = self.problem.propagation;
        let count = (self.problem.size / self.problem.coarsest).ilog2() as usize + 1;
        let operators = operators(scheme, factor, clamp, levels, count)?;
        Ok(operators.into_iter().map(|operator| operator.stencil).collect())
    }

    /// The rules that apply.
    fn rules(&self) -> Vec<Invariant> {
        let settled = again::settles(self);
        let claimed = (self.kind.laws)(&self.problem.propagation);
        let applies = |rule: &Invariant| match rule {
            Invariant::Runs | Invariant::Finite | Invariant::Again => true,
            Invariant::Reach => claimed.contains(&Law::Reach),
            Invariant::NonNegative | Invariant::Accumulates => self.clamped,
            // Reflected light is new light.
            Invariant::Energy => self.clamped && (self.free || self.reflects_nothing()),
            Invariant::Precision => self.clamped && self.free && self.problem.propagation.factor <= 16.0,
            Invariant::Symmetry => self.free && claimed.contains(&Law::Symmetry),
            Invariant::Superposition => claimed.contains(&Law::Superposition),
            Invariant::FixedPoint => self.free && claimed.contains(&Law::FixedPoint),
            Invariant::Converges => settled,
        };
        Invariant::ALL.into_iter().filter(applies).collect()
    }

    fn reflects_nothing(&self) -> bool {
        let blocks = self.scheme.as_ref().is_none_or(|scheme| scheme.surface == Surface::Blocked);
        self.problem.occlusion.bounce == 0.0 && blocks
    }
}

/// Holds a preset against every rule that applies to it.
pub fn check(preset: &Preset) -> Report {
    let mut report = Report { iterations: 0, stopped: false, checked: vec![Invariant::Runs], broken: None };
    let runs = |how: String| Some(Broken { invariant: Invariant::Runs, how });
    let case = match Case::new(preset) {
        Ok(case) => case,
        Err(how) => return Report { broken: runs(how), ..report },
    };
    let started = || {
        let (narrow, wide) = (Simulation::new(case.problem.clone())?, Simulation::new(case.problem.clone())?);
        Ok((narrow, wide, case.stencils()?))
    };
    let (mut narrow, mut wide, stencils) = match started() {
        Ok(started) => started,
        // Some factors have no operator on coarse levels; that is refused by name.
        Err(Refusal::TooLarge(_) | Refusal::Grows(_) | Refusal::Underived { .. }) => return report,
        Err(error) => return Report { broken: runs(error.to_string()), ..report },
    };
    report.checked = case.rules();
    report.broken = step_through(&case, &stencils, &report.checked, &mut narrow, &mut wide).err();
    report.iterations = narrow.iteration();
    report.stopped = narrow.divergence().is_some();
    if report.broken.is_none() {
        report.broken = again::check(&case, &report.checked, &narrow, &wide).err();
    }
    report
}

/// Runs both precisions side by side and looks at every step.
fn step_through(
    case: &Case,
    stencils: &[Stencil<f64>],
    rules: &[Invariant],
    narrow: &mut Simulation<f32>,
    wide: &mut Simulation<f64>,
) -> Result<(), Broken> {
    for action in [Action::Inject, Action::Downsample] {
        narrow.act(action);
        wide.act(action);
    }
    let mut watch = steps::Watch::new(case, stencils, narrow);
    watch.check(rules, narrow, wide)?;
    for _ in 0..case.problem.actions() {
        narrow.act(Action::Propagate);
        if narrow.divergence().is_some() {
            break;
        }
        wide.act(Action::Propagate);
        watch.check(rules, narrow, wide)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_that_a_wall_sends_back_at_once_breaks_no_rule() {
        let text = "(version: 1, size: 2, injectors: [(kind: Single(cell: (1, 0, 1)))],
            occluders: [(kind: Plane(axis: Y, at: 1), albedo: (0.8, 0.8, 0.8))],
            occlusion: (mode: Hard, bounce: 0.2), propagation: (scheme: \"axial\", iterations: 3))";
        let report = check(&Preset::parse(text, Path::new("p.ron")).unwrap());
        assert_eq!((report.broken, report.iterations), (None, 3));
    }
}
