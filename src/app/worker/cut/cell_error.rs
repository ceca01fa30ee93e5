//! How far the cells of a view are from what they ought to hold.

use crate::app::worker::cut::mix;
use crate::app::worker::look::{Against, CellError};
use crate::field::{Cell, Grid, Layout, mean_of_children};
use crate::sh::Sh;
use crate::simulation::Simulation;
use crate::study::ballistic;
use crate::transport::ballistic::Ballistic;

/// Everything that the errors of one state's accumulated cells need.
pub enum Yardstick<'a> {
    Children,
    Uniform,
    /// The merged light that has moved, and what truly arrives, by channel.
    Truth(Vec<Grid<f32>>, &'a [Grid<f32>]),
}

impl<'a> Yardstick<'a> {
    /// What the cells of `state` are measured with; nothing while what truly arrives is not known.
    pub fn new(state: &Simulation<f32>, against: Against, truth: Option<&'a Ballistic>) -> Option<Self> {
        match against {
            Against::Children => Some(Yardstick::Children),
            Against::Uniform => Some(Yardstick::Uniform),
            Against::Truth => Some(Yardstick::Truth(ballistic::moved(state), truth?.light())),
        }
    }

    /// The error of a cell; on level 0 there is only one against what truly arrives.
    pub fn error(&self, state: &Simulation<f32>, level: usize, cell: Cell) -> Option<CellError> {
        let accumulated = |channel: usize| &state.lights()[channel].accumulated;
        let (is, ought) = match self {
            Yardstick::Truth(moved, truth) => (
                mix(state, |channel| mean_within(&moved[channel], level, cell)),
                mix(state, |channel| mean_within(&truth[channel], level, cell)),
            ),
            _ if level == 0 || level >= state.sizes().count() => return None,
            Yardstick::Children | Yardstick::Uniform => (
                mix(state, |channel| accumulated(channel).level(level).get(cell)),
                mix(state, |channel| match self {
                    Yardstick::Children => mean_of_children(accumulated(channel).level(level - 1), cell),
                    _ => mean_within(accumulated(channel).level(0), level, cell),
                }),
            ),
        };
        let norm = |light: [Sh<f32>; 3]| light.iter().fold(0.0, |m: f32, sh| m.max(sh.max_norm()));
        let absolute = norm(std::array::from_fn(|c| is[c] - ought[c]));
        let relative = match norm(is) {
            size if size > 0.0 => Some(absolute / size),
            _ if absolute > 0.0 => None,
            _ => Some(0.0),
        };
        Some(CellError { absolute, relative })
    }
}

/// The mean of all finest cells within a cell of `level`.
fn mean_within(finest: &Grid<f32>, level: usize, cell: Cell) -> Sh<f32> {
    let span = 1 << level;
    let [x0, y0, z0] = cell.map(|c| c * span);
    let inside = Layout::new(span).cells().map(|[x, y, z]| finest.get([x0 + x, y0 + y, z0 + z]).widen());
    let sum: Sh<f64> = inside.sum();
    (sum * (span as f64).powi(-3)).cast()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::app::worker::cut::panes;
    use crate::app::worker::cut::tests::{ONE, look, track};
    use crate::app::worker::look::{Against, Layer, Look};
    use crate::app::worker::track::Track;
    use crate::scene::{Preset, Problem};
    use crate::simulation::Action;
    use crate::transport::ballistic::Ballistic;

    #[test]
    fn errors_against_a_uniform_volume_vanish_where_nothing_is_propagated() {
        let preset = Preset::parse(ONE, Path::new("test")).unwrap();
        let mut fresh = Track::new(Problem::build(&preset, Path::new("")).unwrap(), 1 << 20).unwrap();
        fresh.act(Action::Inject);
        fresh.act(Action::Downsample);
        let shown = panes(&mut [fresh], None, &look(Layer::Level(2), None));
        assert_eq!(shown[0].errors.len(), 4);
        assert!(shown[0].errors.iter().all(|error| error.unwrap().absolute < 1e-6));
        let shown = panes(&mut [track(ONE)], None, &look(Layer::Level(2), None));
        assert!(shown[0].errors.iter().any(|error| error.unwrap().absolute > 1e-4));
        assert!(panes(&mut [track(ONE)], None, &look(Layer::Level(0), None))[0].errors.iter().all(Option::is_none));
    }

    #[test]
    fn errors_against_what_truly_arrives_are_those_of_the_metric() {
        let mut tracks = [track(ONE)];
        let truth = Ballistic::new(tracks[0].now().problem(), &|_| true).unwrap();
        let look = Look { against: Against::Truth, ..look(Layer::Level(0), None) };
        let mut largest = 0.0f32;
        for index in 0..8 {
            let plane = crate::report::slice::Plane { index, ..look.plane };
            let shown = panes(&mut tracks, Some(&truth), &Look { plane, ..look.clone() });
            largest = shown[0].errors.iter().fold(largest, |m, error| m.max(error.unwrap().absolute));
        }
        let row = crate::study::ballistic::error(tracks[0].now(), &truth);
        assert!((f64::from(largest) - row.absolute_max).abs() < 1e-6, "{largest} {row:?}");
        let unknown = panes(&mut tracks, None, &look);
        assert!(unknown[0].errors.is_empty());
    }
}
