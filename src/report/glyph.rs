//! An SH vector as a flat polar outline: the sampled polygon of (000, 5.1), its negative lobe apart.
//!
//! Within a slice the two-band function is f(θ) = a + m·cos(θ − φ), where a = K0·c00 and m, φ are the
//! length and angle of K1·(the flux direction's two parts in the slice). So it is sampled evenly from
//! its own peak φ onwards: the peak is always hit, both halves are mirror images, and what is negative
//! is one lobe about the opposite direction.

use std::f64::consts::PI;

use super::slice::{Axis, Slice};
use crate::sh::{K0, K1, Sh};

/// The largest radius that is drawn, where the cell's side is 1: just clear of the cell's edge.
pub const FULL_RADIUS: f32 = 0.48;

/// What of a coloured light a glyph shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Hue {
    /// The mean of red, green and blue; of white light, each of them.
    #[default]
    Mean,
    /// Red alone.
    Red,
    /// Green alone.
    Green,
    /// Blue alone.
    Blue,
}

impl Hue {
    /// All of them, the mean first.
    pub const ALL: [Hue; 4] = [Hue::Mean, Hue::Red, Hue::Green, Hue::Blue];

    /// The light that is shown.
    pub fn of(self, [red, green, blue]: [Sh<f32>; 3]) -> Sh<f32> {
        match self {
            // White light must be shown as each of its channels, to the last bit.
            Hue::Mean if red == green && green == blue => red,
            Hue::Mean => (red + green + blue) * (1.0 / 3.0),
            Hue::Red => red,
            Hue::Green => green,
            Hue::Blue => blue,
        }
    }

    /// Its name, in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Hue::Mean => "mean of red, green and blue",
            Hue::Red => "red",
            Hue::Green => "green",
            Hue::Blue => "blue",
        }
    }
}

/// How an intensity becomes a radius. Intensities are magnitudes |f| = |c·Y(ω)|, per steradian and in
/// the units of the injectors' multipliers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GlyphScale {
    /// The radius is proportional to the intensity.
    Linear {
        /// The intensity that fills a cell, above zero.
        full: f32,
    },
    /// The glyph's size is proportional to its largest intensity's logarithm. Its shape is the same as on a
    /// linear scale: a lobe drawn by logarithms in every direction would look like a ball.
    Log {
        /// The intensity that fills a cell, above zero.
        full: f32,
        /// How many powers of ten below `full` the radius reaches 0, above zero.
        decades: f32,
    },
    /// Every glyph fills its cell: shapes can be compared, intensities cannot.
    PerGlyph,
}

impl GlyphScale {
    /// An intensity as a share of a full glyph's radius: 0 for none, above 1 where it would leave its
    /// cell. `brightest` is the intensity that fills a cell where the scale itself sets none.
    pub fn share(self, intensity: f32, brightest: f32) -> f32 {
        match self {
            GlyphScale::Linear { full } => intensity / full,
            GlyphScale::Log { full, decades } => (1.0 + log10(intensity / full) / decades).max(0.0),
            GlyphScale::PerGlyph => intensity / brightest,
        }
    }
}

/// The logarithm to base ten, to within 1e-6; some −38 for what is not above zero. A slice asks for it at every
/// point of every outline, where the standard library's would take most of the time.
fn log10(x: f32) -> f32 {
    use std::f32::consts::{LN_2, LN_10, SQRT_2};
    let x = if x > f32::MIN_POSITIVE { x.min(f32::MAX) } else { f32::MIN_POSITIVE };
    // x = 2^e · m: the exponent's bits give e, the others m from 1 to 2.
    let bits = x.to_bits();
    let (mut e, mut m) = ((bits >> 23) as f32 - 127.0, f32::from_bits(bits & 0x007f_ffff | 0x3f80_0000));
    if m > SQRT_2 {
        (e, m) = (e + 1.0, 0.5 * m);
    }
    // ln m = 2·artanh t, whose series is short for |t| ≤ 0.172.
    let t = (m - 1.0) / (m + 1.0);
    let tt = t * t;
    let ln_m = 2.0 * t * (1.0 + tt * (1.0 / 3.0 + tt * (1.0 / 5.0 + tt * (1.0 / 7.0))));
    (e * LN_2 + ln_m) / LN_10
}

