//! What becomes of a scene's light at its own factor: level by level, the growth an iteration and the
//! iteration in which numbers will overflow.

use std::f64::consts::PI;

use super::level::{critical, long_run_growth, without_borders};
use crate::field::Levels;
use crate::scene::{Problem, Propagation};
use crate::simulation::limit;
use crate::transport::lattice::levels::{LevelOperator, operators};
use crate::transport::lattice::scheme::Scheme;
use crate::transport::lattice::schemes;

/// What becomes of the light of one level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlook {
    /// The level, 0 the finest.
    pub level: usize,
    /// Its side, in cells.
    pub side: usize,
    /// The factor above which its light grows without bound; infinite where all light leaves at once.
    pub critical: f64,
    /// What an iteration multiplies its light by in the long run, at the scene's factor.
    pub growth: f64,
    /// About when its numbers leave single precision: in which iteration. `None` where they never do.
    pub overflow: Option<usize>,
}

/// A level that bears less than the factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exceeded {
    /// The level, 0 the finest.
    pub level: usize,
    /// Its side, in cells.
    pub side: usize,
    /// The factor above which its light grows without bound.
    pub critical: f64,
}

/// The level that bears the least, if its critical factor is exceeded; occluders aside. Nothing for settings
/// that cannot be run. A factor that is safe in a volume without borders costs nothing to tell.
pub fn exceeded(propagation: &Propagation, size: usize, coarsest: usize) -> Option<Exceeded> {
    let (scheme, sizes, operators) = parts(propagation, size, coarsest)?;
    let suspects = operators.iter().enumerate().filter(|(_, operator)| without_borders(&operator.stencil) > 1.0);
    let all = suspects.map(|(level, _)| {
        let side = sizes.side(level);
        Exceeded { level, side, critical: critical(&scheme, propagation.clamp, propagation.levels, level, side) }
    });
    all.filter(|level| level.critical < propagation.factor).min_by(|a, b| a.critical.total_cmp(&b.critical))
}

/// Whether light is known at once to stay bounded, whatever the volume: each level's operator would bear the factor even
/// if no light could leave. Where this is false light may still be bounded; [`exceeded`] finds out.
pub fn surely_bounded(propagation: &Propagation, size: usize, coarsest: usize) -> bool {
    let parts = parts(propagation, size, coarsest);
    parts.is_some_and(|(_, _, operators)| operators.iter().all(|level| without_borders(&level.stencil) <= 1.0))
}

/// The outlook of every level of a scene, occluders aside: they remove light, and only a bounce, which
/// the preset must ask for, gives some back. Empty where the scene cannot be run.
pub fn levels(problem: &Problem) -> Vec<Outlook> {
    let Some((scheme, sizes, operators)) = parts(&problem.propagation, problem.size, problem.coarsest) else {
        return Vec::new();
    };
    let outlook = |(level, operator): (usize, LevelOperator<f64>)| {
        of_level(problem, &scheme, level, sizes.side(level), &operator)
    };
    operators.into_iter().enumerate().map(outlook).collect()
}

fn of_level(problem: &Problem, scheme: &Scheme, level: usize, side: usize, operator: &LevelOperator<f64>) -> Outlook {
    let propagation = &problem.propagation;
    let growth = long_run_growth(&operator.stencil, side);
    let critical = critical(scheme, propagation.clamp, propagation.levels, level, side);
    Outlook { level, side, critical, growth, overflow: overflow(problem, level, side, growth) }
}

/// The level whose numbers overflow first, if any does. A factor that is safe in a volume without borders
/// is safe on every level, and costs nothing to tell.
pub fn first_to_overflow(problem: &Problem) -> Option<Outlook> {
    let (scheme, sizes, operators) = parts(&problem.propagation, problem.size, problem.coarsest)?;
    let mut first: Option<(usize, usize)> = None;
    for (level, operator) in operators.iter().enumerate() {
        if without_borders(&operator.stencil) <= 1.0 {
            continue;
        }
        let side = sizes.side(level);
        let growth = long_run_growth(&operator.stencil, side);
        let sooner = |k: &usize| first.is_none_or(|(earliest, _)| *k < earliest);
        if let Some(k) = overflow(problem, level, side, growth).filter(sooner) {
            first = Some((k, level));
        }
    }
    let (_, level) = first?;
    Some(of_level(problem, &scheme, level, sizes.side(level), &operators[level]))
}

