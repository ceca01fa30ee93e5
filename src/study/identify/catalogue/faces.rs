//! Mistakes in the tables of faces: which way a side looks, about which axis its light is put back, which faces
//! there are.

use glam::DVec3;

use super::{Form, Group, Mistake, each_side, each_tap, form, none, others, scopes};
use crate::sh::Sh;
use crate::study::identify::port::{Kind, Port, Tap};
use crate::transport::lattice::face::Direction;

/// The part along the direction of travel of a side's direction, 2/√5, and the part across, 1/√5.
const ALONG: f64 = 0.894_427_190_999_915_9;
const ACROSS: f64 = 0.447_213_595_499_958;

pub(super) const MISTAKES: &[Mistake] = &[
    Mistake {
        id: "componentwise-sides",
        sentence: "The vectors of the side faces are multiplied with the direction of travel component by component, \
                   so that one axis is never turned.",
        remedy: "Turn the table (±1, 0, 2)/√5, (0, ±1, 2)/√5 by a rotation matrix for each of the six directions; \
                 read along (2d + f)/√5 and put the light back about f.",
        group: Group::Faces,
        edits: componentwise,
    },
    Mistake {
        id: "face-index-sides",
        sentence: "The table of orientations is indexed by the side's number where it should be the neighbour's, so \
                   sides put light back about no axis.",
        remedy: "Index the table of orientations by the neighbour; put a side's light back about its own axis f.",
        group: Group::Faces,
        edits: face_index,
    },
    Mistake {
        id: "zero-sides",
        sentence: "The table of side vectors is all zeros, so that sides carry the mean alone.",
        remedy: "Fill the table (a `static const` in HLSL; a global with an initialiser is left at zero): read along \
                 (2d + f)/√5, put back about f.",
        group: Group::Faces,
        edits: zero_sides,
    },
    Mistake {
        id: "sides-30-degrees",
        sentence: "Side faces are read 30 degrees off the direction of travel.",
        remedy: "The centre of a side face is seen at atan(1/2) = 26.565 degrees: read along (2d + f)/√5.",
        group: Group::Faces,
        edits: || angle(30.0),
    },
    Mistake {
        id: "sides-45-degrees",
        sentence: "Side faces are read 45 degrees off the direction of travel.",
        remedy: "The centre of a side face is seen at atan(1/2) = 26.565 degrees: read along (2d + f)/√5, not \
                 (d + f)/√2.",
        group: Group::Faces,
        edits: || angle(45.0),
    },
    Mistake {
        id: "sides-minus-d",
        sentence: "Side faces are read against the direction of travel, so that light turns back.",
        remedy: "Read sides along (2d + f)/√5, d from the sending cell to the receiving one. A vector on the left of \
                 a matrix turns it the other way.",
        group: Group::Faces,
        edits: sides_minus_d,
    },
    Mistake {
        id: "reads-minus-d",
        sentence: "The neighbour's light is read against the direction of travel, so that light turns back.",
        remedy: "Read along d = receiving cell - sending cell for the far face, along (2d + f)/√5 for the sides.",
        group: Group::Faces,
        edits: reads_minus_d,
    },
    Mistake {
        id: "reprojected-along-read",
        sentence: "Light of side faces is put back along the direction in which it was read.",
        remedy: "Put the light of a side back about the face's axis f, L(f), not about (2d + f)/√5.",
        group: Group::Faces,
        edits: reprojected,
    },
    Mistake {
        id: "near-face",
        sentence: "The face that both cells share sends light back.",
        remedy: "Go through five faces of the receiving cell: far and four sides. Leave out the shared one, f = -d.",
        group: Group::Faces,
        edits: near_face,
    },
    Mistake {
        id: "no-far-face",
        sentence: "The far face sends nothing.",
        remedy: "Add the far face: read along d, weight 4·asin(0.1)/(4π) = 0.0318842778, put back about d.",
        group: Group::Number,
        edits: none,
    },
];

/// The length of a function's direction part.
fn length(f: Sh<f64>) -> f64 {
    f.vector().length()
}

/// A function with another direction part.
pub(super) fn with_vector(f: Sh<f64>, v: DVec3) -> Sh<f64> {
    Sh([f.0[0], v.x, v.y, v.z])
}

/// Gives each of the four sides of every direction what a table in the plane across `frame` says of it.
fn tabled(port: &mut Port, frame: usize, rule: impl Fn(DVec3, DVec3, &mut Tap)) {
    let axis = |a: usize| Direction::ALL[2 * a].vector();
    let [u, v] = others(frame).map(axis);
    for (d, taps) in port.taps.iter_mut().enumerate() {
        let sides = taps.iter_mut().filter(|tap| tap.kind == Kind::Side);
        for (tap, side) in sides.zip([u, v, -u, -v]) {
            rule(Direction::ALL[d].vector(), side, tap);
        }
    }
}

fn axis_name(axis: usize) -> &'static str {
    ["x", "y", "z"][axis]
}

