//! Two pictures of one view: how far apart they are, in numbers and pixel by pixel.
//!
//! - RMSE: √(mean of (t − r)²) over pixels and colours, in radiance.
//! - relMSE: the mean of (t − r)²/(r² + 0.01·m²), m the reference's mean: an error counts by how bright its place is,
//!   and dark places do not blow up.
//! - [FLIP](flip): what is seen on a display, 0 to 1.
//!
//! Each as the pictures are and after the one scale of the indirect light i that makes the RMSE least,
//! Σ i·(r − d) / Σ i² with the direct light d: renderers scale light by taste, but not the light of lamps.

pub(crate) mod flip;

use crate::render::image::Image;
use crate::render::seen::Seen;

/// The share of the mean squared that relMSE adds to each divisor.
pub const FLOOR: f64 = 0.01;

/// How far a picture is from a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Root of the mean squared error, in radiance [W/(m²·sr)].
    pub rmse: f64,
    /// Mean squared error relative to the reference.
    pub rel_mse: f64,
    /// Mean FLIP, 0 to 1.
    pub flip: f64,
    /// The picture's mean over the reference's; not a number where both are dark.
    pub mean_ratio: f64,
}

/// A picture against a reference: as it is, and scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared {
    /// As it is.
    pub raw: Difference,
    /// With its indirect light times `scale`.
    pub fitted: Difference,
    /// What makes the RMSE least.
    pub scale: f64,
}

/// Compares what is seen of a volume's light with a reference of the same size; `exposure` is that of the display that
/// FLIP looks at.
pub fn compare(reference: &Image, seen: &Seen, exposure: f32) -> Compared {
    let scale = best_scale(reference, seen);
    Compared {
        raw: difference(reference, &seen.total(), exposure),
        fitted: difference(reference, &seen.scaled(scale), exposure),
        scale,
    }
}

/// One comparison, without a scale.
pub fn difference(reference: &Image, test: &Image, exposure: f32) -> Difference {
    let pairs = || pairs(reference, test);
    let count = pairs().count().max(1) as f64;
    let mean = |image: &Image| image.mean().iter().sum::<f64>() / 3.0;
    let floor = FLOOR * mean(reference).powi(2);
    let squared = pairs().map(|(r, t)| (t - r).powi(2)).sum::<f64>() / count;
    let relative =
        pairs().map(|(r, t)| if t == r { 0.0 } else { (t - r).powi(2) / (r * r + floor) }).sum::<f64>() / count;
    let map = flip::flip(reference, test, exposure, flip::PIXELS_A_DEGREE);
    Difference {
        rmse: squared.sqrt(),
        rel_mse: relative,
        flip: map.iter().sum::<f64>() / map.len().max(1) as f64,
        mean_ratio: mean(test) / mean(reference),
    }
}

/// The scale of the indirect light that makes the RMSE least; 1 where there is none.
fn best_scale(reference: &Image, seen: &Seen) -> f64 {
    let wanted = reference.zip(&seen.direct, |all, direct| all - direct);
    let sums = pairs(&wanted, &seen.indirect).fold((0.0, 0.0), |(p, s), (r, t)| (p + r * t, s + t * t));
    if sums.1 > 0.0 { sums.0 / sums.1 } else { 1.0 }
}

fn pairs<'a>(reference: &'a Image, test: &'a Image) -> impl Iterator<Item = (f64, f64)> {
    let numbers = |image: &'a Image| image.pixels().iter().flatten().map(|v| f64::from(*v));
    numbers(reference).zip(numbers(test))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Image {
        Image::from_fn([8, 8], |x, y| [x as f32 * 0.1, y as f32 * 0.05, 0.2])
    }

    fn seen(indirect: f32) -> Seen {
        Seen { direct: ramp().scaled(0.5), indirect: ramp().scaled(indirect) }
    }

    #[test]
    fn a_picture_is_no_different_from_itself() {
        let same = compare(&ramp(), &seen(0.5), 1.0);
        assert_eq!((same.raw.rmse, same.raw.rel_mse, same.raw.flip), (0.0, 0.0, 0.0));
        assert!((same.scale - 1.0).abs() < 1e-6 && (same.raw.mean_ratio - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_scale_of_the_indirect_light_is_found_and_taken_back() {
        let compared = compare(&ramp(), &seen(0.125), 1.0);
        assert!((compared.scale - 4.0).abs() < 1e-6 && compared.fitted.rmse < 1e-7);
        assert!((compared.raw.mean_ratio - 0.625).abs() < 1e-6 && compared.raw.flip > 0.0);
    }

    #[test]
    fn errors_of_even_pictures_have_their_closed_forms() {
        let [one, three] = [1.0f32, 3.0].map(|v| Image::from_fn([4, 4], |_, _| [v; 3]));
        let found = difference(&one, &three, 0.1);
        assert!((found.rmse - 2.0).abs() < 1e-12 && (found.rel_mse - 4.0 / 1.01).abs() < 1e-9);
        assert_eq!(found.mean_ratio, 3.0);
    }

    #[test]
    fn dark_pictures_are_alike() {
        let dark = Image::from_fn([4, 4], |_, _| [0.0; 3]);
        let compared = compare(&dark, &Seen { direct: dark.clone(), indirect: dark.clone() }, 1.0);
        assert_eq!((compared.raw.rmse, compared.raw.rel_mse, compared.scale), (0.0, 0.0, 1.0));
    }
}
