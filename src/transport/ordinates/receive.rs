//! What surfaces receive of light that keeps its direction.
//!
//! f_k(u) is the flux of direction u that entered a surface's cell, of side s, by the face across axis k. The surface
//! has the unit normal n. What enters by that face is spread over s² of it, so across the beam it is f_k/(s²·|u_k|), and a
//! surface that this face looks at gets
//!
//! ```text
//! E = s⁻² · Σ_u max(0, −u·n) · Σ_{k: u_k·n_k < 0} n_k² · f_k(u)/|u_k| / Σ_{k: u_k·n_k < 0} n_k²
//! ```
//!
//! Only faces that look at the surface count, each by its share n_k²: a wall stands in its cell somewhere between two of
//! them, and what enters from the side passes along it, beside it or behind it. For a beam that fills all faces evenly
//! f_k/|u_k| is one number φ·s² whatever k is, and E = φ·max(0, −u·n).
//!
//! f_k is what comes in by the face or, where the surface stands on the border by which that light leaves its cell, what
//! is about to leave by it.
//!
//! A slanted surface covers a part of a face in one cell and the rest in the next. What the second gets has come through
//! the part o that the first leaves [open](Transmittance::open), so it is spread over o·s² and counts 1/o times.

use super::{Came, Group, LANES, Lanes};
use crate::field::Cell;
use crate::scene::receiver::Receiver;
use crate::sh::Real;
use crate::transport::transmittance::Transmittance;

/// Receivers that a thread takes at once.
pub(super) const PIECE: usize = 256;
/// Of less of a face than this nothing is concluded.
const LEAST_OPEN: f32 = 0.15;

/// Receivers made ready.
#[derive(Clone, Debug, Default)]
pub struct Facing {
    pub(super) all: Vec<Face>,
    /// Their numbers by cell, and where those of each cell begin: the cells x fastest.
    order: Vec<u32>,
    starts: Vec<u32>,
}

#[derive(Clone, Debug)]
pub(super) struct Face {
    pub cell: Cell,
    normal: [f64; 3],
    /// By octant of directions, for each axis what f_k/|u_k| counts: n_k²/o over the sum of n_k², 0 where no light comes
    /// from before the surface.
    shares: [[f32; 3]; 8],
    /// By axis, whether light comes to it where it leaves the cell ([`Transmittance::at_exit`]).
    at_exit: [bool; 3],
    /// The number of its cell among those of sheets.
    pub sheet: Option<usize>,
}

