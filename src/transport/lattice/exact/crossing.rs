//! What crosses a face between two cells, whatever their sizes, as multiples of the two halves of a share.
//!
//! Let M be the share that goes through the face in its outward direction (seen from the cell that we look at), N
//! the one that comes back. Both have the same even numbers α δ ε and opposite odd numbers β γ. Let *own* and
//! *beyond* be the light in the planes next to the face, here and there ([`Decay::face`]). In one finest step
//! N·beyond − M·own crosses a unit of the face, and a cell of h planes with a face of A units gains A/h³ of that:
//!
//! ```text
//! N·x − M·y = even part·(x − y) − odd part·(x + y)
//! ```
//!
//! The planes are sums of the two cells' means. So what a cell gains through a face is four numbers: the even and the
//! odd multiple for the mean beyond, and those for its own mean ([`Crossing`]).
//!
//! One cell's gain is the other's loss, whatever M is, so light is neither made nor lost between cells, of whatever
//! sizes. Between cells of one size the own parts of opposite faces add up to −2·[`Decay::even`] and 0, which is why
//! P_i of [`super`] has no odd part of its own.

use super::decay::{Decay, Face};

/// Multiples of the even (α δ ε) and of the odd (β γ) numbers of a share, in the outward direction of a face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pass {
    /// What α, δ and ε are multiplied with.
    pub even: f64,
    /// What β and γ are multiplied with.
    pub odd: f64,
}

/// What a cell gains through a face, or a part of it, in one finest step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Crossing {
    /// From the mean beyond the face.
    pub beyond: Pass,
    /// From its own mean; mostly a loss.
    pub own: Pass,
}

impl Crossing {
    /// Between a cell of `own` planes and one of `beyond`, over the smaller face of the two.
    pub fn between(decay: &Decay, own: f64, beyond: f64) -> Self {
        Self::through(decay.face(own, beyond), own, beyond)
    }

    /// As [`Self::between`], where of the light that enters the cell a share `here` passes, and of that which enters the
    /// other a share `there`. As far as either is shut the two know nothing of each other: light falls off towards the
    /// face as towards an open border.
    pub fn behind(decay: &Decay, own: f64, beyond: f64, [here, there]: [f64; 2]) -> Self {
        let open = here * there;
        let mix = |[near, far]: [f64; 2], alone: f64| [open * near + (1.0 - open) * alone, open * far];
        let face = decay.face(own, beyond);
        let [own_own, own_beyond] = mix(face.left, decay.border(own));
        let [beyond_own, beyond_beyond] = face.right;
        let [beyond_beyond, beyond_own] = mix([beyond_beyond, beyond_own], decay.border(beyond));
        let face = Face { left: [own_own, own_beyond], right: [here * beyond_own, here * beyond_beyond] };
        Self::through(face, own, beyond)
    }

    /// As [`Self::between`], with the planes beside the face given; its own is the left one.
    pub fn through(face: Face, own: f64, beyond: f64) -> Self {
        let area = own.min(beyond).powi(2) / own.powi(3);
        let [own_own, own_beyond] = face.left;
        let [beyond_own, beyond_beyond] = face.right;
        let pass = |there: f64, here: f64| Pass { even: area * (there - here), odd: -area * (there + here) };
        Crossing { beyond: pass(beyond_beyond, own_beyond), own: pass(beyond_own, own_own) }
    }

    /// Between a cell of `own` planes and the dark outside.
    pub fn open(decay: &Decay, own: f64) -> Self {
        let lost = decay.border(own) / own;
        Crossing { beyond: Pass::default(), own: Pass { even: -lost, odd: -lost } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_one_size_exchange_even_and_odd_differences() {
        for mu in [0.0, 0.475_835_79, 1.146_309_91, 5.0] {
            let decay = Decay::new(mu);
            for h in [1.0, 2.0, 4.0, 64.0] {
                let crossing = Crossing::between(&decay, h, h);
                assert!((crossing.beyond.even - decay.even(h)).abs() < 1e-14, "μ = {mu}, h = {h}");
                assert!((crossing.beyond.odd + decay.odd(h)).abs() < 1e-14);
                assert!((crossing.own.even + decay.even(h)).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn what_one_cell_gains_the_other_loses() {
        let decay = Decay::new(0.7);
        for (a, b) in [(1.0, 1.0), (1.0, 2.0), (2.0, 4.0), (8.0, 4.0)] {
            let (here, there) = (Crossing::between(&decay, a, b), Crossing::between(&decay, b, a));
            // Volumes a³ and b³; the outward direction there is the inward one here, which turns odd numbers.
            let (va, vb) = (f64::powi(a, 3), f64::powi(b, 3));
            assert!((va * here.beyond.even + vb * there.own.even).abs() < 1e-12);
            assert!((va * here.own.even + vb * there.beyond.even).abs() < 1e-12);
            assert!((va * here.beyond.odd - vb * there.own.odd).abs() < 1e-12);
            assert!((va * here.own.odd - vb * there.beyond.odd).abs() < 1e-12);
        }
    }

    #[test]
    fn a_shut_face_passes_nothing_and_an_open_one_everything() {
        let decay = Decay::new(0.7);
        for (own, beyond) in [(1.0, 1.0), (2.0, 1.0), (4.0, 8.0)] {
            assert_eq!(Crossing::behind(&decay, own, beyond, [1.0; 2]), Crossing::between(&decay, own, beyond));
            let shut = Crossing::behind(&decay, own, beyond, [0.0, 1.0]);
            assert_eq!(shut.beyond, Pass { even: 0.0, odd: 0.0 });
            let area = own.min(beyond).powi(2) / own.powi(2);
            assert!((shut.own.even - area * Crossing::open(&decay, own).own.even).abs() < 1e-15);
        }
        // Between finest cells what enters is thinned and what leaves is not.
        let half = Crossing::behind(&decay, 1.0, 1.0, [0.5, 1.0]);
        assert_eq!((half.beyond.even, half.own.even), (0.5, -1.0));
    }

    #[test]
    fn finest_cells_take_what_is_sent_and_lose_what_they_send() {
        for mu in [0.0, 1.1] {
            let one = Crossing::between(&Decay::new(mu), 1.0, 1.0);
            assert_eq!((one.beyond, one.own), (Pass { even: 1.0, odd: -1.0 }, Pass { even: -1.0, odd: -1.0 }));
            assert_eq!(Crossing::open(&Decay::new(mu), 1.0).own, one.own);
        }
    }
}
