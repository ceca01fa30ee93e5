//! Reflective shadow maps as pictures: how far surfaces are from the light, which way they face, what they send back.
//!
//! The six faces of a point light lie three beside each other, +x −x +y above −y +z −z. Texels that see nothing are
//! black. Distances run from white (nearest) to dark grey; a normal n is the colour (n + 1)/2; flux is the share of the
//! brightest texel's, in sRGB. A texel is at least one pixel.

use std::io::Cursor;

use glam::DVec3;
use image::{ImageFormat, Rgb, RgbImage};

use super::raster::RasterError;
use crate::scene::shadow_map::{ShadowMap, Texel};

/// The least pixels along a side of a face.
const LEAST: u32 = 128;

/// What a picture of a map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aspect {
    /// How far surfaces are.
    Depth,
    /// Which way they face.
    Normal,
    /// What they send back.
    Flux,
}

impl Aspect {
    /// All three.
    pub const ALL: [Aspect; 3] = [Aspect::Depth, Aspect::Normal, Aspect::Flux];

    /// Its name, as in names of files.
    pub fn name(self) -> &'static str {
        match self {
            Aspect::Depth => "depth",
            Aspect::Normal => "normal",
            Aspect::Flux => "flux",
        }
    }
}

/// A map as a picture.
pub fn picture(map: &ShadowMap, aspect: Aspect) -> RgbImage {
    let side = map.faces.first().map_or(1, |face| face.side) as u32;
    let (columns, rows) = if map.faces.len() > 1 { (3, map.faces.len().div_ceil(3) as u32) } else { (1, 1) };
    let zoom = LEAST.div_ceil(side).max(1);
    let distances = || map.texels().map(|texel| texel.distance);
    let (near, far) = distances().fold((f64::INFINITY, 0.0), |(near, far): (f64, f64), d| (near.min(d), far.max(d)));
    let brightest = map.texels().flat_map(|texel| texel.flux).fold(f64::MIN_POSITIVE, f64::max);
    let colour = |texel: &Texel| match aspect {
        Aspect::Depth => [1.0 - 0.85 * (texel.distance - near) / (far - near).max(f64::MIN_POSITIVE); 3],
        Aspect::Normal => ((texel.normal + DVec3::ONE) / 2.0).to_array(),
        Aspect::Flux => texel.flux.map(|flux| srgb(flux / brightest)),
    };
    let face_pixels = side * zoom;
    RgbImage::from_fn(columns * face_pixels, rows * face_pixels, |x, y| {
        let face = (y / face_pixels * columns + x / face_pixels) as usize;
        let (i, j) = (x % face_pixels / zoom, y % face_pixels / zoom);
        let texel = map.faces.get(face).and_then(|face| face.texels[(j * side + i) as usize].as_ref());
        Rgb(texel.map_or([0; 3], |texel| colour(texel).map(|part| (255.0 * part.clamp(0.0, 1.0)).round() as u8)))
    })
}

/// The same as the bytes of a PNG.
pub fn png(map: &ShadowMap, aspect: Aspect) -> Result<Vec<u8>, RasterError> {
    let mut bytes = Cursor::new(Vec::new());
    let written = picture(map, aspect).write_to(&mut bytes, ImageFormat::Png);
    written.map(|()| bytes.into_inner()).map_err(|error| RasterError::Png(error.to_string()))
}

/// A share of light as a part of an sRGB colour, both 0 to 1 (IEC 61966-2-1).
fn srgb(light: f64) -> f64 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shadow_map::Face;

    #[test]
    fn texels_stand_where_they_are_in_their_face_and_nothing_is_black() {
        let texel = |distance: f64, flux: f64| {
            Some(Texel { distance, position: DVec3::ZERO, normal: DVec3::X, flux: [flux, flux / 2.0, 0.0] })
        };
        let dark = || Face { side: 2, texels: vec![None; 4] };
        let mut faces: Vec<Face> = (0..6).map(|_| dark()).collect();
        faces[4].texels[1] = texel(1.0, 4.0);
        faces[0].texels[2] = texel(3.0, 1.0);
        let map = ShadowMap { faces, given: [1.0; 3], met: [1.0; 3] };
        let at = |aspect: Aspect, x: u32, y: u32| picture(&map, aspect).get_pixel(x, y).0;
        // Faces of 128 pixels, texels of 64: face 4 is the middle one below, its texel 1 to the right above.
        assert_eq!(at(Aspect::Flux, 128 + 64 + 3, 128 + 60), [255, 188, 0]);
        assert_eq!(at(Aspect::Depth, 128 + 64 + 3, 128 + 60), [255; 3]);
        assert_eq!(at(Aspect::Depth, 5, 64 + 5), [38; 3]);
        assert_eq!(at(Aspect::Normal, 5, 64 + 5), [255, 128, 128]);
        assert_eq!(at(Aspect::Flux, 5, 5), [0; 3]);
        assert!(png(&map, Aspect::Flux).unwrap().starts_with(b"\x89PNG"));
    }
}
