//! The 48 symmetries of the cube.

use lpv_lab::field::Cell;
use lpv_lab::sh::Sh;

/// One of them: a permutation of the axes, then a reflection of some of them.
#[derive(Clone, Copy, Debug)]
pub struct Symmetry {
    order: [usize; 3],
    flip: [bool; 3],
}

impl Symmetry {
    /// All 48.
    pub fn all() -> impl Iterator<Item = Symmetry> {
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        orders.into_iter().flat_map(|order| {
            (0..8).map(move |bits| Symmetry { order, flip: std::array::from_fn(|a| bits >> a & 1 == 1) })
        })
    }

    /// Where it takes a cell whose coordinates go from 0 to `last`.
    pub fn cell(self, cell: Cell, last: usize) -> Cell {
        std::array::from_fn(|a| {
            let c = cell[self.order[a]];
            if self.flip[a] { last - c } else { c }
        })
    }

    /// What it makes of a vector.
    pub fn vector(self, v: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| {
            let c = v[self.order[a]];
            if self.flip[a] { -c } else { c }
        })
    }

    /// What it makes of a function on the sphere.
    pub fn light(self, light: Sh<f64>) -> Sh<f64> {
        let [x, y, z] = self.vector(light.vector().to_array());
        Sh([light.0[0], x, y, z])
    }
}
