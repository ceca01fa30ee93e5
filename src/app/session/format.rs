//! The size and the colours in which plots and pictures are taken home.

use serde::{Deserialize, Serialize};

use crate::report::colour::Theme;

/// CSS pixels in a millimetre: the unit of SVG where nothing else is said.
const PER_MM: f64 = 96.0 / 25.4;
/// CSS pixels in a typographic point.
const PER_POINT: f64 = 96.0 / 72.0;
/// The height of text in papers, in points.
const PAPER_TEXT: f64 = 7.5;
/// Dots in an inch of a printed page.
const PRINTED: f32 = 300.0;
/// The smallest text in a picture for the screen, in pixels.
const SMALLEST_TEXT: f64 = 12.0;
/// The least and the greatest side that can be chosen, in pixels.
pub const SIDES: std::ops::RangeInclusive<u32> = 200..=8000;

/// How large an export is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Size {
    /// One column of a paper, 85 mm.
    #[default]
    Column,
    /// Both columns of a paper, 180 mm.
    Page,
    /// 1920 × 1080 pixels.
    Slide,
    /// What is typed in.
    Own,
}

impl Size {
    /// All of them.
    pub const ALL: [Size; 4] = [Size::Column, Size::Page, Size::Slide, Size::Own];

    /// Its name on screen.
    pub fn name(self) -> &'static str {
        match self {
            Size::Column => "One column, 85 mm",
            Size::Page => "Two columns, 180 mm",
            Size::Slide => "Slide, 1920 × 1080",
            Size::Own => "Own size",
        }
    }
}

/// Size and colours of exports.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Format {
    /// How large.
    pub size: Size,
    /// Width and height of a size of one's own, in pixels.
    pub own: [u32; 2],
    /// Light on dark.
    pub dark: bool,
}

impl Default for Format {
    fn default() -> Self {
        Format { size: Size::default(), own: [1200, 1000], dark: false }
    }
}

impl Format {
    /// The colours.
    pub fn theme(&self) -> Theme {
        if self.dark { Theme::DARK } else { Theme::LIGHT }
    }

    /// The width, in CSS pixels.
    pub fn width(&self) -> u32 {
        match self.size {
            Size::Column => (85.0 * PER_MM).round() as u32,
            Size::Page => (180.0 * PER_MM).round() as u32,
            Size::Slide => 1920,
            Size::Own => self.own[0].clamp(*SIDES.start(), *SIDES.end()),
        }
    }

    /// The width on paper, in millimetres; none for the screen.
    pub fn millimetres(&self) -> Option<f32> {
        let on_paper = matches!(self.size, Size::Column | Size::Page);
        on_paper.then(|| (f64::from(self.width()) / PER_MM) as f32)
    }

    /// The height, in CSS pixels, where it is fixed; on paper it follows.
    pub fn height(&self) -> Option<u32> {
        match self.size {
            Size::Column | Size::Page => None,
            Size::Slide => Some(1080),
            Size::Own => Some(self.own[1].clamp(*SIDES.start(), *SIDES.end())),
        }
    }

    /// Width and height of a figure of so many plots below each other, in CSS pixels.
    pub fn figure(&self, plots: usize) -> [u32; 2] {
        let each = if self.size == Size::Column { 58.0 } else { 62.0 };
        let follows = (PER_MM * (10.0 + each * plots.max(1) as f64)).round() as u32;
        [self.width(), self.height().unwrap_or(follows)]
    }

    /// The height of ordinary text, in CSS pixels: that of a paper's captions, or of what is read from afar.
    pub fn text(&self) -> f64 {
        match self.size {
            Size::Column | Size::Page => PAPER_TEXT * PER_POINT,
            Size::Slide | Size::Own => (f64::from(self.width()) / 80.0).max(SMALLEST_TEXT),
        }
    }

    /// Pixels of a PNG for each CSS pixel.
    pub fn pixels_each(&self) -> f32 {
        match self.size {
            Size::Column | Size::Page => PRINTED / 96.0,
            Size::Slide | Size::Own => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_can_be_read_at_every_size() {
        for size in Size::ALL {
            for own in [[200, 200], [1200, 1000], [8000, 8000]] {
                let format = Format { size, own, ..Format::default() };
                let lines = f64::from(format.width()) / format.text();
                assert!(format.text() >= PAPER_TEXT * PER_POINT, "{format:?}");
                assert!(lines <= 80.0, "{format:?}: a line of text is a {lines}th of the width");
            }
        }
    }

    #[test]
    fn paper_is_measured_in_millimetres_and_printed_at_300_dots_an_inch() {
        let column = Format { size: Size::Column, ..Format::default() };
        let dots = f64::from(column.width()) * f64::from(column.pixels_each());
        assert!((dots - 85.0 / 25.4 * 300.0).abs() < 2.0);
        assert_eq!(Format { size: Size::Slide, ..column }.figure(3), [1920, 1080]);
    }
}
