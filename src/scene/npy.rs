//! NumPy's `.npy` form of light: an array of shape (n, n, n, 4), C order, indexed [z, y, x], each entry
//! (c00, c1-1, c10, c11) in the published basis.
//!
//! f2, f4 and f8 of either endianness are read, little-endian f4 is written. The reader takes the header apart
//! by itself: it must trust nothing that the header claims before the file's length agrees.

use std::io::{self, BufReader, Read, Write};
use std::path::Path;

use npyz::{DType, WriterBuilder};

use super::error::{SceneError, quote};
use super::row_text::other_kind;
use super::rows::Wrong;
use crate::field::{Cell, Grid, Layout};
use crate::sh::Sh;
use crate::system::file;

/// The longest header that is read, in bytes; that of a plain array takes 118.
const LONGEST_HEADER: usize = 4096;

/// The longest file that is looked into: light in the largest volume, of side 1024, as f8.
const LONGEST: u64 = 12 + LONGEST_HEADER as u64 + 1024u64.pow(3) * 4 * 8;

/// The lit cells of a file, at most `most`, for a volume of side `size`: z slowest, x fastest.
pub(super) fn read(path: &Path, size: usize, most: usize) -> Result<Vec<(Cell, Sh<f64>)>, SceneError> {
    // One of another size is told by its shape, so it is opened whatever its length.
    let (file, length) = file::open(path, LONGEST)?;
    lit_cells(BufReader::new(file), length, size, most)
        .map_err(|(what, remedy)| SceneError::file(path, None, what, remedy))
}

fn lit_cells(mut file: impl Read, length: u64, size: usize, most: usize) -> Result<Vec<(Cell, Sh<f64>)>, Wrong> {
    let (header, header_length) = header(&mut file)?;
    let number = Number::of(&header, size)?;
    let expected = header_length + size.pow(3) as u64 * 4 * number.width as u64;
    if length != expected {
        let what = format!("the file has {length} bytes, its header promises {expected}");
        return Err((what, "write the whole array again".to_owned()));
    }
    let mut light = Vec::new();
    for cell in Layout::new(size).cells() {
        let mut coefficients = [0.0; 4];
        for (j, coefficient) in coefficients.iter_mut().enumerate() {
            *coefficient = number.read(&mut file).map_err(unreadable)?;
            if !coefficient.is_finite() {
                let [x, y, z] = cell;
                let what = format!("the entry [{z}, {y}, {x}, {j}] is {coefficient}");
                return Err((what, "light is a finite number".to_owned()));
            }
        }
        let sh = Sh::from_basis(coefficients);
        if sh.is_zero() {
            continue;
        }
        if light.len() == most {
            return Err(("the scene holds too many lit cells with this file".to_owned(), "light fewer".to_owned()));
        }
        light.push((cell, sh));
    }
    Ok(light)
}

/// The header's dictionary without blanks, and where the data begin.
pub(super) fn header(file: &mut impl Read) -> Result<(String, u64), Wrong> {
    let none = || ("this is no .npy file".to_owned(), "numpy.save writes one".to_owned());
    let mut start = [0; 8];
    file.read_exact(&mut start).map_err(|_| none())?;
    if &start[..6] != b"\x93NUMPY" {
        let known = other_kind(&start).map(|(what, remedy)| (what.to_owned(), remedy.to_owned()));
        return Err(known.unwrap_or_else(none));
    }
    if !(1..=3).contains(&start[6]) {
        let what = format!("version {} of .npy is not known", start[6]);
        return Err((what, "numpy.save writes versions 1 to 3".to_owned()));
    }
    // Version 1 has two bytes for the header's length, later ones four.
    let bytes = if start[6] == 1 { 2 } else { 4 };
    let mut claimed = [0; 4];
    file.read_exact(&mut claimed[..bytes]).map_err(|_| none())?;
    let claimed = u32::from_le_bytes(claimed) as usize;
    if claimed > LONGEST_HEADER {
        let what = format!("the header claims {claimed} bytes");
        return Err((what, format!("that of a plain array has fewer than {LONGEST_HEADER}")));
    }
    let mut text = vec![0; claimed];
    file.read_exact(&mut text).map_err(|_| none())?;
    let dictionary = String::from_utf8_lossy(&text).split_whitespace().collect::<String>().replace('"', "'");
    Ok((dictionary, (start.len() + bytes + claimed) as u64))
}

