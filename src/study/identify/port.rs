//! A port as data: for each direction of travel the ways by which light goes to the neighbour, what lies beyond the
//! border, and in which order cells are updated. The lab's schemes become ports here, and a mistake is a change of
//! one ([`super::catalogue`]).
//!
//! One step of a port is linear in the few numbers that its author typed in, the weights of far and side faces:
//!
//! ```text
//! S₁(x) = Σ_d Σ_taps w(tap) · max(0, read · S₀(x − d)) · lobe  +  own · S₀(x)
//! ```
//!
//! so a step is computed as one grid for each kind of weight ([`Columns`]), and least squares finds the weights.

use super::light::{Light, is_lit};
use crate::field::Cell;
use crate::sh::{K0, Sh};
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::scheme::Scheme;

/// The kinds of weight that a step is linear in.
pub const KINDS: usize = 6;

/// Which weight multiplies a contribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Through the far face.
    Far,
    /// Through a side face.
    Side,
    /// Back through the shared face, which no scheme does.
    Near,
    /// The cell's own c00 stays.
    Own0,
    /// The cell's own direction part stays.
    Own1,
    /// The light of one neighbour is copied.
    Copied,
}

/// A way by which light of a cell goes to its neighbour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// Which weight it has.
    pub kind: Kind,
    /// The axis about which a right port puts the light back, as an index of [`Direction::ALL`].
    pub face: usize,
    /// What the cell's light is multiplied with, before the weight.
    pub read: Sh<f64>,
    /// What one unit adds to the neighbour.
    pub lobe: Sh<f64>,
    /// Whether a negative flux counts as none.
    pub clamp: bool,
}

/// What a cell at the border reads beyond it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Border {
    /// Nothing.
    Dark,
    /// The border cell itself.
    Edge,
    /// The cell at the other end of the row.
    Wrap,
    /// Slices lie side by side in one picture: along the first axis the row runs over into the next slice of the
    /// second axis.
    Flat(usize, usize),
}

/// In which order cells are updated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// All at once, from the old grid.
    AtOnce,
    /// One after the other in one grid, so that neighbours already updated are read; for each axis whether the
    /// sweep runs upwards.
    Sweep([bool; 3]),
    /// First the cells of this parity of x + y + z, then the others from the new ones.
    Chessboard(usize),
}

impl Order {
    /// Whether the neighbour at `other` is updated before the cell at `cell`.
    fn is_before(self, other: Cell, cell: Cell) -> bool {
        match self {
            Order::AtOnce => false,
            // With any nesting of the loops the axis along which two neighbours differ decides.
            Order::Sweep(up) => (0..3).any(|a| if up[a] { other[a] < cell[a] } else { other[a] > cell[a] }),
            Order::Chessboard(first) => {
                let parity = |c: Cell| (c[0] + c[1] + c[2]) % 2;
                parity(cell) != first && parity(other) == first
            }
        }
    }
}

/// A port: how one step goes, but for the weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Port {
    /// For each of [`Direction::ALL`], in which light travels, its taps.
    pub taps: [Vec<Tap>; 6],
    /// What lies beyond the border.
    pub border: Border,
    /// The order of updates.
    pub order: Order,
    /// Whether every neighbour's place holds the cell itself.
    pub reads_itself: bool,
    /// The neighbour whose light is copied, as an index of [`Direction::ALL`].
    pub copied: Option<usize>,
}

/// A step for each weight: what the receiving cell gets at weight one.
pub type Columns = [[f64; 4]; KINDS];

impl Port {
    /// The port that does what a scheme says.
    pub fn of(scheme: &Scheme) -> Port {
        let taps = Direction::ALL.map(|d| {
            let turned = scheme.faces.iter().map(|face| {
                let sampler = d.turn_sh(face.sampler);
                let lobe = d.turn_sh(face.lobe);
                let axis = Direction::ALL.iter().position(|a| a.vector().dot(lobe.vector()) > 0.5).unwrap_or(0);
                let far = Direction::ALL[axis] == d;
                // Schemes that read alike must read the same numbers, whatever weight was divided out.
                let read = Sh((sampler * (K0 / sampler.0[0])).0.map(|c| (c * 1e14).round() / 1e14));
                Tap { kind: if far { Kind::Far } else { Kind::Side }, face: axis, read, lobe, clamp: face.clamp }
            });
            turned.collect()
        });
        Port { taps, border: Border::Dark, order: Order::AtOnce, reads_itself: false, copied: None }
    }

    /// The cell at whose light a receiver looks for what travels in direction `d`.
    pub fn sender(&self, receiver: Cell, d: usize, side: usize) -> Option<Cell> {
        if self.reads_itself {
            return Some(receiver);
        }
        let back = Direction::ALL[d].opposite();
        if let Some(cell) = back.neighbour(receiver, side) {
            return Some(cell);
        }
        let mut cell = receiver;
        let axis = back.axis();
        match self.border {
            Border::Dark => None,
            Border::Edge => Some(cell),
            Border::Wrap => {
                cell[axis] = if back.is_positive() { 0 } else { side - 1 };
                Some(cell)
            }
            Border::Flat(row, slice) if row == axis => {
                cell[axis] = if back.is_positive() { 0 } else { side - 1 };
                let next = if back.is_positive() { cell[slice] + 1 } else { cell[slice].checked_sub(1)? };
                (next < side).then_some(())?;
                cell[slice] = next;
                Some(cell)
            }
            Border::Flat(..) => None,
        }
    }

