//! What a port injected, held against the pattern that it was given.

use super::fit::{DEVIATION, SLACK};
use super::layout::{Axes, Coefficients, Dump, Layout, Shift, align, coefficients, shifted};
use super::light::Light;
use super::verdict::Estimate;
use crate::field::Cell;
use crate::sh::{LOBE0, LOBE1, Sh};
use crate::study::pattern::Pattern;

/// What becomes of several lights in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Together {
    /// They add up.
    Sum,
    /// The brightest stays.
    Brightest,
    /// Their mean.
    Mean,
}

/// What was injected.
#[derive(Clone, Debug)]
pub struct Injection {
    /// How the dump lies in its file.
    pub layout: Layout,
    /// By how many cells the lights were moved.
    pub shift: Shift,
    /// What became of several lights in a cell.
    pub together: Together,
    /// What the lobes were multiplied with.
    pub scale: Estimate,
    /// Band 1 over band 0, over that of the clamped cosine lobe.
    pub ratio: Estimate,
    /// Whether every number of the dump agrees.
    pub agrees: bool,
    /// The first cell that does not agree with the pattern as it should be injected at this scale, with its light as
    /// it should be and as it is.
    pub first_wrong: Option<(Cell, [f64; 4], [f64; 4])>,
    /// How alike the dump's bright cells are to the pattern's, 0 to 1.
    pub alike: f64,
}

/// The pattern's light, injected in a certain way.
pub fn injected(pattern: &Pattern, together: Together, shift: Shift) -> Light {
    let side = pattern.side();
    let mut light = Light::dark(side);
    let mut cells: Vec<Cell> = pattern.lobes().iter().map(|lobe| lobe.cell).collect();
    cells.sort_unstable();
    cells.dedup();
    for cell in cells {
        let Some(to) = shifted(cell, shift, side) else { continue };
        let mut lobes: Vec<_> = pattern.lobes().iter().filter(|lobe| lobe.cell == cell).collect();
        let count = lobes.len() as f64;
        if together == Together::Brightest {
            lobes.sort_by(|a, b| b.multiplier.total_cmp(&a.multiplier));
            lobes.truncate(1);
        }
        let sum: Sh<f64> = lobes.iter().map(|lobe| lobe.light()).sum();
        light.add(to, if together == Together::Mean { sum * (1.0 / count) } else { sum });
    }
    light
}

/// Reads from the injected dump what was injected; `None` where the dump is dark or its numbers cannot be told apart.
pub fn read(dump: &Dump, pattern: &Pattern) -> Option<Injection> {
    let (axes, shift, alike) = align(dump, &injected(pattern, Together::Sum, [0; 3]));
    let right = injected(pattern, Together::Sum, [0; 3]);
    let ways = [Together::Sum, Together::Brightest, Together::Mean];
    let mut read: Vec<Injection> = ways
        .into_iter()
        .filter_map(|together| {
            let expected = injected(pattern, together, shift);
            let coefficients = coefficients(dump, axes, &expected)?;
            Some(held_against(dump, axes, coefficients, &expected, &right, (shift, together, alike)))
        })
        .collect();
    let best = read.iter().position(|injection| injection.agrees).unwrap_or(0);
    (!read.is_empty()).then(|| read.swap_remove(best))
}

/// Fits one scale for each band and says whether all numbers agree.
fn held_against(
    dump: &Dump,
    axes: Axes,
    coefficients: Coefficients,
    expected: &Light,
    right: &Light,
    (shift, together, alike): (Shift, Together, f64),
) -> Injection {
    let layout = Layout { axes, coefficients };
    let light = layout.light(dump);
    let tolerance = |found: f64, wanted: f64| dump.storage.rounding(found) * 1.0001 + wanted.abs() * 4e-7 + 1e-12;
    let mut sums = [[0.0; 2]; 2];
    for (found, wanted) in light.cells().iter().zip(expected.cells()) {
        for c in 0..4 {
            let weight = tolerance(found[c], wanted[c]).powi(-2);
            sums[usize::from(c > 0)][0] += weight * found[c] * wanted[c];
            sums[usize::from(c > 0)][1] += weight * wanted[c] * wanted[c];
        }
    }
    let [band0, band1] = sums.map(|[product, square]| (product / square, DEVIATION / square.sqrt()));
    let scales = [band0.0, band1.0, band1.0, band1.0];
    let off = |found: &[f64; 4], wanted: &[f64; 4], scales: [f64; 4], slack: f64| {
        (0..4).any(|c| (found[c] - scales[c] * wanted[c]).abs() > slack * tolerance(found[c], scales[c] * wanted[c]))
    };
    let agrees = !light.cells().iter().zip(expected.cells()).any(|(found, wanted)| off(found, wanted, scales, SLACK));
    let as_it_should = [band0.0; 4];
    let first = (0..light.cells().len()).find(|&i| off(&light.cells()[i], &right.cells()[i], as_it_should, 4.0));
    let first_wrong = first.map(|i| (light.cell(i), right.cells()[i].map(|c| c * band0.0), light.cells()[i]));
    let ratio = band1.0 / band0.0;
    let ratio_error = ratio.abs() * ((band0.1 / band0.0).powi(2) + (band1.1 / band1.0).powi(2)).sqrt();
    Injection {
        layout,
        shift,
        together,
        scale: Estimate::of(band0.0, band0.1),
        ratio: Estimate::of(ratio, ratio_error),
        agrees,
        first_wrong,
        alike,
    }
}

