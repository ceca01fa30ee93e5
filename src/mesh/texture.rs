//! Textures, as far as flat colours need them: the mean colour of a texture over a triangle.
//!
//! Pictures hold sRGB; their colours are made linear (IEC 61966-2-1) before anything is averaged. The mean is
//! over a grid of places in the triangle, about one a texel, each between the four texels around it. A texture
//! repeats beyond its sides.

use std::collections::HashMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use glam::Vec2;
use image::{ImageReader, Limits, RgbImage};

use crate::system::file::FileError;

/// The longest file of a texture, in bytes.
pub(super) const LONGEST: u64 = 64 << 20;
/// The longest side of a texture, in texels.
const LARGEST: u32 = 8192;
/// The most bytes that all textures of a mesh may take.
const MOST: u64 = 512 << 20;

/// The number of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TextureId(usize);

/// The textures of a mesh.
#[derive(Default)]
pub(super) struct Textures {
    pictures: Vec<RgbImage>,
    pub(super) by_file: HashMap<PathBuf, Option<TextureId>>,
    taken: u64,
}

impl Textures {
    /// Whether there is one.
    pub(super) fn any(&self) -> bool {
        !self.pictures.is_empty()
    }

    /// Adds a picture in PNG or JPEG, whose fault is told of `path`.
    pub(super) fn add(&mut self, bytes: &[u8], path: &Path) -> Result<TextureId, FileError> {
        let fault = |what: String| {
            let remedy = format!("give a PNG or JPEG of at most {LARGEST} × {LARGEST} texels");
            FileError::new(path, what, remedy)
        };
        let mut limits = Limits::default();
        (limits.max_image_width, limits.max_image_height) = (Some(LARGEST), Some(LARGEST));
        limits.max_alloc = Some(MOST - self.taken.min(MOST));
        let reader = || ImageReader::new(Cursor::new(bytes)).with_guessed_format();
        let mut sized = reader().map_err(|e| fault(format!("the texture cannot be read ({e})")))?;
        sized.limits(limits.clone());
        let (width, height) =
            sized.into_dimensions().map_err(|e| fault(format!("the texture cannot be read ({e})")))?;
        let bytes_needed = 3 * u64::from(width) * u64::from(height);
        if width > LARGEST || height > LARGEST || width == 0 || height == 0 || self.taken + bytes_needed > MOST {
            return Err(fault(format!("the texture has {width} × {height} texels, or with it all are too large")));
        }
        let mut whole = reader().map_err(|e| fault(format!("the texture cannot be read ({e})")))?;
        whole.limits(limits);
        let picture = whole.decode().map_err(|e| fault(format!("the texture cannot be read ({e})")))?.into_rgb8();
        self.taken += bytes_needed;
        self.pictures.push(picture);
        Ok(TextureId(self.pictures.len() - 1))
    }

    /// The albedo of a triangle: `factor`, times the mean of the texture over it where it has one. A corner
    /// without a place on the texture takes the texture's origin.
    pub(super) fn tint(&self, texture: Option<TextureId>, places: [Option<Vec2>; 3], factor: [f64; 3]) -> [f32; 3] {
        let Some(TextureId(i)) = texture else { return factor.map(|f| f as f32) };
        let mean = mean(&self.pictures[i], places.map(|place| place.unwrap_or_default()));
        [0, 1, 2].map(|c| (factor[c] * mean[c]) as f32)
    }
}

/// The most places along a triangle's side at which its texture is looked at.
const MOST_PLACES: usize = 64;

/// The mean colour of a picture over a triangle, linear; `corners` are places on it, (0, 0) at the lower left.
fn mean(picture: &RgbImage, corners: [Vec2; 3]) -> [f64; 3] {
    let size = Vec2::new(picture.width() as f32, picture.height() as f32);
    let [a, b, c] = corners;
    let longest = [a - b, b - c, c - a].map(|side| (side * size).length()).into_iter().fold(0.0, f32::max);
    // Not a number, and infinity, end at a bound.
    let m = (longest.ceil().clamp(1.0, MOST_PLACES as f32)) as usize;
    let mut sum = [0.0; 3];
    // The triangle in m² alike ones: those that stand as it does, and those turned over between them.
    for i in 0..m {
        for j in 0..m - i {
            let mut add = |third: f32| {
                let (u, v) = ((i as f32 + third) / m as f32, (j as f32 + third) / m as f32);
                let colour = at(picture, a + (b - a) * u + (c - a) * v);
                (0..3).for_each(|k| sum[k] += colour[k]);
            };
            add(1.0 / 3.0);
            if i + j + 1 < m {
                add(2.0 / 3.0);
            }
        }
    }
    sum.map(|s| s / (m * m) as f64)
}

/// The colour at a place, between the four texels around it, linear.
fn at(picture: &RgbImage, place: Vec2) -> [f64; 3] {
    let (w, h) = (picture.width(), picture.height());
    let x = f64::from(place.x).rem_euclid(1.0) * f64::from(w) - 0.5;
    let y = (1.0 - f64::from(place.y).rem_euclid(1.0)) * f64::from(h) - 0.5;
    let (fx, fy) = (x - x.floor(), y - y.floor());
    let wrap = |c: f64, n: u32| (c as i64).rem_euclid(i64::from(n)) as u32;
    let mut colour = [0.0; 3];
    for (dx, wx) in [(0.0, 1.0 - fx), (1.0, fx)] {
        for (dy, wy) in [(0.0, 1.0 - fy), (1.0, fy)] {
            let texel = picture.get_pixel(wrap(x.floor() + dx, w), wrap(y.floor() + dy, h));
            (0..3).for_each(|k| colour[k] += wx * wy * linear(texel[k]));
        }
    }
    colour
}

/// A part of an sRGB colour as a share of light (IEC 61966-2-1).
fn linear(part: u8) -> f64 {
    let v = f64::from(part) / 255.0;
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_over_a_triangle_is_that_of_the_texels_under_it() {
        // Left half black, right half white, 64 texels wide.
        let picture = RgbImage::from_fn(64, 64, |x, _| image::Rgb([if x < 32 { 0 } else { 255 }; 3]));
        let over = |corners: [[f32; 2]; 3]| mean(&picture, corners.map(Vec2::from_array))[0];
        assert!((over([[0.6, 0.2], [0.9, 0.2], [0.6, 0.8]]) - 1.0).abs() < 1e-9);
        assert!(over([[0.1, 0.2], [0.4, 0.2], [0.1, 0.8]]).abs() < 1e-9);
        // Of the triangle under the diagonal a quarter lies left of the middle.
        assert!((over([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]) - 0.75).abs() < 0.01);
        // It repeats.
        assert!((over([[1.6, -0.8], [1.9, -0.8], [1.6, -0.2]]) - 1.0).abs() < 1e-9);
        for odd in [f32::NAN, f32::INFINITY, 1e30] {
            over([[odd, 0.0], [1.0, odd], [0.0, 0.0]]);
        }
    }

    #[test]
    fn colours_are_made_linear() {
        assert_eq!((linear(0), linear(255)), (0.0, 1.0));
        // The published value for the middle of the scale.
        assert!((linear(128) - 0.215_860_5).abs() < 1e-6);
    }
}
