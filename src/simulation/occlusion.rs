//! What a scene's occluders are to its simulation: of which kind, from which iteration on, whether they tint
//! light.

use crate::field::{Channels, Grid, IndexVolume, Levels};
use crate::propagate::barrier::Barrier;
use crate::propagate::geometry::Geometry;
use crate::propagate::kernel::occluded::{Fuzzy, Hard, Mirrored, Occluders, Which};
use crate::propagate::kernel::plain;
use crate::propagate::scheme::{Scheme, Surface};
use crate::propagate::stencil::Stencil;
use crate::scene::Scene;
use crate::scene::occluder::{BlockingSign, OcclusionMode};
use crate::sh::Real;

/// The occluders of a scene as a scheme sees them.
#[derive(Clone, Debug)]
pub(super) struct Occlusion<T> {
    occluders: Option<Occluders<T>>,
    /// The first iteration in which they act.
    from_iteration: usize,
}

impl<T: Real> Occlusion<T> {
    pub(super) fn new(scene: &Scene, sizes: Levels, scheme: &Scheme) -> Self {
        let hindered = !scene.blockers.is_empty() && scene.occlusion.mode != OcclusionMode::Off;
        let occluders = hindered.then(|| occluders(scene, sizes, scheme));
        // What is fuzzy lets light get away from its own surface first. Hard cells and mirrors do not block the
        // light that starts in them.
        let fuzzy = matches!(occluders, Some(Occluders::Fuzzy(_)));
        Occlusion { occluders, from_iteration: if fuzzy { scene.occlusion.from_iteration } else { 0 } }
    }

    /// Sets `target` to what `source` sends in the given iteration, among the occluders that act in it.
    pub(super) fn step(
        &self,
        iteration: usize,
        stencil: &Stencil<T>,
        which: Which,
        source: &Grid<T>,
        target: &mut Grid<T>,
    ) {
        match &self.occluders {
            Some(occluders) if iteration >= self.from_iteration => {
                occluders.propagate(stencil, which, source, target);
            }
            _ => plain::propagate(stencil, source, target),
        }
    }

    /// Sees to it that cells which no light can enter are sampled at level 0.
    pub(super) fn mark_shut(&self, index: &mut IndexVolume) {
        if let Some(Occluders::Hard(hard)) = &self.occluders {
            let marks = index.level_mut(0);
            hard.barrier.shut().for_each(|cell| marks.set(cell));
        }
    }
}

fn occluders<T: Real>(scene: &Scene, sizes: Levels, scheme: &Scheme) -> Occluders<T> {
    let occlusion = scene.occlusion;
    let geometry = Geometry::new(sizes, &scene.blockers);
    // Reflection is what a mirroring scheme is; in the others it is an extra that the preset asks for.
    let mirrors = scheme.surface == Surface::Mirrored;
    match occlusion.mode {
        OcclusionMode::Hard => {
            let injected = scene.sources.iter().flat_map(|source| &source.light);
            let barrier = Barrier::new(sizes, &scene.blockers, injected.map(|(cell, _)| *cell));
            let bounce = if mirrors { 1.0 } else { occlusion.bounce };
            Occluders::Hard(Hard { barrier, geometry, bounce: T::of(bounce) })
        }
        _ if mirrors => Occluders::Mirrored(Mirrored { geometry }),
        _ => {
            let fuzzy = Fuzzy {
                geometry,
                amplifier: T::of(occlusion.amplifier),
                along_travel: occlusion.sign == BlockingSign::AlongTravel,
                bounce: T::of(occlusion.bounce),
            };
            Occluders::Fuzzy(fuzzy)
        }
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
