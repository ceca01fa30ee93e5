//! The lines and numbers of the plots' axes: whole iterations, powers of ten.

use egui_plot::{GridInput, GridMark};

/// The lines of the axis of iterations: whole numbers, one, two or five times a power of ten apart.
pub fn iterations_apart(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let wanted = (high - low) / 8.0;
    if !wanted.is_finite() || wanted <= 0.0 {
        return Vec::new();
    }
    let step = round_step(wanted).max(1.0);
    let places = (low / step).ceil() as i64..=(high / step).floor() as i64;
    // The spacing tells the plot how bold a line is and whether its number has room.
    places.map(|i| GridMark { value: i as f64 * step, step_size: 10.0 * input.base_step_size.max(step) }).collect()
}

/// The lines of an axis that holds logarithms: one for each power of ten, fewer where they would crowd, its double
/// and fivefold where there is room, and round numbers within a single one.
pub fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    // What is called the base step takes eight points, a number thirty.
    let step = (4.0 * input.base_step_size).ceil().max(1.0);
    if !(low.is_finite() && high.is_finite()) || (high - low) / step > 1000.0 {
        return Vec::new();
    }
    let values: Vec<f64> = if high - low < 1.0 {
        let (least, most) = (10f64.powf(low), 10f64.powf(high));
        let step = round_step((most - least) / 5.0);
        let places = (least / step).ceil() as i64..=(most / step).floor() as i64;
        places.map(|i| (i as f64 * step).log10()).collect()
    } else {
        let between: &[f64] = if high - low < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let powers = (low / step).floor() as i64..=(high / step).floor() as i64;
        powers.flat_map(|i| between.iter().map(move |part| i as f64 * step + part.log10())).collect()
    };
    let inside = values.into_iter().filter(|value| (low..=high).contains(value));
    inside.map(|value| GridMark { value, step_size: 10.0 * input.base_step_size.max(step) }).collect()
}

/// The least of 1, 2 and 5 times a power of ten that is not below `wanted`.
fn round_step(wanted: f64) -> f64 {
    let power = 10f64.powf(wanted.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|part| part * power).into_iter().find(|step| *step >= wanted).unwrap_or(wanted)
}

/// A number on an axis, from its logarithm; the window's fonts have no raised minus.
pub fn from_logarithm(exponent: f64) -> String {
    let value = 10f64.powf(exponent);
    if (0.0099..1000.0).contains(&value) {
        // Three digits tell the lines apart; zeros at their end do not.
        let digits = (2.0 - exponent.floor()).clamp(0.0, 4.0) as usize;
        let text = format!("{value:.digits$}");
        return match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            false => text,
        };
    }
    let power = (exponent + 1e-9).floor();
    format!("{}e{power}", (10f64.powf(exponent - power) * 100.0).round() / 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stand_at_round_numbers() {
        let apart = |high| iterations_apart(GridInput { bounds: (-0.2, high), base_step_size: 0.01 });
        assert_eq!(apart(5.2).iter().map(|mark| mark.value).collect::<Vec<_>>(), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(
            apart(33.0).iter().map(|mark| mark.value).collect::<Vec<_>>(),
            [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0]
        );
        let marks = decades(GridInput { bounds: (-3.2, 0.4), base_step_size: 0.2 });
        assert_eq!(marks.iter().map(|mark| mark.value).collect::<Vec<_>>(), [-3.0, -2.0, -1.0, 0.0]);
        let narrow = decades(GridInput { bounds: (0.71f64.log10(), 0.93f64.log10()), base_step_size: 0.01 });
        let narrow: Vec<String> = narrow.iter().map(|mark| from_logarithm(mark.value)).collect();
        assert_eq!(narrow, ["0.75", "0.8", "0.85", "0.9"]);
    }

    #[test]
    fn numbers_are_as_short_as_tells_them_apart() {
        for (value, text) in
            [(1e-12, "1e-12"), (5e-3, "5e-3"), (0.01, "0.01"), (0.5, "0.5"), (1.0, "1"), (20.0, "20"), (2e4, "2e4")]
        {
            assert_eq!(from_logarithm(f64::log10(value)), text);
        }
    }
}
