//! Pictures of linear radiance, and how they are written: `.npy`, PFM, and eight bits a channel for the eye.

use std::io::{self, Write};

use npyz::{DType, WriterBuilder};

/// Linear radiance [W/(m²·sr)] in red, green and blue for each pixel, row 0 at the top, x fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: usize,
    pixels: Vec<[f32; 3]>,
}

impl Image {
    /// A picture `width` pixels wide; rows that are not whole are cut off.
    pub fn new(width: usize, mut pixels: Vec<[f32; 3]>) -> Self {
        let width = width.max(1);
        pixels.truncate(pixels.len() / width * width);
        Image { width, pixels }
    }

    /// A picture that is `of(x, y)` in column x of row y.
    pub fn from_fn([width, height]: [usize; 2], mut of: impl FnMut(usize, usize) -> [f32; 3]) -> Self {
        Image::new(width, (0..width * height).map(|i| of(i % width, i / width)).collect())
    }

    /// Pixels across and down.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.pixels.len() / self.width]
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// The pixel in column `x` of row `y`, if there is one.
    pub fn get(&self, [x, y]: [usize; 2]) -> Option<[f32; 3]> {
        if x < self.width { self.pixels.get(y * self.width + x).copied() } else { None }
    }

    /// Pixel by pixel and channel by channel `of` both pictures; the smaller height counts.
    pub fn zip(&self, other: &Image, of: impl Fn(f32, f32) -> f32) -> Image {
        let pixel = |(a, b): (&[f32; 3], &[f32; 3])| std::array::from_fn(|c| of(a[c], b[c]));
        Image::new(self.width, self.pixels.iter().zip(&other.pixels).map(pixel).collect())
    }

    /// All radiance times `scale`.
    pub fn scaled(&self, scale: f32) -> Image {
        Image { width: self.width, pixels: self.pixels.iter().map(|p| p.map(|v| v * scale)).collect() }
    }

    /// The mean of red, green and blue over all pixels.
    pub fn mean(&self) -> [f64; 3] {
        let count = self.pixels.len().max(1) as f64;
        std::array::from_fn(|c| self.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / count)
    }

    /// Writes a little-endian float32 array of shape (height, width, 3).
    ///
    /// # Errors
    /// Where the writer fails.
    pub fn write_npy(&self, writer: impl Write) -> io::Result<()> {
        let little_endian = "<f4".parse().map(DType::new_scalar).map_err(io::Error::other)?;
        let shape = [self.size()[1] as u64, self.width as u64, 3];
        let mut array =
            npyz::WriteOptions::<f32>::new().dtype(little_endian).shape(&shape).writer(writer).begin_nd()?;
        array.extend(self.pixels.iter().flatten().copied())?;
        array.finish()
    }

    /// Writes a portable float map: three floats a pixel, rows from the bottom up, little-endian (scale −1).
    ///
    /// # Errors
    /// Where the writer fails.
    pub fn write_pfm(&self, mut writer: impl Write) -> io::Result<()> {
        let [width, height] = self.size();
        write!(writer, "PF\n{width} {height}\n-1.0\n")?;
        for row in self.pixels.chunks_exact(self.width).rev() {
            let bytes: Vec<u8> = row.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
            writer.write_all(&bytes)?;
        }
        Ok(())
    }

    /// Eight bits a channel, row by row from the top: radiance times `exposure`, cut off at 1, encoded as sRGB.
    pub fn to_srgb(&self, exposure: f32) -> Vec<u8> {
        self.pixels.iter().flatten().map(|value| eight_bits(encode(f64::from(value * exposure)))).collect()
    }

    /// An exposure that brings the radiance below which 98 in 100 pixels lie (by their brightest channel) to 80 % of
    /// white; 1 for a dark picture.
    pub fn exposure(&self) -> f32 {
        let mut brightest: Vec<f32> = self.pixels.iter().map(|p| p[0].max(p[1]).max(p[2])).collect();
        brightest.retain(|value| value.is_finite());
        if brightest.is_empty() {
            return 1.0;
        }
        let at = (brightest.len() - 1) * 98 / 100;
        let (_, value, _) = brightest.select_nth_unstable_by(at, f32::total_cmp);
        if *value > 0.0 { 0.8 / *value } else { 1.0 }
    }
}

/// Linear light from 0 to 1 as sRGB (IEC 61966-2-1); what lies outside is cut off, what is no number is black.
pub fn encode(linear: f64) -> f64 {
    let linear = linear.clamp(0.0, 1.0);
    if linear.is_nan() {
        0.0
    } else if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// sRGB from 0 to 1 as linear light.
pub fn decode(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// 0 to 1 as 0 to 255.
fn eight_bits(value: f64) -> u8 {
    (value * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image() -> Image {
        Image::from_fn([3, 2], |x, y| [x as f32, y as f32, 0.25])
    }

    #[test]
    fn npy_says_its_shape_and_keeps_every_number() {
        let mut bytes = Vec::new();
        image().write_npy(&mut bytes).unwrap();
        let array = npyz::NpyFile::new(&bytes[..]).unwrap();
        assert_eq!(array.shape(), [2, 3, 3]);
        let numbers: Vec<f32> = array.into_vec().unwrap();
        assert_eq!(numbers, image().pixels().iter().flatten().copied().collect::<Vec<f32>>());
    }

    #[test]
    fn pfm_begins_at_the_bottom() {
        let mut bytes = Vec::new();
        image().write_pfm(&mut bytes).unwrap();
        let (header, data) = bytes.split_at(b"PF\n3 2\n-1.0\n".len());
        assert_eq!(header, b"PF\n3 2\n-1.0\n");
        assert_eq!(data.len(), 3 * 2 * 3 * 4);
        assert_eq!(data[4..8], 1f32.to_le_bytes(), "green of row 1 comes first");
    }

    #[test]
    fn srgb_has_its_published_values_and_comes_back() {
        assert_eq!(Image::from_fn([1, 1], |_, _| [0.0, 0.5, 2.0]).to_srgb(1.0), [0, 188, 255]);
        assert_eq!(Image::from_fn([1, 1], |_, _| [f32::NAN, -1.0, 0.25]).to_srgb(2.0), [0, 0, 188]);
        for i in 0..=100 {
            let value = f64::from(i) / 100.0;
            assert!((decode(encode(value)) - value).abs() < 1e-7);
        }
    }

    #[test]
    fn exposure_looks_past_a_few_bright_pixels() {
        let image = Image::from_fn([10, 10], |x, y| if x + y == 0 { [1e6; 3] } else { [0.0, 0.5, 0.0] });
        assert_eq!(image.exposure(), 1.6);
        assert_eq!(Image::from_fn([4, 4], |_, _| [0.0; 3]).exposure(), 1.0);
        assert_eq!(Image::new(4, Vec::new()).exposure(), 1.0);
    }

    #[test]
    fn pixels_are_found_by_column_and_row() {
        assert_eq!(image().size(), [3, 2]);
        assert_eq!(image().get([2, 1]), Some([2.0, 1.0, 0.25]));
        assert_eq!((image().get([3, 0]), image().get([0, 2])), (None, None));
        assert_eq!(image().mean(), [1.0, 0.5, 0.25]);
    }
}
