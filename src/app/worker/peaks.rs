//! The brightest glyphs of a cut in every iteration that is at hand, so that one scale serves a whole run and decay
//! over time can be seen.

use std::collections::HashMap;

use super::cut;
use super::look::{Brightest, Layer, Light, Look, Of, Pane};
use super::track::Track;
use crate::report::glyph::fit;
use crate::report::slice::Plane;

/// What the brightest glyph was sought in: a track, an iteration and one of its octrees.
type Place = (usize, usize, Light);

/// What is known, for one way of cutting.
#[derive(Debug, Default)]
pub struct Peaks {
    of: Option<(Layer, Plane, Brightest)>,
    known: HashMap<Place, Option<f32>>,
}

impl Peaks {
    /// The intensity that makes the brightest glyph of a view fill its cell in every iteration that its track
    /// remembers. Nothing for differences, for what truly arrives, and in the dark. The target of an iteration is the
    /// source of the one before, so both have the source's.
    pub fn of_run(&mut self, tracks: &[Track], pane: Pane, look: &Look) -> Option<f32> {
        let Of::Track(at) = pane.state.of else { return None };
        let track = tracks.get(at).filter(|_| pane.minus.is_none())?;
        let way = (look.layer, look.plane, look.brightest);
        if self.of != Some(way) {
            self.known.clear();
            self.of = Some(way);
        }
        let light = if pane.light == Light::Target { Light::Source } else { pane.light };
        let brightest = look.brightest;
        let peaks = track.states().filter_map(|state| {
            *self.known.entry((at, state.iteration(), light)).or_insert_with(|| {
                let slice = cut::slice(state, light, look.layer, look.plane);
                fit([&slice], brightest.hue, brightest.quantile)
            })
        });
        peaks.reduce(f32::max)
    }

    /// Iteration `k` and later ones are not what they were.
    pub fn forget_from(&mut self, k: usize) {
        self.known.retain(|(_, iteration, _), _| *iteration < k);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::worker::cut::tests::{ONE, look, track};

    #[test]
    fn a_run_s_brightest_glyph_is_that_of_its_brightest_iteration_and_forgotten_with_it() {
        let tracks = [track(ONE)];
        let asked = look(Layer::Level(0), None);
        let mut peaks = Peaks::default();
        let source = Pane { light: Light::Source, ..asked.panes[0] };
        let all: Vec<f32> = tracks[0]
            .states()
            .filter_map(|state| {
                fit([&cut::slice(state, Light::Source, asked.layer, asked.plane)], asked.brightest.hue, 1.0)
            })
            .collect();
        let most = all.iter().copied().fold(0.0, f32::max);
        assert_eq!(peaks.of_run(&tracks, source, &asked), Some(most));
        // What is injected is brightest before it spreads.
        assert_eq!(all[0], most);
        peaks.forget_from(1);
        assert_eq!(peaks.known.len(), 1);
        assert_eq!(peaks.of_run(&tracks, Pane { minus: Some(source.state), ..source }, &asked), None);
    }
}
