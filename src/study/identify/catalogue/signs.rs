//! Mistakes of one sign, one entry or one axis, and of lobes.

use glam::DVec3;

use super::faces::with_vector;
use super::{Form, Group, Mistake, each_side, each_tap, form, others, scopes};
use crate::sh::{K0, K1, LOBE0, LOBE1, Sh};
use crate::study::identify::port::Port;
use crate::transport::lattice::face::Direction;

pub(super) const MISTAKES: &[Mistake] = &[
    Mistake {
        id: "read-sign",
        sentence: "One sign of the basis is wrong where light is read.",
        remedy: "Read with Y(d) = (0.28209479, -0.48860251·y, 0.48860251·z, -0.48860251·x), the same signs as the \
                 lobes that are injected.",
        group: Group::Faces,
        edits: read_sign,
    },
    Mistake {
        id: "lobe-sign",
        sentence: "One sign of the lobe is wrong where light is put back.",
        remedy: "Put back L(f) = (0.88622693, -1.02332671·y, 1.02332671·z, -1.02332671·x): the same signs as the \
                 basis.",
        group: Group::Faces,
        edits: lobe_sign,
    },
    Mistake {
        id: "mirrored-sides",
        sentence: "Sides are put back about the opposite face of the one they were read towards.",
        remedy: "The light read along (2d + f)/√5 goes back about f, not -f: turn both vectors by the same matrix.",
        group: Group::Faces,
        edits: mirrored,
    },
    Mistake {
        id: "axes-exchanged",
        sentence: "Two axes are exchanged between reading a side and putting its light back.",
        remedy: "The light read along (2d + f)/√5 goes back about f: check the table's rows for this direction.",
        group: Group::Faces,
        edits: exchanged,
    },
    Mistake {
        id: "side-table-sign",
        sentence: "One entry of the table of sides has the wrong sign.",
        remedy: "The four sides are (1, 0), (0, 1), (-1, 0), (0, -1).",
        group: Group::Faces,
        edits: table_sign,
    },
    Mistake {
        id: "basis-and-lobe-exchanged",
        sentence: "The lobe's constants are used to read and the basis's to put back.",
        remedy: "Read with Y: 1/(2√π) = 0.28209479 and √3/(2√π) = 0.48860251. Put back L: √π/2 = 0.88622693 and \
                 √(π/3) = 1.02332671.",
        group: Group::Faces,
        edits: basis_and_lobe,
    },
    Mistake {
        id: "wrong-lobe",
        sentence: "Light is put back with another lobe than the clamped cosine.",
        remedy: "The clamped cosine lobe is (√π/2, √(π/3)·n) = (0.88622693, 1.02332671·n): band 1 over band 0 is \
                 2/√3 = 1.15470054.",
        group: Group::Faces,
        edits: lobes,
    },
    Mistake {
        id: "four-digit-constants",
        sentence: "Constants are given to four digits.",
        remedy: "Basis 0.28209479, 0.48860251; lobe 0.88622693, 1.02332671; far 0.4006696846, side 0.4234313544 \
                 over 4π.",
        group: Group::Faces,
        edits: four_digits,
    },
    Mistake {
        id: "injects-minus-n",
        sentence: "The lobe of -n is injected: light leaves into the surface.",
        remedy: "Inject L(n), n the surface's normal on the lit side; in the published basis its signs are \
                 (+, -y, +z, -x).",
        group: Group::Injection,
        edits: minus_n,
    },
    Mistake {
        id: "injection-axes",
        sentence: "The lobe that is injected has other axes or signs than propagation reads.",
        remedy: "Use one function for the lobe that is injected and the lobe that is put back, and the grid's axes \
                 for its normal.",
        group: Group::Injection,
        edits: axes,
    },
];

fn axis_name(axis: usize) -> &'static str {
    ["x", "y", "z"][axis]
}

fn read_sign() -> Vec<Form> {
    let turn = |a: usize| move |port: &mut Port| each_tap(port, [true; 6], |_, tap| tap.read = tap.read.mirrored(a));
    (0..3).map(|a| form(axis_name(a), turn(a))).collect()
}

fn lobe_sign() -> Vec<Form> {
    let turn = |a: usize| move |port: &mut Port| each_tap(port, [true; 6], |_, tap| tap.lobe = tap.lobe.mirrored(a));
    (0..3).map(|a| form(axis_name(a), turn(a))).collect()
}

/// With a comma where both are there.
fn both(first: &str, second: &str) -> String {
    if first.is_empty() || second.is_empty() { format!("{first}{second}") } else { format!("{first}, {second}") }
}

fn mirrored() -> Vec<Form> {
    let mut forms = Vec::new();
    for which in [None, Some(0), Some(1), Some(2)] {
        for (name, scope) in scopes() {
            let kept = |d: usize| which.is_none_or(|a| Direction::ALL[d].axis() != a);
            let scope: [bool; 6] = std::array::from_fn(|d| scope[d] && kept(d));
            if scope == [false; 6] {
                continue;
            }
            let sides = which.map_or(String::new(), |a: usize| format!("sides along {}", axis_name(a)));
            let rule = move |port: &mut Port| {
                each_side(port, scope, |_, tap| {
                    if which.is_none_or(|a| Direction::ALL[tap.face].axis() == a) {
                        tap.lobe = tap.lobe.reversed();
                    }
                });
            };
            forms.push(form(both(&name, &sides), rule));
        }
    }
    forms
}

