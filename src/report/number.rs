//! Numbers as a reader of a paper wants them: few digits, powers of ten with raised exponents.

/// An exponent in raised digits: −3 is `⁻³`.
pub fn raised(exponent: i32) -> String {
    let raise = |digit| match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    };
    exponent.to_string().chars().map(raise).collect()
}

/// A power of ten: `10⁻³`; the first and zeroth are written out.
pub fn power_of_ten(exponent: i32) -> String {
    match exponent {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        _ => format!("10{}", raised(exponent)),
    }
}

/// A number in `digits` significant digits (at least 1), trailing zeros left out: `0.031`, `2.5×10⁻⁵`, `−12`.
///
/// ```
/// use lpv_lab::report::number::short;
///
/// assert_eq!(short(2.5e-5, 2), "2.5×10⁻⁵");
/// ```
pub fn short(value: f64, digits: usize) -> String {
    let Some((mantissa, exponent)) = rounded(value, digits) else { return special(value).to_owned() };
    let sign = if value < 0.0 { "−" } else { "" };
    match exponent {
        None => format!("{sign}{mantissa}"),
        Some(exponent) if mantissa == "1" => format!("{sign}{}", power_of_ten(exponent)),
        Some(exponent) => format!("{sign}{mantissa}×{}", power_of_ten(exponent)),
    }
}

/// The same in characters that a terminal has and other programs read: `0.031`, `2.5e-5`, `-12`.
///
/// ```
/// use lpv_lab::report::number::plain;
///
/// assert_eq!([plain(0.031_4, 2), plain(-0.0, 3), plain(2.5e-5, 2)], ["0.031", "0", "2.5e-5"]);
/// ```
pub fn plain(value: f64, digits: usize) -> String {
    let Some((mantissa, exponent)) = rounded(value, digits) else { return special(value).to_owned() };
    let sign = if value < 0.0 { "-" } else { "" };
    exponent.map_or_else(|| format!("{sign}{mantissa}"), |exponent| format!("{sign}{mantissa}e{exponent}"))
}

/// What stands for a number that has no digits.
fn special(value: f64) -> &'static str {
    match value {
        f64::INFINITY => "∞",
        f64::NEG_INFINITY => "−∞",
        _ => "undefined",
    }
}

/// The magnitude's digits, and the power of ten where that is too small or large to write out.
fn rounded(value: f64, digits: usize) -> Option<(String, Option<i32>)> {
    if value == 0.0 {
        return Some(("0".to_owned(), None));
    }
    let digits = digits.max(1);
    // Rounded before its size is looked at: 0.9996 in three digits is 1.
    let scientific = value.is_finite().then(|| format!("{:.*e}", digits - 1, value.abs()))?;
    let (mantissa, exponent) = scientific.split_once('e')?;
    let power: i32 = exponent.parse().ok()?;
    if (-3..5).contains(&power) {
        let decimals = (digits as i32 - 1 - power).max(0) as usize;
        let value: f64 = scientific.parse().ok()?;
        Some((trimmed(&format!("{value:.decimals$}")).to_owned(), None))
    } else {
        Some((trimmed(mantissa).to_owned(), Some(power)))
    }
}

fn trimmed(number: &str) -> &str {
    if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_right() {
        for (value, digits, expected) in [
            (0.0, 2, "0"),
            (1.0, 2, "1"),
            (100.0, 2, "100"),
            (0.031_4, 2, "0.031"),
            (0.3, 3, "0.3"),
            (0.999_6, 3, "1"),
            (-12.04, 3, "−12"),
            (123.4, 2, "120"),
            (2.5e-5, 2, "2.5×10⁻⁵"),
            (1e-7, 3, "10⁻⁷"),
            (-6.02e23, 3, "−6.02×10²³"),
            (f64::NAN, 2, "undefined"),
        ] {
            assert_eq!(short(value, digits), expected, "{value} in {digits}");
        }
    }

    #[test]
    fn plain_numbers_can_be_read_by_programs() {
        for (value, text) in [(-2.5e-5, "-2.5e-5"), (1e-7, "1e-7"), (0.031, "0.031"), (6.02e23, "6.02e23")] {
            assert_eq!(plain(value, 3), text);
            assert_eq!(text.parse(), Ok(value));
        }
        assert_eq!((short(f64::NEG_INFINITY, 2), plain(f64::INFINITY, 2)), ("−∞".to_owned(), "∞".to_owned()));
    }

    #[test]
    fn exponents_are_raised() {
        assert_eq!(power_of_ten(-10), "10⁻¹⁰");
        assert_eq!((power_of_ten(0), power_of_ten(1)), ("1".to_owned(), "10".to_owned()));
    }
}
