//! Colours for light, intensities, directions and curves, on light and dark ground.
//!
//! Where colours stand for numbers they are chosen in OKLab (B. Ottosson, "A perceptual color space
//! for image processing", 2020), so that equal steps look equal and a hue is as strong as the next.

use std::f32::consts::TAU;

use super::slice::Axis;
use crate::sh::Sh;

/// An opaque colour, sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Rgb(pub [u8; 3]);

impl Rgb {
    /// From 0xRRGGBB.
    pub const fn hex(code: u32) -> Self {
        Rgb([(code >> 16) as u8, (code >> 8) as u8, code as u8])
    }

    /// As SVG and CSS write it, `#rrggbb`.
    pub fn css(self) -> String {
        let Rgb([r, g, b]) = self;
        format!("#{r:02x}{g:02x}{b:02x}")
    }

    /// The colour `t` of the way to `other`, 0 to 1, by perception.
    pub fn towards(self, other: Rgb, t: f32) -> Rgb {
        let (from, to) = (Oklab::of(self), Oklab::of(other));
        let step = |a: f32, b: f32| a + (b - a) * t.clamp(0.0, 1.0);
        Oklab { l: step(from.l, to.l), a: step(from.a, to.a), b: step(from.b, to.b) }.to_rgb()
    }
}

/// The ground that is drawn on and what must be told apart from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Theme {
    /// Whether the ground is dark.
    pub dark: bool,
    /// The ground.
    pub ground: Rgb,
    /// Text, axes and the borders between levels.
    pub ink: Rgb,
    /// Text of lesser weight.
    pub muted: Rgb,
    /// Thin lines between cells and behind curves.
    pub grid: Rgb,
    /// Glyphs of one colour.
    pub glyph: Rgb,
    /// Negative lobes: never a colour that [`Theme::glyph`] could be taken for.
    pub negative: Rgb,
    /// The strong end of heat maps; the weak end is the ground.
    pub heat: Rgb,
}

impl Theme {
    /// For paper.
    pub const LIGHT: Theme = Theme {
        dark: false,
        ground: Rgb::hex(0xffffff),
        ink: Rgb::hex(0x1b1f24),
        muted: Rgb::hex(0x59616b),
        grid: Rgb::hex(0xdfe3e8),
        glyph: Rgb::hex(0x0072b2),
        negative: Rgb::hex(0xd55e00),
        heat: Rgb::hex(0xe69f00),
    };

    /// For screens in dark rooms.
    pub const DARK: Theme = Theme {
        dark: true,
        ground: Rgb::hex(0x15181c),
        ink: Rgb::hex(0xe8eaed),
        muted: Rgb::hex(0xa2a9b3),
        grid: Rgb::hex(0x31363d),
        glyph: Rgb::hex(0x56b4e9),
        negative: Rgb::hex(0xf0793a),
        heat: Rgb::hex(0xb06f00),
    };

    /// A cell's ground for a share from 0 (the ground itself) to 1; weak enough at 1 for glyphs to stand out.
    pub fn heat(&self, share: f32) -> Rgb {
        self.ground.towards(self.heat, 0.85 * share)
    }

    /// The colour of the `i`-th curve: Okabe and Ito's palette, which colour-blind readers can tell apart
    /// ("Color universal design", 2008), without its yellow on white and its black on dark ground.
    pub fn curve(&self, i: usize) -> Rgb {
        const BLUE: Rgb = Rgb::hex(0x0072b2);
        const VERMILLION: Rgb = Rgb::hex(0xd55e00);
        const GREEN: Rgb = Rgb::hex(0x009e73);
        const PURPLE: Rgb = Rgb::hex(0xcc79a7);
        const ORANGE: Rgb = Rgb::hex(0xe69f00);
        const SKY: Rgb = Rgb::hex(0x56b4e9);
        const YELLOW: Rgb = Rgb::hex(0xf0e442);
        const BLACK: Rgb = Rgb::hex(0x000000);
        let palette = match self.dark {
            true => [SKY, ORANGE, GREEN, PURPLE, YELLOW, VERMILLION, BLUE],
            false => [BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, BLACK],
        };
        palette[i % palette.len()]
    }
}

/// What a glyph's colour tells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Paint {
    /// Nothing: the theme's one colour.
    #[default]
    Single,
    /// The colour of the light: its hue, however strong it is.
    Light,
    /// The direction of its flow: the hue is the angle in the slice, grey is straight at or away from the eye.
    Direction,
    /// Its intensity, on the viridis ramp, in the sense that lets the strongest stand out from the ground.
    Intensity,
}

