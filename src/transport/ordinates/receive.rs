//! What surfaces receive of light that keeps its direction.
//!
//! f_k(u) is the flux of direction u that entered a surface's cell, of side s, by the face across axis k. The surface
//! has the unit normal n. What enters by that face is spread over s² of it, so across the beam it is f_k/(s²·|u_k|), and a
//! surface that this face looks at gets
//!
//! ```text
//! E = s⁻² · Σ_u max(0, −u·n) · Σ_{k: u_k·n_k < 0} n_k² · f_k(u)/|u_k|
//! ```
//!
//! Only faces that look at the surface count, each by its share n_k² (the shares sum to 1): a wall stands in its cell
//! somewhere between two of them, and what enters from the side passes along it, beside it or behind it. For a beam
//! that fills all faces evenly f_k/|u_k| is one number φ·s², and E = φ·max(0, −u·n) but for the k that are left out,
//! those by which none of the beam comes from before the surface.

use rayon::prelude::*;

use super::LANES;
use super::stepper::Stepper;
use crate::scene::receiver::Receiver;
use crate::sh::Real;

/// Receivers that a thread takes at once.
const PIECE: usize = 256;

impl<T: Real> Stepper<T> {
    /// Adds to each receiver's number what came to it in the last step: its irradiance times a cell's side squared.
    pub fn receive(&self, receivers: &[Receiver], received: &mut [f64]) {
        let pieces = receivers.par_chunks(PIECE).zip(received.par_chunks_mut(PIECE));
        pieces.for_each(|(receivers, received)| {
            for (receiver, received) in receivers.iter().zip(received) {
                *received += self.comes_to(receiver);
            }
        });
    }

    fn comes_to(&self, receiver: &Receiver) -> f64 {
        let normal = receiver.normal.to_array().map(T::of);
        let mut sum = [T::ZERO; LANES];
        for (group, came) in self.arrivals(receiver.cell) {
            for (l, sum) in sum.iter_mut().enumerate() {
                let way = [group.way[0][l], group.way[1][l], group.way[2][l]];
                let towards = T::ZERO - (way[0] * normal[0] + way[1] * normal[1] + way[2] * normal[2]);
                if towards <= T::ZERO {
                    continue;
                }
                for k in 0..3 {
                    if way[k] * normal[k] < T::ZERO {
                        *sum += towards * normal[k] * normal[k] * came[k][l] / way[k].abs();
                    }
                }
            }
        }
        sum.iter().map(|lane| lane.to_f64()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Grid;
    use crate::scene::Solid;
    use crate::scene::propagation::directions::{Lattice, Rule};
    use crate::sh::{K0, Sh};
    use crate::transport::ordinates::Ordinates;
    use crate::transport::transmittance::Transmittance;
    use glam::DVec3;

    /// A cell's c00 of 1 at (3, 4, 3), and what surfaces receive of it in so many steps.
    fn received(receivers: &[Receiver], walls: Option<&Transmittance>, steps: usize) -> (Vec<f64>, Grid<f32>) {
        let mut stepper = Stepper::<f32>::new(Ordinates::new(Lattice::Octahedral, 72, Rule::Faces), 8);
        stepper.inject([3, 4, 3], Sh([1.0, 0.0, 0.0, 0.0]));
        let (mut arrived, mut sums) = (Grid::new(8), vec![0.0; receivers.len()]);
        for _ in 0..steps {
            stepper.step(1.0, walls, &mut arrived);
            stepper.receive(receivers, &mut sums);
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
