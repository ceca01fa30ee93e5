//! Reads Wavefront OBJ: vertices, texture coordinates, faces of any number of corners, materials by name.
//!
//! A first walk over the lines counts what will be stored, so that limits are checked before anything is taken;
//! the second reads. Normals, lines, points, curves, groups and smoothing are stepped over: surfaces here are
//! flat. Every fault has its line.

mod mtl;

use std::collections::HashMap;
use std::str::FromStr;

use glam::{Vec2, Vec3};

use super::job::{Job, Parts, at_line, shortened};
use super::texture::TextureId;
use super::{FARTHEST, MOST_TRIANGLES, MOST_VERTICES, Material, is_usable, polygon};
use crate::system::file::FileError;

/// The most corners that a face may have.
const MOST_CORNERS: usize = 1000;

/// Reads an OBJ file's bytes.
pub(super) fn read(bytes: &[u8], job: &mut Job) -> Result<Parts, FileError> {
    let count = Count::of(bytes, job)?;
    let parts = Parts {
        vertices: Vec::with_capacity(count.vertices),
        triangles: Vec::with_capacity(count.triangles),
        made_of: Vec::with_capacity(count.triangles),
        ..Parts::default()
    };
    let mut reader = Reader { parts, coordinates: Vec::new(), paints: HashMap::new(), paint: None, job };
    let (mut done, mut told) = (0, 0);
    for (i, line) in lines(bytes).enumerate() {
        reader.take(i + 1, line)?;
        done += line.len() + 1;
        if done - told > bytes.len() / 100 {
            told = done;
            reader.job.progress(done as f64 / bytes.len() as f64);
        }
    }
    Ok(reader.parts)
}

/// The lines of a text, without their ends.
fn lines(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    bytes.split(|b| *b == b'\n')
}

/// A line as text without its comment; `None` where it is not UTF-8, as comments and names in old files are.
fn text(line: &[u8]) -> Option<&str> {
    std::str::from_utf8(line.split(|b| *b == b'#').next().unwrap_or(line)).ok().map(str::trim)
}

/// How much a file holds.
struct Count {
    vertices: usize,
    triangles: usize,
}

impl Count {
    fn of(bytes: &[u8], job: &Job) -> Result<Count, FileError> {
        let mut count = Count { vertices: 0, triangles: 0 };
        for (i, line) in lines(bytes).enumerate() {
            match keyword(line) {
                b"v" => count.vertices += 1,
                b"f" => {
                    let words = line.split(|b| b.is_ascii_whitespace()).filter(|word| !word.is_empty());
                    count.triangles += words.count().saturating_sub(3);
                }
                _ => continue,
            }
            if count.triangles > MOST_TRIANGLES || count.vertices > MOST_VERTICES {
                let what = format!("here it comes to more than {MOST_TRIANGLES} triangles");
                return Err(at_line(job.path, i + 1, what, "take a coarser mesh"));
            }
        }
        Ok(count)
    }
}

/// The first word of a line.
fn keyword(line: &[u8]) -> &[u8] {
    line.trim_ascii_start().split(|b| b.is_ascii_whitespace()).next().unwrap_or(line)
}

struct Reader<'a, 'b> {
    parts: Parts,
    /// Texture coordinates.
    coordinates: Vec<Vec2>,
    /// Materials by name.
    paints: HashMap<String, Paint>,
    paint: Option<Paint>,
    job: &'a mut Job<'b>,
}

/// A material in use.
#[derive(Clone, Copy)]
struct Paint {
    material: u32,
    texture: Option<TextureId>,
}

impl Reader<'_, '_> {
    /// Reads a line, counted from 1.
    fn take(&mut self, number: usize, line: &[u8]) -> Result<(), FileError> {
        match keyword(line) {
            b"v" | b"vt" | b"f" | b"mtllib" | b"usemtl" => {}
            _ => return Ok(()),
        }
        let fault = |job: &Job, what: String, remedy: &str| at_line(job.path, number, what, remedy);
        let Some(line) = text(line) else {
            return Err(fault(self.job, "this line is not UTF-8 text".into(), "save the file as UTF-8"));
        };
        if line.ends_with('\\') {
            let what = "the line goes on in the next one".to_owned();
            return Err(fault(self.job, what, "write every face and vertex in one line"));
        }
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        match word {
            "v" => match numbers::<3>(rest) {
                Some(v) if is_usable(Vec3::from_array(v)) => self.parts.vertices.push(Vec3::from_array(v)),
                Some([x, y, z]) => {
                    let what = format!("the vertex ({x}, {y}, {z}) cannot stand in a scene");
                    return Err(fault(self.job, what, &format!("write finite numbers up to {FARTHEST:e}")));
                }
                None => {
                    let what = format!("`{}` is no vertex", shortened(line));
                    return Err(fault(self.job, what, "write v and three numbers"));
                }
            },
            "vt" => {
                let at = numbers::<2>(rest).or(numbers::<1>(rest).map(|[u]| [u, 0.0]));
                match at.map(Vec2::from_array) {
                    Some(at) if at.is_finite() => self.coordinates.push(at),
                    _ => {
                        let what = format!("`{}` is no place on a texture", shortened(line));
                        return Err(fault(self.job, what, "write vt and two finite numbers"));
                    }
                }
            }
            "f" => self.face(rest).map_err(|(what, remedy)| fault(self.job, what, remedy))?,
            "mtllib" => self.library(rest)?,
            _ => self.paint = Some(self.paint_of(rest)),
        }
        Ok(())
    }

