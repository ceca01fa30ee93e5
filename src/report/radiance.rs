//! Pictures of radiance as PNG: as a display shows them, and how two of them differ.

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::raster::RasterError;
use crate::render::image::{Image, encode};

/// The powers of ten that false colours span.
pub const DECADES: f64 = 3.0;

/// A picture as it looks at an exposure, in sRGB.
///
/// # Errors
/// Where it has no pixels, or more than PNG can hold.
pub fn png(image: &Image, exposure: f32) -> Result<Vec<u8>, RasterError> {
    packed(image.size(), &image.to_srgb(exposure))
}

/// Pictures of one height side by side, each at the same exposure.
///
/// # Errors
/// As [`png`].
pub fn side_by_side(images: &[&Image], exposure: f32) -> Result<Vec<u8>, RasterError> {
    let height = images.iter().map(|image| image.size()[1]).min().unwrap_or(0);
    let width: usize = images.iter().map(|image| image.size()[0]).sum();
    let rows =
        |y: usize| images.iter().flat_map(move |image| (0..image.size()[0]).filter_map(move |x| image.get([x, y])));
    png(&Image::new(width, (0..height).flat_map(rows).collect()), exposure)
}

/// How much brighter (red) or darker (blue) a picture looks than `reference` on a display: alike is white, black against
/// white, or more, is the full colour. What is beyond white in both is alike.
///
/// # Errors
/// As [`png`].
pub fn difference(reference: &Image, test: &Image, exposure: f32) -> Result<Vec<u8>, RasterError> {
    packed(reference.size(), &difference_pixels(reference, test, exposure))
}

/// The pixels of [`difference`], eight bits a channel, row by row from the top.
pub fn difference_pixels(reference: &Image, test: &Image, exposure: f32) -> Vec<u8> {
    let shown = |light: f32| encode(f64::from((light * exposure).clamp(0.0, 1.0)));
    let pixel = |(r, t): (&[f32; 3], &[f32; 3])| {
        let by: f64 = (0..3).map(|c| shown(t[c]) - shown(r[c])).sum::<f64>() / 3.0;
        let [strong, weak] = [1.0, 1.0 - by.abs()].map(|v| (v * 255.0).round() as u8);
        if by > 0.0 { [strong, weak, weak] } else { [weak, weak, strong] }
    };
    reference.pixels().iter().zip(test.pixels()).flat_map(pixel).collect()
}

/// A map of numbers from 0 to 1, row by row: black over violet and orange to pale yellow.
///
/// # Errors
/// As [`png`].
pub fn map(width: usize, numbers: &[f64]) -> Result<Vec<u8>, RasterError> {
    let width = width.max(1);
    packed([width, numbers.len() / width], &map_pixels(numbers))
}

/// The pixels of [`map`], eight bits a channel.
pub fn map_pixels(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| heat(*number)).collect()
}

/// A picture's brightness as a [`map`]: over [`DECADES`] powers of ten up to what is white at an exposure. The mean of
/// the colours counts.
pub fn false_colour(image: &Image, exposure: f32) -> Vec<u8> {
    let share = |pixel: &[f32; 3]| {
        let shown = f64::from(pixel.iter().sum::<f32>() / 3.0 * exposure);
        if shown > 0.0 { 1.0 + shown.log10() / DECADES } else { 0.0 }
    };
    map_pixels(&image.pixels().iter().map(share).collect::<Vec<f64>>())
}

/// Between colours that grow lighter at an even pace.
fn heat(number: f64) -> [u8; 3] {
    const STOPS: [[f64; 3]; 5] =
        [[0.0, 0.0, 4.0], [81.0, 18.0, 124.0], [183.0, 55.0, 121.0], [252.0, 137.0, 97.0], [252.0, 253.0, 191.0]];
    let at = number.clamp(0.0, 1.0) * 4.0;
    let i = (at as usize).min(3);
    let part = at - i as f64;
    std::array::from_fn(|c| (STOPS[i][c] * (1.0 - part) + STOPS[i + 1][c] * part).round() as u8)
}

pub(super) fn packed([width, height]: [usize; 2], rgb: &[u8]) -> Result<Vec<u8>, RasterError> {
    let size = RasterError::Size { width: width as u32, height: height as u32 };
    if width == 0 || height == 0 || rgb.len() != 3 * width * height {
        return Err(size);
    }
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(rgb, width as u32, height as u32, ExtendedColorType::Rgb8)
        .map_err(|error| RasterError::Png(error.to_string()))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(png: &[u8]) -> ([u32; 2], Vec<u8>) {
        let image = image::load_from_memory(png).unwrap().to_rgb8();
        ([image.width(), image.height()], image.into_raw())
    }

    #[test]
    fn pictures_come_back_as_they_were_shown() {
        let image = Image::from_fn([3, 2], |x, y| [x as f32 * 0.5, y as f32, 0.25]);
        assert_eq!(pixels(&png(&image, 1.0).unwrap()), ([3, 2], image.to_srgb(1.0)));
        let (size, both) = pixels(&side_by_side(&[&image, &image], 1.0).unwrap());
        assert_eq!((size, &both[..9], &both[9..18]), ([6, 2], &image.to_srgb(1.0)[..9], &image.to_srgb(1.0)[..9]));
        assert!(png(&Image::new(1, Vec::new()), 1.0).is_err());
    }

    #[test]
    fn brighter_is_red_darker_blue_alike_white() {
        let of = |test: f32| {
            let [reference, test] = [0.5, test].map(|v| Image::from_fn([1, 1], |_, _| [v; 3]));
            pixels(&difference(&reference, &test, 1.0).unwrap()).1
        };
        assert_eq!(of(0.5), [255, 255, 255]);
        let (red, blue) = (of(1.0), of(0.0));
        assert!(red[0] == 255 && red[1] < 255 && blue[2] == 255 && blue[0] < 255);
        // sRGB shows a radiance of 0.5 as 0.735 of white.
        assert_eq!((red[1], blue[0]), (188, 67));
        let (bright, brighter) = (Image::from_fn([1, 1], |_, _| [5.0; 3]), Image::from_fn([1, 1], |_, _| [7.0; 3]));
        assert_eq!(difference_pixels(&bright, &brighter, 1.0), [255, 255, 255]);
    }

    #[test]
    fn false_colours_go_by_powers_of_ten() {
        let image = |v: f32| Image::from_fn([1, 1], |_, _| [v; 3]);
        let of = |v: f32, exposure: f32| false_colour(&image(v), exposure);
        assert_eq!((of(1.0, 1.0), of(0.0, 1.0)), (vec![252, 253, 191], vec![0, 0, 4]));
        assert_eq!(of(0.25, 4.0), of(1.0, 1.0), "the exposure counts");
        // Three decades over four steps: half of them down is the stop in the middle.
        assert_eq!(of(10f32.powf(-1.5), 1.0), vec![183, 55, 121]);
    }

    #[test]
    fn maps_run_from_black_to_pale() {
        let (size, bytes) = pixels(&map(2, &[0.0, 1.0]).unwrap());
        assert_eq!((size, bytes), ([2, 1], vec![0, 0, 4, 252, 253, 191]));
    }
}
