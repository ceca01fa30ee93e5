//! What hard occluders let through, cell by cell.

use crate::field::Cell;
use crate::scene::{Problem, Solid};

/// How much of the light that enters a cell of an n³ volume goes on.
#[derive(Clone, Debug, PartialEq)]
pub struct Transmittance {
    n: usize,
    passes: Vec<[f32; 3]>,
}

impl Transmittance {
    /// What the occluders of `problem` let through; `None` where nothing stands in light's way.
    pub fn of(problem: &Problem) -> Option<Self> {
        if problem.has_occluders() { Transmittance::new(problem.size, &problem.solids) } else { None }
    }

    /// What `blockers` let through: 1 − opacity each, by axis; `None` if there are none.
    pub fn new(n: usize, solids: &[Solid]) -> Option<Self> {
        if solids.is_empty() {
            return None;
        }
        let mut passes = vec![[1.0; 3]; n.pow(3)];
        for blocker in solids {
            let [x, y, z] = blocker.cell;
            passes[(z * n + y) * n + x] = blocker.opacity.map(|opacity| 1.0 - opacity as f32);
        }
        Some(Transmittance { n, passes })
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.passes.as_slice())
    }

    /// The shares that pass a cell of what enters it by its faces across x, y and z, each 0 to 1.
    #[inline]
    pub fn at(&self, [x, y, z]: Cell) -> [f32; 3] {
        self.passes[(z * self.n + y) * self.n + x]
    }

    /// The least of them: for light whose way through the cell nobody follows.
    #[inline]
    pub fn least(&self, cell: Cell) -> f32 {
        self.at(cell).into_iter().fold(1.0, f32::min)
    }
}