/// The intensity that lets all but the largest `1 − quantile` of the lit glyphs of `slices` stay inside their
/// cells (1 for all of them); `None` where all is dark.
pub fn fit<'a>(slices: impl IntoIterator<Item = &'a Slice>, hue: Hue, quantile: f32) -> Option<f32> {
    let mut peaks: Vec<f32> = Vec::new();
    for slice in slices {
        let found = slice.cells.iter().map(|cell| peak(hue.of(cell.light), slice.plane.axis));
        peaks.extend(found.filter(|peak| *peak > 0.0 && peak.is_finite()));
    }
    let last = peaks.len().checked_sub(1)?;
    let at = (quantile.clamp(0.0, 1.0) * last as f32).round() as usize;
    let (_, peak, _) = peaks.select_nth_unstable_by(at.min(last), f32::total_cmp);
    Some(*peak)
}

/// An outline around (0, 0), in units of its cell's side, y upwards. Kept and refilled, so that
/// drawing a whole slice allocates nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    /// The closed polygon where f > 0, counter-clockwise; empty where there is none.
    pub positive: Vec<[f32; 2]>,
    /// The closed polygon where f < 0, at radius |f| in the direction of evaluation; empty where there is none.
    /// This is what a clamp removes.
    pub negative: Vec<[f32; 2]>,
    /// Whether any radius was cut down to the cell.
    pub clipped: bool,
}

/// A two-band function within a slice: f(θ) = mean + swing·cos(θ − φ), swing ≥ 0.
#[derive(Clone, Copy, Debug)]
pub struct Lobes {
    mean: f32,
    swing: f32,
    /// (cos φ, sin φ)
    peak_direction: [f32; 2],
}

impl Lobes {
    /// That of `light` within cuts across `axis`.
    pub fn of(light: Sh<f32>, axis: Axis) -> Self {
        let Sh([c00, x, y, z]) = light;
        let [right, up] = axis.project([x, y, z]);
        let length = right.hypot(up);
        let peak_direction = if length > 0.0 { [right / length, up / length] } else { [1.0, 0.0] };
        Lobes { mean: K0 as f32 * c00, swing: K1 as f32 * length, peak_direction }
    }

    /// The largest |f|, per steradian.
    pub fn peak(self) -> f32 {
        self.mean.abs() + self.swing
    }

    /// (cos φ, sin φ): to the right and upwards in the slice.
    pub fn peak_direction(self) -> [f32; 2] {
        self.peak_direction
    }

    /// mean / peak: 1 where f is the same all round, 0 where it is all swing, −1 where it is negative all round.
    /// Not a number where all is dark.
    pub fn roundness(self) -> f32 {
        self.mean / self.peak()
    }
}

/// The largest |f| within cuts across `axis`, per steradian: the intensity that a glyph's radius stands for.
pub fn peak(light: Sh<f32>, axis: Axis) -> f32 {
    Lobes::of(light, axis).peak()
}

/// The mean intensity over the whole sphere, per steradian.
pub fn mean(light: Sh<f32>) -> f32 {
    K0 as f32 * light.0[0]
}

/// Turns SH vectors into outlines, all with the same cut, scale and number of points.
#[derive(Clone, Debug)]
pub struct Glyphs {
    axis: Axis,
    scale: GlyphScale,
    /// (cos, sin) of the sample angles, counted from the peak; an even number of them.
    turn: Vec<[f32; 2]>,
}

impl Glyphs {
    /// Glyphs for cuts across `axis`, sampled in `points` directions (rounded up to even, at least 4).
    pub fn new(axis: Axis, scale: GlyphScale, points: usize) -> Self {
        let half = points.div_ceil(2).max(2);
        let angle = |k: usize| (PI * k as f64 / half as f64).sin_cos();
        let upper = (0..=half).map(|k| [angle(k).1 as f32, angle(k).0 as f32]);
        let lower = (1..half).rev().map(|k| [angle(k).1 as f32, -angle(k).0 as f32]);
        Glyphs { axis, scale, turn: upper.chain(lower).collect() }
    }

    /// How intensities become radii.
    pub fn scale(&self) -> GlyphScale {
        self.scale
    }

    /// Fills `out` with the outline of `light`; both polygons stay empty where it is dark or not finite.
    pub fn outline(&self, light: Sh<f32>, out: &mut Outline) {
        out.positive.clear();
        out.negative.clear();
        out.clipped = false;
        let lobes = Lobes::of(light, self.axis);
        let peak = lobes.peak();
        if !(peak > 0.0 && peak.is_finite()) {
            return;
        }
        // A peak that fills its cell may overshoot by a rounding error; that clips nothing.
        out.clipped = self.scale.share(peak, peak) > 1.0001;
        // f falls all the way from the peak to the opposite direction, so each sign is one run of samples.
        let half = self.turn.len() / 2;
        let f = |k: usize| lobes.mean + lobes.swing * self.turn[k][0];
        let positive = (0..=half).take_while(|&k| f(k) > 0.0).count();
        let negative = (0..=half).rev().take_while(|&k| f(k) < 0.0).count();
        self.lobe(lobes, 0, positive, &mut out.positive);
        self.lobe(lobes, half, negative, &mut out.negative);
    }

