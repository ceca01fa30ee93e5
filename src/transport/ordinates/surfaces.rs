//! Light of surfaces that is about to be sent: from which cells, and about which normals.

use super::{Came, Group};

/// The cosine to an axis below which a surface stands along it, and its light meets what stands across.
const ALONGSIDE: f64 = 0.1;

/// What one side of a surface sends: `along`·max(0, n·u) along u [W/sr].
#[derive(Clone, Copy, Debug)]
pub(super) struct Side<T> {
    /// The number of its cell, x fastest.
    cell: u32,
    pub normal: [T; 3],
    pub along: T,
    /// By axis, whether it stands along it: its light meets what else stands across.
    pub beside: [bool; 3],
}

/// All such light, in the order in which it came.
#[derive(Clone, Debug)]
pub(super) struct Surfaces<T> {
    sides: Vec<Side<T>>,
}

impl<T> Default for Surfaces<T> {
    fn default() -> Self {
        Surfaces { sides: Vec::new() }
    }
}

impl<T: crate::sh::Real> Surfaces<T> {
    /// Adds the light of a side.
    pub fn push(&mut self, cell: usize, normal: [T; 3], along: T) {
        let beside = normal.map(|n| n.abs() < T::of(ALONGSIDE));
        self.sides.push(Side { cell: cell as u32, normal, along, beside });
    }

    pub fn clear(&mut self) {
        self.sides.clear();
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.sides.as_slice())
    }

    /// The same by cell, of n³; those of a cell in the order in which they came.
    pub fn by_cell(&mut self, n: usize) -> ByCell<'_, T> {
        if self.sides.is_empty() {
            return ByCell::none();
        }
        self.sides.sort_by_key(|side| side.cell);
        let mut starts = vec![0; n.pow(3) + 1];
        self.sides.iter().for_each(|side| starts[side.cell as usize + 1] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        ByCell { sides: &self.sides, starts }
    }
}

impl<T: crate::sh::Real> Group<T> {
    /// Adds what surfaces in a cell send of this group's light by its far faces: to `free` what nothing stands in the way
    /// of, to `meets` what goes along its own surface, and meets a second one that stands across it.
    #[inline(always)]
    pub(super) fn leave(&self, sides: &[Side<T>], free: &mut Came<T>, meets: &mut Came<T>) {
        for side in sides {
            let lambert = self.lambert(side.normal);
            for axis in 0..3 {
                let to = if side.beside[axis] { &mut meets[axis] } else { &mut free[axis] };
                for (l, to) in to.iter_mut().enumerate() {
                    *to += self.start[axis][l] * side.along * lambert[l];
                }
            }
        }
    }
}

/// [`Surfaces`] by cell.
#[derive(Debug)]
pub(super) struct ByCell<'a, T> {
    sides: &'a [Side<T>],
    /// Where those of each cell begin; empty where there are none at all.
    starts: Vec<u32>,
}

impl<T> ByCell<'_, T> {
    /// None.
    pub fn none() -> Self {
        ByCell { sides: &[], starts: Vec::new() }
    }

    /// The cells that have any, of n³; some more than once.
    pub fn cells(&self, n: usize) -> impl Iterator<Item = crate::field::Cell> {
        self.sides.iter().map(move |side| side.cell as usize).map(move |i| [i % n, i / n % n, i / (n * n)])
    }

    /// Those of the cell with this number.
    pub fn of(&self, cell: usize) -> &[Side<T>] {
        match self.starts.get(cell..cell + 2) {
            Some([start, end]) => &self.sides[*start as usize..*end as usize],
            _ => &[],
        }
    }
}
