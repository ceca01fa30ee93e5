//! The difference between two pictures as somebody sees it who flips between them.
//!
//! FLIP (Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild 2020, "FLIP: a difference evaluator for
//! alternating images"), for pictures that are ready for a display. Two pipelines meet:
//!
//! - *Colour*: the eye's contrast sensitivity blurs both pictures in an opponent colour space (Y C_x C_z); then their
//!   distance in L*a*b*, a* and b* scaled by L* (Hunt's effect), is
//!
//!   ```text
//!   h = (|ΔL| + √(Δa² + Δb²))^0.7
//!   ```
//!
//!   bent so that what lies below 0.4 of the greatest (green to blue) takes up 0.95 of the range: ΔE_c.
//! - *Features*: first and second derivatives of a Gaussian, half of 0.082 degrees wide, find edges and points; with
//!   e and p the lengths of their two answers, ΔE_f = √(max(|e − e'|, |p − p'|)/√2).
//!
//! The difference of a pixel is ΔE_c^(1 − ΔE_f): 0 alike, 1 as far apart as green and blue.

use rayon::prelude::*;

use crate::render::image::Image;

/// Pixels a degree of a picture that is looked at from 0.7 m on a screen of 0.7 m and 3840 pixels: the published
/// default, 67.02.
pub const PIXELS_A_DEGREE: f64 = 3840.0 * std::f64::consts::PI / 180.0;

/// The exponent of colour distances.
const COLOUR_POWER: f64 = 0.7;
/// Which share of the greatest distance takes up which share of the range.
const BEND: [f64; 2] = [0.4, 0.95];
/// The width of features that are seen, in degrees.
const FEATURE: f64 = 0.082;
/// How far Gaussians are followed, in standard deviations.
const REACH: f64 = 3.0;
/// Contrast sensitivity of the three opponent channels as Gaussians of the frequency, a·exp(−b·f²): (a, b) [1, degree²].
const SENSITIVITY: [&[[f64; 2]]; 3] = [&[[1.0, 0.0047]], &[[1.0, 0.0053]], &[[34.1, 0.04], [13.5, 0.025]]];

/// Linear sRGB to CIE XYZ (ITU-R BT.709 primaries, D65).
const TO_XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// The inverse of [`TO_XYZ`].
const FROM_XYZ: [[f64; 3]; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_929_926, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];

/// For each pixel the difference, 0 to 1, row by row. Radiance is multiplied by `exposure` and cut off at 1, as a
/// display shows it; both pictures are of one size.
pub fn flip(reference: &Image, test: &Image, exposure: f32, pixels_a_degree: f64) -> Vec<f64> {
    let pictures = [reference, test].map(|image| Opponent::of(image, exposure));
    let colours = [0, 1].map(|i| pictures[i].seen(pixels_a_degree));
    let features = [0, 1].map(|i| pictures[i].features(pixels_a_degree));
    let greatest = distance(lab([0.0, 1.0, 0.0]), lab([0.0, 0.0, 1.0]));
    (0..reference.pixels().len().min(test.pixels().len()))
        .map(|i| {
            let colour = bend(distance(colours[0][i], colours[1][i]), greatest);
            let [edge, point] = [0, 1].map(|kind| (features[0][i][kind] - features[1][i][kind]).abs());
            let feature = (edge.max(point) / std::f64::consts::SQRT_2).sqrt();
            colour.powf(1.0 - feature)
        })
        .collect()
}

/// A picture in Y, C_x and C_z, a plane each.
struct Opponent {
    width: usize,
    planes: [Vec<f64>; 3],
}

