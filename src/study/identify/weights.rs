//! From weights to names: which scheme's weights they are, at which factor, or which mistake made them.
//!
//! A step's weights are far = p·Ω_far/4π and side = p·Ω_side/4π, with Ω_far = 4·asin(1/10) and Ω_side = (2π/3 −
//! Ω_far)/4 (000, 3.2.3). Their ratio tells the scheme or the mistake, their sum the factor: p = 6·(far + 4·side).

use std::f64::consts::PI;

use super::fit::Fit;
use super::port::{KINDS, Kind, Port};
use super::verdict::Estimate;
use crate::sh::K0;
use crate::transport::lattice::face::{far_solid_angle, side_solid_angle};
use crate::transport::lattice::scheme::Scheme;

/// A scheme's weights at factor 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nominal {
    /// The scheme's name.
    pub scheme: &'static str,
    /// The weight of the far face.
    pub far: f64,
    /// The weight of a side face; 0 where there are none.
    pub side: f64,
}

/// Schemes that read and put back in the same way and differ in weights alone.
#[derive(Clone, Debug)]
pub struct Base {
    /// How they read and put back.
    pub port: Port,
    /// Their weights.
    pub schemes: Vec<Nominal>,
}

/// The bases of some schemes, in their order. A scheme without sides joins the one whose far face it has.
pub fn bases(schemes: &[Scheme]) -> Vec<Base> {
    let mut bases: Vec<Base> = Vec::new();
    for scheme in schemes {
        let port = Port::of(scheme);
        let weight = |kind: Kind| {
            let tap = port.taps[0].iter().position(|tap| tap.kind == kind);
            tap.map_or(0.0, |i| scheme.faces[i].sampler.0[0] / K0)
        };
        let nominal = Nominal { scheme: scheme.name, far: weight(Kind::Far), side: weight(Kind::Side) };
        let holds = |base: &Base| (0..6).all(|d| port.taps[d].iter().all(|tap| base.port.taps[d].contains(tap)));
        match bases.iter_mut().find(|base| holds(base)) {
            Some(base) => base.schemes.push(nominal),
            None => bases.push(Base { port, schemes: vec![nominal] }),
        }
    }
    bases
}

/// What weights say.
#[derive(Clone, Debug)]
pub struct Reading {
    /// The scheme.
    pub scheme: &'static str,
    /// Its factor.
    pub factor: Estimate,
    /// side/far.
    pub ratio: Option<Estimate>,
    /// Mistakes of the weights, with what they are here.
    pub mistakes: Vec<(&'static str, String)>,
    /// What cannot be told.
    pub notes: Vec<String>,
    /// Whether the weights are those of a scheme or a known mistake.
    pub known: bool,
    /// The weights to go on with.
    pub weights: [f64; KINDS],
}

/// Ratios that are mistakes: id, side/far, its width and the weights it comes from in words.
fn wrong_ratios() -> [(&'static str, f64, f64, &'static str); 8] {
    let (far, side) = (far_solid_angle(), side_solid_angle());
    [
        ("digit-typo", 0.423_441_354_4 / far, 1e-7, "side/far 1.0568340"),
        ("equal-weights", 1.0, 1e-6, "side/far 1"),
        ("swapped-weights", far / side, 1e-5, "side/far 0.9462"),
        ("swapped-weights", 0.944_72, 1.5e-3, "side/far 0.9447, rounded"),
        ("four-digit-constants", 0.4234 / 0.4007, 1e-6, "weights 0.4007 and 0.4234"),
        ("four-digit-constants", 0.1348 / 0.1275, 1e-6, "weights 0.1275 and 0.1348"),
        ("four-digit-constants", 0.1347 / 0.1275, 1e-6, "weights 0.1275 and 0.1347"),
        ("four-digit-constants", 0.0337 / 0.0319, 1e-6, "weights 0.0319 and 0.0337"),
    ]
}

/// How finely dumps tell weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Finely enough for a wrong digit of a constant.
    Digits,
    /// Half precision of few lit cells: what would tell a digit are a few numbers near zero, whose errors are those of
    /// the port's arithmetic.
    Coarse,
}

impl Precision {
    /// How far a ratio of two constants of ten digits may be off, relative.
    fn ratio_error(self) -> f64 {
        match self {
            Precision::Digits => 3e-6,
            Precision::Coarse => 6e-5,
        }
    }
}

/// Factors that people use.
const USUAL: [f64; 6] = [1.0, 2.0, 3.0, 3.5, 3.8, 4.0];

