//! SVG text to PNG bytes, with the fonts that the lab brings along: the same picture on every machine, but for
//! characters that only a font of the system's has (see [`fonts`]).

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{self, Options, Tree};
use thiserror::Error;

use super::fonts;

/// The family that text is set in, and the one to look for its missing characters in.
pub const FONTS: &str = "Ubuntu, Hack, sans-serif";

/// The largest width or height of a picture, in pixels; four bytes for each of its pixels are held in memory.
pub const LARGEST_SIDE: u32 = 16_384;

/// Why a picture could not be turned into pixels.
#[derive(Debug, Error)]
pub enum RasterError {
    /// The text is not SVG.
    #[error("the picture is not valid SVG: {0}")]
    Svg(#[from] usvg::Error),
    /// There would be too many pixels, or none.
    #[error("a picture of {width} × {height} pixels cannot be made: each side must be from 1 to {LARGEST_SIDE}")]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The pixels could not be packed.
    #[error("the picture could not be written as PNG: {0}")]
    Png(String),
}

/// The picture as a PNG file's bytes, one pixel for each unit of the SVG.
///
/// # Errors
/// Where the text is not SVG or its size is none that can be held in memory.
pub fn png(svg: &str) -> Result<Vec<u8>, RasterError> {
    png_at(svg, 1.0)
}

/// The same with so many pixels for each unit of the SVG.
///
/// # Errors
/// As [`png`].
pub fn png_at(svg: &str, pixels_each: f32) -> Result<Vec<u8>, RasterError> {
    pixels(svg, pixels_each)?.encode_png().map_err(|error| RasterError::Png(error.to_string()))
}

/// The picture as pixels, so many for each unit of the SVG.
///
/// # Errors
/// As [`png`].
pub fn pixels(svg: &str, pixels_each: f32) -> Result<Pixmap, RasterError> {
    let tree = tree(svg)?;
    let side = |units: f32| (units * pixels_each).ceil() as u32;
    let (width, height) = (side(tree.size().width()), side(tree.size().height()));
    let wrong_size = RasterError::Size { width, height };
    if width > LARGEST_SIDE || height > LARGEST_SIDE {
        return Err(wrong_size);
    }
    let mut pixels = Pixmap::new(width, height).ok_or(wrong_size)?;
    resvg::render(&tree, Transform::from_scale(pixels_each, pixels_each), &mut pixels.as_mut());
    Ok(pixels)
}

/// The picture as a tree of shapes, its text already turned into outlines.
fn tree(svg: &str) -> Result<Tree, usvg::Error> {
    let options = Options {
        fontdb: fonts::own(),
        font_family: "Ubuntu".to_owned(),
        font_resolver: fonts::resolver(),
        ..Options::default()
    };
    Tree::from_str(svg, &options)
}

#[cfg(test)]
mod tests {
    use resvg::usvg::{Group, Node};

    use super::*;

    const SQUARE: &str = "<svg xmlns='http://www.w3.org/2000/svg' width='40' height='30'>\
                          <rect x='10' y='5' width='10' height='10' fill='#ff0000'/></svg>";

    #[test]
    fn a_png_has_the_size_and_the_pixels_of_its_svg() {
        let picture = Pixmap::decode_png(&png(SQUARE).unwrap()).unwrap();
        assert_eq!((picture.width(), picture.height()), (40, 30));
        let alpha = |x, y| picture.pixel(x, y).unwrap().alpha();
        let red = picture.pixel(15, 10).unwrap();
        assert_eq!((red.red(), red.green(), red.alpha()), (255, 0, 255));
        assert_eq!((alpha(9, 10), alpha(20, 10), alpha(15, 15)), (0, 0, 0));
    }

    #[test]
    fn what_is_no_picture_is_refused_in_words() {
        assert!(matches!(png("no picture"), Err(RasterError::Svg(_))));
        let huge = SQUARE.replace("width='40'", "width='20000'");
        assert!(png(&huge).unwrap_err().to_string().contains("20000 × 30"));
    }

    fn text_boxes(group: &Group) -> Vec<f64> {
        let of = |node: &Node| match node {
            Node::Text(text) => vec![f64::from(text.bounding_box().width())],
            Node::Group(group) => text_boxes(group),
            _ => Vec::new(),
        };
        group.children().iter().flat_map(of).collect()
    }

    #[test]
    fn text_is_no_wider_than_was_reckoned_and_not_much_narrower() {
        use crate::report::colour::Rgb;
        use crate::report::svg::{Anchor, Svg, Type, text_width};
        for text in [
            "radius: logarithm of the intensity, c·Y(ω) per steradian in units of the multipliers",
            "full cell: 0.77 sr⁻¹, none below 7.7×10⁻⁵ sr⁻¹",
            "Relative error (up to 4 cells undefined and left out)",
            "mean, all levels",
            "MMXVI, WIMMIC, 10⁻¹⁰",
        ] {
            let mut svg = Svg::new(2000.0, 50.0, Rgb::hex(0xffffff), "");
            svg.text([0.0, 20.0], text, Type { size: 16.0, color: Rgb::hex(0), anchor: Anchor::Start });
            let wide = text_boxes(tree(&svg.finish()).unwrap().root())[0];
            let share = wide / text_width(text, 16.0);
            assert!((0.75..=1.0).contains(&share), "{text}: {share}");
        }
    }

    fn glyphs(group: &Group) -> usize {
        let of = |node: &Node| match node {
            Node::Text(text) => text.layouted().iter().flat_map(|span| &span.positioned_glyphs).count(),
            Node::Group(group) => glyphs(group),
            _ => 0,
        };
        group.children().iter().map(of).sum()
    }

    #[test]
    fn the_fonts_hold_every_character_that_reports_are_set_in() {
        let text = "Abz 0189 × · − – … ’ ≤ ∞ ω ₃ é";
        let svg = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='900' height='30'>\
             <text x='0' y='20' font-family='{FONTS}' xml:space='preserve'>{text}</text></svg>"
        );
        assert_eq!(glyphs(tree(&svg).unwrap().root()), text.chars().count());
    }
}