impl Opponent {
    fn of(image: &Image, exposure: f32) -> Self {
        let pixel = |pixel: &[f32; 3]| {
            let shown = pixel.map(|v| f64::from((v * exposure).clamp(0.0, 1.0)));
            let [x, y, z] = to_xyz_of_white(shown);
            [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
        };
        let pixels: Vec<[f64; 3]> = image.pixels().iter().map(pixel).collect();
        Opponent { width: image.size()[0], planes: [0, 1, 2].map(|c| pixels.iter().map(|p| p[c]).collect()) }
    }

    /// The colours that are seen, in [`lab`].
    fn seen(&self, pixels_a_degree: f64) -> Vec<[f64; 3]> {
        let widest = SENSITIVITY.iter().flat_map(|sum| sum.iter()).map(|[_, b]| *b).fold(0.0, f64::max);
        // a·exp(−b·f²) is in space a·√(π/b)·exp(−π²x²/b): a standard deviation of √(b/(2π²)) degrees.
        let deviation = |b: f64| (b / 2.0).sqrt() / std::f64::consts::PI * pixels_a_degree;
        let radius = (REACH * deviation(widest)).ceil() as usize;
        let filtered: Vec<Vec<f64>> = SENSITIVITY
            .into_iter()
            .zip(&self.planes)
            .map(|(sum, plane)| {
                // In two dimensions a Gaussian's part is its factor times the square of its own sum.
                let parts = sum.iter().map(|[a, b]| {
                    let taps = gaussian(deviation(*b), radius);
                    let own: f64 = taps.iter().sum();
                    (a * (std::f64::consts::PI / b).sqrt() * own * own, taps.iter().map(|t| t / own).collect())
                });
                let parts: Vec<(f64, Vec<f64>)> = parts.collect();
                let whole: f64 = parts.iter().map(|(part, _)| part).sum();
                let mut result = vec![0.0; plane.len()];
                for (part, taps) in &parts {
                    let blurred = separable(plane, self.width, taps, taps);
                    result.iter_mut().zip(blurred).for_each(|(sum, value)| *sum += part / whole * value);
                }
                result
            })
            .collect();
        (0..self.planes[0].len())
            .map(|i| {
                let y = (filtered[0][i] + 16.0) / 116.0;
                let [x, z] = [y + filtered[1][i] / 500.0, y - filtered[2][i] / 200.0];
                lab(from_xyz_of_white([x, y, z]).map(|v| v.clamp(0.0, 1.0)))
            })
            .collect()
    }

    /// How strong edges and points are.
    fn features(&self, pixels_a_degree: f64) -> Vec<[f64; 2]> {
        let grey: Vec<f64> = self.planes[0].iter().map(|y| (y + 16.0) / 116.0).collect();
        let deviation = 0.5 * FEATURE * pixels_a_degree;
        let radius = (REACH * deviation).ceil() as usize;
        let even = normalised(gaussian(deviation, radius));
        let offset = |i: usize| i as f64 - radius as f64;
        let along = |weight: &dyn Fn(f64) -> f64| {
            let taps = gaussian(deviation, radius);
            normalised(taps.iter().enumerate().map(|(i, tap)| weight(offset(i)) * tap).collect())
        };
        let first = along(&|x| -x);
        let second = along(&|x| x * x / (deviation * deviation) - 1.0);
        let strength = |taps: &[f64]| -> Vec<f64> {
            let across = separable(&grey, self.width, taps, &even);
            let down = separable(&grey, self.width, &even, taps);
            across.iter().zip(down).map(|(x, y)| x.hypot(y)).collect()
        };
        strength(&first).into_iter().zip(strength(&second)).map(|(edge, point)| [edge, point]).collect()
    }
}

/// exp(−x²/2σ²) from −radius to radius.
fn gaussian(deviation: f64, radius: usize) -> Vec<f64> {
    let at = |i: usize| (i as f64 - radius as f64) / deviation;
    (0..=2 * radius).map(|i| (-0.5 * at(i) * at(i)).exp()).collect()
}

/// Scaled so that positive weights sum to 1 and negative ones to −1.
fn normalised(taps: Vec<f64>) -> Vec<f64> {
    let sum = |sign: f64| taps.iter().map(|t| (t * sign).max(0.0)).sum::<f64>();
    let (above, below) = (sum(1.0), sum(-1.0));
    taps.iter().map(|t| t / if *t < 0.0 { below } else { above }).collect()
}

/// A plane filtered along rows with `across` and along columns with `down`; beyond its edge it goes on as it ends.
fn separable(plane: &[f64], width: usize, across: &[f64], down: &[f64]) -> Vec<f64> {
    let height = plane.len() / width.max(1);
    let near =
        |i: usize, tap: usize, taps: &[f64], count: usize| (i + tap).saturating_sub(taps.len() / 2).min(count - 1);
    let mut rows = vec![0.0; plane.len()];
    rows.par_chunks_mut(width.max(1)).zip(plane.par_chunks(width.max(1))).for_each(|(to, from)| {
        for (x, to) in to.iter_mut().enumerate() {
            *to = across.iter().enumerate().map(|(i, tap)| tap * from[near(x, i, across, width)]).sum();
        }
    });
    let mut result = vec![0.0; plane.len()];
    result.par_chunks_mut(width.max(1)).enumerate().for_each(|(y, to)| {
        for (i, tap) in down.iter().enumerate() {
            let from = &rows[near(y, i, down, height) * width..][..width];
            to.iter_mut().zip(from).for_each(|(to, from)| *to += tap * from);
        }
    });
    result
}

/// XYZ over the XYZ of white.
fn to_xyz_of_white(rgb: [f64; 3]) -> [f64; 3] {
    TO_XYZ.map(|row| (row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]) / row.iter().sum::<f64>())
}

