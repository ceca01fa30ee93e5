//! What a scene's occluders are to its simulation: which kind of occluders, from which iteration on, and
//! whether they tint light.

use crate::field::{Channels, IndexVolume, Levels};
use crate::propagate::barrier::Barrier;
use crate::propagate::geometry::Geometry;
use crate::propagate::kernel::occluded::{Fuzzy, Hard, Mirrored, Occluders};
use crate::propagate::scheme::{Scheme, Surface};
use crate::scene::Scene;
use crate::scene::occluder::{BlockingSign, OcclusionMode};
use crate::sh::Real;

/// The occluders of a scene as a scheme sees them, and the first iteration in which they act. `None`
/// where there are none.
pub(super) fn occluders<T: Real>(scene: &Scene, sizes: Levels, scheme: &Scheme) -> Option<(Occluders<T>, usize)> {
    let occlusion = scene.occlusion;
    if scene.blockers.is_empty() || occlusion.mode == OcclusionMode::Off {
        return None;
    }
    let geometry = Geometry::new(sizes, &scene.blockers);
    // Reflection is what a mirroring scheme is; in the others it is an extra that the preset asks for.
    let mirrors = scheme.surface == Surface::Mirrored;
    let occluders = match occlusion.mode {
        OcclusionMode::Hard => {
            let injected = scene.sources.iter().flat_map(|source| &source.light);
            let barrier = Barrier::new(sizes, &scene.blockers, injected.map(|(cell, _)| *cell));
            let bounce = if mirrors { 1.0 } else { occlusion.bounce };
            (Occluders::Hard(Hard { barrier, geometry, bounce: T::of(bounce) }), 0)
        }
        _ if mirrors => (Occluders::Mirrored(Mirrored { geometry }), 0),
        _ => {
            let fuzzy = Fuzzy {
                geometry,
                amplifier: T::of(occlusion.amplifier),
                along_travel: occlusion.sign == BlockingSign::AlongTravel,
                bounce: T::of(occlusion.bounce),
            };
            (Occluders::Fuzzy(fuzzy), occlusion.from_iteration)
        }
    };
    Some(occluders)
}

/// Sees to it that cells which hard occluders let no light enter are sampled at level 0.
pub(super) fn mark_shut<T: Real>(occluders: Option<&(Occluders<T>, usize)>, index: &mut IndexVolume) {
    if let Some((Occluders::Hard(hard), _)) = occluders {
        let marks = index.level_mut(0);
        hard.barrier.shut().for_each(|cell| marks.set(cell));
    }
}

/// The channels that a scene needs: one a colour where a surface may tint the light, else the fewest.
pub(super) fn channels(scene: &Scene) -> Channels {
    let tints = |[red, green, blue]: [f64; 3]| red != green || green != blue;
    if scene.occlusion.mode != OcclusionMode::Off && scene.blockers.iter().any(|b| tints(b.albedo)) {
        return Channels::separate();
    }
    let colors: Vec<[f64; 3]> = scene.sources.iter().map(|source| source.color).collect();
    Channels::of_colors(&colors)
}
