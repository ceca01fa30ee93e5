//! Leaves that fuzzy occluders touch: a matrix for every face, and one for what stays.
//!
//! [`super::blockers`] has the step. Here it is put into the form of the other leaves: a part D that stays in the leaf
//! and a part from each of its neighbours.

use glam::DMat4;

use super::blockers::{Blockers, norm};
use super::decay::Decay;
use super::meeting::{Beyond, Face};
use crate::field::Cell;
use crate::sh::{Real, Sh};
use crate::transport::lattice::face::Direction;

/// What a leaf's residence may be at most, times that of the longest of all leaves without occluders.
pub(super) const LONGEST: f64 = 4.0;

/// A leaf that fuzzy occluders touch. Places are those in the planes of a level.
#[derive(Clone, Copy, Debug)]
pub struct Touched<T> {
    pub(super) at: u32,
    /// What lies beyond each face, in the order of [`Direction::ALL`].
    pub(super) beyond: [Beyond; 6],
    /// Where, as in [`super::leaves::Seam`].
    pub(super) sides: [u32; 6],
    /// What comes in through each face.
    pub(super) shares: [Matrix<T>; 6],
    /// What stays: D in step, nothing ahead.
    pub(super) stays: Matrix<T>,
    /// What a source is multiplied with: 1 in step, (I − D)⁻¹ ahead.
    pub(super) residence: Matrix<T>,
}

/// A 4×4 matrix by columns.
#[derive(Clone, Copy, Debug)]
pub struct Matrix<T>([Sh<T>; 4]);

impl<T: Real> Matrix<T> {
    fn new(matrix: DMat4) -> Self {
        Matrix(matrix.to_cols_array_2d().map(|column| Sh(column).cast()))
    }

    #[inline(always)]
    pub(super) fn times(&self, Sh([c, x, y, z]): Sh<T>) -> Sh<T> {
        let [of_c, of_x, of_y, of_z] = self.0;
        (of_c * c + of_x * x) + (of_y * y + of_z * z)
    }
}

/// What touched leaves of a level have in common.
pub(super) struct Around<'a> {
    pub(super) blockers: &'a Blockers,
    pub(super) decay: &'a Decay,
    pub(super) level: usize,
    /// If light that stays is to be summed up at once, the longest that it resides in a leaf that nothing touches.
    pub(super) residence: Option<f64>,
}

impl Around<'_> {
    /// A cell, its place being `at`; `None` where nothing touches it.
    pub(super) fn leaf<T: Real>(&self, cell: Cell, at: u32, faces: &[Face; 6]) -> Option<Touched<T>> {
        let means = self.blockers.means(self.level, cell)?;
        let width = |level: usize| f64::from(1u32 << level);
        let h = width(self.level);
        let mut stays: DMat4 = means.inside.iter().sum();
        let mut shares = [DMat4::ZERO; 6];
        for (d, (face, share)) in faces.iter().zip(&mut shares).enumerate() {
            let leaves = means.inside[d];
            let enters = means.entering[Direction::ALL[d].opposite().index()];
            if face.beyond == Beyond::Dark {
                stays -= leaves * (self.decay.border(h) / h);
                continue;
            }
            let other = width(face.beyond.level(self.level));
            let planes = self.decay.face(h, other);
            let area = h.min(other).powi(2) / h.powi(3);
            let gained = |[own, beyond]: [f64; 2]| (enters * beyond - leaves * own) * area;
            let [[own_own, own_beyond], [beyond_own, beyond_beyond]] = [planes.left, planes.right];
            stays += gained([own_own, beyond_own]) * face.beyond.count() as f64;
            *share = gained([own_beyond, beyond_beyond]);
        }
        let (residence, stays) = match self.residence.and_then(|longest| sum(stays, LONGEST * longest)) {
            Some(residence) => (residence, DMat4::ZERO),
            None => (DMat4::IDENTITY, stays),
        };
        Some(Touched {
            at,
            beyond: faces.each_ref().map(|face| face.beyond),
            sides: faces.each_ref().map(|face| face.place),
            shares: shares.map(|share| Matrix::new(residence * share)),
            stays: Matrix::new(stays),
            residence: Matrix::new(residence),
        })
    }
}

/// I + D + D² + …, if that is a number and not above `most`: mirrors may send more around in a leaf than ever leaves it.
/// Such a leaf takes one step at a time, to the same end if there is one.
fn sum(stays: DMat4, most: f64) -> Option<DMat4> {
    let sum = (DMat4::IDENTITY - stays).inverse();
    let mut power = stays;
    (0..24).for_each(|_| power *= power);
    let settles = norm(&power) < 1.0;
    (settles && norm(&sum) <= most).then_some(sum)
}
