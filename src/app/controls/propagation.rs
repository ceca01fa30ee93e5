//! How light is propagated: scheme, factor, iterations.

use egui::{DragValue, Ui};

use super::field::{choice, number, row};
use crate::app::critical::warning;
use crate::propagate::levels::Policy;
use crate::propagate::scheme;
use crate::scene::Propagation;
use crate::scene::preset::{MOST_ITERATIONS, Snapshots};
use crate::study::stability::outlook::Exceeded;

/// The largest factor that can be dragged to: far beyond where every scheme grows without bound.
const LARGEST_FACTOR: f64 = 100.0;

/// The fields of a propagator; those that the preset shares with no other. `exceeded` is a level that bears less
/// than its factor.
pub fn ui(ui: &mut Ui, propagation: &mut Propagation, exceeded: Option<Exceeded>) {
    let schemes: Vec<String> = scheme::names().iter().map(|name| (*name).to_owned()).collect();
    let about = scheme::find(&propagation.scheme);
    let hint = about.map_or_else(|| "not known".to_owned(), |scheme| format!("{}\n{}", scheme.summary, scheme.source));
    choice(ui, "Scheme", &hint, &mut propagation.scheme, &schemes, String::clone);
    let field = DragValue::new(&mut propagation.factor).range(0.0..=LARGEST_FACTOR).speed(0.01).max_decimals(6);
    number(
        ui,
        "Factor p",
        "The propagation factor; of the cascaded scheme 4 keeps all energy, 3 three quarters",
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
    };
    let hint = "How the operator follows from the level: alike on all, as in the thesis, or so that levels agree";
    choice(ui, "Levels", hint, &mut propagation.levels, &Policy::ALL, text);
    row(ui, "Clamp", |ui| {
        ui.checkbox(&mut propagation.clamp, "")
            .on_hover_text("Negative flux counts as none; off, every iteration is linear")
    });
}