    /// The closed polygon of the samples less than `reach` steps from sample `middle`.
    fn lobe(&self, lobes: Lobes, middle: usize, reach: usize, out: &mut Vec<[f32; 2]>) {
        let points = self.turn.len();
        let all_round = reach > points / 2;
        let from = if all_round { middle } else { points + middle + 1 - reach };
        let count = if all_round { points } else { (2 * reach).saturating_sub(1) };
        let [right, up] = lobes.peak_direction;
        let size = self.scale.share(lobes.peak(), lobes.peak()).min(1.0);
        out.extend((from..from + count).map(|k| {
            let [cos, sin] = self.turn[k % points];
            let intensity = (lobes.mean + lobes.swing * cos).abs();
            let radius = FULL_RADIUS
                * match self.scale {
                    GlyphScale::Log { .. } => size * intensity / lobes.peak(),
                    linear => linear.share(intensity, lobes.peak()).min(1.0),
                };
            [radius * (cos * right - sin * up), radius * (cos * up + sin * right)]
        }));
        if count > 0 && !all_round {
            // Where f changes its sign the radius is zero: the lobe closes in the middle of the cell.
            out.push([0.0, 0.0]);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn outline(light: Sh<f32>, axis: Axis, scale: GlyphScale) -> Outline {
        let mut out = Outline::default();
        Glyphs::new(axis, scale, 48).outline(light, &mut out);
        out
    }

    /// The shoelace formula: positive where the polygon runs counter-clockwise.
    fn area(polygon: &[[f32; 2]]) -> f64 {
        let next = polygon.iter().cycle().skip(1);
        polygon.iter().zip(next).map(|(a, b)| f64::from(a[0] * b[1] - a[1] * b[0]) / 2.0).sum()
    }

    const SOME: [Sh<f32>; 5] = [
        Sh([1.0, 0.3, -0.1, 0.2]),
        Sh([0.2, -0.3, 0.5, 0.1]),
        Sh([-0.2, 0.1, 0.4, -0.6]),
        Sh([-1.0, 0.2, 0.1, 0.0]),
        Sh([0.5, 0.0, 0.0, 0.0]),
    ];

    #[test]
    fn every_radius_is_the_function_in_that_direction() {
        for (axis, light) in Axis::ALL.into_iter().flat_map(|axis| SOME.map(|light| (axis, light))) {
            let out = outline(light, axis, GlyphScale::Linear { full: 2.0 });
            assert!(!out.clipped);
            assert!(out.positive.len() + out.negative.len() >= 46, "{light:?}");
            for (polygon, sign) in [(&out.positive, 1.0), (&out.negative, -1.0)] {
                for [right, up] in polygon.iter().filter(|p| **p != [0.0, 0.0]) {
                    let mut direction = [0.0; 3];
                    direction[axis.columns()] = f64::from(*right);
                    direction[axis.rows()] = f64::from(*up);
                    let direction = DVec3::from(direction);
                    let value = light.widen().eval(direction.normalize());
                    let radius = sign * direction.length() * 2.0 / f64::from(FULL_RADIUS);
                    assert!((value - radius).abs() < 1e-6, "{axis:?} {light:?}: {value} drawn as {radius}");
                }
            }
        }
    }

    #[test]
    fn the_areas_are_the_integrals_of_half_f_squared() {
        for light in SOME {
            let mut out = Outline::default();
            Glyphs::new(Axis::Z, GlyphScale::Linear { full: FULL_RADIUS * 4.0 }, 2000).outline(light, &mut out);
            let mut expected = [0.0; 2];
            let steps = 100_000;
            for k in 0..steps {
                let (sin, cos) = (2.0 * PI * f64::from(k) / f64::from(steps)).sin_cos();
                let f = light.widen().eval(DVec3::new(cos, sin, 0.0)) / 4.0;
                expected[usize::from(f < 0.0)] += f * f / 2.0 * 2.0 * PI / f64::from(steps);
            }
            for (polygon, expected) in [&out.positive, &out.negative].into_iter().zip(expected) {
                assert!((area(polygon) - expected).abs() < 1e-5, "{light:?}: {} {expected}", area(polygon));
            }
        }
    }

    #[test]
    fn a_lobe_points_where_its_light_flows() {
        let full = GlyphScale::Linear { full: 10.0 };
        for (axis, direction, screen) in [
            (Axis::Z, DVec3::X, [1.0, 0.0]),
            (Axis::Z, DVec3::Y, [0.0, 1.0]),
            (Axis::Y, DVec3::X, [1.0, 0.0]),
            (Axis::Y, DVec3::Z, [0.0, 1.0]),
            (Axis::X, DVec3::Z, [1.0, 0.0]),
            (Axis::X, DVec3::Y, [0.0, 1.0]),
        ] {
            let out = outline(Sh::lobe(direction), axis, full);
            let along = |p: &[f32; 2]| p[0] * screen[0] + p[1] * screen[1];
            let furthest = out.positive.iter().copied().max_by(|a, b| along(a).total_cmp(&along(b))).unwrap();
            assert!((furthest[0] * screen[1] - furthest[1] * screen[0]).abs() < 1e-9, "{axis:?} {direction}");
            assert!(out.negative.iter().all(|p| along(p) <= 0.0) && !out.negative.is_empty());
        }
    }

    #[test]
    fn a_quarter_turn_of_the_light_turns_the_outline() {
        let log = GlyphScale::Log { full: 1.0, decades: 3.0 };
        for (light, scale) in SOME.into_iter().flat_map(|l| [(l, log), (l, GlyphScale::PerGlyph)]) {
            let Sh([c00, x, y, z]) = light;
            if x == 0.0 && y == 0.0 {
                continue;
            }
            let (before, after) = (outline(light, Axis::Z, scale), outline(Sh([c00, -y, x, z]), Axis::Z, scale));
            let turned = |polygon: &[[f32; 2]]| polygon.iter().map(|[x, y]| [-y, *x]).collect::<Vec<_>>();
            assert_eq!(turned(&before.positive), after.positive);
            assert_eq!(turned(&before.negative), after.negative);
        }
    }

    #[test]
    fn dark_and_broken_light_draw_nothing() {
        for light in [Sh::ZERO, Sh([f32::NAN, 0.0, 0.0, 0.0]), Sh([1.0, f32::INFINITY, 0.0, 0.0])] {
            assert_eq!(outline(light, Axis::Z, GlyphScale::PerGlyph), Outline::default());
        }
    }

    #[test]
    fn radii_end_at_the_cell_and_say_so() {
        let light = Sh::lobe(DVec3::X);
        let reach = |out: &Outline| out.positive.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f32::max);
        let peak = peak(light, Axis::Z);
        let fits = outline(light, Axis::Z, GlyphScale::Linear { full: peak });
        assert!((reach(&fits) - FULL_RADIUS).abs() < 1e-6 && !fits.clipped);
        let clipped = outline(light, Axis::Z, GlyphScale::Linear { full: peak / 2.0 });
        assert!(reach(&clipped) <= FULL_RADIUS * 1.000_001 && clipped.clipped);
        // A tenth of the full intensity lies one of four decades down.
        let log = outline(light * 0.1, Axis::Z, GlyphScale::Log { full: peak, decades: 4.0 });
        assert!((reach(&log) - 0.75 * FULL_RADIUS).abs() < 1e-6);
        let unseen = outline(light * 1e-5, Axis::Z, GlyphScale::Log { full: peak, decades: 4.0 });
        assert_eq!(reach(&unseen), 0.0);
    }

    #[test]
    fn the_quick_logarithm_is_the_logarithm() {
        for k in -3700..3800 {
            let x = 10f32.powf(k as f32 / 100.0);
            let close = 1e-6 * x.log10().abs().max(1.0);
            assert!((log10(x) - x.log10()).abs() <= close, "{x}: {} {}", log10(x), x.log10());
        }
        assert!([0.0, -1.0, f32::NAN].iter().all(|x| log10(*x) < -37.0));
    }

    #[test]
    fn the_fit_is_the_peak_at_its_quantile_among_lit_cells() {
        use crate::field::{Channels, Grid};
        use crate::report::slice::Plane;
        let mut grid = Grid::new(4);
        for (k, x) in (0..4).enumerate() {
            grid.set([x, 1, 0], Sh([1.0, 0.0, 0.0, 0.0]) * (k as f32 + 1.0));
        }
        let channels = Channels::of_colors(&[[1.0; 3]]);
        let slice = |index| Slice::level(&[&grid], &channels, 0, Plane { axis: Axis::Z, index });
        let k0 = K0 as f32;
        assert_eq!(fit([&slice(0)], Hue::Mean, 1.0), Some(4.0 * k0));
        assert_eq!(fit([&slice(0)], Hue::Red, 0.0), Some(k0));
        assert_eq!(fit([&slice(1)], Hue::Mean, 1.0), None);
    }
}