impl Injection {
    /// The mistakes of injection that need no propagation to be seen: their ids, with what they are here.
    pub fn mistakes(&self) -> Vec<(&'static str, String)> {
        let mut mistakes = Vec::new();
        if self.shift != [0; 3] {
            let [x, y, z] = self.shift;
            mistakes.push(("injection-shifted", format!("by ({x}, {y}, {z}) cells")));
        }
        match self.together {
            Together::Sum => {}
            Together::Brightest => mistakes.push(("injection-brightest", String::new())),
            Together::Mean => mistakes.push(("injection-averaged", String::new())),
        }
        let four_digits = (1.0233 / LOBE1) / (0.8862 / LOBE0);
        if !self.ratio.holds(1.0) {
            if self.ratio.holds(four_digits) && self.scale.holds(0.8862 / LOBE0) {
                mistakes.push(("four-digit-constants", "the lobe that is injected".to_owned()));
            } else {
                let band = self.ratio.value * LOBE1 / LOBE0;
                mistakes.push(("injection-lobe", format!("band 1 over band 0 is {band:.5}, not 1.15470")));
            }
        }
        mistakes
    }

    /// What the scale is, in words.
    pub fn scale_in_words(&self) -> String {
        let pi = std::f64::consts::PI;
        let known = [
            (1.0, "as given"),
            (1.0 / pi, "divided by π (flux as intensity: right)"),
            (pi, "multiplied by π"),
            (1.0 / (4.0 * pi), "divided by 4π"),
            (4.0 * pi, "multiplied by 4π"),
        ];
        let name = known.into_iter().find(|(value, _)| self.scale.holds(*value));
        name.map_or_else(|| format!("multiplied by {}", self.scale), |(_, name)| name.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::identify::light::{Storage, half};

    fn dumped(light: &Light, storage: Storage) -> Dump {
        let mut numbers = vec![[0.0; 4]; light.cells().len()];
        for i in 0..light.cells().len() {
            let [c0, x, y, z] = light.cells()[i];
            let place = Axes::LAB.place(light.cell(i), light.side());
            numbers[place] = [c0, -y, z, -x].map(|c| if storage == Storage::Half { half(c) } else { c });
        }
        Dump { side: light.side(), numbers, storage }
    }

    #[test]
    fn every_way_to_inject_is_told_and_the_right_one_is_no_mistake() {
        for (name, side) in Pattern::list() {
            let pattern = Pattern::find(name, side).unwrap();
            for storage in [Storage::Half, Storage::Double] {
                for (together, shift, id) in [
                    (Together::Sum, [0; 3], None),
                    (Together::Brightest, [0; 3], Some("injection-brightest")),
                    (Together::Mean, [0; 3], Some("injection-averaged")),
                    (Together::Sum, [0, -1, 0], Some("injection-shifted")),
                ] {
                    let dump = dumped(&injected(&pattern, together, shift), storage);
                    let injection = read(&dump, &pattern).unwrap();
                    let ids: Vec<_> = injection.mistakes().into_iter().map(|m| m.0).collect();
                    assert_eq!(ids, Vec::from_iter(id), "{name}{side} {storage:?}");
                    assert!(injection.agrees && injection.scale.holds(1.0));
                    assert_eq!(injection.layout.coefficients, Coefficients::PUBLISHED);
                    assert_eq!(injection.first_wrong.is_some(), id.is_some());
                }
            }
        }
    }
}
