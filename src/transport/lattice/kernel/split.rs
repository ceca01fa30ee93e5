//! A level cut into runs of slabs, each with its own part of every array, so that threads can write
//! side by side without locks.

use std::ops::Range;

use super::slab::{Source, Target};
use crate::field::{Grid, Layout, Marks};
use crate::sh::Real;

/// The parts of four planes that belong to a run of slabs. The first run of a grid takes the padding
/// before it along, the last the padding behind it.
pub(super) struct Planes<'a, T> {
    planes: [&'a mut [T]; 4],
    /// Where the first slab begins.
    first: usize,
}

impl<'a, T: Real> Planes<'a, T> {
    /// `grid` cut in runs that end at the given slabs, the last of them its side.
    pub(super) fn cut(grid: &'a mut Grid<T>, ends: &[usize]) -> Vec<Self> {
        let (layout, n) = (grid.layout(), grid.side());
        let start = layout.row_start(0, 0);
        let end = |z: usize| if z == n { layout.plane_len() } else { start + z * layout.steps()[2] };
        let ends: Vec<usize> = ends.iter().map(|&z| end(z)).collect();
        let [c, x, y, z] = grid.planes_mut().map(|plane| split(plane, &ends).into_iter());
        let runs = c.zip(x).zip(y.zip(z)).enumerate();
        runs.map(|(i, ((c, x), (y, z)))| Planes { planes: [c, x, y, z], first: if i == 0 { start } else { 0 } })
            .collect()
    }

    /// The same parts, to read.
    pub(super) fn source<'b>(&'b self, lit: &'b [u64]) -> Source<'b, T> {
        Source { planes: self.planes.each_ref().map(|plane| &**plane), lit, first: self.first }
    }

    /// Slab number `z` of the run, without the padding around it.
    fn slab(&mut self, layout: Layout, z: usize) -> [&mut [T]; 4] {
        let slab = layout.steps()[2];
        let start = self.first + z * slab;
        self.planes.each_mut().map(|plane| &mut plane[start..start + layout.side() * layout.steps()[1]])
    }
}

/// What a run of slabs writes besides the light itself.
pub(super) struct Tied<'a, T> {
    sum: Option<Planes<'a, T>>,
    marks: &'a mut [u64],
}

impl<'a, T: Real> Tied<'a, T> {
    /// Sum and marks cut in runs that end at the given slabs.
    pub(super) fn cut(sum: Option<&'a mut Grid<T>>, marks: &'a mut Marks, ends: &[usize]) -> Vec<Self> {
        let sums: Vec<Option<Planes<'a, T>>> = match sum {
            Some(grid) => Planes::cut(grid, ends).into_iter().map(Some).collect(),
            None => ends.iter().map(|_| None).collect(),
        };
        let marks = cut_marks(marks, ends);
        sums.into_iter().zip(marks).map(|(sum, marks)| Tied { sum, marks }).collect()
    }

    /// Slab number `z` of a run, to write.
    pub(super) fn target<'b>(
        &'b mut self,
        layout: Layout,
        z: usize,
        light: &'b mut Planes<'_, T>,
        lit: &'b mut [u64],
    ) -> Target<'b, T> {
        let words = layout.side() * layout.side().div_ceil(64);
        Target {
            planes: light.slab(layout, z),
            lit: &mut lit[z * words..(z + 1) * words],
            sum: self.sum.as_mut().map(|sum| sum.slab(layout, z)),
            marks: &mut self.marks[z * words..(z + 1) * words],
        }
    }
}

/// The words of runs that end at the given slabs.
pub(super) fn cut_marks<'a>(marks: &'a mut Marks, ends: &[usize]) -> Vec<&'a mut [u64]> {
    let slab = marks.side() * marks.words_per_row();
    let ends: Vec<usize> = ends.iter().map(|z| z * slab).collect();
    split(marks.words_mut(), &ends)
}

/// The words of slab number `z`.
pub(super) fn slab_of(marks: &Marks, z: usize) -> &[u64] {
    let slab = marks.side() * marks.words_per_row();
    &marks.words()[z * slab..(z + 1) * slab]
}

/// The slabs of each run.
pub(super) fn runs(ends: &[usize]) -> impl Iterator<Item = Range<usize>> {
    let starts = std::iter::once(0).chain(ends.iter().copied());
    starts.zip(ends).map(|(from, &to)| from..to)
}

/// Cuts numbers into the pieces between consecutive `ends`.
fn split<'a, U>(mut rest: &'a mut [U], ends: &[usize]) -> Vec<&'a mut [U]> {
    let mut taken = 0;
    let mut pieces = Vec::with_capacity(ends.len());
    for &end in ends {
        let (piece, behind) = rest.split_at_mut(end - taken);
        pieces.push(piece);
        (rest, taken) = (behind, end);
    }
    pieces
}
