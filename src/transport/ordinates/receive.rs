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
    use crate::scene::propagation::ordinates::{Lattice, Rule};
    use crate::sh::Sh;
    use crate::transport::ordinates::Ordinates;
    use glam::DVec3;

    /// What six faces of one cell receive of all light that comes by.
    fn received(injected: &[([usize; 3], Sh<f32>)], receivers: &[Receiver]) -> Vec<f64> {
        let mut stepper = Stepper::<f32>::new(Ordinates::new(Lattice::Octahedral, 72, Rule::Faces), 8);
        injected.iter().for_each(|(cell, light)| stepper.inject(*cell, *light));
        let (mut arrived, mut sums) = (Grid::new(8), vec![0.0; receivers.len()]);
        for _ in 0..24 {
            stepper.step(1.0, None, &mut arrived);
            stepper.receive(receivers, &mut sums);
        }
        sums
    }

    #[test]
    fn walls_around_a_volume_receive_all_that_is_sent() {
        // A cell's c00 of 1 sends 2√π; the cells at the border receive it on their inner side, if they hold walls.
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
        let sent = 2.0 * std::f64::consts::PI.sqrt();
        let sum: f64 = received(&[([3, 4, 3], Sh([1.0, 0.0, 0.0, 0.0]))], &receivers).iter().sum();
        // What runs along a wall's last layer of cells and leaves by its side is not received: rays at a slant.
        assert!(sum > 0.85 * sent && sum <= 1.0001 * sent, "{sum}, {sent}");
    }

    #[test]
    fn a_distant_point_gives_intensity_times_cosine_over_the_square() {
        // 1/(2√π) W/sr to all sides, six cells off, straight and at a slant.
        let intensity = f64::from(Sh([1.0f64, 0.0, 0.0, 0.0]).eval(DVec3::X));
        let source = ([1, 1, 1], Sh([1.0, 0.0, 0.0, 0.0]));
        for (cell, normal) in [
            ([7, 1, 1], DVec3::NEG_X),
            ([7, 1, 1], DVec3::new(-0.8, 0.6, 0.0)),
            ([6, 6, 6], DVec3::NEG_ONE.normalize()),
            ([6, 4, 1], DVec3::NEG_X),
        ] {
            let receivers: Vec<Receiver> = vec![Receiver { cell, normal }, Receiver { cell, normal: -normal }];
            let found = received(&[source], &receivers);
            let offset = DVec3::from_array(cell.map(|c| c as f64 - 1.0));
            let wanted = intensity * -offset.normalize().dot(normal) / offset.length_squared();
            // The rays of 72 directions are as far apart as that.
            assert!((found[0] / wanted - 1.0).abs() < 0.35, "{cell:?} {normal}: {found:?}, {wanted}");
            assert_eq!(found[1], 0.0, "nothing from behind");
        }
    }
}
