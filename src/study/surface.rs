//! What a volume's light gives to surfaces, against what truly reaches them.
//!
//! Over all patches i of a mesh's surface with areas a, and colours, with F the found and E the true irradiance of
//! reflected light:
//!
//! - mean ratio: Σ a·F / Σ a·E;
//! - L1: Σ a·|F − E| / Σ a·E, as it is and with F multiplied by the scale that makes it least;
//! - correlation of F and E, weighted by area (Pearson's): 1 where they differ by a scale and a constant alone;
//! - noise: Σ a·σ / Σ a·E, σ the error bar of E: what of the L1 may be the truth's own error.

use crate::render::rgb::Rgb;
use crate::render::surface::{Lit, Patches};

/// How far the light of surfaces is from the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surfaces {
    /// All found light over all true light.
    pub mean_ratio: f64,
    /// The L1 error.
    pub l1: f64,
    /// The L1 error after the scale that fits best.
    pub l1_fitted: f64,
    /// That scale.
    pub scale: f64,
    /// Correlation of found and true light; 0 where one of them does not vary.
    pub correlation: f64,
    /// The truth's own error, as an L1.
    pub noise: f64,
}

/// Compares the irradiance found for each patch with the truth.
pub fn compare(patches: &Patches, found: &[Rgb], truth: &Lit) -> Surfaces {
    let terms = (0..patches.all().len().min(found.len())).flat_map(|i| {
        let (expected, deviation) = (truth.indirect(i), truth.deviation(i));
        (0..3).map(move |c| Term {
            area: patches.all()[i].area,
            found: found[i][c],
            expected: expected[c],
            deviation: deviation[c],
        })
    });
    of(&terms.collect::<Vec<Term>>())
}

/// One colour of one patch.
#[derive(Clone, Copy, Debug)]
struct Term {
    area: f64,
    found: f64,
    expected: f64,
    deviation: f64,
}

fn of(terms: &[Term]) -> Surfaces {
    let sum = |of: &dyn Fn(&Term) -> f64| terms.iter().map(|term| term.area * of(term)).sum::<f64>();
    let (found, expected) = (sum(&|t| t.found), sum(&|t| t.expected));
    // Where both are dark there is no error; where only the truth is, it is without end.
    let over = |difference: f64| if difference == 0.0 { 0.0 } else { difference / expected };
    let l1 = |scale: f64| over(sum(&|t| (scale * t.found - t.expected).abs()));
    let scale = best_scale(terms);
    Surfaces {
        mean_ratio: found / expected,
        l1: l1(1.0),
        l1_fitted: l1(scale),
        scale,
        correlation: correlation(terms),
        noise: over(sum(&|t| t.deviation)),
    }
}

/// The scale s with the least Σ a·|s·F − E|: the median of E/F, each weighing a·F. 1 where all that is found is dark.
fn best_scale(terms: &[Term]) -> f64 {
    let mut ratios: Vec<(f64, f64)> =
        terms.iter().filter(|t| t.found > 0.0).map(|t| (t.expected / t.found, t.area * t.found)).collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * ratios.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut below = 0.0;
    for (ratio, weight) in ratios {
        below += weight;
        if below >= half {
            return ratio;
        }
    }
    1.0
}

fn correlation(terms: &[Term]) -> f64 {
    let area: f64 = terms.iter().map(|t| t.area).sum();
    let mean = |of: &dyn Fn(&Term) -> f64| terms.iter().map(|t| t.area * of(t)).sum::<f64>() / area;
    let (found, expected) = (mean(&|t| t.found), mean(&|t| t.expected));
    let together = mean(&|t| (t.found - found) * (t.expected - expected));
    let spread = (mean(&|t| (t.found - found).powi(2)) * mean(&|t| (t.expected - expected).powi(2))).sqrt();
    if spread > 0.0 { together / spread } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terms(pairs: &[(f64, f64, f64)]) -> Vec<Term> {
        pairs.iter().map(|&(area, found, expected)| Term { area, found, expected, deviation: 0.1 * expected }).collect()
    }

    #[test]
    fn a_multiple_of_the_truth_is_no_error_after_its_scale() {
        let found = of(&terms(&[(1.0, 0.5, 2.0), (3.0, 0.25, 1.0), (0.5, 1.0, 4.0)]));
        assert!((found.scale - 4.0).abs() < 1e-12 && found.l1_fitted < 1e-12);
        assert!((found.l1 - 0.75).abs() < 1e-12 && (found.mean_ratio - 0.25).abs() < 1e-12);
        assert!((found.correlation - 1.0).abs() < 1e-12 && (found.noise - 0.1).abs() < 1e-12);
    }

    #[test]
    fn no_other_scale_is_better_than_the_best() {
        let terms = terms(&[(1.0, 0.5, 2.0), (3.0, 0.7, 1.0), (0.5, 1.0, 0.0), (2.0, 0.0, 1.0), (1.0, 0.2, 0.3)]);
        let at = |scale: f64| terms.iter().map(|t| t.area * (scale * t.found - t.expected).abs()).sum::<f64>();
        let best = at(best_scale(&terms));
        assert!((0..400).all(|i| at(f64::from(i) / 100.0) >= best - 1e-12));
    }

    #[test]
    fn the_truth_has_no_error_and_darkness_all() {
        let same = of(&terms(&[(1.0, 2.0, 2.0), (1.0, 3.0, 3.0)]));
        assert_eq!((same.l1, same.scale, same.mean_ratio), (0.0, 1.0, 1.0));
        let dark = of(&terms(&[(1.0, 0.0, 2.0), (2.0, 0.0, 3.0)]));
        assert_eq!((dark.l1, dark.l1_fitted, dark.scale, dark.correlation), (1.0, 1.0, 1.0, 0.0));
        let both = of(&terms(&[(1.0, 0.0, 0.0)]));
        assert_eq!((both.l1, both.noise), (0.0, 0.0));
    }

    #[test]
    fn a_patch_counts_by_its_area() {
        let found = of(&terms(&[(1.0, 0.0, 1.0), (9.0, 1.0, 1.0)]));
        assert!((found.l1 - 0.1).abs() < 1e-12);
    }
}
