//! How light is propagated: scheme, factor, iterations.

use egui::{DragValue, Ui};

use crate::app::panels::field::{choice, number, row};
use crate::app::panels::runs::warning;
use crate::scene::Propagation;
use crate::scene::propagation::Index;
use crate::scene::propagation::Policy;
use crate::scene::propagation::descent::{Descent, FARTHEST, LEAST_SIDE};
use crate::scene::propagation::directions::Lattice;
use crate::scene::propagation::directions::Rule;
use crate::scene::propagation::directions::{MOST_DIRECTIONS, Setting};
use crate::scene::propagation::{MOST_ITERATIONS, Snapshots};
use crate::study::stability::outlook::Exceeded;
use crate::transport;

/// The largest factor that can be dragged to: far beyond where every scheme grows without bound.
const LARGEST_FACTOR: f64 = 100.0;

/// The fields of a propagator; those that the preset shares with no other. `size` is the volume's side, `exceeded` is a level that bears less than its factor.
pub fn ui(ui: &mut Ui, propagation: &mut Propagation, size: usize, exceeded: Option<Exceeded>) {
    let schemes: Vec<String> = transport::names().iter().map(|name| (*name).to_owned()).collect();
    let kind = transport::find(&propagation.scheme);
    let hint = kind.map_or(String::new(), |kind| format!("{}\n{}", kind.summary, kind.source));
    choice(ui, "Scheme", &hint, &mut propagation.scheme, &schemes, String::clone);
    if kind.is_some_and(|kind| !kind.can.levels) {
        directions(ui, &mut propagation.ordinates);
    }
    let field = DragValue::new(&mut propagation.factor).range(0.0..=LARGEST_FACTOR).speed(0.01).max_decimals(6);
    number(
        ui,
        "Factor p",
        "The propagation factor; with the cascaded scheme and ordinates 4 keeps all energy, 3 three quarters",
        field,
    );
    warning(ui, exceeded);
    let field = DragValue::new(&mut propagation.iterations).range(0..=MOST_ITERATIONS).speed(0.1);
    number(ui, "Iterations", "How many iterations Run all does", field);
    let text = |snapshots: &Snapshots| match snapshots {
        Snapshots::Thesis => "Thesis: S₀ counts".to_owned(),
        Snapshots::WithoutInjected => "From S₁ on".to_owned(),
        Snapshots::CopyFirst => "NVIDIA: copy first".to_owned(),
    };
    let all = [Snapshots::Thesis, Snapshots::WithoutInjected, Snapshots::CopyFirst];
    let hint = "What the accumulated light sums: S₀ to S_k, or as NVIDIA's sample does, S₁ = S₀ + p·P(S₀) and on";
    choice(ui, "Snapshots", hint, &mut propagation.snapshots, &all, text);
    let text = |policy: &Policy| match policy {
        Policy::Same => "One factor for all".to_owned(),
        Policy::Consistent => "Consistent".to_owned(),
        Policy::Exact => "Exact".to_owned(),
        Policy::Ahead => "Exact, ahead".to_owned(),
    };
    let hint = "How the operator follows from the level: alike on all, as in the thesis, or so that levels agree";
    choice(ui, "Levels", hint, &mut propagation.levels, &Policy::ALL, text);
    if kind.is_some_and(|kind| kind.can.levels) {
        index(ui, &mut propagation.index);
        descent(ui, &mut propagation.descent, size);
    }
    row(ui, "Clamp", |ui| {
        ui.checkbox(&mut propagation.clamp, "")
            .on_hover_text("Negative flux counts as none; off, every iteration is linear")
    });
}

/// The fields of the index.
fn index(ui: &mut Ui, index: &mut Index) {
    let reach = if let Index::Radial { reach } = index { *reach } else { Index::REACH };
    let text = |index: &Index| match index {
        Index::Thesis => "Finest that is lit".to_owned(),
        Index::Radial { .. } => "By distance, blended".to_owned(),
    };
    let hint = "Which level is sampled where: the finest that has received light, as in the thesis, or the coarser, the \
                farther injected light is, neighbouring levels blended. Made for exact levels ahead";
    choice(ui, "Index", hint, index, &[Index::Thesis, Index::Radial { reach }], text);
    if let Index::Radial { reach } = index {
        let field = DragValue::new(reach).range(0.5..=1024.0).speed(0.02).max_decimals(2);
        number(ui, "Reach", "How far from injected light the finest level alone is sampled, in cells", field);
    }
}

/// The fields of a descent.
fn descent(ui: &mut Ui, descent: &mut Descent, size: usize) {
    let distance = match descent {
        Descent::Leaves { distance } => *distance,
        _ => Descent::DISTANCE,
    };
    let (side, center) = match descent {
        Descent::Cascades { side, center, .. } => (*side, *center),
        _ => (Descent::SIDE, None),
    };
    let text = |descent: &Descent| match descent {
        Descent::Off => "Off".to_owned(),
        Descent::Cells => "All cells".to_owned(),
        Descent::Leaves { .. } => "Leaves".to_owned(),
        Descent::Cascades { alone: false, .. } => "Nested cascades".to_owned(),
        Descent::Cascades { alone: true, .. } => "Cascades, each alone".to_owned(),
    };
    let cascades = |alone| Descent::Cascades { side, center, alone }.fitted(size);
    let mut all = vec![Descent::Off, Descent::Cells, Descent::Leaves { distance }];
    if size >= LEAST_SIDE {
        all.extend([false, true].map(cascades));
    }
    let hint = "Whether the coarse levels start the fine ones, each with as many iterations: over all cells of a level, \
                over leaves, the larger the farther from injected light, or over nested grids about a point; or such \
                grids each propagated by itself, as NVIDIA's sample does";
    choice(ui, "Descent", hint, descent, &all, text);
    if let Descent::Leaves { distance } = descent {
        let field = DragValue::new(distance).range(2.0..=FARTHEST).speed(0.02).max_decimals(2);
        number(
            ui,
            "Leaf distance",
            "How far leaves stay from injected light, in halves of their width; 2 or more",
            field,
        );
    }
    if let Descent::Cascades { side, .. } = descent {
        let sides: Vec<usize> = (0..).map(|i| LEAST_SIDE << i).take_while(|side| *side <= size).collect();
        choice(ui, "Cascade side", "Cells along a side of every grid", side, &sides, |n| format!("{n}³"));
    }
}

/// The fields of the ordinates.
fn directions(ui: &mut Ui, setting: &mut Setting) {
    let field = DragValue::new(&mut setting.directions).range(1..=MOST_DIRECTIONS).speed(0.2);
    number(ui, "Directions", "About how many; the octahedral lattice has 8, 32, 72, 128, 200, …", field);
    let text = |rule: &Rule| match rule {
        Rule::Donor => "Donor cell".to_owned(),
        Rule::Faces => "By face".to_owned(),
    };
    let hint = "How light is shared among a cell's far faces: all alike, or by the face through which it came in";
    choice(ui, "Shares", hint, &mut setting.rule, &Rule::ALL, text);
    let text = |lattice: &Lattice| match lattice {
        Lattice::Fibonacci => "Fibonacci spiral".to_owned(),
        Lattice::Octahedral => "Octahedral".to_owned(),
    };
    let hint = "How directions are spread: a spiral from pole to pole, or a set with all symmetries of the cube";
    choice(ui, "Lattice", hint, &mut setting.lattice, &Lattice::ALL, text);
}