    /// What each weight brings to a cell in one step from `before`; cells that the order of updates puts first are
    /// read from `after`. `None` where nothing reaches it.
    pub fn columns(&self, before: &Light, after: &Light, receiver: Cell) -> Option<Columns> {
        let mut columns = [[0.0; 4]; KINDS];
        let mut reached = false;
        for (d, taps) in self.taps.iter().enumerate() {
            let Some(sender) = self.sender(receiver, d, before.side()) else { continue };
            let read_from = if self.order.is_before(sender, receiver) { after } else { before };
            let light = read_from.get(sender);
            if !is_lit(&light) {
                continue;
            }
            reached = true;
            for tap in taps {
                let flux = Sh(light).dot(tap.read);
                if tap.clamp && flux <= 0.0 {
                    continue;
                }
                for (sum, c) in columns[tap.kind as usize].iter_mut().zip(tap.lobe.0) {
                    *sum += flux * c;
                }
            }
        }
        let [c00, x, y, z] = if self.reads_itself { [0.0; 4] } else { before.get(receiver) };
        columns[Kind::Own0 as usize] = [c00, 0.0, 0.0, 0.0];
        columns[Kind::Own1 as usize] = [0.0, x, y, z];
        reached |= is_lit(&[c00, x, y, z]);
        let copied = self.copied.and_then(|d| Direction::ALL[d].neighbour(receiver, before.side()));
        if let Some(from) = copied {
            columns[Kind::Copied as usize] = before.get(from);
            reached |= is_lit(&before.get(from));
        }
        reached.then_some(columns)
    }

    /// One step with the given weights.
    pub fn step(&self, weights: &[f64; KINDS], before: &Light) -> Light {
        let side = before.side();
        let mut after = Light::dark(side);
        for receiver in self.order.cells(side) {
            if let Some(columns) = self.columns(before, &after, receiver) {
                let i = after.index(receiver);
                after.cells_mut()[i] = weighted(weights, &columns);
            }
        }
        after
    }

    /// The port that adds magnitudes where this one adds signed light: it carries errors.
    pub fn of_errors(&self) -> Port {
        let mut port = self.clone();
        for tap in port.taps.iter_mut().flatten() {
            tap.read = Sh(tap.read.0.map(f64::abs));
            tap.lobe = Sh(tap.lobe.0.map(f64::abs));
            tap.clamp = false;
        }
        port
    }
}

/// The columns added up with their weights.
pub fn weighted(weights: &[f64; KINDS], columns: &Columns) -> [f64; 4] {
    std::array::from_fn(|c| weights.iter().zip(columns).map(|(w, column)| w * column[c]).sum())
}

impl Order {
    /// All cells in the order in which they are updated.
    fn cells(self, side: usize) -> Vec<Cell> {
        let along = |up: bool, i: usize| if up { i } else { side - 1 - i };
        let [up_x, up_y, up_z] = if let Order::Sweep(up) = self { up } else { [true; 3] };
        let rows = (0..side).flat_map(|z| (0..side).map(move |y| (y, z)));
        let all = rows.flat_map(|(y, z)| (0..side).map(move |x| [along(up_x, x), along(up_y, y), along(up_z, z)]));
        let mut cells: Vec<Cell> = all.collect();
        if let Order::Chessboard(first) = self {
            cells.sort_by_key(|c| (c[0] + c[1] + c[2]) % 2 != first);
        }
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::lattice::schemes;
    use crate::transport::lattice::stencil::Stencil;

    #[test]
    fn a_port_of_a_scheme_steps_as_the_scheme_does() {
        for scheme in schemes::all() {
            let port = Port::of(&scheme);
            let weight = |kind| {
                let is = |far: bool| (kind == Kind::Far) == far;
                scheme.faces.iter().find(|f| is(f.lobe.0[1] > 0.5)).map_or(0.0, |f| f.sampler.0[0] / K0)
            };
            let mut weights = [0.0; KINDS];
            weights[Kind::Far as usize] = 3.0 * weight(Kind::Far);
            weights[Kind::Side as usize] = 3.0 * weight(Kind::Side);
            let stencil = Stencil::<f64>::new(&scheme, 3.0, true);
            let light = Sh([0.9, 0.7, -0.2, 0.4]);
            let mut before = Light::dark(3);
            before.add([1, 1, 1], light);
            let after = port.step(&weights, &before);
            for (d, direction) in Direction::ALL.iter().enumerate() {
                let Some(cell) = direction.neighbour([1, 1, 1], 3) else { panic!() };
                for (found, wanted) in after.get(cell).iter().zip(stencil.send(d, light).0) {
                    assert!((found - wanted).abs() < 1e-14, "{} {d}: {found} {wanted}", scheme.name);
                }
            }
        }
    }

    #[test]
    fn rows_run_over_where_the_border_says_so() {
        let mut port = Port::of(&schemes::all()[0]);
        assert_eq!(port.sender([0, 1, 1], 0, 4), None);
        port.border = Border::Edge;
        assert_eq!(port.sender([0, 1, 1], 0, 4), Some([0, 1, 1]));
        port.border = Border::Wrap;
        assert_eq!(port.sender([0, 1, 1], 0, 4), Some([3, 1, 1]));
        port.border = Border::Flat(0, 2);
        assert_eq!(port.sender([0, 1, 1], 0, 4), Some([3, 1, 0]));
        assert_eq!(port.sender([3, 1, 1], 1, 4), Some([0, 1, 2]));
        assert_eq!(port.sender([3, 1, 3], 1, 4), None);
        assert_eq!(port.sender([1, 0, 1], 2, 4), None);
    }
}
