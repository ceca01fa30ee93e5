//! How the operator changes with the level of an octree.
//!
//! The thesis propagates every level alike, so light fades by the cell, not by the distance, and levels
//! do not agree; it leaves open what each level's factor should be (000, 7.1). [`Policy::Consistent`] is
//! an answer with nothing to tune. It has two parts.
//!
//! **The operator.** Let P = Σ_d shift_d·M_d be one step of the finest level, M_d the 4×4 share of the
//! neighbour in direction d, and T = Σ_d M_d, which symmetry makes diagonal: the gains of the mean and of
//! the direction part of a uniform field. A cell of level i is 2^i finest cells wide. Let its light be
//! spread evenly in it, and let one finest step be taken: of what goes in direction d only the layer next
//! to that side leaves, θ = 2^−i of all, and the rest stays. So, averaged over the cell, one finest step is
//!
//! ```text
//! P_i = (1 − θ)·T + θ·Σ_d shift_d·M_d                     θ = 2^−i
//! ```
//!
//! exactly: it is the Galerkin product of P with averaging and its transpose. Its light in all,
//! A = S + P_i·A, is found in fewer steps if what stays is summed at once. With R = (I − (1 − θ)·T)⁻¹,
//! the time that light resides in a cell before it leaves,
//!
//! ```text
//! A = R·S + R·θ·Σ_d shift_d·M_d·A
//! ```
//!
//! which is the same fixed point by a stencil of the same shape and cost: every lobe that arrives is
//! multiplied by θ·R, a number for each band. Injected light is multiplied by R.
//!
//! **Where it takes over.** Just injected light is not spread evenly. It sits on a wall or in one cell, it
//! has a direction, and the clamp acts on it: all that an average forgets. One step later it has passed
//! the clamp, lost most of its direction and crossed the borders it was next to. So light takes its first
//! step on the level where it is, and what has moved is what the next level takes over; that level takes
//! the first step with it, and hands down what moved. With s_0 = S_0, a_0 = S_A and P' = θ·Σ_d shift_d·M_d
//! of the level that the light comes from,
//!
//! ```text
//! s_i = R_i · mean of children( P'·s_(i−1) )         a_i = mean of children( a_(i−1) ) + s_i
//! ```
//!
//! It costs one more step of each level but the last, once, when the light is downsampled; iterations
//! cost what they did. The coarser levels are then one step ahead of the finer ones.

use super::scheme::Scheme;
use super::stencil::Stencil;
use crate::field::{Grid, mean_of_children};
use crate::scene::propagation::Policy;
use crate::sh::{Real, Sh};

/// A factor so large that light inside a coarse cell would grow for ever before it leaves.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "factor {factor} is too large for consistent levels: on level {level} light would grow inside a cell \
     for ever; use a factor below {limit:.3}, fewer levels, or the same factor on all levels"
)]
pub struct TooLarge {
    /// The factor asked for.
    pub factor: f64,
    /// The first level that has no operator.
    pub level: usize,
    /// Factors below this have one on every level.
    pub limit: f64,
}

/// What propagates one level.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelOperator<T> {
    /// One iteration of the level.
    pub stencil: Stencil<T>,
    /// R of the level: what light that comes to rest in a cell is multiplied with, for c00 and for the
    /// direction part; 1 where every level has the same operator.
    pub residence: [f64; 2],
}

/// The operator of each of `count` levels, the finest first.
pub fn operators<T: Real>(
    scheme: &Scheme,
    factor: f64,
    clamp: bool,
    policy: Policy,
    count: usize,
) -> Result<Vec<LevelOperator<T>>, TooLarge> {
    let gain = Stencil::<f64>::new(scheme, factor, clamp).uniform_gain();
    (0..count)
        .map(|level| {
            let leaving = match policy {
                // Exact levels have operators of another form: see `super::exact`.
                Policy::Same | Policy::Exact | Policy::Ahead => 1.0,
                Policy::Consistent => 0.5f64.powi(level as i32),
            };
            let staying = gain.map(|g| (1.0 - leaving) * g);
            if staying.iter().any(|s| *s >= 1.0) {
                let largest_stay = 1.0 - 0.5f64.powi(count as i32 - 1);
                let limit = factor / (gain[0].max(gain[1]) * largest_stay);
                return Err(TooLarge { factor, level, limit });
            }
            let residence = staying.map(|s| 1.0 / (1.0 - s));
            let stencil = Stencil::scaled(scheme, residence.map(|r| factor * leaving * r), clamp)
                .reflecting(residence.map(|r| leaving * r));
            Ok(LevelOperator { stencil, residence })
        })
        .collect()
}