fn componentwise() -> Vec<Form> {
    [2, 1, 0]
        .map(|frame| {
            form(format!("{} is never turned", axis_name(frame)), move |port| {
                let along = Direction::ALL[2 * frame].vector() * ALONG;
                tabled(port, frame, |d, side, tap| {
                    let (read, lobe) = (length(tap.read), length(tap.lobe));
                    tap.read = with_vector(tap.read, d * (side * ACROSS + along) * read);
                    tap.lobe = with_vector(tap.lobe, d * side * lobe);
                });
            })
        })
        .to_vec()
}

fn face_index() -> Vec<Form> {
    // The first four orientations of the usual table lie in a plane; side i reads orientation i times table row i.
    [2, 1, 0]
        .map(|frame| {
            form(format!("the table of {}", axis_name(frame)), move |port| {
                let along = Direction::ALL[2 * frame].vector() * ALONG;
                let first = others(frame)[0];
                tabled(port, frame, |_, side, tap| {
                    let is_first = side[first] != 0.0;
                    let read = if is_first { along * side[first] * length(tap.read) } else { DVec3::ZERO };
                    tap.read = with_vector(tap.read, read);
                    tap.lobe = with_vector(tap.lobe, DVec3::ZERO);
                });
            })
        })
        .to_vec()
}

fn zero_sides() -> Vec<Form> {
    let cut = |reads: bool, lobes: bool| {
        move |port: &mut Port| {
            each_side(port, [true; 6], |_, tap| {
                if reads {
                    tap.read = with_vector(tap.read, DVec3::ZERO);
                }
                if lobes {
                    tap.lobe = with_vector(tap.lobe, DVec3::ZERO);
                }
            });
        }
    };
    // A table whose sides are zero leaves the part along d: read 2d/√5, put back about nothing.
    let only_along = |port: &mut Port| {
        each_side(port, [true; 6], |d, tap| {
            let along = d.vector() * ALONG * length(tap.read);
            tap.read = with_vector(tap.read, along);
            tap.lobe = with_vector(tap.lobe, DVec3::ZERO);
        });
    };
    vec![
        form("", cut(true, true)),
        form("sides read along 2d/√5 and put back about no axis", only_along),
        form("where light is put back", cut(false, true)),
        form("where light is read", cut(true, false)),
    ]
}

fn angle(degrees: f64) -> Vec<Form> {
    let turn = move |scope: [bool; 6]| {
        move |port: &mut Port| {
            let (across, along) = degrees.to_radians().sin_cos();
            each_side(port, scope, |d, tap| {
                let (f, read) = (Direction::ALL[tap.face].vector(), tap.read.vector());
                let v = d.vector() * along * sign(read.dot(d.vector())) + f * across * sign(read.dot(f));
                tap.read = with_vector(tap.read, v * read.length());
            });
        }
    };
    scopes().into_iter().map(|(name, scope)| form(name, turn(scope))).collect()
}

fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// A function mirrored on the plane across a direction.
fn turned_back(f: Sh<f64>, d: Direction) -> Sh<f64> {
    f.mirrored(d.axis())
}

fn sides_minus_d() -> Vec<Form> {
    let back = |scope| move |port: &mut Port| each_side(port, scope, |d, tap| tap.read = turned_back(tap.read, d));
    scopes().into_iter().map(|(name, scope)| form(name, back(scope))).collect()
}

fn reads_minus_d() -> Vec<Form> {
    let back = |scope| move |port: &mut Port| each_tap(port, scope, |d, tap| tap.read = turned_back(tap.read, d));
    let opposite = |scope| move |port: &mut Port| each_tap(port, scope, |_, tap| tap.read = tap.read.reversed());
    let mut forms: Vec<Form> = scopes().into_iter().map(|(name, scope)| form(name, back(scope))).collect();
    forms.extend(scopes().into_iter().map(|(name, scope)| {
        let name =
            if name.is_empty() { "all of it reversed".to_owned() } else { format!("{name}, all of it reversed") };
        form(name, opposite(scope))
    }));
    forms
}

fn reprojected() -> Vec<Form> {
    let along = |stretch: f64| {
        move |port: &mut Port| {
            each_side(port, [true; 6], |_, tap| {
                let read = tap.read.vector();
                if read != DVec3::ZERO {
                    tap.lobe = with_vector(tap.lobe, read.normalize() * length(tap.lobe) * stretch);
                }
            });
        }
    };
    vec![form("", along(1.0)), form("along d + f/2, not of unit length", along(1.25f64.sqrt()))]
}

fn near_face() -> Vec<Form> {
    let add = |towards: f64| {
        move |port: &mut Port| {
            for taps in &mut port.taps {
                let Some(far) = taps.iter().find(|tap| tap.kind == Kind::Far).copied() else { continue };
                let read = with_vector(far.read, far.read.vector() * towards);
                taps.push(Tap { kind: Kind::Near, read, lobe: far.lobe.reversed(), ..far });
            }
        }
    };
    vec![form("read along d", add(1.0)), form("read along -d", add(-1.0))]
}