impl Paint {
    /// All of them.
    pub const ALL: [Paint; 4] = [Paint::Single, Paint::Light, Paint::Direction, Paint::Intensity];

    /// The colour of a glyph of `light` (red, green, blue), of which `shown` is drawn in a cut across
    /// `axis`; `share` is its peak intensity over that of a full glyph, 0 to 1.
    pub fn glyph(self, theme: &Theme, light: [Sh<f32>; 3], shown: Sh<f32>, axis: Axis, share: f32) -> Rgb {
        match self {
            Paint::Single => theme.glyph,
            Paint::Light => of_light(theme, light),
            Paint::Direction => of_direction(theme, shown, axis),
            Paint::Intensity => of_intensity(theme, share),
        }
    }

    /// The colour of negative lobes: one that no glyph of this paint has.
    pub fn negative(self, theme: &Theme) -> Rgb {
        match self {
            Paint::Single | Paint::Intensity => theme.negative,
            // White light is white on dark ground and grey on light ground.
            Paint::Light if theme.dark => theme.muted,
            Paint::Light | Paint::Direction => theme.ink,
        }
    }
}

/// The hue of red, green and blue light, as light as every other glyph of its theme.
fn of_light(theme: &Theme, light: [Sh<f32>; 3]) -> Rgb {
    let linear = light.map(|Sh([c00, ..])| c00.max(0.0));
    let strongest = linear.iter().fold(0.0, |m: f32, c| m.max(*c));
    if strongest <= 0.0 || !strongest.is_finite() {
        return theme.muted;
    }
    let hue = Oklab::of_linear(linear.map(|c| c / strongest));
    // White light on a white ground must still be seen.
    Oklab { l: if theme.dark { hue.l.max(0.72) } else { hue.l.min(0.55) }, ..hue }.to_rgb()
}

fn of_direction(theme: &Theme, Sh([_, x, y, z]): Sh<f32>, axis: Axis) -> Rgb {
    let [right, up] = axis.project([x, y, z]);
    let length = (x * x + y * y + z * z).sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return theme.muted;
    }
    let (chroma, l) = (0.14 / length, if theme.dark { 0.76 } else { 0.58 });
    // A turn so that light to the right is blue and light upwards red.
    let (sin, cos) = (0.70 * TAU).sin_cos();
    Oklab { l, a: chroma * (right * cos - up * sin), b: chroma * (right * sin + up * cos) }.to_rgb()
}

/// The viridis ramp (S. van der Walt and N. Smith for matplotlib, CC0) in ten equal steps.
const VIRIDIS: [Rgb; 11] = [
    Rgb::hex(0x440154),
    Rgb::hex(0x482576),
    Rgb::hex(0x414487),
    Rgb::hex(0x35608d),
    Rgb::hex(0x2a788e),
    Rgb::hex(0x21908c),
    Rgb::hex(0x22a884),
    Rgb::hex(0x43bf71),
    Rgb::hex(0x7ad151),
    Rgb::hex(0xbbdf27),
    Rgb::hex(0xfde725),
];

/// The viridis ramp at 0 to 1.
pub fn viridis(share: f32) -> Rgb {
    let steps = VIRIDIS.len() - 1;
    // Not a number counts as 0.
    let at = if share > 0.0 { share.min(1.0) * steps as f32 } else { 0.0 };
    let below = (at as usize).min(steps - 1);
    VIRIDIS[below].towards(VIRIDIS[below + 1], at - below as f32)
}

/// The part of the ramp that stands out from the theme's ground, the strongest light the most: the ramp
/// grows lighter on dark ground, darker on light ground, and its lightest yellow is lost on white.
fn of_intensity(theme: &Theme, share: f32) -> Rgb {
    let share = share.clamp(0.0, 1.0);
    viridis(if theme.dark { 0.3 + 0.7 * share } else { 0.75 - 0.75 * share })
}

/// A colour in OKLab: lightness 0 to 1, green to red, blue to yellow.
#[derive(Clone, Copy)]
struct Oklab {
    l: f32,
    a: f32,
    b: f32,
}

impl Oklab {
    fn of(Rgb(rgb): Rgb) -> Self {
        Oklab::of_linear(rgb.map(|c| {
            let c = f32::from(c) / 255.0;
            if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        }))
    }

