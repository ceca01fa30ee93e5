//! Numbers out of buffers: accessors of one or several components, sparse ones too, and how lists, strips and
//! fans make triangles. Every range is checked before it is read.

use std::borrow::Cow;

use gltf::Accessor;
use gltf::accessor::DataType;
use gltf::accessor::sparse::IndexType;
use gltf::buffer::View;
use gltf::mesh::Mode;

/// What is wrong and what would be right.
type Fault = (String, &'static str);

/// The bytes of a view; `None` where they lie outside its buffer.
pub(super) fn view_bytes<'a>(view: &View, buffers: &'a [Cow<'_, [u8]>]) -> Option<&'a [u8]> {
    let buffer = buffers.get(view.buffer().index())?;
    let end = view.offset().checked_add(view.length())?;
    buffer.get(view.offset()..end)
}

/// `count` elements of `size` bytes, `stride` apart, from `offset` on.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn new(
        view: &View,
        offset: usize,
        size: usize,
        count: usize,
        buffers: &'a [Cow<'_, [u8]>],
    ) -> Option<Elements<'a>> {
        let stride = view.stride().unwrap_or(size);
        let bytes = view_bytes(view, buffers)?.get(offset..)?;
        let needed = stride.checked_mul(count.checked_sub(1)?)?.checked_add(size)?;
        (stride >= size && needed <= bytes.len()).then_some(Elements { bytes, stride, size, count })
    }

    fn iter(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let (bytes, stride, size) = (self.bytes, self.stride, self.size);
        (0..self.count).map(move |i| &bytes[i * stride..i * stride + size])
    }
}

/// An accessor's elements of `N` components as numbers.
pub(super) fn vectors<const N: usize>(accessor: &Accessor, buffers: &[Cow<[u8]>]) -> Result<Vec<[f32; N]>, Fault> {
    if accessor.dimensions().multiplicity() != N {
        let what = format!("accessors[{}] holds {:?}", accessor.index(), accessor.dimensions());
        return Err((what, "positions are VEC3 and places on textures VEC2"));
    }
    let (kind, normalized) = (accessor.data_type(), accessor.normalized());
    let vector = |bytes: &[u8]| {
        let mut v = [0.0; N];
        let parts = bytes.chunks_exact(kind.size());
        v.iter_mut().zip(parts).for_each(|(v, bytes)| *v = number(bytes, kind, normalized));
        v
    };
    let outside = || outside(accessor);
    let count = accessor.count();
    let mut vectors: Vec<[f32; N]> = match accessor.view() {
        Some(view) => {
            let elements = Elements::new(&view, accessor.offset(), N * kind.size(), count, buffers);
            elements.ok_or_else(outside)?.iter().map(vector).collect()
        }
        // A sparse accessor may stand on zeros.
        None => vec![[0.0; N]; count],
    };
    if let Some(sparse) = accessor.sparse() {
        let indices = sparse.indices();
        let wide = match indices.index_type() {
            IndexType::U8 => DataType::U8,
            IndexType::U16 => DataType::U16,
            IndexType::U32 => DataType::U32,
        };
        let at = Elements::new(&indices.view(), indices.offset(), wide.size(), sparse.count(), buffers);
        let values = sparse.values();
        let values = Elements::new(&values.view(), values.offset(), N * kind.size(), sparse.count(), buffers);
        for (at, value) in at.ok_or_else(outside)?.iter().zip(values.ok_or_else(outside)?.iter()) {
            *vectors.get_mut(whole(at, wide) as usize).ok_or_else(outside)? = vector(value);
        }
    }
    Ok(vectors)
}