/// A function with two of its axes exchanged.
fn swapped(f: Sh<f64>, [u, v]: [usize; 2]) -> Sh<f64> {
    let Sh(mut c) = f;
    c.swap(1 + u, 1 + v);
    Sh(c)
}

fn exchanged() -> Vec<Form> {
    let mut forms = Vec::new();
    for (name, scope) in scopes() {
        let swap = move |port: &mut Port| {
            each_side(port, scope, |d, tap| tap.lobe = swapped(tap.lobe, others(d.axis())));
        };
        forms.push(form(name.clone(), swap));
        // The sides of one axis alone go to the other axis.
        for first in [0, 1] {
            let rule = move |port: &mut Port| {
                each_side(port, scope, |d, tap| {
                    let axes = others(d.axis());
                    if Direction::ALL[tap.face].axis() == axes[first] {
                        tap.lobe = swapped(tap.lobe, axes);
                    }
                });
            };
            forms.push(form(
                both(&name, ["the first axis goes to the second", "the second axis goes to the first"][first]),
                rule,
            ));
        }
    }
    for pair in [[0, 1], [1, 2], [0, 2]] {
        let [a, b] = pair.map(axis_name);
        let read = move |port: &mut Port| each_tap(port, [true; 6], |_, tap| tap.read = swapped(tap.read, pair));
        let lobe = move |port: &mut Port| each_tap(port, [true; 6], |_, tap| tap.lobe = swapped(tap.lobe, pair));
        forms.push(form(format!("{a} and {b}, reading"), read));
        forms.push(form(format!("{a} and {b}, putting back"), lobe));
    }
    forms
}

/// How a table of sides is laid over the axes across a direction of travel.
#[derive(Clone, Copy)]
enum Table {
    /// By the orientation matrices that most ports share.
    Matrices,
    /// The lower axis first.
    Rising,
    /// The axis that follows in the cycle x, y, z first.
    Cyclic,
}

/// The two axes in which a table of sides counts for a direction of travel.
fn table_axes(d: Direction, table: Table) -> [DVec3; 2] {
    let [u, v] = others(d.axis()).map(|a| Direction::ALL[2 * a].vector());
    match (table, d.axis(), d.is_positive()) {
        (Table::Rising, ..) => [u, v],
        (Table::Cyclic, 1, _) => [v, u],
        (Table::Cyclic, ..) => [u, v],
        (Table::Matrices, 0, true) => [-v, u],
        (Table::Matrices, 0, false) => [v, u],
        (Table::Matrices, 1, true) => [u, -v],
        (Table::Matrices, 1, false) => [u, v],
        (Table::Matrices, _, true) => [u, v],
        (Table::Matrices, _, false) => [-u, v],
    }
}

fn table_sign() -> Vec<Form> {
    let mut forms = Vec::new();
    let single = scopes().into_iter().filter(|(_, scope)| scope.iter().filter(|s| **s).count() == 1);
    let everywhere = [("", Table::Matrices), ("in the grid's axes", Table::Rising), ("in cyclic axes", Table::Cyclic)];
    let everywhere = everywhere.map(|(name, table)| (name.to_owned(), [true; 6], table));
    let single = single.map(|(name, scope)| (name, scope, Table::Rising));
    for (name, scope, table) in everywhere.into_iter().chain(single) {
        for entry in 0..4 {
            for (what, reads, lobes) in
                [("", true, true), ("where light is read", true, false), ("where light is put back", false, true)]
            {
                let rule = move |port: &mut Port| {
                    each_side(port, scope, |d, tap| {
                        let axis = table_axes(d, table)[entry % 2] * if entry < 2 { 1.0 } else { -1.0 };
                        let f = Direction::ALL[tap.face];
                        if f.vector() != axis {
                            return;
                        }
                        if reads {
                            tap.read = tap.read.mirrored(f.axis());
                        }
                        if lobes {
                            tap.lobe = tap.lobe.mirrored(f.axis());
                        }
                    });
                };
                forms.push(form(both(&name, &both(&format!("entry {entry}"), what)), rule));
            }
        }
    }
    forms
}

/// Multiplies the bands of a function.
fn banded(f: Sh<f64>, [band0, band1]: [f64; 2]) -> Sh<f64> {
    let Sh([c00, x, y, z]) = f;
    Sh([c00 * band0, x * band1, y * band1, z * band1])
}

/// Multiplies the bands of what reads and of what is put back.
fn rescaled(read: [f64; 2], lobe: [f64; 2]) -> impl Fn(&mut Port) + Send + Sync {
    move |port: &mut Port| {
        each_tap(port, [true; 6], |_, tap| {
            tap.read = banded(tap.read, read);
            tap.lobe = banded(tap.lobe, lobe);
        });
    }
}

