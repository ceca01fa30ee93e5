//! What a port breaks that is in no catalogue: one law of light propagation after the other is put to its first step.
//!
//! - **Reach**: one iteration carries light one cell along one axis.
//! - **Symmetry**: the spread commutes with the 48 symmetries of the cube, so every direction of travel has the same
//!   weights.
//! - **Homogeneity**: k times the light gives k times the result.
//! - **Translation**: the spread is the same in every cell.

use super::fit::{Rounding, Step};
use super::light::{Light, is_lit};
use super::port::{Kind, Port};
use super::verdict::Law;
use crate::field::Cell;
use crate::sh::Sh;
use crate::transport::lattice::face::Direction;

/// The laws that a step breaks, against a port that keeps them all.
pub fn broken(step: &Step, port: &Port) -> Vec<Law> {
    let mut laws = Vec::new();
    laws.extend(reach(step));
    let by_direction = symmetry(step, port);
    let symmetric = by_direction.is_none();
    laws.extend(by_direction);
    if symmetric {
        laws.extend(by_sender(step, port));
    }
    if laws.is_empty() {
        laws.push(Law {
            name: "additivity",
            how: "no weights of far and side faces, the same for all directions and cells, make the first iteration"
                .to_owned(),
        });
    }
    laws
}

/// Light further than one cell along one axis from all light before.
fn reach(step: &Step) -> Option<Law> {
    let before: Vec<Cell> = step.before.lit().into_iter().map(|i| step.before.cell(i)).collect();
    let distance = |a: Cell, b: Cell| (0..3).map(|i| a[i].abs_diff(b[i])).sum::<usize>();
    let nearest = |cell: Cell| before.iter().map(|b| distance(cell, *b)).min().unwrap_or(0);
    let far = step.after.lit().into_iter().map(|i| step.after.cell(i)).find(|cell| nearest(*cell) > 1)?;
    let [x, y, z] = far;
    let steps = nearest(far);
    let how = format!(
        "the cell ({x}, {y}, {z}) has light after one iteration, {steps} steps from the nearest lit one; one iteration \
         carries light one step along one axis"
    );
    Some(Law { name: "reach", how })
}

/// The receivers that one sender alone reaches, with it and the direction of travel.
fn single(step: &Step) -> Vec<(Cell, Cell, usize)> {
    let side = step.before.side();
    let mut single = Vec::new();
    for receiver in step.receivers() {
        if is_lit(&step.before.get(receiver)) {
            continue;
        }
        let senders: Vec<(Cell, usize)> = (0..6)
            .filter_map(|d| Some((Direction::ALL[d].opposite().neighbour(receiver, side)?, d)))
            .filter(|(cell, _)| is_lit(&step.before.get(*cell)))
            .collect();
        if let [(sender, d)] = senders[..] {
            single.push((receiver, sender, d));
        }
    }
    single
}

/// Weights far and side from some receivers, and whether nothing but rounding is left.
fn weights(step: &Step, port: &Port, receivers: &[Cell]) -> ([f64; 2], [f64; 2], bool) {
    let (fit, agreement) = step.precise(port, Rounding::Dumped, receivers);
    let kinds = [Kind::Far, Kind::Side];
    (kinds.map(|k| fit.weight(k)), kinds.map(|k| fit.deviation(k)), agreement.is_full())
}

fn symmetry(step: &Step, port: &Port) -> Option<Law> {
    let single = single(step);
    let fits: Vec<_> = (0..6)
        .map(|d| {
            let receivers: Vec<Cell> = single.iter().filter(|s| s.2 == d).map(|s| s.0).collect();
            weights(step, port, &receivers)
        })
        .collect();
    let names = ["+x", "-x", "+y", "-y", "+z", "-z"];
    let differ = |a: usize, b: usize| {
        (0..2)
            .map(|k| (fits[a].0[k] - fits[b].0[k]).abs() / (5.0 * (fits[a].1[k] + fits[b].1[k]) + 1e-6))
            .fold(0.0, f64::max)
    };
    let pairs = (0..6).flat_map(|a| (a + 1..6).map(move |b| (a, b)));
    let (a, b) = pairs.max_by(|p, q| differ(p.0, p.1).total_cmp(&differ(q.0, q.1)))?;
    // Weights that differ prove it where each direction by itself is explained; otherwise only if they differ much.
    let explained = fits.iter().filter(|fit| fit.2).count();
    if explained < 4 || differ(a, b) <= 1.0 {
        return None;
    }
    let element = if Direction::ALL[a].axis() == Direction::ALL[b].axis() {
        format!("the mirror that exchanges {} and {}", names[a], names[b])
    } else {
        format!("the symmetry that exchanges {} and {}", names[a], names[b])
    };
    let [(fa, sa), (fb, sb)] = [a, b].map(|d| (fits[d].0[0], fits[d].0[1]));
    let how = format!(
        "it breaks {element}: light towards {} has weights {fa:.6} (far) and {sa:.6} (side), towards {} {fb:.6} and \
         {sb:.6}",
        names[a], names[b]
    );
    Some(Law { name: "symmetry", how })
}

