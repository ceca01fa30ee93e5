//! The few numbers that symmetry leaves of a stencil, and what can be proved from them.
//!
//! Seen from the sending cell, with V the part of the direction along the way and W either of the two
//! across it, a scheme of the lab has at most one face straight ahead and four to the sides:
//!
//! ```text
//! ahead  = s0·c00 + s1·V                 adds ahead·(l0, l1 along the way)
//! side±  = s0·c00 + s1·V ± s2·W          adds side±·(l0, l1 along the way, ±l2 across)
//! ```
//!
//! Without clamps one neighbour's share is a matrix with five distinct numbers (MATH.md section 2):
//! out0 = α·c00 + β·V, outV = γ·c00 + δ·V, outW = ε·W. They are sums over the faces, and finding them
//! fails for a stencil that is not of that shape; the plain kernel takes such a one.
//!
//! **When the linear form is the clamped one.** A clamped face removes nothing from a cell with
//! s0·c00 ≥ |s|·‖direction‖. Let r be the least s0/|s| over the clamped faces, and call the cells with
//! ‖direction‖ ≤ r·c00 the *cone*. In the cone both forms agree. If the linear share of every cell in the
//! cone is in the cone, so is every sum of shares (a cone is convex), and then a grid that is in the
//! cone once stays in it. For a cell on its rim, with u the cosine between direction and way,
//!
//! ```text
//! q(u) = r²·(α + β·r·u)² − (γ + δ·r·u)² − ε²·r²·(1 − u²)  ≥ 0   and   α ≥ β·r
//! ```
//!
//! is just that; q is a parabola, so three points decide for all u, and light inside the cone is a sum of
//! light on its rim. [`Form::cone`] is r if the check holds. The cascaded scheme passes (r = 1/√3); it
//! takes lobes along the axes into the cone in one clamped step, oblique ones in up to four. The axial
//! scheme does not pass: its front is a bare lobe for ever. Whether a grid lies in the cone is read from
//! the light itself.

use crate::sh::{Real, Sh};
use crate::transport::lattice::face::Direction;
use crate::transport::lattice::stencil::{Stencil, Tap};

/// A face in its own frame: component 0 is c00, 1 along the way, 2 across it towards the face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face<T> {
    /// What light is multiplied with for the flux.
    pub sampler: [T; 3],
    /// What a unit of flux adds.
    pub lobe: [T; 3],
    /// The flux is at least this: 0 where clamped, −∞ where not.
    pub least: T,
}

/// The five numbers of a neighbour's share without clamps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share<T> {
    /// c00 from c00.
    pub alpha: T,
    /// c00 from the direction along the way.
    pub beta: T,
    /// The direction along the way from c00.
    pub gamma: T,
    /// The direction along the way from itself.
    pub delta: T,
    /// The direction across the way from itself.
    pub epsilon: T,
}

/// A stencil in the form that the fast loops use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form<T> {
    /// The face straight ahead; all zero if there is none.
    pub ahead: Face<T>,
    /// One of the four side faces, if there are any.
    pub side: Option<Face<T>>,
    /// All of them together, without clamps.
    pub share: Share<T>,
    /// r, if light in the cone ‖direction‖ ≤ r·c00 stays in it and is not clamped; infinite if nothing
    /// is ever clamped.
    pub cone: Option<f64>,
    /// Upper bounds on what one iteration multiplies Σc00 with.
    pub gain: Gain,
}

/// Upper bounds on what one iteration multiplies Σc00 with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// For light in the cone: 6·α, for what goes forward in one direction comes back in the other. Open
    /// borders only take away.
    pub in_cone: f64,
    /// For sums of lobes, where every face is clamped. From max(0, f) = (f + |f|)/2 and Cauchy–Schwarz.
    pub of_lobes: Option<f64>,
    /// The largest ‖direction‖/c00 of what the scheme sends.
    pub slope: f64,
}

impl<T: Real> Form<T> {
    /// The form of `stencil`, or `None` if it has another shape.
    pub fn of(stencil: &Stencil<T>) -> Option<Self> {
        let first = Frame::of(0, &stencil.taps()[0])?;
        let same = (1..6).all(|d| Frame::of(d, &stencil.taps()[d]).is_some_and(|other| first.agrees(&other)));
        same.then(|| first.form())
    }
}

/// The faces of one direction in f64, out of which a form is made.
struct Frame {
    ahead: Face<f64>,
    side: Option<Face<f64>>,
}

