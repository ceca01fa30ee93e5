//! What becomes of a scene's light at its own factor: level by level, the growth an iteration and the
//! iteration in which numbers will overflow.

use std::f64::consts::PI;

use super::{Borders, Start, growth};
use crate::propagate::scheme::{self, Scheme};
use crate::propagate::stencil::Stencil;
use crate::scene::Scene;
use crate::simulation::limit;

/// The largest side whose growth is computed; beyond it the law of large volumes is near enough.
const LARGEST_COMPUTED: usize = 32;

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

/// The outlook of every level of a scene, occluders aside: they remove light, and only a bounce, which
/// the preset must ask for, gives some back. Empty where the scheme has no such name.
pub fn levels(scene: &Scene) -> Vec<Outlook> {
    let propagation = &scene.propagation;
    let Some(scheme) = scheme::find(&propagation.scheme) else { return Vec::new() };
    let gains = Gains::new(&scheme, propagation.clamp, scene.size);
    let sides = (0..).map(|i| scene.size >> i).take_while(|side| *side >= scene.coarsest.max(1));
    let outlook = |(level, side): (usize, usize)| {
        let gain = gains.of(side);
        let growth = propagation.factor * gain;
        Outlook { level, side, critical: 1.0 / gain, growth, overflow: overflow(scene, level, side, growth) }
    };
    sides.enumerate().map(outlook).collect()
}

/// The level whose numbers overflow first, if any does. A factor that is safe in a volume without borders
/// is safe on every level, and costs nothing to tell.
pub fn first_to_overflow(scene: &Scene) -> Option<Outlook> {
    let scheme = scheme::find(&scene.propagation.scheme)?;
    if scene.propagation.factor * without_borders(&scheme) <= 1.0 {
        return None;
    }
    levels(scene).into_iter().filter(|level| level.overflow.is_some()).min_by_key(|level| level.overflow)
}

/// λ at p = 1 of a scheme, by the side of the volume.
struct Gains {
    computed: Vec<(usize, f64)>,
    without_borders: f64,
}

impl Gains {
    fn new(scheme: &Scheme, clamp: bool, largest: usize) -> Self {
        let stencil = Stencil::new(scheme, 1.0, clamp);
        let sides = (1..).map(|i| 1 << i).take_while(|side| *side <= largest.min(LARGEST_COMPUTED));
        let computed = sides.map(|side| (side, growth(&stencil, Start::Arch, Borders::Open(side)))).collect();
        Gains { computed, without_borders: without_borders(scheme) }
    }

    /// From a lone cell all light leaves. Beyond the computed sides λ(n) = λ(∞)·(1 − a/(n + b)²), as for
    /// diffusion between walls that lie b/2 outside the volume; a and b fit the two largest computed sides.
    fn of(&self, side: usize) -> f64 {
        if side == 1 {
            return 0.0;
        }
        if let Some((_, gain)) = self.computed.iter().find(|(computed, _)| *computed == side) {
            return *gain;
        }
        let [.., (n0, g0), (n1, g1)] = self.computed[..] else { return self.without_borders };
        let missing = |gain: f64| (1.0 - gain / self.without_borders).sqrt();
        let (n0, n1, n) = (n0 as f64, n1 as f64, side as f64);
        let b = (n1 * missing(g1) - n0 * missing(g0)) / (missing(g0) - missing(g1));
        let shortfall = missing(g1) * (n1 + b) / (n + b);
        self.without_borders * (1.0 - shortfall * shortfall)
    }
}

/// λ at p = 1 without borders: that of a uniform field, which no other mode exceeds.
fn without_borders(scheme: &Scheme) -> f64 {
    Stencil::<f64>::new(scheme, 1.0, true).uniform_gain().into_iter().fold(0.0, f64::max)
}

/// The iteration in which the accumulated light reaches what f32 may hold. What grows is the share of the
/// injected light in the slowest mode, a product of sines; the sum of its powers is g/(g − 1) times the
/// last.
fn overflow(scene: &Scene, level: usize, side: usize, growth: f64) -> Option<usize> {
    if growth <= 1.0 {
        return None;
    }
    let sine = |c: usize| (PI * ((c >> level) + 1) as f64 / (side + 1) as f64).sin();
    let children = 8f64.powi(i32::try_from(level).ok()?);
    let mut amplitude = 0.0;
    for source in &scene.sources {
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
    use crate::propagate::cascaded;
    use crate::scene::preset::Propagation;
    use crate::scene::{Occlusion, Source};
    use crate::sh::Sh;

    fn scene(size: usize, factor: f64) -> Scene {
        let light = vec![([size / 2; 3], Sh::lobe(glam::DVec3::X)), ([0; 3], Sh::lobe(glam::DVec3::Y))];
        Scene {
            size,
            coarsest: 1,
            sources: vec![Source { color: [1.0, 0.5, 0.0], light }],
            blockers: Vec::new(),
            occlusion: Occlusion::default(),
            propagation: Propagation { factor, ..Propagation::default() },
        }
    }

    #[test]
    fn only_levels_above_their_critical_factor_overflow() {
        // MATH.md section 2: 4.33 at 8³, 5.22 at 4³, 9.53 at 2³.
        assert_eq!(first_to_overflow(&scene(8, 4.0)), None);
        assert_eq!(first_to_overflow(&scene(8, 4.25)), None);
        let found = levels(&scene(8, 5.0));
        assert_eq!(found.iter().map(|level| level.side).collect::<Vec<_>>(), [8, 4, 2, 1]);
        assert_eq!(found.iter().map(|level| level.overflow.is_some()).collect::<Vec<_>>(), [true, false, false, false]);
        assert_eq!(found[3].growth, 0.0);
        assert_eq!(first_to_overflow(&scene(8, 20.0)).map(|level| level.level), Some(0));
    }

    #[test]
    fn light_diverges_when_the_outlook_says() {
        for (size, factor) in [(4, 6.0), (8, 5.0), (8, 12.0), (16, 4.5)] {
            let mut scene = scene(size, factor);
            scene.propagation.iterations = 5000;
            let told = first_to_overflow(&scene).and_then(|outlook| outlook.overflow).unwrap();
            let mut simulation = crate::simulation::Simulation::<f32>::new(scene).unwrap();
            simulation.run(|_| true);
            let found = simulation.divergence().unwrap().iteration;
            assert!(found.abs_diff(told) <= 3 + told / 20, "{size}³ at {factor}: {told} told, {found} found");
        }
    }

    #[test]
    fn large_volumes_continue_the_law_of_the_computed_ones() {
        let gains = Gains::new(&cascaded::scheme(), true, 16);
        let computed = growth(&Stencil::new(&cascaded::scheme(), 1.0, true), Start::Arch, Borders::Open(32));
        assert!((gains.of(32) / computed - 1.0).abs() < 1e-4, "{}, {computed}", gains.of(32));
        assert!(gains.of(32) < gains.of(64) && gains.of(1024) < 0.25);
    }
}