/// What a sender's neighbours get if each face's flux f became |f|^γ.
fn bent(step: &Step, port: &Port, exponent: f64) -> f64 {
    let bend = |light: &Light| {
        // Homogeneity bends the light as a whole: the spread of a cell k times as bright is k^γ times as bright.
        let mut bent = light.clone();
        for cell in bent.cells_mut().iter_mut().filter(|cell| is_lit(cell)) {
            let scale = cell[0].abs().powf(exponent - 1.0);
            cell.iter_mut().for_each(|c| *c *= scale);
        }
        bent
    };
    let step = Step { before: bend(&step.before), ..step.clone() };
    let receivers: Vec<Cell> = single(&step).into_iter().map(|s| s.0).collect();
    step.rough(port, &receivers).left
}

/// The same with each face's own flux bent.
fn face_bent(step: &Step, port: &Port, bend: &dyn Fn(f64) -> f64) -> f64 {
    let side = step.before.side();
    let mut sums = super::fit::Sums::default();
    for (receiver, sender, d) in single(step) {
        debug_assert!(sender.iter().all(|c| *c < side));
        let light = Sh(step.before.get(sender));
        let mut columns = [[0.0; 4]; super::port::KINDS];
        for tap in &port.taps[d] {
            let flux = bend(light.dot(tap.read).max(0.0));
            for (sum, c) in columns[tap.kind as usize].iter_mut().zip(tap.lobe.0) {
                *sum += flux * c;
            }
        }
        sums.add(&columns, &step.after.get(receiver), &[1.0; 4]);
    }
    sums.solve(0.0).left
}

fn by_sender(step: &Step, port: &Port) -> Option<Law> {
    let straight = face_bent(step, port, &|f| f);
    let exponents = (10..=40).map(|i| f64::from(i) / 20.0).filter(|e| (e - 1.0).abs() > 1e-9);
    let mut best = (straight, String::new());
    for e in exponents {
        let left = face_bent(step, port, &|f: f64| f.powf(e)).min(bent(step, port, e));
        if left < best.0 {
            best = (left, format!("as if light went with the power {e:.2} of the flux"));
        }
    }
    for c in [0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 4.0] {
        for sign in [1.0, -0.2] {
            let left = face_bent(step, port, &|f: f64| f / (1.0 + sign * c * f));
            if left < best.0 {
                best = (
                    left,
                    format!("as if flux f became f/(1 {} {:.2}·f)", if sign > 0.0 { "+" } else { "-" }, sign.abs() * c),
                );
            }
        }
    }
    // One factor for each sender: do bright cells or certain places send more than their share?
    let single = single(step);
    let mut senders: Vec<Cell> = single.iter().map(|s| s.1).collect();
    senders.sort_unstable();
    senders.dedup();
    let of = |sender: Cell| {
        let receivers: Vec<Cell> = single.iter().filter(|s| s.1 == sender).map(|s| s.0).collect();
        let (w, e, full) = weights(step, port, &receivers);
        (sender, step.before.get(sender)[0], w, e, full)
    };
    let factors: Vec<_> = senders.into_iter().map(of).collect();
    let explained = factors.iter().filter(|f| f.4).count();
    let total = |w: [f64; 2]| 6.0 * (w[0] + 4.0 * w[1]);
    if best.0 < 0.05 * straight && explained * 2 < factors.len() {
        return Some(Law {
            name: "homogeneity",
            how: format!("twice the light gives not twice the result, {}", best.1),
        });
    }
    if explained * 2 < factors.len() || factors.len() < 2 {
        if best.0 < 0.3 * straight {
            return Some(Law {
                name: "homogeneity",
                how: format!("twice the light gives not twice the result, {}", best.1),
            });
        }
        return None;
    }
    let low = factors.iter().min_by(|a, b| total(a.2).total_cmp(&total(b.2)))?;
    let high = factors.iter().max_by(|a, b| total(a.2).total_cmp(&total(b.2)))?;
    let error = 30.0 * (low.3[0] + low.3[1] + high.3[0] + high.3[1]) + 1e-5;
    if total(high.2) - total(low.2) <= error {
        return None;
    }
    // A factor that follows the brightness breaks homogeneity, any other the place.
    let mut by_brightness: Vec<(f64, f64)> = factors.iter().map(|f| (f.1, total(f.2))).collect();
    by_brightness.sort_by(|a, b| a.0.total_cmp(&b.0));
    let rises = by_brightness.windows(2).filter(|w| w[1].1 > w[0].1).count();
    let monotone = rises == 0 || rises == by_brightness.len() - 1;
    let (name, what) = if monotone && by_brightness.len() > 3 {
        ("homogeneity", "the factor follows the brightness")
    } else {
        ("translation", "the factor depends on the place")
    };
    let how = format!("{what}: {:.5} from the cell {:?}, {:.5} from {:?}", total(low.2), low.0, total(high.2), high.0);
    Some(Law { name, how })
}
