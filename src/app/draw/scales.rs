//! What makes a glyph fill its cell: what is the same for views that are to be compared.

use crate::app::session::sight::LINEAR_QUANTILE;
use crate::app::session::view::{Fill, Heat, Scaling, View};
use crate::app::worker::look::{Light, Shown};
use crate::report::colour::Paint;
use crate::report::glyph::{GlyphScale, fit};
use crate::report::slice::SliceCell;

/// The intensity that a scale starts from while all is dark.
const DARK_FULL: f32 = 1.0;

/// One scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Intensities to radii.
    pub glyph: GlyphScale,
    /// The intensity that fills a cell.
    pub full: f32,
    /// The largest heat.
    pub heat: f32,
}

/// The scales of all views. What an iteration moves is soon far fainter than the sum of all, and differences fainter
/// than either, so each has a scale of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// That of source and target, where any are seen.
    pub moving: Option<Scale>,
    /// That of accumulated light, where any is seen.
    pub accumulated: Option<Scale>,
    /// That of differences, where any are seen; it is that of what is seen, also where others serve a whole run.
    pub difference: Option<Scale>,
    /// Whether any light is not white.
    pub hues: bool,
}

impl Scales {
    /// The scales for everything that is seen.
    pub fn of(view: &View, shown: &[Shown]) -> Self {
        let of = |kind: Kind| {
            let ours: Vec<&Shown> = shown.iter().filter(|shown| Kind::of(shown) == kind).collect();
            (!ours.is_empty()).then(|| Scale::of(view, &ours))
        };
        let (moving, accumulated, difference) = (of(Kind::Moving), of(Kind::Accumulated), of(Kind::Difference));
        let has_hues = |cell: &SliceCell| cell.light[0] != cell.light[1] || cell.light[1] != cell.light[2];
        let hues = shown.iter().flat_map(|shown| &shown.slice.cells).any(has_hues);
        Scales { moving, accumulated, difference, hues }
    }

    /// The colouring that is chosen; where directions are and there are hues to be seen, the light's own colours.
    pub fn paint(&self, view: &View) -> Paint {
        match view.paint {
            Paint::Direction if view.hues && self.hues => Paint::Light,
            paint => paint,
        }
    }

    /// That of a view.
    pub fn scale(&self, shown: &Shown) -> Scale {
        let found = match Kind::of(shown) {
            Kind::Moving => self.moving,
            Kind::Accumulated => self.accumulated,
            Kind::Difference => self.difference,
        };
        found.unwrap_or(Scale { glyph: GlyphScale::PerGlyph, full: DARK_FULL, heat: 0.0 })
    }
}

/// What shares a scale.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Moving,
    Accumulated,
    Difference,
}

impl Kind {
    fn of(shown: &Shown) -> Self {
        match shown.pane.light {
            _ if shown.pane.minus.is_some() => Kind::Difference,
            Light::Source | Light::Target => Kind::Moving,
            Light::Accumulated => Kind::Accumulated,
        }
    }
}

impl Scale {
    fn of(view: &View, shown: &[&Shown]) -> Self {
        let quantile = if view.scaling == Scaling::Linear { LINEAR_QUANTILE } else { 1.0 };
        let frame = || fit(shown.iter().map(|s| s.slice.as_ref()), view.hue, quantile);
        let full = match view.fill {
            Fill::Run => shown.iter().filter_map(|shown| shown.of_run).reduce(f32::max).or_else(frame),
            Fill::Frame => frame(),
            Fill::Fixed => Some(view.full.max(f32::MIN_POSITIVE)),
        };
        let full = full.unwrap_or(DARK_FULL);
        let glyph = match view.scaling {
            Scaling::Linear => GlyphScale::Linear { full },
            Scaling::Log => GlyphScale::Log { full, decades: view.decades },
            Scaling::PerGlyph => GlyphScale::PerGlyph,
        };
        let all = shown.iter().flat_map(|shown| (0..shown.slice.cells.len()).filter_map(|i| heat(view, shown, i)));
        Scale { glyph, full, heat: all.fold(0.0, f32::max) }
    }
}

/// The heat of a slice's `i`-th cell, where it has any.
pub fn heat(view: &View, shown: &Shown, i: usize) -> Option<f32> {
    let error = || shown.errors.get(i).copied().flatten();
    match view.heat {
        Heat::None => None,
        Heat::Mean => Some(view.hue.of(shown.slice.cells[i].light).0[0].abs()),
        Heat::Absolute => error().map(|error| error.absolute as f32),
        Heat::Relative => error().and_then(|error| error.relative).map(|relative| relative as f32),
    }
}
