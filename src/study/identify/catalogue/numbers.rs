//! Mistakes that are numbers: weights, factors, sums and what injection writes.

use super::{Group, Mistake, none};

/// A mistake without a rule.
const fn number(id: &'static str, sentence: &'static str, remedy: &'static str) -> Mistake {
    Mistake { id, sentence, remedy, group: Group::Number, edits: none }
}

pub(super) const MISTAKES: &[Mistake] = &[
    number(
        "digit-typo",
        "The solid angle of the side faces has one wrong digit, 0.4234413544.",
        "The five faces fill the shared one, 2π/3: side = (2π/3 - 4·asin(0.1))/4 = 0.4234313544.",
    ),
    number(
        "swapped-weights",
        "The weights of far and side faces are exchanged.",
        "far = 4·asin(0.1) = 0.4006696846, side = (2π/3 - far)/4 = 0.4234313544.",
    ),
    number(
        "equal-weights",
        "Far and side faces have the same weight.",
        "far = 4·asin(0.1) = 0.4006696846, side = (2π/3 - far)/4 = 0.4234313544.",
    ),
    number(
        "not-over-4pi",
        "Solid angles are not divided by the sphere's, so that light grows in every iteration.",
        "Divide by 4π = 12.5663706: far 0.0318842778, side 0.0336956032. The factor 4 then keeps all energy.",
    ),
    number(
        "twice-over-pi",
        "The flux is divided by π twice.",
        "Divide once: Ω/π is factor 4 over 4π, and the lobe L of the face holds π already.",
    ),
    number(
        "first-twice",
        "The sum counts the first grid twice.",
        "A = S0 + S1 + … + Sk (thesis) or S1 + … + Sk (NVIDIA's, whose S1 holds S0 already).",
    ),
    number("no-sum", "The accumulated grid is the last iteration alone.", "Add every iteration: A += S(k)."),
    number(
        "half-sums",
        "The sum is kept in half precision while the light is not.",
        "Sum in single precision: small terms of late iterations get lost in half.",
    ),
    number(
        "injection-shifted",
        "Lights are injected into the wrong cell.",
        "The cell of a light is ⌊(position - origin)/cell size⌋; a shift by half a cell along the normal must not \
         carry it past its neighbour.",
    ),
    number(
        "injection-brightest",
        "Of several lights in a cell the brightest alone is kept.",
        "Add the lobes of all lights in a cell: additive blending or atomic additions.",
    ),
    number(
        "injection-averaged",
        "Lights in a cell are averaged.",
        "Add the lobes of all lights in a cell and divide by nothing.",
    ),
    number(
        "injection-lobe",
        "Another lobe than the clamped cosine is injected.",
        "Inject (√π/2, √(π/3)·n) = (0.88622693, 1.02332671·n): band 1 over band 0 is 2/√3 = 1.15470054.",
    ),
];