/// What people are told before a scene runs, if a level of it will overflow.
pub fn warning(problem: &Problem) -> Option<String> {
    let found = first_to_overflow(problem)?;
    let percent = 100.0 * (found.growth - 1.0);
    Some(format!(
        "the factor {} exceeds {:.2}, the critical one of level {} ({}³): its light grows by {percent:.2} % an iteration \
         and will overflow about iteration {}",
        problem.propagation.factor, found.critical, found.level, found.side, found.overflow?
    ))
}

/// The scheme, the levels and their operators; none where the simulation will refuse one of them.
fn parts(propagation: &Propagation, size: usize, coarsest: usize) -> Option<(Scheme, Levels, Vec<LevelOperator<f64>>)> {
    let scheme = schemes::find(&propagation.scheme)?;
    let sizes = Levels::new(size, coarsest)?;
    let operators = operators(&scheme, propagation.factor, propagation.clamp, propagation.levels, sizes.count());
    Some((scheme, sizes, operators.ok()?))
}

/// The iteration in which the accumulated light reaches what f32 may hold. What grows is the share of the
/// injected light in the slowest mode, a product of sines; the sum of its powers is g/(g − 1) times the
/// last.
fn overflow(problem: &Problem, level: usize, side: usize, growth: f64) -> Option<usize> {
    if growth <= 1.0 {
        return None;
    }
    let sine = |c: usize| (PI * ((c >> level) + 1) as f64 / (side + 1) as f64).sin();
    let children = 8f64.powi(i32::try_from(level).ok()?);
    let mut amplitude = 0.0;
    for source in &problem.sources {
        let color = source.color.into_iter().fold(0.0, f64::max);
        for (cell, light) in &source.light {
            amplitude += color * light.0[0].abs() * cell.map(sine).iter().product::<f64>() / children;
        }
    }
    amplitude *= (2.0 / (side + 1) as f64).powi(3);
    if amplitude <= 0.0 {
        return None;
    }
    let iterations = (limit::<f32>() * (growth - 1.0) / (growth * amplitude)).ln() / growth.ln();
    Some(iterations.max(1.0).ceil() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Occlusion, Source};
    use crate::sh::Sh;

    fn problem(size: usize, factor: f64) -> Problem {
        let light = vec![([size / 2; 3], Sh::lobe(glam::DVec3::X)), ([0; 3], Sh::lobe(glam::DVec3::Y))];
        Problem {
            size,
            coarsest: 1,
            sources: vec![Source { color: [1.0, 0.5, 0.0], light, ..Source::default() }],
            solids: Vec::new(),
            occlusion: Occlusion::default(),
            propagation: Propagation { factor, ..Propagation::default() },
            ..Problem::default()
        }
    }

    #[test]
    fn only_levels_above_their_critical_factor_overflow() {
        // MATH.md section 2: 4.33 at 8³, 5.22 at 4³, 9.53 at 2³.
        assert_eq!(first_to_overflow(&problem(8, 4.0)), None);
        assert_eq!(first_to_overflow(&problem(8, 4.25)), None);
        let found = levels(&problem(8, 5.0));
        assert_eq!(found.iter().map(|level| level.side).collect::<Vec<_>>(), [8, 4, 2, 1]);
        assert_eq!(found.iter().map(|level| level.overflow.is_some()).collect::<Vec<_>>(), [true, false, false, false]);
        assert_eq!(found[3].growth, 0.0);
        assert_eq!(first_to_overflow(&problem(8, 20.0)).map(|level| level.level), Some(0));
    }

    #[test]
    fn the_level_that_bears_the_least_is_told_where_it_is_exceeded() {
        let at = |factor| exceeded(&Propagation { factor, ..Propagation::default() }, 8, 1);
        assert_eq!((at(3.0), at(4.25)), (None, None));
        let found = at(5.5).unwrap();
        assert_eq!((found.level, found.side), (0, 8));
        assert!((found.critical - 4.334).abs() < 1e-3);
        let unknown = Propagation { scheme: "none".to_owned(), factor: 9.0, ..Propagation::default() };
        assert_eq!(exceeded(&unknown, 8, 1), None);
    }

    #[test]
    fn light_diverges_when_the_outlook_says() {
        for (size, factor) in [(4, 6.0), (8, 5.0), (8, 12.0), (16, 4.5)] {
            let mut problem = problem(size, factor);
            problem.propagation.iterations = 5000;
            let told = first_to_overflow(&problem).and_then(|outlook| outlook.overflow).unwrap();
            let mut simulation = crate::simulation::Simulation::<f32>::new(problem).unwrap();
            simulation.run(|_| true);
            let found = simulation.divergence().unwrap().iteration;
            assert!(found.abs_diff(told) <= 3 + told / 20, "{size}³ at {factor}: {told} told, {found} found");
        }
    }
}
