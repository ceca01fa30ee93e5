//! Numbers on the command line, refused in words where they are none.

/// A decimal number; what is out of its range is told by whoever takes it.
///
/// # Errors
/// Where it is none; a decimal comma is named as what it is.
pub fn decimal(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| match with_point(text) {
        Some(point) => format!("decimals stand after a point here, write {point}"),
        None => "this should be a number such as 0.5".to_owned(),
    })
}

/// A whole number, zero or more.
///
/// # Errors
/// Where it is none.
pub fn whole(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| "this should be a whole number, zero or more, of usual size".to_owned())
}

/// What a number with a decimal comma is with a point.
fn with_point(text: &str) -> Option<String> {
    let point = text.replacen(',', ".", 1);
    (point != text && point.parse::<f64>().is_ok()).then_some(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_commas_are_named() {
        assert_eq!(decimal("-3.5"), Ok(-3.5));
        assert_eq!(decimal("3,5"), Err("decimals stand after a point here, write 3.5".to_owned()));
        for text in ["", "x", "1,2,3", "3.5,1"] {
            assert_eq!(decimal(text), Err("this should be a number such as 0.5".to_owned()), "{text}");
        }
        assert_eq!(whole("12"), Ok(12));
        assert!(["-1", "1.5", "", "99999999999999999999"].iter().all(|text| whole(text).is_err()));
    }
}
