//! What stands below a picture of slices: how radii are to be read, and what colours and lines mean.

use std::f64::consts::TAU;

use glam::DVec3;

use super::{Picture, Seen};
use crate::report::colour::{Paint, Rgb};
use crate::report::glyph::{GlyphScale, Glyphs, Hue, Outline};
use crate::report::number::short;
use crate::report::slice::Axis;
use crate::report::svg::{Anchor, PathData, Stroke, Svg, Type, text_width, wrapped};
use crate::sh::Sh;

/// Room for the circle below a panel, in heights of text.
const SCALE_SIGN: f64 = 2.0;
/// From one line of text to the next, in heights of text.
pub(super) const LEADING: f64 = 1.3;

/// The explanations below a picture.
pub(super) struct Legend<'a> {
    picture: &'a Picture<'a>,
    em: f64,
    width: f64,
    items: Vec<(Sign, String)>,
}

/// What an explanation explains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sign {
    Glyph,
    Negative,
    Border,
    Ramp,
    Wheel,
    Heat,
}

impl<'a> Legend<'a> {
    pub fn new(picture: &'a Picture<'a>, seen: &[Seen], em: f64, width: f64) -> Self {
        let mut items = vec![(Sign::Glyph, radius_text(picture))];
        if seen.iter().any(|seen| seen.negative) {
            items.push((Sign::Negative, "negative: what a clamp removes".to_owned()));
        }
        match picture.paint {
            Paint::Single | Paint::Light => {}
            Paint::Direction => items.push((Sign::Wheel, "direction of the light".to_owned())),
            Paint::Intensity => {
                let own = picture.panels.iter().any(|panel| panel.scale == GlyphScale::PerGlyph);
                let text =
                    if own { "intensity, none to the slice’s brightest" } else { "intensity, none to a full cell" };
                items.push((Sign::Ramp, text.to_owned()));
            }
        }
        if picture.heat {
            items.push((Sign::Heat, "ground: mean over all directions, K0·c00, on the same scale".to_owned()));
        }
        if seen.iter().any(|seen| seen.borders) {
            items.push((Sign::Border, "border between octree levels".to_owned()));
        }
        Legend { picture, em, width, items }
    }

    /// In pixels.
    pub fn height(&self) -> f64 {
        self.rows().iter().map(|row| self.row_height(row)).sum()
    }

    fn row_height(&self, row: &[(f64, usize)]) -> f64 {
        let lines = row.iter().map(|(x, i)| self.lines(*x, *i).len()).max().unwrap_or(1);
        (1.8 + LEADING * (lines as f64 - 1.0)) * self.em
    }

    /// An item's text, in as many lines as it takes from its place to the right margin.
    fn lines(&self, x: f64, item: usize) -> Vec<String> {
        let (sign, text) = &self.items[item];
        wrapped(text, self.em, self.width - x - self.sign_width(*sign))
    }

    /// The items of each row, with their distance from the left.
    fn rows(&self) -> Vec<Vec<(f64, usize)>> {
        let mut rows: Vec<Vec<(f64, usize)>> = vec![Vec::new()];
        let mut x = 0.0;
        for (i, (sign, text)) in self.items.iter().enumerate() {
            // With room for a reader whose font is wider than ours.
            let wide = self.sign_width(*sign) + 1.12 * text_width(text, self.em) + 1.5 * self.em;
            if x > 0.0 && x + wide > self.width {
                rows.push(Vec::new());
                x = 0.0;
            }
            if let Some(row) = rows.last_mut() {
                row.push((x, i));
            }
            x += wide;
        }
        rows
    }

    fn sign_width(&self, sign: Sign) -> f64 {
        self.em * if matches!(sign, Sign::Ramp | Sign::Heat) { 5.5 } else { 2.2 }
    }

    pub fn draw(&self, svg: &mut Svg, [left, top]: [f64; 2]) {
        let mut y = top + 0.9 * self.em;
        for row in self.rows() {
            for &(x, i) in &row {
                let sign = self.items[i].0;
                self.draw_sign(svg, sign, [left + x, y]);
                let set = Type { size: self.em, color: self.picture.theme.ink, anchor: Anchor::Start };
                let beside = x + self.sign_width(sign);
                let at = [left + beside, y + 0.35 * self.em];
                svg.lines(at, &self.lines(x, i), set, LEADING * self.em, self.width - beside);
            }
            y += self.row_height(&row);
        }
    }

    /// Grey where the glyphs themselves are of many colours.
    fn glyph_color(&self) -> Rgb {
        let theme = &self.picture.theme;
        if self.picture.paint == Paint::Single { theme.glyph } else { theme.muted }
    }

