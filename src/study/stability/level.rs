//! One level of an octree by itself: the long-run growth of its light, and the factor it bears.

use super::{Borders, Start, growth};
use crate::scene::propagation::Policy;
use crate::transport::lattice::levels;
use crate::transport::lattice::scheme::Scheme;
use crate::transport::lattice::stencil::Stencil;

/// The largest side whose growth is computed; beyond it the law of large volumes is near enough.
const LARGEST_COMPUTED: usize = 32;
/// Halvings of the interval that holds a critical factor: to a millionth of it.
const HALVINGS: usize = 20;

/// What an iteration multiplies the light of an open level by, in the long run. From a lone cell all light
/// leaves. Beyond the computed sides λ(n) = λ(∞)·(1 − a/(n + b)²), as for diffusion between walls that lie
/// b/2 outside the volume; a and b fit the two largest computed sides.
pub fn long_run_growth(stencil: &Stencil<f64>, side: usize) -> f64 {
    let computed = |side| growth(stencil, Start::Arch, Borders::Open(side));
    match side {
        ..2 => 0.0,
        2..=LARGEST_COMPUTED => computed(side),
        _ => {
            let limit = without_borders(stencil);
            let [n0, n1] = [LARGEST_COMPUTED / 2, LARGEST_COMPUTED];
            let [m0, m1] = [n0, n1].map(|side| (1.0 - computed(side) / limit).sqrt());
            let (n0, n1, n) = (n0 as f64, n1 as f64, side as f64);
            let b = (n1 * m1 - n0 * m0) / (m0 - m1);
            let missing = m1 * (n1 + b) / (n + b);
            limit * (1.0 - missing * missing)
        }
    }
}

/// The growth without borders: that of a uniform field, which no other mode exceeds.
pub fn without_borders(stencil: &Stencil<f64>) -> f64 {
    stencil.uniform_gain().into_iter().fold(0.0, f64::max)
}

/// The factor above which the light of level `level`, of side `side`, grows; infinite where none does.
pub fn critical(scheme: &Scheme, clamp: bool, policy: Policy, level: usize, side: usize) -> f64 {
    let operator = |factor: f64| {
        let mut operators = levels::operators::<f64>(scheme, factor, clamp, policy, level + 1)?;
        Ok(operators.swap_remove(level).stencil)
    };
    // Where every level has the scheme's own operator its growth is the factor times that at p = 1.
    let refused = match policy {
        Policy::Same => return 1.0 / long_run_growth(&Stencil::new(scheme, 1.0, clamp), side),
        // Every exact level takes the steps of the finest level for its means, so it grows where that does.
        Policy::Exact | Policy::Ahead => {
            return 1.0 / long_run_growth(&Stencil::new(scheme, 1.0, clamp), side << level);
        }
        Policy::Consistent => match operator(f64::MAX.sqrt()) {
            Ok(_) => return 1.0 / long_run_growth(&Stencil::new(scheme, 1.0, clamp), side),
            Err(levels::TooLarge { limit, .. }) => limit,
        },
    };
    let grows = |factor| operator(factor).map_or(true, |stencil| long_run_growth(&stencil, side) > 1.0);
    let (mut low, mut high) = (0.0, refused);
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        if grows(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    (low + high) / 2.0
}

/// The factor above which the light of some level of an octree of side `size` grows.
pub fn critical_of_octree(scheme: &Scheme, policy: Policy, size: usize) -> f64 {
    let of = |level: usize| critical(scheme, true, policy, level, size >> level);
    (0..=size.ilog2() as usize).map(of).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::lattice::schemes::cascaded;

    #[test]
    fn large_volumes_continue_the_law_of_the_computed_ones() {
        let stencil = Stencil::new(&cascaded::scheme(), 1.0, true);
        let computed = growth(&stencil, Start::Arch, Borders::Open(64));
        let fitted = long_run_growth(&stencil, 64);
        assert!((fitted / computed - 1.0).abs() < 1e-4, "{fitted}, {computed}");
        assert!(long_run_growth(&stencil, 1024) < 0.25);
    }

    #[test]
    fn consistent_levels_are_critical_where_their_light_neither_grows_nor_fades() {
        let scheme = cascaded::scheme();
        for (level, side) in [(0, 4), (1, 4), (2, 2)] {
            let found = critical(&scheme, true, Policy::Consistent, level, side);
            let operators = levels::operators::<f64>(&scheme, found, true, Policy::Consistent, level + 1).unwrap();
            let growth = long_run_growth(&operators[level].stencil, side);
            assert!((growth - 1.0).abs() < 1e-3, "level {level}, {side}³: {found}, {growth}");
        }
        // In the 1³ level above 2³ light stays with probability 1/2: (1 − 1/2)·p/4 reaches 1 at p = 8.
        assert!((critical(&scheme, true, Policy::Consistent, 1, 1) - 8.0).abs() < 1e-4);
        assert!((critical_of_octree(&scheme, Policy::Consistent, 2) - 8.0).abs() < 1e-4);
        assert!((critical_of_octree(&scheme, Policy::Same, 2) / 9.53 - 1.0).abs() < 0.01);
    }
}
