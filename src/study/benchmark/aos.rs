//! The baseline: the cascaded scheme as it is usually written, an array of four-component vectors, a loop
//! over cells, neighbours and faces, a test for the border.

use glam::Vec4;

use crate::sh::Sh;
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::stencil::Stencil;

/// An n³ volume as an array of structures.
pub struct Aos {
    n: usize,
    source: Vec<Vec4>,
    target: Vec<Vec4>,
    sum: Vec<Vec4>,
    /// For each direction the faces: what light is multiplied with, and what a unit of flux adds.
    faces: [Vec<(Vec4, Vec4)>; 6],
}

impl Aos {
    /// A dark volume for a scheme all of whose faces are clamped.
    pub fn new(n: usize, stencil: &Stencil<f32>) -> Self {
        let vector = |Sh(c): Sh<f32>| Vec4::from_array(c);
        let faces = stencil
            .taps()
            .each_ref()
            .map(|taps| taps.iter().map(|tap| (vector(tap.sampler), vector(tap.lobe))).collect());
        let dark = || vec![Vec4::ZERO; n.pow(3)];
        Aos { n, source: dark(), target: dark(), sum: dark(), faces }
    }

    /// Gives every cell of the source this light.
    pub fn fill(&mut self, Sh(light): Sh<f32>) {
        self.source.fill(Vec4::from_array(light));
        self.sum.fill(Vec4::ZERO);
    }

    /// One iteration.
    pub fn step(&mut self) {
        let n = self.n;
        for z in 0..n {
            for y in 0..n {
                for x in 0..n {
                    let mut received = Vec4::ZERO;
                    for (direction, faces) in Direction::ALL.iter().zip(&self.faces) {
                        let Some([x, y, z]) = direction.opposite().neighbour([x, y, z], n) else { continue };
                        let light = self.source[(z * n + y) * n + x];
                        for &(sampler, lobe) in faces {
                            received += lobe * light.dot(sampler).max(0.0);
                        }
                    }
                    let here = (z * n + y) * n + x;
                    self.target[here] = received;
                    self.sum[here] += received;
                }
            }
        }
        std::mem::swap(&mut self.source, &mut self.target);
    }

    /// The light of a cell.
    #[cfg(test)]
    pub fn light(&self, [x, y, z]: [usize; 3]) -> Sh<f32> {
        Sh(self.source[(z * self.n + y) * self.n + x].to_array())
    }

    /// Bytes of memory it holds.
    pub fn bytes(&self) -> usize {
        3 * size_of_val(self.source.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Grid;
    use crate::transport::lattice::kernel::plain;
    use crate::transport::lattice::schemes;

    #[test]
    fn it_is_the_same_propagation() {
        let stencil = Stencil::new(&schemes::find("cascaded").unwrap(), 3.0, true);
        let light = Sh([1.0, 0.4, -0.2, 0.1]);
        let (mut aos, mut source, mut target) = (Aos::new(8, &stencil), Grid::new(8), Grid::new(8));
        aos.fill(light);
        source.layout().cells().for_each(|cell| source.set(cell, light));
        for _ in 0..3 {
            aos.step();
            plain::propagate(&stencil, &source, &mut target);
            std::mem::swap(&mut source, &mut target);
        }
        for (cell, light) in source.iter() {
            assert!((aos.light(cell) - light).max_norm() < 1e-6, "{cell:?}");
        }
    }
}
