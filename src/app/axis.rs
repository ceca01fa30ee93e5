//! The lines and numbers of the plots' axes: whole iterations, powers of ten.

use egui_plot::{GridInput, GridMark};

/// The lines of the axis of iterations: whole numbers, one, two or five times a power of ten apart.
pub fn iterations_apart(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let wanted = (high - low) / 8.0;
    if !wanted.is_finite() || wanted <= 0.0 {
        return Vec::new();
    }
    let power = 10f64.powf(wanted.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|part| part * power).into_iter().find(|step| *step >= wanted);
    let step = step.unwrap_or(1.0).max(1.0);
    let places = (low / step).ceil() as i64..=(high / step).floor() as i64;
    // The spacing tells the plot how bold a line is and whether its number has room.
    places.map(|i| GridMark { value: i as f64 * step, step_size: 10.0 * input.base_step_size.max(step) }).collect()
}

/// The lines of a logarithmic axis: one for each power of ten, fewer where they would crowd, and its double
/// and fivefold where there is room.
pub fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let step = input.base_step_size.ceil().max(1.0);
    if !(low.is_finite() && high.is_finite()) || (high - low) / step > 1000.0 {
        return Vec::new();
    }
    let between: &[f64] = if high - low < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let powers = (low / step).floor() as i64..=(high / step).floor() as i64;
    let marks = powers.flat_map(|i| between.iter().map(move |part| i as f64 * step + part.log10()));
    marks.filter(|value| (low..=high).contains(value)).map(|value| GridMark { value, step_size: step }).collect()
}

/// A number on an axis, from its logarithm; the window's fonts have no raised minus.
pub fn power_of_ten(exponent: f64) -> String {
    let power = (exponent + 1e-9).floor();
    let part = 10f64.powf(exponent - power).round();
    format!("{part}e{power}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stand_at_round_numbers() {
        assert_eq!(power_of_ten(-12.0), "1e-12");
        assert_eq!(power_of_ten(5f64.log10() - 3.0), "5e-3");
        let apart = |high| iterations_apart(GridInput { bounds: (-0.2, high), base_step_size: 0.01 });
        assert_eq!(apart(5.2).iter().map(|mark| mark.value).collect::<Vec<_>>(), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(
            apart(33.0).iter().map(|mark| mark.value).collect::<Vec<_>>(),
            [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0]
        );
        let marks = decades(GridInput { bounds: (-3.2, 0.4), base_step_size: 0.2 });
        assert_eq!(marks.iter().map(|mark| mark.value).collect::<Vec<_>>(), [-3.0, -2.0, -1.0, 0.0]);
    }
}