    /// Takes over the materials of a library: of the file of this name, or of several where no file has it.
    fn library(&mut self, names: &str) -> Result<(), FileError> {
        let instead = "its materials are grey";
        let whole = [names];
        let files: Vec<&str> =
            if names.contains(".mtl ") { names.split_whitespace().collect() } else { whole.to_vec() };
        for name in files {
            let Some((path, bytes)) = self.job.beside(name, mtl::LONGEST, instead)? else { continue };
            for made in mtl::read(&bytes, &path)? {
                let material = self.parts.materials.len() as u32;
                let texture = match &made.texture {
                    None => None,
                    Some(name) => self.job.texture_in_file(name)?,
                };
                let lost = made.texture.is_some() && texture.is_none();
                let name = made.material.name.clone();
                let grey = Material { emission: made.material.emission, ..Material::grey(name.clone()) };
                self.parts.materials.push(if lost { grey } else { made.material });
                self.paints.insert(name, Paint { material, texture });
            }
        }
        Ok(())
    }

    /// The material of this name, or a grey one.
    fn paint_of(&mut self, name: &str) -> Paint {
        if let Some(paint) = self.paints.get(name) {
            return *paint;
        }
        if !name.is_empty() {
            self.job.note(format!("the material `{}` is not there: it is grey", shortened(name)));
        }
        let paint = Paint { material: self.parts.materials.len() as u32, texture: None };
        self.parts.materials.push(Material::grey(name));
        self.paints.insert(name.to_owned(), paint);
        paint
    }

    /// Adds a face.
    fn face(&mut self, words: &str) -> Result<(), (String, &'static str)> {
        let mut corners: Vec<u32> = Vec::new();
        let mut places: Vec<Option<Vec2>> = Vec::new();
        for word in words.split_whitespace() {
            let mut parts = word.split('/');
            let vertex = index(parts.next().unwrap_or(""), self.parts.vertices.len())
                .ok_or_else(|| no_corner(word, self.parts.vertices.len()))?;
            let place = match parts.next() {
                None | Some("") => None,
                Some(place) => Some(
                    self.coordinates[index(place, self.coordinates.len()).ok_or_else(|| {
                        let what = format!("`{}` names a vt that is not there", shortened(word));
                        (what, "name one of those above")
                    })?],
                ),
            };
            corners.push(vertex as u32);
            places.push(place);
        }
        if !(3..=MOST_CORNERS).contains(&corners.len()) {
            return Err((format!("the face has {} corners", corners.len()), "a face has 3 to 1000 corners"));
        }
        let paint = match self.paint {
            Some(paint) => paint,
            None => self.paint_of(""),
        };
        let points: Vec<Vec3> = corners.iter().map(|v| self.parts.vertices[*v as usize]).collect();
        for corner in polygon::triangles(&points) {
            self.parts.triangles.push(corner.map(|c| corners[c]));
            self.parts.made_of.push(paint.material);
            let albedo = self.parts.materials[paint.material as usize].albedo;
            let places = corner.map(|c| places[c]);
            self.parts.tints.push(self.job.textures.tint(paint.texture, places, albedo));
        }
        Ok(())
    }
}

fn no_corner(word: &str, vertices: usize) -> (String, &'static str) {
    let what = format!("`{}` is no corner: {vertices} vertices stand above", shortened(word));
    (what, "count vertices from 1, or from -1 backwards")
}

/// The number, from 0, of what an index of a file means among `length`: from 1 on, or from −1 backwards.
fn index(word: &str, length: usize) -> Option<usize> {
    let index = i64::from_str(word).ok()?;
    let index = if index < 0 { index + length as i64 } else { index - 1 };
    usize::try_from(index).ok().filter(|i| *i < length)
}

/// The first `N` numbers of a line; more may follow.
pub(super) fn numbers<const N: usize>(words: &str) -> Option<[f32; N]> {
    let mut found = [0.0; N];
    let mut words = words.split_whitespace();
    for number in &mut found {
        *number = words.next()?.parse().ok()?;
    }
    Some(found)
}