/// Reads weights that were fitted on `base`; `others` are the schemes of all bases with the same faces. `mixed` is
/// the share of new light where old light is mixed in, 1 otherwise.
pub fn read(fit: &Fit, base: &Base, others: &[Nominal], mixed: f64, precision: Precision) -> Reading {
    let (far, side) = (fit.weight(Kind::Far), fit.weight(Kind::Side));
    let (far_error, side_error) = (fit.deviation(Kind::Far), fit.deviation(Kind::Side));
    let mut mistakes = Vec::new();
    let mut notes = Vec::new();
    let covariance = fit.covariance[Kind::Far as usize][Kind::Side as usize];
    let ratio = (far != 0.0 && fit.known[Kind::Side as usize]).then(|| {
        let ratio = side / far;
        let variance = side_error.powi(2) + (ratio * far_error).powi(2) - 2.0 * ratio * covariance;
        (ratio, variance.max(0.0).sqrt() / far.abs())
    });
    let is = |nominal: &Nominal, slack: f64| match ratio {
        None if !fit.known[Kind::Side as usize] => nominal.side == 0.0 || base.schemes.len() == 1,
        None => false,
        Some(_) if nominal.side == 0.0 => side.abs() <= 5.0 * side_error + 2e-6 * far.abs(),
        Some((ratio, error)) => {
            let right = nominal.side / nominal.far;
            (ratio - right).abs() <= (slack * error).max(precision.ratio_error() * right)
        }
    };
    // Weights that are no scheme's do not tell one: that which clamps every face is meant.
    let clamps_all = base.port.taps.iter().flatten().all(|tap| tap.clamp);
    let own = base.schemes[0];
    let first = if clamps_all { own } else { others.first().copied().unwrap_or(own) };
    let no_far = far.abs() <= 5.0 * far_error + 2e-6 * side.abs() && side.abs() > 5.0 * side_error;
    let mut candidates = base.schemes.iter().chain(others).filter(|_| !no_far);
    let found = candidates.find(|nominal| is(nominal, 5.0)).copied();
    let mut known = true;
    let nominal = if let Some(nominal) = found {
        if let Some((ratio, error)) = ratio.filter(|_| nominal.side > 0.0) {
            let typo = wrong_ratios()[0].1;
            let told = precision == Precision::Digits && (ratio - typo).abs() >= 5.0 * error;
            if !told && nominal.scheme == first.scheme {
                let text = "The wrong digit 0.4234413544 of the side angle cannot be told in this precision; the \
                            pattern `dense`, or single precision, would tell.";
                notes.push(text.to_owned());
            }
        }
        nominal
    } else if no_far {
        mistakes.push(("no-far-face", String::new()));
        Nominal { far: 0.0, ..first }
    } else {
        let matching = ratio.and_then(|(ratio, error)| {
            // Four digits show in single precision alone.
            let told = |id: &str| id != "four-digit-constants" || error < 2e-6;
            let near = |w: &(&str, f64, f64, &str)| told(w.0) && (ratio - w.1).abs() <= (5.0 * error).max(w.2 * w.1);
            wrong_ratios().into_iter().find(near)
        });
        if let Some((id, ratio, _, what)) = matching {
            mistakes.push((id, what.to_owned()));
            let sum = first.far + 4.0 * first.side;
            let far = sum / (1.0 + 4.0 * ratio);
            Nominal { far, side: far * ratio, ..first }
        } else {
            known = false;
            first
        }
    };
    let (factor, error) = factor(fit, &nominal, no_far);
    let factor = Estimate::of(factor / mixed, error / mixed);
    let mut weights = fit.weights;
    if known {
        weights[Kind::Far as usize] = nominal.far * factor.value * mixed;
        weights[Kind::Side as usize] = nominal.side * factor.value * mixed;
    }
    scaled(&factor, &nominal, far, &mut mistakes, &mut notes);
    let ratio = ratio.map(|(ratio, error)| Estimate::of(ratio, error));
    Reading { scheme: nominal.scheme, factor, ratio, mistakes, notes, known, weights }
}

/// The factor that fits both weights best, and one standard deviation.
fn factor(fit: &Fit, nominal: &Nominal, no_far: bool) -> (f64, f64) {
    let (far, side) = (fit.weight(Kind::Far), fit.weight(Kind::Side));
    let c = |a: Kind, b: Kind| fit.covariance[a as usize][b as usize];
    let [ff, fs, ss] = [c(Kind::Far, Kind::Far), c(Kind::Far, Kind::Side), c(Kind::Side, Kind::Side)];
    if no_far {
        return (side / nominal.side, ss.max(0.0).sqrt() / nominal.side);
    }
    let determinant = ff * ss - fs * fs;
    if nominal.side == 0.0 || !fit.known[Kind::Side as usize] || determinant <= 0.0 {
        return (far / nominal.far, ff.max(0.0).sqrt() / nominal.far);
    }
    // nᵀC⁻¹w / nᵀC⁻¹n, C the covariance of the two weights.
    let inverse = |a: [f64; 2], b: [f64; 2]| {
        (ss * a[0] * b[0] - fs * (a[0] * b[1] + a[1] * b[0]) + ff * a[1] * b[1]) / determinant
    };
    let n = [nominal.far, nominal.side];
    let precision = inverse(n, n);
    (inverse(n, [far, side]) / precision, precision.sqrt().recip())
}

