//! Red, green and blue: three numbers that light does not mix.

/// Red, green and blue.
pub type Rgb = [f64; 3];

/// Colour by colour a + b.
pub fn add(a: Rgb, b: Rgb) -> Rgb {
    std::array::from_fn(|c| a[c] + b[c])
}

/// Colour by colour a·b.
pub fn times(a: Rgb, b: Rgb) -> Rgb {
    std::array::from_fn(|c| a[c] * b[c])
}
