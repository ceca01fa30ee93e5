//! Pictures one after the other as one animated PNG, which plays in browsers and in papers' web pages and is a plain
//! picture elsewhere.
//!
//! Each picture is a PNG file already; its compressed pixels are taken over as they are and wrapped in the chunks that
//! the third edition of the PNG specification (W3C, 2025, chapter 11.3.6) has for animation: `acTL` with the number of
//! frames, `fcTL` before each, and `fdAT` in place of `IDAT` from the second on.

use thiserror::Error;

/// What every PNG file begins with.
const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";

/// A chunk: its kind and its data.
type Chunk<'a> = ([u8; 4], &'a [u8]);

/// Why pictures could not be joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ApngError {
    /// There are none.
    #[error("an animation needs at least one picture")]
    Empty,
    /// One is no whole PNG file.
    #[error("picture {0} of the animation is no whole PNG file")]
    NoPng(usize),
    /// One is of another size or kind of pixels than the first.
    #[error("picture {0} of the animation is not as large as the first")]
    Unlike(usize),
}

/// Joins PNG files of one size into an animated one that shows each for `milliseconds` and begins again at the end.
///
/// # Errors
/// Where there are no pictures, or one does not fit the first.
pub fn join(pictures: &[Vec<u8>], milliseconds: u16) -> Result<Vec<u8>, ApngError> {
    let mut joined = SIGNATURE.to_vec();
    let mut head: Option<Vec<u8>> = None;
    let mut sequence = 0u32;
    for (i, picture) in pictures.iter().enumerate() {
        let chunks = chunks(picture).ok_or(ApngError::NoPng(i))?;
        let own = of(&chunks, *b"IHDR").next().filter(|head| head.len() == 13).ok_or(ApngError::NoPng(i))?;
        match &head {
            None => {
                write(&mut joined, b"IHDR", &[own]);
                write(&mut joined, b"acTL", &[&(pictures.len() as u32).to_be_bytes(), &0u32.to_be_bytes()]);
                // How large a pixel is, and what else stands before the pixels.
                let before = chunks.iter().take_while(|(kind, _)| kind != b"IDAT").filter(|(kind, _)| kind != b"IHDR");
                before.for_each(|(kind, data)| write(&mut joined, kind, &[data]));
                head = Some(own.to_vec());
            }
            Some(first) if first == own => {}
            Some(_) => return Err(ApngError::Unlike(i)),
        }
        let mut next = || {
            sequence += 1;
            (sequence - 1).to_be_bytes()
        };
        let [origin, delay] = [[0u8; 8].as_slice(), &[milliseconds.to_be_bytes(), 1000u16.to_be_bytes()].concat()];
        // Shown as it is, in place of what was there.
        write(&mut joined, b"fcTL", &[&next(), &own[..8], origin, delay, &[0, 0]]);
        for data in of(&chunks, *b"IDAT") {
            match i {
                0 => write(&mut joined, b"IDAT", &[data]),
                _ => write(&mut joined, b"fdAT", &[&next(), data]),
            }
        }
    }
    head.ok_or(ApngError::Empty)?;
    write(&mut joined, b"IEND", &[]);
    Ok(joined)
}

/// A PNG file's chunks, each with its kind; `None` where it is no whole file.
fn chunks(mut png: &[u8]) -> Option<Vec<Chunk<'_>>> {
    png = png.strip_prefix(&SIGNATURE)?;
    let mut chunks = Vec::new();
    while !png.is_empty() {
        let length = u32::from_be_bytes(png.first_chunk().copied()?) as usize;
        let kind: [u8; 4] = png.get(4..8)?.try_into().ok()?;
        chunks.push((kind, png.get(8..8 + length)?));
        png = png.get(12 + length..)?;
    }
    chunks.last().is_some_and(|(kind, _)| kind == b"IEND").then_some(chunks)
}

/// The data of all chunks of a kind.
fn of<'a>(chunks: &'a [Chunk<'a>], kind: [u8; 4]) -> impl Iterator<Item = &'a [u8]> {
    chunks.iter().filter(move |(found, _)| *found == kind).map(|(_, data)| *data)
}

/// Writes a chunk of some parts.
fn write(out: &mut Vec<u8>, kind: &[u8; 4], parts: &[&[u8]]) {
    let length: usize = parts.iter().map(|part| part.len()).sum();
    out.extend((length as u32).to_be_bytes());
    let start = out.len();
    out.extend(kind);
    parts.iter().for_each(|part| out.extend(*part));
    let check = crc(&out[start..]);
    out.extend(check.to_be_bytes());
}

/// The cyclic redundancy check of the PNG specification (annex D), bit by bit: the polynomial 0xEDB88320.
fn crc(bytes: &[u8]) -> u32 {
    let step = |check: u32, _| if check & 1 == 1 { 0xEDB8_8320 ^ (check >> 1) } else { check >> 1 };
    !bytes.iter().fold(u32::MAX, |check, byte| (0..8).fold(check ^ u32::from(*byte), step))
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use image::AnimationDecoder;
    use image::codecs::png::PngDecoder;

    use super::*;
    use crate::report::raster;

    fn square(color: &str) -> Vec<u8> {
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"8\" height=\"6\"><rect width=\"8\" height=\"6\" \
             fill=\"{color}\"/></svg>"
        );
        raster::png(&svg).unwrap()
    }

    #[test]
    fn every_picture_is_a_frame_that_a_reader_gives_back() {
        let colors = [("#ff0000", [255, 0, 0]), ("#00ff00", [0, 255, 0]), ("#0000ff", [0, 0, 255])];
        let joined = join(&colors.map(|(color, _)| square(color)), 250).unwrap();
        let decoder = PngDecoder::new(Cursor::new(&joined)).unwrap();
        let frames = decoder.apng().unwrap().into_frames().collect_frames().unwrap();
        assert_eq!(frames.len(), 3);
        for (frame, (_, rgb)) in frames.iter().zip(colors) {
            assert_eq!(frame.delay().numer_denom_ms(), (250, 1));
            assert_eq!(frame.buffer().dimensions(), (8, 6));
            assert!(frame.buffer().pixels().all(|pixel| pixel.0[..3] == rgb));
        }
        // Where animations are not known it is its first picture.
        let plain = image::load_from_memory(&joined).unwrap().to_rgb8();
        assert!(plain.pixels().all(|pixel| pixel.0 == [255, 0, 0]));
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        assert_eq!(join(&[], 100), Err(ApngError::Empty));
        let good = square("#fff");
        let cut = good[..good.len() - 3].to_vec();
        assert_eq!(join(&[good.clone(), cut], 100), Err(ApngError::NoPng(1)));
        let larger = raster::png_at("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"9\" height=\"6\"/>", 1.0);
        assert_eq!(join(&[good, larger.unwrap()], 100), Err(ApngError::Unlike(1)));
    }

    #[test]
    fn the_check_is_the_specification_s() {
        // The well-known check of an empty IEND chunk.
        assert_eq!(crc(b"IEND"), 0xAE42_6082);
    }
}