fn basis_and_lobe() -> Vec<Form> {
    let to_lobe = [LOBE0 / K0, LOBE1 / K1];
    let to_basis = [K0 / LOBE0, K1 / LOBE1];
    vec![
        form("", rescaled(to_lobe, to_basis)),
        form("reading with the lobe", rescaled(to_lobe, [1.0; 2])),
        form("putting back with the basis", rescaled([1.0; 2], to_basis)),
    ]
}

fn lobes() -> Vec<Form> {
    let pi = std::f64::consts::PI;
    let lobe = |name: &str, band0: f64, band1: f64| form(name, rescaled([1.0; 2], [band0 / LOBE0, band1 / LOBE1]));
    vec![
        lobe("√π·(1/4, 1/2)", pi.sqrt() / 4.0, pi.sqrt() / 2.0),
        lobe("(1, 1)", 1.0, 1.0),
        lobe("√π/2 in both bands", LOBE0, LOBE0),
        // Normalised clamped cosine without the factor of band 1's convolution.
        lobe("(√π/2, √(3π)/2)", LOBE0, (3.0 * pi).sqrt() / 2.0),
        lobe("(√π/2, √(π/3)/2)", LOBE0, LOBE1 / 2.0),
        lobe("(√π/2, 2·√(π/3))", LOBE0, 2.0 * LOBE1),
    ]
}

fn four_digits() -> Vec<Form> {
    let basis = [0.2821 / K0, 0.4886 / K1];
    let lobe = [0.8862 / LOBE0, 1.0233 / LOBE1];
    let root = |port: &mut Port| {
        each_side(port, [true; 6], |_, tap| {
            tap.read = with_vector(tap.read, tap.read.vector() * (0.4472 * 5f64.sqrt()));
        });
    };
    let all = move |port: &mut Port| {
        rescaled(basis, lobe)(port);
        root(port);
    };
    vec![
        form("basis and lobe", rescaled(basis, lobe)),
        form("basis", rescaled(basis, [1.0; 2])),
        form("lobe", rescaled([1.0; 2], lobe)),
        form("basis, lobe and side vectors", all),
        form("side vectors", root),
    ]
}

/// Another convention for the direction part: propagation reads what injection wrote with its axes turned.
fn turned(axes: [usize; 3], signs: [f64; 3]) -> impl Fn(&mut Port) + Send + Sync {
    move |port: &mut Port| {
        let turn = |f: Sh<f64>| {
            let v = f.vector();
            with_vector(f, DVec3::from_array(std::array::from_fn(|a| signs[a] * v[axes[a]])))
        };
        for tap in port.taps.iter_mut().flatten() {
            tap.read = turn(tap.read);
            tap.lobe = turn(tap.lobe);
        }
    }
}

fn minus_n() -> Vec<Form> {
    vec![form("", turned([0, 1, 2], [-1.0; 3]))]
}

fn axes() -> Vec<Form> {
    let orders = [[0, 2, 1], [1, 0, 2], [2, 1, 0], [1, 2, 0], [2, 0, 1], [0, 1, 2]];
    let mut forms = Vec::new();
    // Exchanged axes before wrong signs, few signs before many.
    for (bits, order) in [0, 1, 2, 4, 3, 5, 6, 7].into_iter().flat_map(|bits| orders.map(|order| (bits, order))) {
        let signs: [f64; 3] = std::array::from_fn(|a| if bits >> a & 1 == 1 { -1.0 } else { 1.0 });
        if order == [0, 1, 2] && (bits == 0 || bits == 7) {
            continue;
        }
        let name = |a: usize| format!("{}{}", if signs[a] < 0.0 { "-" } else { "" }, axis_name(order[a]));
        forms.push(form(
            format!("(x, y, z) is injected as ({}, {}, {})", name(0), name(1), name(2)),
            turned(order, signs),
        ));
    }
    forms
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::identify::port::Kind;
    use crate::transport::lattice::schemes;

    #[test]
    fn a_sign_of_the_basis_and_of_the_lobe_together_are_a_convention() {
        let right = Port::of(&schemes::all()[0]);
        let (mut signs, mut convention) = (right.clone(), right);
        (read_sign()[1].1)(&mut signs);
        (lobe_sign()[1].1)(&mut signs);
        turned([0, 1, 2], [1.0, -1.0, 1.0])(&mut convention);
        assert_eq!(signs, convention);
    }

    #[test]
    fn sides_that_look_the_other_way_and_lobes_that_do_are_the_same_mistake() {
        let right = Port::of(&schemes::all()[0]);
        let mut mirrored_all = right.clone();
        (mirrored()[0].1)(&mut mirrored_all);
        for taps in &mirrored_all.taps {
            for tap in taps.iter().filter(|tap| tap.kind == Kind::Side) {
                assert!(tap.read.vector().dot(tap.lobe.vector()) < 0.0);
            }
        }
    }
}
