//! Random scenes, reproducible from a seed, each held against what must be true of every scene; a scene
//! that breaks a rule is made as small as it goes, so that it can be read, saved and run again.

pub mod invariants;
mod scenes;
mod shrink;

pub use invariants::{Broken, Invariant};
pub use scenes::preset;

use crate::scene::Preset;
use crate::system::random::Random;

/// A rule that a scene broke.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The number of the scene, from 0.
    pub scene: usize,
    /// What is not as it must be in the small preset.
    pub broken: Broken,
    /// The smallest preset found that breaks the same rule.
    pub preset: Preset,
}

/// What came of many scenes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Scenes tried.
    pub scenes: usize,
    /// Iterations of all scenes, in single precision.
    pub iterations: usize,
    /// Runs that were stopped because their light would have overflowed.
    pub stopped: usize,
    /// How many scenes each rule was held against.
    pub checked: Vec<(Invariant, usize)>,
    /// The rules that were broken, by which scenes.
    pub findings: Vec<Finding>,
}

/// Tries as many scenes of a seed; `watch` is told the number of each before it starts.
pub fn run(seed: u64, scenes: usize, mut watch: impl FnMut(usize)) -> Outcome {
    let mut outcome = Outcome { checked: Invariant::ALL.map(|rule| (rule, 0)).to_vec(), ..Outcome::default() };
    for scene in 0..scenes {
        watch(scene);
        let tried = scenes::preset(&mut of_scene(seed, scene));
        let report = invariants::check(&tried);
        outcome.scenes += 1;
        outcome.iterations += report.iterations;
        outcome.stopped += usize::from(report.stopped);
        for (rule, count) in &mut outcome.checked {
            *count += usize::from(report.checked.contains(rule));
        }
        if let Some(broken) = report.broken {
            outcome.findings.push(shrunk(scene, tried, broken));
        }
    }
    outcome
}

/// The numbers of a scene of a seed: each scene has its own, so that any can be made again by itself.
pub fn of_scene(seed: u64, scene: usize) -> Random {
    Random::new(Random::new(seed).bits() ^ (scene as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

/// The finding of a scene, its preset made small.
fn shrunk(scene: usize, preset: Preset, broken: Broken) -> Finding {
    let rule = broken.invariant;
    let mut smallest = broken;
    let preset = shrink::smallest(preset, |candidate| {
        let found = invariants::check(candidate).broken.filter(|found| found.invariant == rule);
        let still = found.is_some();
        smallest = found.unwrap_or_else(|| smallest.clone());
        still
    });
    let title = format!("Breaks: {}", smallest.invariant.name());
    Finding { scene, broken: smallest, preset: Preset { title, ..preset } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_random_scene_breaks_a_rule() {
        let outcome = run(1, 250, |_| ());
        assert_eq!(outcome.findings, []);
        // Rules that were never held against anything would not be worth their name.
        assert!(outcome.checked.iter().all(|(_, count)| *count >= 10), "{outcome:?}");
        assert!(outcome.stopped > 0 && outcome.iterations > 1000);
    }

    #[test]
    fn the_same_seed_makes_the_same_scenes_and_another_others() {
        let scene = |seed, number| preset(&mut of_scene(seed, number));
        assert_eq!(scene(3, 5), scene(3, 5));
        assert_ne!(scene(3, 5), scene(3, 6));
        assert_ne!(scene(3, 5), scene(4, 5));
    }
}