    fn of_linear([r, g, b]: [f32; 3]) -> Self {
        let l = (0.412_221_47 * r + 0.536_332_55 * g + 0.051_445_995 * b).cbrt();
        let m = (0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b).cbrt();
        let s = (0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b).cbrt();
        Oklab {
            l: 0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
            a: 1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
            b: 0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
        }
    }

    fn to_linear(self) -> [f32; 3] {
        let l = (self.l + 0.396_337_78 * self.a + 0.215_803_76 * self.b).powi(3);
        let m = (self.l - 0.105_561_346 * self.a - 0.063_854_17 * self.b).powi(3);
        let s = (self.l - 0.089_484_18 * self.a - 1.291_485_5 * self.b).powi(3);
        [
            4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
            -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
            -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
        ]
    }

    /// As sRGB. What a screen cannot show loses colour, not lightness, until it can.
    fn to_rgb(mut self) -> Rgb {
        let shown = |lab: Oklab| lab.to_linear().iter().all(|c| (-1e-3..=1.001).contains(c));
        for _ in 0..40 {
            if shown(self) {
                break;
            }
            self.a *= 0.92;
            self.b *= 0.92;
        }
        Rgb(self.to_linear().map(|c| {
            let c = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
            (c * 255.0).round() as u8
        }))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn oklab_there_and_back_keeps_every_colour() {
        for code in (0..0x100_0000).step_by(4099) {
            let Rgb(before) = Rgb::hex(code);
            let Rgb(after) = Oklab::of(Rgb(before)).to_rgb();
            assert!(before.iter().zip(after).all(|(a, b)| a.abs_diff(b) <= 1), "{before:?} {after:?}");
        }
    }

    #[test]
    fn oklab_has_its_published_values() {
        // Ottosson's table of XYZ pairs ends with the white point; red is his formula worked out by CSS Color 4.
        let white = Oklab::of(Rgb::hex(0xffffff));
        assert!((white.l - 1.0).abs() < 1e-4 && white.a.abs() < 1e-4 && white.b.abs() < 1e-4);
        let red = Oklab::of(Rgb::hex(0xff0000));
        assert!((red.l - 0.62796).abs() < 1e-3 && (red.a - 0.22486).abs() < 1e-3 && (red.b - 0.12585).abs() < 1e-3);
    }

    #[test]
    fn viridis_grows_lighter_all_the_way() {
        let lightness: Vec<f32> = (0..=100).map(|i| Oklab::of(viridis(i as f32 / 100.0)).l).collect();
        assert!(lightness.windows(2).all(|pair| pair[1] > pair[0] - 2e-3), "{lightness:?}");
        assert_eq!((viridis(-1.0), viridis(f32::NAN), viridis(2.0)), (VIRIDIS[0], VIRIDIS[0], VIRIDIS[10]));
    }

    #[test]
    fn the_colour_of_light_does_not_depend_on_its_strength() {
        let light = |scale: f32| [1.0, 0.5, 0.0].map(|c| Sh([c * scale, 0.1, 0.0, 0.0]));
        for theme in [Theme::LIGHT, Theme::DARK] {
            assert_eq!(of_light(&theme, light(1.0)), of_light(&theme, light(0.03125)));
            assert_eq!(of_light(&theme, [Sh::ZERO; 3]), theme.muted);
        }
    }

    #[test]
    fn what_is_drawn_stands_out_from_the_ground() {
        for theme in [Theme::LIGHT, Theme::DARK] {
            let ground = Oklab::of(theme.ground).l;
            let apart = |color: Rgb| (Oklab::of(color).l - ground).abs();
            assert!([theme.ink, theme.muted, theme.glyph, theme.negative].into_iter().all(|c| apart(c) > 0.3));
            assert!((0..7).all(|i| apart(theme.curve(i)) > 0.2), "{theme:?}");
            for i in 0..=10 {
                let (share, angle) = (i as f32 / 10.0, f64::from(i));
                let flow = Sh::lobe(DVec3::new(angle.cos(), angle.sin(), 0.0));
                assert!(apart(of_direction(&theme, flow, Axis::Z)) > 0.3);
                assert!(apart(of_intensity(&theme, share)) > 0.2, "{share} {theme:?}");
                assert!(apart(of_light(&theme, [1.0, share, share * share].map(|c| Sh([c, 0.0, 0.0, 0.0])))) > 0.3);
            }
        }
    }
}