impl Facing {
    /// The receivers of a volume of n³ cells.
    pub fn new(n: usize, receivers: &[Receiver], occluders: Option<&Transmittance>) -> Self {
        let face = |receiver: &Receiver| {
            let normal = receiver.normal.to_array();
            let open = occluders.map_or([[1.0; 3]; 2], |occluders| occluders.open(receiver.cell));
            let shares = std::array::from_fn(|i| {
                let backwards = [0, 1, 2].map(|k| i >> k & 1 == 1);
                let before = [0, 1, 2].map(|k| if (normal[k] > 0.0) == backwards[k] { normal[k].powi(2) } else { 0.0 });
                let sum: f64 = before.iter().sum();
                [0, 1, 2].map(|k| {
                    let open = open[usize::from(backwards[k])][k].max(LEAST_OPEN);
                    if before[k] > 0.0 { (before[k] / sum) as f32 / open } else { 0.0 }
                })
            });
            let towards = [0, 1, 2].map(|k| normal[k] > 0.0);
            let at_exit = occluders.map_or([false; 3], |occluders| occluders.at_exit(receiver.cell, towards));
            let sheet = occluders.and_then(|occluders| occluders.sheet(receiver.cell));
            Face { cell: receiver.cell, normal, shares, at_exit, sheet }
        };
        let all: Vec<Face> = receivers.iter().map(face).collect();
        let number = |[x, y, z]: Cell| (z * n + y) * n + x;
        let mut order: Vec<u32> = (0..all.len() as u32).collect();
        order.sort_by_key(|i| number(all[*i as usize].cell));
        let mut starts = vec![0; if all.is_empty() { 0 } else { n.pow(3) + 1 }];
        all.iter().for_each(|face| starts[number(face.cell) + 1] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        Facing { all, order, starts }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        size_of_val(self.all.as_slice()) + size_of_val(self.order.as_slice()) + size_of_val(self.starts.as_slice())
    }

    /// Bytes that so many will take in a volume of n³ cells.
    pub fn bytes_of(n: usize, count: usize) -> u64 {
        let starts = if count == 0 { 0 } else { n.pow(3) + 1 };
        (count * (size_of::<Face>() + size_of::<u32>()) + starts * size_of::<u32>()) as u64
    }

    /// The numbers of those of the cell with this number.
    #[inline]
    pub(super) fn of(&self, cell: usize) -> &[u32] {
        match self.starts.get(cell..cell + 2) {
            Some([start, end]) => &self.order[*start as usize..*end as usize],
            _ => &[],
        }
    }

    /// Adds what some of a cell get of what came into it, and of what is about to leave it, in a group of directions.
    #[inline]
    pub(super) fn receive<T: Real>(
        &self,
        some: &[u32],
        backwards: [bool; 3],
        group: &Group<T>,
        came_and_left: [&Came<T>; 2],
        received: &mut [f64],
    ) {
        for i in some {
            received[*i as usize] += total(self.all[*i as usize].gets(backwards, group, came_and_left));
        }
    }
}

impl Face {
    /// Its irradiance times a cell's side squared, by direction of a group.
    #[inline]
    pub fn gets<T: Real>(&self, backwards: [bool; 3], group: &Group<T>, [came, left]: [&Came<T>; 2]) -> Lanes<T> {
        let normal = self.normal.map(T::of);
        let shares = self.shares[octant(backwards)].map(|share| T::of(f64::from(share)));
        let mut sum = [T::ZERO; LANES];
        for (l, sum) in sum.iter_mut().enumerate() {
            let way = [group.way[0][l], group.way[1][l], group.way[2][l]];
            let towards = T::ZERO - (way[0] * normal[0] + way[1] * normal[1] + way[2] * normal[2]);
            if towards <= T::ZERO {
                continue;
            }
            for k in 0..3 {
                if shares[k] > T::ZERO && way[k] * normal[k] < T::ZERO {
                    let flux = if self.at_exit[k] { left[k][l] } else { came[k][l] };
                    *sum += towards * shares[k] * flux / way[k].abs();
                }
            }
        }
        sum
    }
}

/// The number of an octant of directions.
fn octant(backwards: [bool; 3]) -> usize {
    backwards.into_iter().enumerate().map(|(k, backwards)| usize::from(backwards) << k).sum()
}

pub(super) fn total<T: Real>(lanes: Lanes<T>) -> f64 {
    lanes.iter().map(|lane| lane.to_f64()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Grid;
    use crate::scene::Solid;
    use crate::scene::propagation::directions::{Lattice, Rule};
    use crate::sh::{K0, Sh};
    use crate::transport::ordinates::Ordinates;
    use crate::transport::ordinates::stepper::Stepper;
    use glam::DVec3;

    /// A cell's c00 of 1 at (3, 4, 3), and what surfaces receive of it in so many steps.
    fn received(receivers: &[Receiver], walls: Option<&Transmittance>, steps: usize) -> (Vec<f64>, Grid<f32>) {
        let mut stepper = Stepper::<f32>::new(Ordinates::new(Lattice::Octahedral, 72, Rule::Faces), 8);
        stepper.inject([3, 4, 3], Sh([1.0, 0.0, 0.0, 0.0]));
        let (mut arrived, mut sums) = (Grid::new(8), vec![0.0; receivers.len()]);
        let receivers = Facing::new(8, receivers, walls);
        for _ in 0..steps {
            stepper.step(1.0, walls, &mut arrived);
            stepper.receive(&receivers, &mut sums);
        }
        (sums, arrived)
    }

    #[test]
    fn opaque_walls_around_a_volume_receive_all_that_is_sent() {
        // 2√π of c00 1; cells in edges and corners hold a piece of each of their walls.
        let mut receivers = Vec::new();
        for axis in 0..3 {
            for (at, sign) in [(0, 1.0), (7, -1.0)] {
                for i in 0..64 {
                    let mut cell = [0; 3];
                    (cell[axis], cell[(axis + 1) % 3], cell[(axis + 2) % 3]) = (at, i % 8, i / 8);
                    receivers.push(Receiver { cell, normal: DVec3::AXES[axis] * sign });
                }
            }
        }
        let walls: Vec<Solid> = receivers.iter().map(|r| Solid::new(r.cell, r.normal, 1.0, [0.0; 3])).collect();
        let sent = 2.0 * std::f64::consts::PI.sqrt();
        let sum: f64 = received(&receivers, Transmittance::new(8, &walls).as_ref(), 24).0.iter().sum();
        assert!((sum / sent - 1.0).abs() < 1e-4, "{sum}, {sent}");
    }

    #[test]
    fn a_surface_square_to_the_face_that_light_came_in_by_receives_its_flux_and_its_back_nothing() {
        let beside = |normal: DVec3| Receiver { cell: [4, 4, 3], normal };
        let (sums, arrived) = received(&[beside(DVec3::NEG_X), beside(DVec3::X), beside(DVec3::Y)], None, 1);
        let flux = f64::from(arrived.get([4, 4, 3]).0[0]) / K0;
        assert!(flux > 0.1 && (sums[0] / flux - 1.0).abs() < 1e-5, "{sums:?}, {flux}");
        // By the faces across y nothing came in this step.
        assert_eq!(sums[1..], [0.0, 0.0]);
    }
}
