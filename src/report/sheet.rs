//! Pictures side by side on one sheet, each with its name above and its numbers below.

use super::colour::Theme;
use super::radiance::packed;
use super::raster::{self, RasterError};
use super::svg::{Anchor, Svg, Type, fitted};

/// Room around tiles, in pixels.
const GAP: usize = 16;
/// Height of a line of text, in pixels.
const LINE: usize = 18;
/// Height of the sheet's own title, in pixels.
const HEAD: usize = 30;
/// The narrowest that a tile is: its numbers need room.
const NARROWEST: usize = 176;

/// A picture of a sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Tile {
    /// Its name.
    pub title: String,
    /// What is to be said of it, line by line.
    pub lines: Vec<String>,
    /// Pixels across and down.
    pub size: [usize; 2],
    /// Eight bits a channel, row by row from the top.
    pub rgb: Vec<u8>,
}

/// The sheet as a PNG file's bytes, so many tiles in a row. Pictures keep their pixels, small ones several for each.
///
/// # Errors
/// Where it has no tiles, or more pixels than PNG can hold.
pub fn png(title: &str, tiles: &[Tile], columns: usize, theme: &Theme) -> Result<Vec<u8>, RasterError> {
    let columns = columns.clamp(1, tiles.len().max(1));
    let widest = tiles.iter().map(|tile| tile.size[0]).max().unwrap_or(0);
    let each = NARROWEST.div_ceil(widest.max(1));
    let lines = tiles.iter().map(|tile| tile.lines.len()).max().unwrap_or(0);
    let tallest = tiles.iter().map(|tile| tile.size[1]).max().unwrap_or(0) * each;
    let (wide, high) = (widest * each + GAP, LINE + tallest + lines * LINE + GAP);
    let size = [GAP + columns * wide, HEAD + tiles.len().div_ceil(columns) * high];
    let corner = |i: usize| [GAP + i % columns * wide, HEAD + i / columns * high];

    let mut svg = Svg::new(size[0] as f64, size[1] as f64, theme.ground, title);
    let mut line = |[x, y]: [usize; 2], text: &str, size: f64, width: usize, color| {
        let set = Type { size, color, anchor: Anchor::Start };
        let (text, set) = fitted(text, set, width as f64);
        svg.text([x as f64, y as f64], &text, set);
    };
    line([GAP, HEAD - 9], title, 15.0, size[0] - 2 * GAP, theme.ink);
    for (i, tile) in tiles.iter().enumerate() {
        let [x, y] = corner(i);
        line([x, y + LINE - 5], &tile.title, 13.0, wide - GAP, theme.ink);
        for (row, text) in tile.lines.iter().enumerate() {
            let below = y + LINE + tallest + (row + 1) * LINE - 4;
            line([x, below], text, 12.0, wide - GAP, theme.muted);
        }
    }
    let ground = raster::pixels(&svg.finish(), 1.0)?;
    // The ground is opaque, so its colours are not premultiplied by anything but 1.
    let mut rgb: Vec<u8> = ground.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    for (i, tile) in tiles.iter().enumerate() {
        let [x0, y0] = corner(i);
        let [width, height] = tile.size;
        for (y, x) in (0..height * each).flat_map(|y| (0..width * each).map(move |x| (y, x))) {
            let from = 3 * (y / each * width + x / each);
            let to = 3 * ((y0 + LINE + y) * size[0] + x0 + x);
            let pixels = rgb.get_mut(to..to + 3).zip(tile.rgb.get(from..from + 3));
            pixels.into_iter().for_each(|(to, from)| to.copy_from_slice(from));
        }
    }
    packed(size, &rgb)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile(size: [usize; 2], color: [u8; 3]) -> Tile {
        let rgb = color.repeat(size[0] * size[1]);
        Tile { title: "A".to_owned(), lines: vec!["1 %".to_owned()], size, rgb }
    }

    #[test]
    fn every_picture_is_on_the_sheet_pixel_by_pixel() {
        let tiles = [tile([200, 100], [255, 0, 0]), tile([200, 100], [0, 255, 0]), tile([200, 100], [0, 0, 255])];
        let sheet = image::load_from_memory(&png("Title", &tiles, 2, &Theme::LIGHT).unwrap()).unwrap().to_rgb8();
        assert_eq!(sheet.width() as usize, GAP + 2 * (200 + GAP));
        let count = |color: [u8; 3]| sheet.pixels().filter(|pixel| pixel.0 == color).count();
        assert_eq!([count([255, 0, 0]), count([0, 255, 0]), count([0, 0, 255])], [200 * 100; 3]);
        assert!(sheet.pixels().any(|pixel| pixel.0 == Theme::LIGHT.ink.0), "and its text");
    }

    #[test]
    fn small_pictures_are_shown_large_and_none_is_no_panic() {
        let sheet = png("", &[tile([64, 64], [255, 0, 0])], 4, &Theme::DARK).unwrap();
        let sheet = image::load_from_memory(&sheet).unwrap().to_rgb8();
        // 64 pixels, three for each.
        assert_eq!(sheet.pixels().filter(|pixel| pixel.0 == [255, 0, 0]).count(), 192 * 192);
        png("", &[], 2, &Theme::DARK).unwrap();
        png("", &[tile([0, 0], [0; 3])], 1, &Theme::DARK).unwrap();
    }
}
