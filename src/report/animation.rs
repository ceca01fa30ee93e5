//! Pictures one after the other as one file: an animated PNG, which every browser plays and every viewer shows at least
//! the first picture of.
//!
//! The pictures are PNGs of one size by one encoder, so their compressed data can be taken over as it is: the first
//! picture's chunks stay, an `acTL` says how many there are, each is announced by an `fcTL`, and the data of all but the
//! first becomes `fdAT` (PNG, third edition, 11.3.6).

/// What every PNG begins with.
const SIGNATURE: [u8; 8] = [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n'];

/// The pictures at so many a second, without end; `None` without pictures, or where they are not PNGs of one kind.
pub fn of_pngs(pictures: &[Vec<u8>], rate: f64) -> Option<Vec<u8>> {
    let parsed: Vec<Vec<Chunk<'_>>> = pictures.iter().map(|picture| chunks(picture)).collect::<Option<_>>()?;
    let head = parsed.first()?.iter().find(|chunk| chunk.kind == *b"IHDR")?.data;
    let size = head.get(..8)?;
    let mut file = SIGNATURE.to_vec();
    push(&mut file, *b"IHDR", head);
    let mut control = u32::try_from(parsed.len()).ok()?.to_be_bytes().to_vec();
    control.extend(0u32.to_be_bytes());
    push(&mut file, *b"acTL", &control);
    // Seconds a picture as a fraction of two sixteen-bit numbers.
    let delay = (1000.0 / rate).round().clamp(1.0, 65_535.0) as u16;
    let mut number = 0u32;
    for (i, picture) in parsed.iter().enumerate() {
        if picture.iter().find(|chunk| chunk.kind == *b"IHDR")?.data != head {
            return None;
        }
        let mut frame = next(&mut number).to_vec();
        frame.extend(size);
        frame.extend([0; 8]); // at the upper left
        frame.extend(delay.to_be_bytes());
        frame.extend(1000u16.to_be_bytes());
        frame.extend([0, 0]); // nothing is cleared, and nothing blended
        push(&mut file, *b"fcTL", &frame);
        for chunk in picture.iter().filter(|chunk| chunk.kind == *b"IDAT") {
            if i == 0 {
                push(&mut file, *b"IDAT", chunk.data);
            } else {
                let mut data = next(&mut number).to_vec();
                data.extend(chunk.data);
                push(&mut file, *b"fdAT", &data);
            }
        }
    }
    push(&mut file, *b"IEND", &[]);
    Some(file)
}

/// The next sequence number.
fn next(number: &mut u32) -> [u8; 4] {
    *number += 1;
    (*number - 1).to_be_bytes()
}

/// A chunk of a PNG.
struct Chunk<'a> {
    kind: [u8; 4],
    data: &'a [u8],
}

fn chunks(png: &[u8]) -> Option<Vec<Chunk<'_>>> {
    let mut rest = png.strip_prefix(&SIGNATURE)?;
    let mut chunks = Vec::new();
    while !rest.is_empty() {
        let (length, after) = rest.split_first_chunk::<4>()?;
        let (kind, after) = after.split_first_chunk::<4>()?;
        let data = after.get(..u32::from_be_bytes(*length) as usize)?;
        chunks.push(Chunk { kind: *kind, data });
        rest = after.get(data.len() + 4..)?;
    }
    Some(chunks)
}

fn push(file: &mut Vec<u8>, kind: [u8; 4], data: &[u8]) {
    // A chunk's length fits: PNGs hold less than 2³¹ bytes a chunk.
    file.extend((data.len() as u32).to_be_bytes());
    let from = file.len();
    file.extend(kind);
    file.extend(data);
    let sum = checksum(&file[from..]);
    file.extend(sum.to_be_bytes());
}

/// The CRC-32 of PNG (annex D).
fn checksum(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { 0xedb8_8320 ^ crc >> 1 } else { crc >> 1 })
    };
    !bytes.iter().fold(u32::MAX, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_the_standard() {
        assert_eq!(checksum(b"123456789"), 0xcbf4_3926);
        assert_eq!(checksum(b"IEND"), 0xae42_6082);
    }

    #[test]
    fn every_picture_is_a_frame_with_its_own_data() {
        let picture = |bytes: &[u8]| {
            let mut png = SIGNATURE.to_vec();
            push(&mut png, *b"IHDR", &[0, 0, 0, 2, 0, 0, 0, 1, 8, 2, 0, 0, 0]);
            push(&mut png, *b"IDAT", bytes);
            push(&mut png, *b"IEND", &[]);
            png
        };
        let file = of_pngs(&[picture(b"one"), picture(b"two"), picture(b"three")], 25.0).unwrap();
        let found = chunks(&file).unwrap();
        let kinds: Vec<&[u8]> = found.iter().map(|chunk| &chunk.kind[..]).collect();
        let wanted: [&[u8]; 9] = [b"IHDR", b"acTL", b"fcTL", b"IDAT", b"fcTL", b"fdAT", b"fcTL", b"fdAT", b"IEND"];
        assert_eq!(kinds, wanted);
        assert_eq!(found[1].data, [0, 0, 0, 3, 0, 0, 0, 0]);
        assert_eq!(found[3].data, b"one");
        // Frames and their data are numbered in one row.
        assert_eq!((found[5].data, found[7].data), (&b"\0\0\0\x02two"[..], &b"\0\0\0\x04three"[..]));
        assert_eq!(found[2].data[20..24], [0, 40, 0x03, 0xe8]);
        assert!(of_pngs(&[], 25.0).is_none() && of_pngs(&[b"no picture".to_vec()], 25.0).is_none());
    }
}