impl Frame {
    fn of<T: Real>(d: usize, taps: &[Tap<T>]) -> Option<Self> {
        let mut ahead = None;
        let mut sides: Vec<(usize, bool, Face<f64>)> = Vec::new();
        for tap in taps {
            let (sampler, lobe) = (local(d, tap.sampler), local(d, tap.lobe));
            let least = if tap.clamp { 0.0 } else { f64::NEG_INFINITY };
            let face = |w: usize, sign: f64| Face {
                sampler: [sampler[0], sampler[1], sign * sampler[w]],
                lobe: [lobe[0], lobe[1], sign * lobe[w]],
                least,
            };
            let across: Vec<usize> = [2, 3].into_iter().filter(|&w| sampler[w] != 0.0 || lobe[w] != 0.0).collect();
            match across[..] {
                [] if ahead.is_none() => ahead = Some(face(2, 1.0)),
                [w] => {
                    let up = sampler[w] > 0.0;
                    sides.push((w, up, face(w, if up { 1.0 } else { -1.0 })));
                }
                _ => return None,
            }
        }
        let dark = Face { sampler: [0.0; 3], lobe: [0.0; 3], least: 0.0 };
        let ahead = ahead.unwrap_or(dark);
        let Some(&(_, _, side)) = sides.first() else {
            return Some(Frame { ahead, side: None });
        };
        let all_four = [(2, true), (2, false), (3, true), (3, false)]
            .iter()
            .all(|&(w, up)| sides.iter().filter(|s| s.0 == w && s.1 == up && near(&s.2, &side)).count() == 1);
        (all_four && sides.len() == 4).then_some(Frame { ahead, side: Some(side) })
    }

    fn agrees(&self, other: &Frame) -> bool {
        near(&self.ahead, &other.ahead)
            && match (&self.side, &other.side) {
                (Some(a), Some(b)) => near(a, b),
                (None, None) => true,
                _ => false,
            }
    }

    fn share(&self) -> Share<f64> {
        let (a, s) = (&self.ahead, self.side.as_ref());
        let sum = |l: usize, v: usize| a.lobe[l] * a.sampler[v] + s.map_or(0.0, |s| 4.0 * s.lobe[l] * s.sampler[v]);
        Share {
            alpha: sum(0, 0),
            beta: sum(0, 1),
            gamma: sum(1, 0),
            delta: sum(1, 1),
            epsilon: s.map_or(0.0, |s| 2.0 * s.lobe[2] * s.sampler[2]),
        }
    }

    /// The faces with how many there are of each, those that carry nothing left out.
    fn faces(&self) -> impl Iterator<Item = (f64, &Face<f64>)> {
        let side = self.side.as_ref().map(|s| (4.0, s));
        std::iter::once((1.0, &self.ahead)).chain(side).filter(|(_, f)| f.sampler != [0.0; 3])
    }

    fn form<T: Real>(&self) -> Form<T> {
        let share = self.share();
        let cast =
            |f: &Face<f64>| Face { sampler: f.sampler.map(T::of), lobe: f.lobe.map(T::of), least: T::of(f.least) };
        Form {
            ahead: cast(&self.ahead),
            side: self.side.as_ref().map(cast),
            share: Share {
                alpha: T::of(share.alpha),
                beta: T::of(share.beta),
                gamma: T::of(share.gamma),
                delta: T::of(share.delta),
                epsilon: T::of(share.epsilon),
            },
            cone: self.cone(&share),
            gain: self.gain(&share),
        }
    }

    fn cone(&self, share: &Share<f64>) -> Option<f64> {
        let clamped = self.faces().filter(|(_, f)| f.least == 0.0);
        let r = clamped.map(|(_, f)| f.sampler[0] / length(f.sampler)).fold(f64::INFINITY, f64::min);
        if r.is_infinite() {
            return Some(r);
        }
        // A little inside, so that rounding cannot bring a flux under zero either.
        let r = r * (1.0 - 1e-5);
        let Share { alpha, beta, gamma, delta, epsilon } = *share;
        let q = |u: f64| {
            (r * (alpha + beta * r * u)).powi(2)
                - (gamma + delta * r * u).powi(2)
                - (epsilon * r).powi(2) * (1.0 - u * u)
        };
        // The parabola through q(−1), q(0), q(1): a·u² + b·u + q(0).
        let (a, b) = ((q(1.0) + q(-1.0)) / 2.0 - q(0.0), (q(1.0) - q(-1.0)) / 2.0);
        let lowest = if a > 0.0 { (-b / (2.0 * a)).clamp(-1.0, 1.0) } else { -1.0 };
        let closed = r > 0.0 && alpha >= beta.abs() * r && [-1.0, 1.0, lowest].into_iter().all(|u| q(u) >= 0.0);
        closed.then_some(r)
    }