/// An accessor's elements as numbers of vertices, each below `vertices`.
pub(super) fn indices(accessor: &Accessor, buffers: &[Cow<[u8]>], vertices: usize) -> Result<Vec<u32>, Fault> {
    let kind = accessor.data_type();
    let whole_numbers = matches!(kind, DataType::U8 | DataType::U16 | DataType::U32);
    if accessor.dimensions().multiplicity() != 1 || !whole_numbers || accessor.sparse().is_some() {
        let what = format!("accessors[{}] cannot hold indices", accessor.index());
        return Err((what, "indices are SCALAR and of an unsigned type"));
    }
    let view = accessor.view().ok_or_else(|| outside(accessor))?;
    let elements = Elements::new(&view, accessor.offset(), kind.size(), accessor.count(), buffers);
    let indices: Vec<u32> = elements.ok_or_else(|| outside(accessor))?.iter().map(|bytes| whole(bytes, kind)).collect();
    match indices.iter().position(|i| *i as usize >= vertices) {
        None => Ok(indices),
        Some(at) => {
            let what = format!("index {at} is {}, and there are {vertices} vertices", indices[at]);
            Err((what, "indices count vertices from 0"))
        }
    }
}

fn outside(accessor: &Accessor) -> Fault {
    (format!("accessors[{}] lies outside its buffer", accessor.index()), "export the mesh again")
}

/// An unsigned number of a kind.
fn whole(bytes: &[u8], kind: DataType) -> u32 {
    let mut four = [0; 4];
    four[..kind.size()].copy_from_slice(&bytes[..kind.size()]);
    u32::from_le_bytes(four)
}

/// A number of a kind; whole numbers that are normalised stand for −1 to 1 or 0 to 1.
fn number(bytes: &[u8], kind: DataType, normalized: bool) -> f32 {
    let raw = whole(bytes, kind);
    let (value, most) = match kind {
        DataType::F32 => return f32::from_bits(raw),
        DataType::I8 => (f32::from(raw as u8 as i8), f32::from(i8::MAX)),
        DataType::U8 => (raw as f32, f32::from(u8::MAX)),
        DataType::I16 => (f32::from(raw as u16 as i16), f32::from(i16::MAX)),
        DataType::U16 => (raw as f32, f32::from(u16::MAX)),
        DataType::U32 => (raw as f32, u32::MAX as f32),
    };
    if normalized { (value / most).max(-1.0) } else { value }
}

/// How many triangles so many corners make.
pub(super) fn triangle_count(mode: Mode, corners: usize) -> usize {
    if mode == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) }
}

/// The corners of triangle `i` as places in the list of corners; all triangles of a strip or fan turn one way.
pub(super) fn triangle(mode: Mode, i: usize) -> [usize; 3] {
    match mode {
        Mode::TriangleStrip if i % 2 == 1 => [i + 1, i, i + 2],
        Mode::TriangleStrip => [i, i + 1, i + 2],
        Mode::TriangleFan => [0, i + 1, i + 2],
        _ => [3 * i, 3 * i + 1, 3 * i + 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_kind_are_read_as_the_format_says() {
        assert_eq!(number(&1.5f32.to_le_bytes(), DataType::F32, false), 1.5);
        assert_eq!(number(&[0x80], DataType::I8, true), -1.0);
        assert_eq!(number(&[0xff], DataType::U8, true), 1.0);
        assert_eq!(number(&(-2i16).to_le_bytes(), DataType::I16, false), -2.0);
        assert_eq!(number(&65535u16.to_le_bytes(), DataType::U16, true), 1.0);
        assert_eq!(whole(&[1, 2], DataType::U16), 513);
    }

    #[test]
    fn strips_and_fans_make_triangles_that_turn_one_way() {
        let of = |mode, corners| -> Vec<[usize; 3]> {
            (0..triangle_count(mode, corners)).map(|i| triangle(mode, i)).collect()
        };
        assert_eq!(of(Mode::Triangles, 7), [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(of(Mode::TriangleStrip, 5), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        assert_eq!(of(Mode::TriangleFan, 4), [[0, 1, 2], [0, 2, 3]]);
        assert!(of(Mode::TriangleStrip, 1).is_empty());
    }
}