    fn draw_sign(&self, svg: &mut Svg, sign: Sign, [x, y]: [f64; 2]) {
        let (em, theme) = (self.em, &self.picture.theme);
        match sign {
            Sign::Glyph | Sign::Negative => {
                // A lobe to the right; its own back is negative.
                let mut outline = Outline::default();
                Glyphs::new(Axis::Z, GlyphScale::PerGlyph, 48).outline(Sh::lobe(DVec3::X), &mut outline);
                let (points, color, size, middle) = match sign {
                    Sign::Glyph => (&outline.positive, self.glyph_color(), 3.0, 0.1),
                    _ => (&outline.negative, self.picture.paint.negative(theme), 9.0, 1.5),
                };
                let mut path = PathData::default();
                let place =
                    |p: &[f32; 2]| [x + em * (middle + size * f64::from(p[0])), y - em * size * f64::from(p[1])];
                path.polygon(points.iter().map(place));
                svg.shape(path.as_str(), color);
            }
            Sign::Border => {
                svg.line([x, y], [x + 1.7 * em, y], Stroke::solid(theme.ink, (em * 0.16).max(1.2)));
            }
            Sign::Ramp | Sign::Heat => {
                let steps = 40;
                for k in 0..steps {
                    let share = (k as f32 + 0.5) / steps as f32;
                    let color = match sign {
                        Sign::Heat => theme.heat(share),
                        _ => Paint::Intensity.glyph(theme, [Sh::ZERO; 3], Sh::ZERO, Axis::Z, share),
                    };
                    // Each runs on to the end, under those that follow: no seams.
                    let from = 5.0 * em * f64::from(k) / f64::from(steps);
                    svg.rect([x + from, y - 0.4 * em], [5.0 * em - from, 0.8 * em], color);
                }
            }
            Sign::Wheel => {
                let (steps, radius) = (24, 0.75 * em);
                for k in 0..steps {
                    let angle = |half_steps: i32| TAU * f64::from(half_steps) / f64::from(2 * steps);
                    let (sin, cos) = angle(2 * k).sin_cos();
                    let flow = Sh::lobe(DVec3::new(cos, sin, 0.0));
                    let color = Paint::Direction.glyph(theme, [flow; 3], flow, Axis::Z, 1.0);
                    let rim = |half_steps: i32| {
                        let (sin, cos) = angle(half_steps).sin_cos();
                        [x + 0.8 * em + radius * cos, y - radius * sin]
                    };
                    let mut path = PathData::default();
                    path.polygon([[x + 0.8 * em, y], rim(2 * k - 1), rim(2 * k + 1), rim(2 * k + 2)]);
                    svg.shape(path.as_str(), color);
                }
            }
        }
    }

    /// Under a panel: a cell with the circle that just fills it, and the intensity that this stands for.
    pub fn draw_scale(&self, svg: &mut Svg, text: &[String], [left, y]: [f64; 2], width: f64) {
        let (em, theme) = (self.em, &self.picture.theme);
        let (low, high) = (y - 0.95 * em, y + 0.45 * em);
        let mut cell = PathData::default();
        cell.polygon([[left, low], [left + 1.4 * em, low], [left + 1.4 * em, high], [left, high]]);
        svg.outline(cell.as_str(), Stroke::solid(theme.muted, (em * 0.06).max(0.5)));
        svg.disc([left + 0.7 * em, (low + high) / 2.0], 0.48 * 1.4 * em, self.glyph_color());
        let set = Type { size: em, color: theme.muted, anchor: Anchor::Start };
        svg.lines([left + SCALE_SIGN * em, y + 0.1 * em], text, set, LEADING * em, width - SCALE_SIGN * em);
    }

    /// What stands beside that circle, in lines that fit below a panel.
    pub fn scale_text(&self, scale: GlyphScale, seen: Seen, width: f64) -> Vec<String> {
        let mut text = match scale {
            GlyphScale::Linear { full } => format!("full cell: {}\u{a0}sr⁻¹", short(f64::from(full), 2)),
            GlyphScale::Log { full, decades } => {
                let least = f64::from(full) * 10f64.powf(-f64::from(decades));
                format!(
                    "logarithmic; full cell: {}\u{a0}sr⁻¹, none below {}\u{a0}sr⁻¹",
                    short(f64::from(full), 2),
                    short(least, 2)
                )
            }
            GlyphScale::PerGlyph => "every glyph fills its cell".to_owned(),
        };
        if seen.clipped > 0 {
            text += &format!("; {} cut at the cell", seen.clipped);
        }
        wrapped(&text, self.em, width - SCALE_SIGN * self.em)
    }
}

/// What a radius stands for, and on which scale.
fn radius_text(picture: &Picture) -> String {
    let all = |test: fn(GlyphScale) -> bool| picture.panels.iter().all(|panel| test(panel.scale));
    let scale = if all(|scale| matches!(scale, GlyphScale::Log { .. })) {
        "logarithm of the intensity"
    } else if all(|scale| scale == GlyphScale::PerGlyph) {
        "intensity over the glyph’s own largest"
    } else {
        "intensity"
    };
    let of = match picture.hue {
        Hue::Mean => String::new(),
        hue => format!(" in {}", hue.name()),
    };
    let color = match picture.paint {
        Paint::Light => "; coloured as the light is",
        _ => "",
    };
    format!("radius: {scale}{of}, c·Y(ω) per steradian in units of the multipliers{color}")
}
