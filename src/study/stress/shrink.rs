//! A preset made smaller, step by step, as long as it still shows what it was chosen for.

use crate::scene::Preset;
use crate::scene::injector::InjectorKind;
use crate::scene::occluder::{OccluderKind, Occlusion};
use crate::scene::propagation::descent::Descent;
use crate::scene::propagation::{Index, Policy, Snapshots};

/// The smallest preset that can be reached from `preset` by the steps below and for which `shows` holds,
/// as it does for `preset`.
pub fn smallest(mut preset: Preset, mut shows: impl FnMut(&Preset) -> bool) -> Preset {
    // Each step taken makes the preset smaller by some measure, so this ends.
    while let Some(smaller) = smaller(&preset).into_iter().find(|candidate| shows(candidate)) {
        preset = smaller;
    }
    preset
}

/// Presets that are a step smaller, the larger steps first.
fn smaller(preset: &Preset) -> Vec<Preset> {
    let mut candidates = Vec::new();
    let mut propose = |change: &dyn Fn(&mut Preset)| {
        let mut candidate = preset.clone();
        change(&mut candidate);
        if candidate != *preset && candidate.check().is_ok() {
            candidates.push(candidate);
        }
    };
    propose(&halve);
    for i in 0..preset.injectors.len() {
        propose(&|p| drop(p.injectors.remove(i)));
    }
    for i in 0..preset.occluders.len() {
        propose(&|p| drop(p.occluders.remove(i)));
    }
    propose(&|p| p.propagation.iterations /= 2);
    propose(&|p| p.propagation.iterations = p.propagation.iterations.saturating_sub(1));
    propose(&|p| p.coarsest = p.size);
    propose(&|p| p.occlusion = Occlusion { mode: p.occlusion.mode, ..Occlusion::default() });
    propose(&|p| p.propagation.snapshots = Snapshots::Thesis);
    propose(&|p| p.propagation.levels = Policy::Same);
    propose(&|p| p.propagation.descent = Descent::Off);
    propose(&|p| p.propagation.index = Index::Thesis);
    propose(&|p| p.propagation.factor = p.propagation.factor.round());
    for i in 0..preset.injectors.len() {
        propose(&|p| p.injectors[i].color = [1.0; 3]);
        propose(&|p| p.injectors[i].multiplier = 1.0);
        propose(&|p| p.injectors[i].direction = None);
    }
    for i in 0..preset.occluders.len() {
        propose(&|p| p.occluders[i].albedo = [0.0; 3]);
        propose(&|p| p.occluders[i].opacity = 1.0);
        propose(&|p| p.occluders[i].normal = None);
    }
    candidates
}

/// Half the side, and every cell at half its coordinates.
fn halve(preset: &mut Preset) {
    preset.size /= 2;
    preset.coarsest = preset.coarsest.min(preset.size);
    for injector in &mut preset.injectors {
        match &mut injector.kind {
            InjectorKind::Rectangle { from, to } => [from, to].into_iter().flatten().for_each(|c| *c /= 2),
            InjectorKind::Single { cell } => cell.iter_mut().for_each(|c| *c /= 2),
            InjectorKind::Wall { .. } | InjectorKind::File { .. } => {}
        }
    }
    for occluder in &mut preset.occluders {
        match &mut occluder.kind {
            OccluderKind::Box { from, to } => [from, to].into_iter().flatten().for_each(|c| *c /= 2),
            OccluderKind::Plane { at, .. } => *at /= 2,
            OccluderKind::File { .. } => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::stress::scenes;
    use crate::system::random::Random;

    #[test]
    fn what_does_not_matter_is_taken_away() {
        let strong = |p: &Preset| p.injectors.iter().any(|injector| injector.multiplier > 3.0);
        let mut random = Random::new(2);
        let found = std::iter::repeat_with(|| scenes::preset(&mut random))
            .find(|p| strong(p) && p.size > 4 && p.injectors.len() > 2 && !p.occluders.is_empty())
            .unwrap();
        let small = smallest(found, strong);
        assert_eq!((small.size, small.injectors.len(), small.occluders.len()), (1, 1, 0));
        assert_eq!(small.propagation.iterations, 0);
        assert!(strong(&small) && small.check().is_ok());
    }
}