/// Names factors that nobody means.
fn scaled(
    factor: &Estimate,
    nominal: &Nominal,
    far: f64,
    mistakes: &mut Vec<(&'static str, String)>,
    notes: &mut Vec<String>,
) {
    let p = factor.value;
    let ones = (far - 1.0).abs() < 1e-3 && mistakes.iter().any(|(id, _)| *id == "equal-weights");
    if p >= 0.75 * 4.0 * PI && !ones {
        mistakes.push(("not-over-4pi", format!("the factor is {:.4} times 4π", p / (4.0 * PI))));
    }
    // Wrong weights do not add up to the face's: the author's factor is that of the far face, or of the side's.
    let slack = if mistakes.is_empty() { 2e-6 } else { 3e-5 };
    let usual = |p: f64| USUAL.iter().any(|u| (p - u).abs() <= (factor.uncertainty * PI).max(slack * u));
    let sum = nominal.far + 4.0 * nominal.side;
    let swapped = (side_solid_angle() + 4.0 * far_solid_angle()) / (4.0 * PI);
    let meant = [1.0, sum / swapped];
    let round = ((p * 100.0).round() / 100.0 - p).abs() <= factor.uncertainty;
    if p < 1.3 && !round && meant.iter().any(|m| usual(p * PI * m)) {
        mistakes.push(("twice-over-pi", format!("the factor is {:.4} over π", p * PI)));
    }
    if nominal.scheme == "cascaded" && factor.holds(4.0) {
        notes.push("Factor 4 with solid angles over 4π and solid angles over π are the same numbers.".to_owned());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::lattice::schemes;

    fn fitted(far: f64, side: f64, error: f64) -> Fit {
        let mut fit = Fit {
            weights: [0.0; KINDS],
            known: [true; KINDS],
            covariance: [[0.0; KINDS]; KINDS],
            left: 0.0,
            total: 1.0,
            sums: Default::default(),
        };
        fit.weights[Kind::Far as usize] = far;
        fit.weights[Kind::Side as usize] = side;
        fit.covariance[Kind::Far as usize][Kind::Far as usize] = error * error;
        fit.covariance[Kind::Side as usize][Kind::Side as usize] = error * error;
        fit
    }

    #[test]
    fn weights_over_the_sphere_are_right_and_others_are_named() {
        let bases = bases(&schemes::all());
        let (far, side) = (far_solid_angle() / (4.0 * PI), side_solid_angle() / (4.0 * PI));
        let typo = 0.423_441_354_4 / (4.0 * PI);
        for (weights, ids) in [
            ([3.0 * far, 3.0 * side], vec![]),
            ([3.0 * far, 3.0 * typo], vec!["digit-typo"]),
            ([3.0 * side, 3.0 * far], vec!["swapped-weights"]),
            ([0.1, 0.1], vec!["equal-weights"]),
            ([12.0 * PI * far, 12.0 * PI * side], vec!["not-over-4pi"]),
            ([4.0 * far / PI, 4.0 * side / PI], vec!["twice-over-pi"]),
            ([0.0, 3.0 * side], vec!["no-far-face"]),
            ([0.5, 0.0], vec![]),
        ] {
            let reading =
                read(&fitted(weights[0], weights[1], 1e-9), &bases[0], &bases[1].schemes, 1.0, Precision::Digits);
            let found: Vec<_> = reading.mistakes.iter().map(|m| m.0).collect();
            assert_eq!(found, ids, "{weights:?}");
            assert!(reading.known);
        }
        let reading = read(&fitted(0.5, 0.0, 1e-9), &bases[0], &[], 1.0, Precision::Digits);
        assert_eq!(reading.scheme, "axial");
        assert!(reading.factor.holds(3.0));
        // A digit cannot be told where the error bars hold both.
        let reading = read(&fitted(3.0 * far, 3.0 * typo, 1e-5), &bases[0], &[], 1.0, Precision::Digits);
        assert!(reading.mistakes.is_empty() && reading.notes.len() == 1);
        assert!(!read(&fitted(0.1, 0.2, 1e-9), &bases[0], &[], 1.0, Precision::Digits).known);
    }
}