/// Sets `coarser` to the light that a level takes over: the mean of what `moved` in one step of the next
/// finer level, amplified by the residence of the coarser level, `to`, in place of the finer one's, `from`.
pub fn hand_down<T: Real>(from: [f64; 2], to: [f64; 2], moved: &Grid<T>, coarser: &mut Grid<T>) {
    let [band0, band1] = [0, 1].map(|band| T::of(to[band] / from[band]));
    for cell in coarser.layout().cells() {
        let Sh([c00, x, y, z]) = mean_of_children(moved, cell);
        coarser.set(cell, Sh([c00 * band0, x * band1, y * band1, z * band1]));
    }
}

#[cfg(test)]
mod tests {
    use super::super::kernel::plain;
    use super::super::schemes::cascaded;
    use super::*;
    use crate::field::downsample_into;
    use glam::DVec3;

    /// Spreads every cell's light evenly over its eight children.
    fn spread(coarse: &Grid<f64>) -> Grid<f64> {
        let mut fine = Grid::new(2 * coarse.side());
        for cell in fine.layout().cells() {
            fine.set(cell, coarse.get(cell.map(|c| c / 2)));
        }
        fine
    }

    fn some_light(n: usize) -> Grid<f64> {
        let mut grid = Grid::new(n);
        grid.set([0, 1, 2], Sh::lobe(DVec3::new(0.6, 0.0, -0.8)) + Sh([1.0, 0.0, 0.0, 0.0]));
        grid.set([1, 1, 3], Sh([0.8, -0.1, 0.3, 0.2]));
        grid
    }

    #[test]
    fn the_operator_is_one_fine_step_of_evenly_spread_light_and_the_residence_sums_what_stays() {
        let (scheme, factor) = (cascaded::scheme(), 3.0);
        let levels = operators::<f64>(&scheme, factor, false, Policy::Consistent, 3).unwrap();
        let fine = Stencil::<f64>::new(&scheme, factor, false);
        for (level, operator) in levels.iter().enumerate() {
            let light = some_light(4);
            // One fine step of the same light spread evenly over the cells of the finest level.
            let mut moved = light.clone();
            (0..level).for_each(|_| moved = spread(&moved));
            let mut next = Grid::new(moved.side());
            plain::propagate(&fine, &moved, &mut next);
            for _ in 0..level {
                let mut mean = Grid::new(next.side() / 2);
                downsample_into(&next, &mut mean);
                next = mean;
            }
            // (I − (1−θ)T)·R·θ·M must be θ·M, and what stays (1−θ)·T.
            let mut left = Grid::new(4);
            plain::propagate(&operator.stencil, &light, &mut left);
            for cell in light.layout().cells() {
                for (c, wanted) in next.get(cell).0.iter().enumerate() {
                    let residence = operator.residence[usize::from(c > 0)];
                    let stayed = (1.0 - 1.0 / residence) * light.get(cell).0[c];
                    let found = left.get(cell).0[c] / residence + stayed;
                    assert!((found - wanted).abs() < 1e-14, "level {level}, {cell:?}: {found}, {wanted}");
                }
            }
        }
    }

    #[test]
    fn the_finest_level_is_the_scheme_itself_and_same_repeats_it() {
        let scheme = cascaded::scheme();
        let plain = Stencil::<f32>::new(&scheme, 3.8, true);
        let consistent = operators::<f32>(&scheme, 3.8, true, Policy::Consistent, 6).unwrap();
        assert_eq!(consistent[0].stencil, plain);
        for operator in operators::<f32>(&scheme, 3.8, true, Policy::Same, 6).unwrap() {
            assert_eq!((operator.stencil, operator.residence), (plain.clone(), [1.0; 2]));
        }
    }

    #[test]
    fn uniform_light_adds_up_alike_on_every_level() {
        // Without borders Σ over all steps of uniform light is S/(1 − g), whatever the level.
        for operator in operators::<f64>(&cascaded::scheme(), 3.0, false, Policy::Consistent, 6).unwrap() {
            let gain = operator.stencil.uniform_gain();
            assert!((operator.residence[0] / (1.0 - gain[0]) - 1.0 / (1.0 - 0.75)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_factor_that_grows_inside_a_cell_is_refused_with_one_that_does_not() {
        let scheme = cascaded::scheme();
        let refused = operators::<f64>(&scheme, 4.5, true, Policy::Consistent, 6).unwrap_err();
        assert_eq!(refused.level, 4); // 15/16 · 1.125 > 1 > 7/8 · 1.125
        assert!(operators::<f64>(&scheme, refused.limit * 0.999, true, Policy::Consistent, 6).is_ok());
        assert!(operators::<f64>(&scheme, refused.limit * 1.001, true, Policy::Consistent, 6).is_err());
        assert!(operators::<f64>(&scheme, 4.5, true, Policy::Same, 6).is_ok());
    }
}
