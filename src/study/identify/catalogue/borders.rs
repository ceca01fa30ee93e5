//! Mistakes about what is read where: clamps, borders, the order of updates, the cell itself.

use super::{Form, Group, Mistake, each_tap, form, none, scopes};
use crate::study::identify::port::{Border, Kind, Order, Port};
use crate::transport::lattice::face::Direction;

pub(super) const MISTAKES: &[Mistake] = &[
    Mistake {
        id: "clamp-none",
        sentence: "Negative flux is sent on.",
        remedy: "Clamp each face's flux: max(0, a · Y(dir)), for the far face and the four sides.",
        group: Group::Clamp,
        edits: || vec![form("", unclamped([true; 6], true, true))],
    },
    Mistake {
        id: "clamp-partial",
        sentence: "Some faces are clamped and others are not.",
        remedy: "Clamp each face's flux: max(0, a · Y(dir)), for the far face and the four sides.",
        group: Group::Clamp,
        edits: partial,
    },
    Mistake {
        id: "edge-border",
        sentence: "Cells at the border read themselves as the neighbour outside (clamp to edge).",
        remedy: "Outside the grid is dark: border colour zero, or a test of the index.",
        group: Group::Border,
        edits: || vec![form("", |port: &mut Port| port.border = Border::Edge)],
    },
    Mistake {
        id: "wrap-border",
        sentence: "Cells at the border read the other end of the grid (repeat).",
        remedy: "Outside the grid is dark: border colour zero, or a test of the index.",
        group: Group::Border,
        edits: || vec![form("", |port: &mut Port| port.border = Border::Wrap)],
    },
    Mistake {
        id: "flat-layout",
        sentence: "Slices lie side by side in one picture and rows run over into the next slice.",
        remedy: "Test the cell's own index before computing its place in the picture: outside the grid is dark.",
        group: Group::Border,
        edits: flat,
    },
    Mistake {
        id: "in-place",
        sentence: "The grid is swept in place: neighbours that are already updated are read.",
        remedy: "Read one grid and write another, then exchange them.",
        group: Group::Order,
        edits: sweeps,
    },
    Mistake {
        id: "chessboard",
        sentence: "Cells of one parity are updated first, the others from them.",
        remedy: "Read one grid and write another, then exchange them.",
        group: Group::Order,
        edits: chessboard,
    },
    Mistake {
        id: "own-cell",
        sentence: "A cell reads itself where it should read its neighbour.",
        remedy: "Read the cell at x - d for light that travels along d.",
        group: Group::Order,
        edits: || vec![form("light never leaves", |port: &mut Port| port.reads_itself = true)],
    },
    Mistake {
        id: "wrong-cell-copied",
        sentence: "The copy of the source that the first iteration keeps is a neighbour's.",
        remedy: "Copy the cell itself, S1(x) = S0(x) + p·P(S0)(x), or nothing.",
        group: Group::Copy,
        edits: copied,
    },
    Mistake {
        id: "stale-target",
        sentence: "The target grid is not cleared, so that S(k+1) still holds S(k-1).",
        remedy: "Clear the grid that is written before each iteration, or write with = in place of +=.",
        group: Group::Number,
        edits: none,
    },
    Mistake {
        id: "temporal-mix",
        sentence: "New light is mixed with old light.",
        remedy: "Write the new light alone; mix over frames after the last iteration if at all.",
        group: Group::Number,
        edits: none,
    },
    Mistake {
        id: "sum-into-source",
        sentence: "Propagated light is added to the grid that is propagated next, S := S + P(S).",
        remedy: "Keep two grids: S(k+1) = P(S(k)), and the sum A += S(k+1).",
        group: Group::Number,
        edits: none,
    },
];

/// Takes clamps away.
fn unclamped(scope: [bool; 6], far: bool, sides: bool) -> impl Fn(&mut Port) + Send + Sync {
    move |port: &mut Port| {
        each_tap(port, scope, |_, tap| {
            let chosen = if tap.kind == Kind::Far { far } else { sides };
            tap.clamp &= !chosen;
        });
    }
}

fn partial() -> Vec<Form> {
    let mut forms = Vec::new();
    for (name, far, sides) in [
        ("sides are not clamped", false, true),
        ("the far face is not clamped", true, false),
        ("not clamped", true, true),
    ] {
        for (scope_name, scope) in scopes() {
            if scope == [true; 6] && far && sides {
                continue;
            }
            let name = if scope_name.is_empty() { name.to_owned() } else { format!("{scope_name}: {name}") };
            forms.push(form(name, unclamped(scope, far, sides)));
        }
    }
    forms
}

fn flat() -> Vec<Form> {
    let pairs = [(0, 2), (1, 2), (0, 1), (2, 1), (1, 0), (2, 0)];
    let names = ["x", "y", "z"];
    pairs
        .map(|(row, slice)| {
            form(format!("{} runs over into {}", names[row], names[slice]), move |port: &mut Port| {
                port.border = Border::Flat(row, slice)
            })
        })
        .to_vec()
}

fn sweeps() -> Vec<Form> {
    (0..8)
        .map(|bits| {
            let up: [bool; 3] = std::array::from_fn(|a| bits >> a & 1 == 0);
            let name = |a: usize| format!("{}{}", if up[a] { "+" } else { "-" }, ["x", "y", "z"][a]);
            form(format!("swept towards {} {} {}", name(0), name(1), name(2)), move |port: &mut Port| {
                port.order = Order::Sweep(up)
            })
        })
        .collect()
}

fn chessboard() -> Vec<Form> {
    [0, 1]
        .map(|first| {
            let name = ["even cells first", "odd cells first"][first];
            form(name, move |port: &mut Port| port.order = Order::Chessboard(first))
        })
        .to_vec()
}

fn copied() -> Vec<Form> {
    let names = ["x + 1", "x - 1", "y + 1", "y - 1", "z + 1", "z - 1"];
    (0..Direction::ALL.len())
        .map(|d| form(format!("that of {}", names[d]), move |port: &mut Port| port.copied = Some(d)))
        .collect()
}