    fn gain(&self, share: &Share<f64>) -> Gain {
        let slope = self.faces().map(|(_, f)| length(f.lobe) / f.lobe[0]).fold(0.0, f64::max);
        let all_clamped = self.faces().all(|(_, f)| f.least == 0.0 && f.lobe[0] >= 0.0);
        // Over all six directions Σ l0·(s·a)² = A·c00² + B·‖direction‖², by the symmetry of the cube.
        let sum =
            |of: &dyn Fn(&Face<f64>) -> f64| -> f64 { self.faces().map(|(m, f)| 6.0 * m * f.lobe[0] * of(f)).sum() };
        let (weight, a) = (sum(&|_| 1.0), sum(&|f| f.sampler[0].powi(2)));
        let b = sum(&|f| f.sampler[1].powi(2) + f.sampler[2].powi(2)) / 3.0;
        let in_cone = 6.0 * share.alpha;
        let of_lobes = (in_cone + (weight * (a + b * slope * slope)).sqrt()) / 2.0;
        Gain { in_cone, of_lobes: all_clamped.then_some(of_lobes), slope }
    }
}

/// `v` with direction `d` (an index of [`Direction::ALL`]) turned to +X: (c00, along, across, across).
fn local<T: Real>(d: usize, v: Sh<T>) -> [f64; 4] {
    let direction = Direction::ALL[d];
    let Sh([c00, x, y, z]) = v.widen();
    let sign = if direction.is_positive() { 1.0 } else { -1.0 };
    match direction.axis() {
        0 => [c00, sign * x, y, z],
        1 => [c00, sign * y, x, z],
        _ => [c00, sign * z, x, y],
    }
}

fn near(a: &Face<f64>, b: &Face<f64>) -> bool {
    let close = |a: [f64; 3], b: [f64; 3]| {
        let size = length(a).max(length(b));
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-6 * size)
    };
    close(a.sampler, b.sampler) && close(a.lobe, b.lobe) && a.least == b.least
}

/// The length of the direction part.
fn length([_, along, across]: [f64; 3]) -> f64 {
    along.hypot(across)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::lattice::schemes;
    use glam::DVec3;

    #[test]
    fn the_five_numbers_send_what_the_stencil_sends() {
        for scheme in schemes::all() {
            let stencil = Stencil::<f64>::scaled(&scheme, [3.0, 2.0], false);
            let Share { alpha, beta, gamma, delta, epsilon } = Form::of(&stencil).unwrap().share;
            let light = Sh([0.7, -0.2, 0.5, 0.3]);
            for (d, direction) in Direction::ALL.iter().enumerate() {
                let (axis, sign) = (direction.axis(), direction.vector().to_array()[direction.axis()]);
                let along = sign * light.0[axis + 1];
                let mut wanted = light.0.map(|c| epsilon * c);
                wanted[0] = alpha * light.0[0] + beta * along;
                wanted[axis + 1] = sign * (gamma * light.0[0] + delta * along);
                for (found, wanted) in stencil.send(d, light).0.iter().zip(wanted) {
                    assert!((found - wanted).abs() < 1e-14, "{}, direction {d}", scheme.name);
                }
            }
        }
    }

    #[test]
    fn a_stencil_of_another_shape_is_refused() {
        let mut scheme = schemes::find("cascaded").unwrap();
        scheme.faces.pop();
        assert_eq!(Form::of(&Stencil::<f32>::new(&scheme, 3.0, true)), None);
    }

    #[test]
    fn the_cascaded_cone_is_closed_and_bounds_the_gain() {
        let stencil = Stencil::<f64>::new(&schemes::find("cascaded").unwrap(), 3.0, true);
        let form = Form::of(&stencil).unwrap();
        let r = form.cone.unwrap();
        assert!((r - 1.0 / 3f64.sqrt()).abs() < 1e-5);
        assert!((form.gain.in_cone - 0.75).abs() < 1e-15);
        // Directions all over the sphere, on a spiral.
        for i in 0..500 {
            let z = (f64::from(i) + 0.5) / 250.0 - 1.0;
            let (s, c) = (2.399_963 * f64::from(i)).sin_cos();
            let n = DVec3::new((1.0 - z * z).sqrt() * c, (1.0 - z * z).sqrt() * s, z);
            let rim = Sh([1.0, r * n.x, r * n.y, r * n.z]);
            let lobe = Sh::lobe(n);
            let sent = |light| (0..6).map(|d| stencil.send(d, light)).collect::<Vec<Sh<f64>>>();
            assert!(sent(rim).iter().all(|share| slope(*share) <= r), "{n}");
            let gain = sent(lobe).iter().map(|share| share.0[0]).sum::<f64>() / lobe.0[0];
            assert!(gain <= form.gain.of_lobes.unwrap(), "{n}: {gain}");
        }
    }

    #[test]
    fn lobes_along_the_axes_are_in_the_cone_after_one_step() {
        let stencil = Stencil::<f64>::new(&schemes::find("cascaded").unwrap(), 3.0, true);
        let r = Form::of(&stencil).unwrap().cone.unwrap();
        for d in 0..6 {
            let share = stencil.send(d, Sh::lobe(DVec3::X));
            assert!(share.is_zero() || slope(share) <= r, "direction {d}");
        }
    }

    fn slope(light: Sh<f64>) -> f64 {
        light.vector().length() / light.0[0]
    }
}