fn from_xyz_of_white(xyz: [f64; 3]) -> [f64; 3] {
    let scaled: [f64; 3] = std::array::from_fn(|c| xyz[c] * TO_XYZ[c].iter().sum::<f64>());
    FROM_XYZ.map(|row| row[0] * scaled[0] + row[1] * scaled[1] + row[2] * scaled[2])
}

/// L*, and a* and b* times L*/100, of linear sRGB.
fn lab(rgb: [f64; 3]) -> [f64; 3] {
    let bent = |t: f64| {
        let edge: f64 = 6.0 / 29.0;
        if t > edge.powi(3) { t.cbrt() } else { t / (3.0 * edge * edge) + 4.0 / 29.0 }
    };
    let [x, y, z] = to_xyz_of_white(rgb).map(bent);
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    ((a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])).powf(COLOUR_POWER)
}

/// A distance on the range from 0 to 1.
fn bend(distance: f64, greatest: f64) -> f64 {
    let [share, range] = BEND;
    let knee = share * greatest;
    if distance < knee {
        range / knee * distance
    } else {
        range + (distance - knee) / (greatest - knee) * (1.0 - range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn even(colour: [f32; 3]) -> Image {
        Image::from_fn([16, 12], |_, _| colour)
    }

    fn mean(a: &Image, b: &Image) -> f64 {
        let map = flip(a, b, 1.0, PIXELS_A_DEGREE);
        map.iter().sum::<f64>() / map.len() as f64
    }

    #[test]
    fn alike_is_nothing_and_green_to_blue_is_all() {
        let noisy = Image::from_fn([20, 20], |x, y| [(x * y % 7) as f32 / 7.0, (x % 3) as f32 / 3.0, 0.2]);
        assert_eq!(mean(&noisy, &noisy), 0.0);
        assert!((mean(&even([0.0, 1.0, 0.0]), &even([0.0, 0.0, 1.0])) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn black_to_white_follows_from_the_formulas() {
        // h = 100^0.7; the greatest distance is that of green to blue, L* 87.735 and 32.297, their a*, b* by Hunt
        // (-75.61, 72.98) and (25.58, -34.84).
        let greatest = (87.735_f64 - 32.297 + (101.19f64).hypot(107.82)).powf(0.7);
        let knee = 0.4 * greatest;
        let wanted = 0.95 + 0.05 * (100f64.powf(0.7) - knee) / (greatest - knee);
        let found = mean(&even([0.0; 3]), &even([1.0; 3]));
        assert!((found - wanted).abs() < 1e-3, "{found}, {wanted}");
        assert!((mean(&even([1.0; 3]), &even([0.0; 3])) - found).abs() < 1e-12, "the same either way");
    }

    #[test]
    fn the_matrices_are_each_others_inverse() {
        for i in 0..3 {
            let unit: [f64; 3] = std::array::from_fn(|c| f64::from(u8::from(c == i)));
            let back = from_xyz_of_white(to_xyz_of_white(unit));
            assert!((0..3).all(|c| (back[c] - unit[c]).abs() < 1e-6), "{back:?}");
        }
    }

    #[test]
    fn an_edge_that_moved_shows_at_the_edge_alone() {
        let edge = |at: usize| Image::from_fn([64, 8], |x, _| [if x < at { 0.1 } else { 0.6 }; 3]);
        let map = flip(&edge(32), &edge(34), 1.0, PIXELS_A_DEGREE);
        let row = &map[4 * 64..5 * 64];
        assert!(row[33] > 0.4 && row[4] < 1e-9 && row[60] < 1e-9, "{row:?}");
        let larger = flip(&edge(32), &edge(37), 1.0, PIXELS_A_DEGREE);
        assert!(larger.iter().sum::<f64>() > map.iter().sum::<f64>());
    }

    #[test]
    fn detail_too_fine_to_be_seen_counts_little() {
        let board = |phase: usize| Image::from_fn([64, 64], |x, y| [((x + y + phase) % 2) as f32 * 0.5; 3]);
        let near = flip(&board(0), &board(1), 1.0, 10.0);
        let far = flip(&board(0), &board(1), 1.0, 200.0);
        let middle = |map: &[f64]| map[32 * 64 + 32];
        assert!(middle(&far) < 0.3 * middle(&near), "{} {}", middle(&far), middle(&near));
    }

    #[test]
    fn kernels_sum_to_one_and_minus_one() {
        let taps = normalised(vec![-2.0, -1.0, 0.5, 1.0, 4.0]);
        let above: f64 = taps.iter().filter(|t| **t > 0.0).sum();
        let below: f64 = taps.iter().filter(|t| **t < 0.0).sum();
        assert!((above - 1.0).abs() < 1e-12 && (below + 1.0).abs() < 1e-12);
    }
}
