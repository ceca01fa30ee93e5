//! The range of a plot's axis and where its labelled ticks stand, linear or by powers of ten.

use super::number::{power_of_ten, short};

/// Magnitudes beyond this are not drawn: the distance between two of them may not be a number any more.
const LARGEST: f64 = 1e300;

/// An axis: the values at its ends, and how they are spaced between.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    low: f64,
    high: f64,
    log: bool,
}

/// A mark on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Where, in the axis's own values.
    pub value: f64,
    /// What is written there; `None` for the small ticks between powers of ten.
    pub label: Option<String>,
}

impl Axis {
    /// Whether an axis can show a value: on a logarithmic one only numbers above zero have a place.
    pub fn shows(value: f64, log: bool) -> bool {
        value.abs() <= LARGEST && (!log || value >= 1.0 / LARGEST)
    }

    /// An axis that ends where its values end.
    pub fn tight(values: impl IntoIterator<Item = f64>) -> Self {
        let (low, high) = ends(values, false).unwrap_or((0.0, 1.0));
        let size = low.abs().max(high.abs());
        if high - low > 1e-9 * size {
            return Axis { low, high, log: false };
        }
        // A single value stands in the middle, no further from the ends than 1 where that can be told apart.
        let room = if size == 0.0 { 1.0 } else { (0.5 * size).min(1.0).max(1e-6 * size) };
        Axis { low: low - room, high: high + room, log: false }
    }

    /// An axis that ends at ticks; a linear one holds 0.
    pub fn rounded(values: impl IntoIterator<Item = f64>, log: bool) -> Self {
        let (low, high) = ends(values, log).unwrap_or(if log { (0.1, 1.0) } else { (0.0, 1.0) });
        if log {
            let (low, high) = (low.log10().floor(), high.log10().ceil());
            let low = if low == high { low - 1.0 } else { low };
            return Axis { low: 10f64.powf(low), high: 10f64.powf(high), log };
        }
        let (low, high) = (low.min(0.0), high.max(0.0));
        let high = if high > low { high } else { 1.0 };
        let step = nice_step((high - low) / 5.0);
        Axis { low: (low / step).floor() * step, high: (high / step - 1e-9).ceil() * step, log }
    }

    /// A value's place from 0, the low end, to 1.
    pub fn share(&self, value: f64) -> f64 {
        if self.log {
            (value.log10() - self.low.log10()) / (self.high.log10() - self.low.log10())
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// The ticks, from low to high, about `most` of them labelled.
    pub fn ticks(&self, most: usize) -> Vec<Tick> {
        let most = most.max(2);
        if self.log { self.log_ticks(most) } else { self.linear_ticks(most) }
    }

    fn linear_ticks(&self, most: usize) -> Vec<Tick> {
        let step = nice_step((self.high - self.low) / most as f64);
        let (first, last) = ((self.low / step - 1e-9).ceil(), (self.high / step + 1e-9).floor());
        let count = (last - first).max(0.0) as usize;
        let ticks = (0..=count).map(|k| {
            let value = (first + k as f64) * step;
            // As many digits as tell it from its neighbours.
            let digits = if value == 0.0 { 1.0 } else { value.abs().log10().floor() - step.log10().floor() + 1.0 };
            Tick { value, label: Some(short(value, digits.max(1.0) as usize)) }
        });
        ticks.collect()
    }

    fn log_ticks(&self, most: usize) -> Vec<Tick> {
        let (low, high) = (self.low.log10().round() as i32, self.high.log10().round() as i32);
        let decades = (high - low).max(1) as usize;
        let every = decades.div_ceil(most) as i32;
        let mut ticks = Vec::new();
        for exponent in low..=high {
            let decade = 10f64.powi(exponent);
            let name = || if decades == 1 { short(decade, 1) } else { power_of_ten(exponent) };
            let label = ((exponent - low) % every == 0).then(name);
            ticks.push(Tick { value: decade, label });
            if decades <= 3 && exponent < high {
                ticks.extend((2..10).map(|m| {
                    let label = decades == 1 && (m == 2 || m == 5);
                    let value = f64::from(m) * decade;
                    Tick { value, label: label.then(|| short(value, 1)) }
                }));
            }
        }
        ticks
    }
}

/// The least and the greatest of the values that can be shown.
fn ends(values: impl IntoIterator<Item = f64>, log: bool) -> Option<(f64, f64)> {
    let shown = values.into_iter().filter(|value| Axis::shows(*value, log));
    shown.fold(None, |ends, v| Some(ends.map_or((v, v), |(low, high): (f64, f64)| (low.min(v), high.max(v)))))
}

/// The least of 1, 2 and 5 times a power of ten that is not below `least`.
fn nice_step(least: f64) -> f64 {
    let decade = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|m| m * decade).into_iter().find(|step| *step >= least * (1.0 - 1e-9)).unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, most: usize) -> Vec<String> {
        axis.ticks(most).into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn linear_ticks_are_round_and_lie_within() {
        let axis = Axis::rounded([0.0, 9.43e-5], false);
        assert_eq!(labels(&axis, 6), ["0", "2×10⁻⁵", "4×10⁻⁵", "6×10⁻⁵", "8×10⁻⁵", "10⁻⁴"]);
        assert_eq!(labels(&Axis::tight([0.0, 32.0]), 7), ["0", "5", "10", "15", "20", "25", "30"]);
        assert_eq!(labels(&Axis::tight([99.5, 100.5]), 6), ["99.6", "99.8", "100", "100.2", "100.4"]);
        assert_eq!(labels(&Axis::rounded([-1.0, 1.0], false), 5), ["−1", "−0.5", "0", "0.5", "1"]);
    }

    #[test]
    fn log_ticks_are_powers_of_ten_and_only_positive_values_count() {
        let axis = Axis::rounded([0.0, -1.0, f64::NAN, f64::INFINITY, 3e-5, 0.2], true);
        assert_eq!(labels(&axis, 8), ["10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "1"]);
        assert!((axis.share(1e-5) - 0.0).abs() < 1e-12 && (axis.share(1.0) - 1.0).abs() < 1e-12);
        assert!((axis.share(10f64.powf(-2.5)) - 0.5).abs() < 1e-12);
        let one = Axis::rounded([0.3], true);
        assert_eq!(labels(&one, 8), ["0.1", "0.2", "0.5", "1"]);
    }

    #[test]
    fn any_values_make_an_axis_with_few_ticks() {
        let wild = [0.0, -0.0, 1.0, -1e300, 1e300, 1e-300, f64::MAX, f64::MIN_POSITIVE, f64::NAN, f64::INFINITY, 1e-12];
        for (a, b) in wild.into_iter().flat_map(|a| wild.map(|b| (a, b))) {
            for axis in [Axis::tight([a, b]), Axis::rounded([a, b], false), Axis::rounded([a, b], true)] {
                let ticks = axis.ticks(6);
                assert!(labels(&axis, 6).len() <= 8, "{a:e} {b:e}: {ticks:?}");
                for tick in ticks {
                    let share = axis.share(tick.value);
                    assert!((-1e-6..=1.000_001).contains(&share), "{a:e} {b:e}: {tick:?} at {share}");
                }
            }
        }
    }
}