/// How a file writes a number.
pub(super) struct Number {
    /// Bytes of one: 2, 4 or 8.
    pub(super) width: usize,
    /// Whether the largest byte comes first.
    big_endian: bool,
}

impl Number {
    /// The form that a header names, if the header is that of light in a volume of side `size`.
    fn of(header: &str, size: usize) -> Result<Self, Wrong> {
        let missing = |key: &str| (format!("the header has no {key}"), "numpy.save writes it".to_owned());
        let shape = entry(header, "shape").ok_or_else(|| missing("shape"))?;
        if shape.replace(",)", ")") != format!("({size},{size},{size},4)") {
            let what = format!("the array's shape is {}", quote(shape));
            return Err((what, format!("this volume takes ({size}, {size}, {size}, 4), indexed [z, y, x]")));
        }
        Self::in_c_order(header)
    }

    /// The form that a header names, whatever the array's shape.
    pub(super) fn in_c_order(header: &str) -> Result<Self, Wrong> {
        let missing = |key: &str| (format!("the header has no {key}"), "numpy.save writes it".to_owned());
        if entry(header, "fortran_order").ok_or_else(|| missing("fortran_order"))? != "False" {
            return Err((
                "the array is in Fortran order".to_owned(),
                "numpy.ascontiguousarray puts it right".to_owned(),
            ));
        }
        let descr = entry(header, "descr").ok_or_else(|| missing("descr"))?;
        let (width, big_endian) = match descr {
            "'<f2'" => (2, false),
            "'>f2'" => (2, true),
            "'<f4'" => (4, false),
            "'>f4'" => (4, true),
            "'<f8'" => (8, false),
            "'>f8'" => (8, true),
            _ => {
                let what = format!("the array's type is {}", quote(descr));
                return Err((what, "write it as float16, float32 or float64".to_owned()));
            }
        };
        Ok(Number { width, big_endian })
    }

    /// The next number.
    pub(super) fn read(&self, file: &mut impl Read) -> io::Result<f64> {
        let mut bytes = [0; 8];
        let bytes = &mut bytes[..self.width];
        file.read_exact(bytes)?;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(match *bytes {
            [a, b] => half(u16::from_le_bytes([a, b])),
            [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
            [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            _ => return Err(io::ErrorKind::InvalidData.into()),
        })
    }
}

/// The number that sixteen bits hold: a sign, five bits of exponent, ten of mantissa.
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, mantissa) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023) / 1024.0);
    sign * match exponent {
        0 => mantissa * 2f64.powi(-14),
        31 if mantissa == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1.0 + mantissa) * 2f64.powi(exponent - 15),
    }
}

/// What a Python dictionary without blanks holds under `key`.
pub(super) fn entry<'a>(dictionary: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = dictionary.split_once(&format!("'{key}':"))?;
    let end = if rest.starts_with('(') { rest.find(')')? + 1 } else { rest.find([',', '}'])? };
    Some(&rest[..end])
}

pub(super) fn unreadable(error: io::Error) -> Wrong {
    (error.to_string(), "check the file and its disk".to_owned())
}

/// Writes a grid as a little-endian f4 array.
pub fn write(writer: impl Write, grid: &Grid<f32>) -> io::Result<()> {
    let n = grid.side() as u64;
    let little_endian = "<f4".parse().map(DType::new_scalar).map_err(io::Error::other)?;
    let array = npyz::WriteOptions::<f32>::new().dtype(little_endian).shape(&[n, n, n, 4]).writer(writer);
    let mut array = array.begin_nd()?;
    array.extend(grid.iter().flat_map(|(_, sh)| sh.to_basis()))?;
    array.finish()
}
