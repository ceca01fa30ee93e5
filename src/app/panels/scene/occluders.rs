//! The list of occluders, and how they act.

use egui::{CollapsingHeader, DragValue, Ui};

use super::injectors::titled_buttons;
use crate::app::panels::button::small_button;
use crate::app::panels::field::{self, choice, named_choice, named_row, number};
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::cell_files::opaque;
use crate::app::session::purpose::Purpose;
use crate::scene::Preset;
use crate::scene::occluder::{Accumulate, Axis, BlockingSign, Occluder, OccluderKind, Occlusion, OcclusionMode};

/// The list, and a button that makes it longer.
pub fn ui(ui: &mut Ui, preset: &mut Preset, asks: &mut Asks) {
    let mut change = None;
    let count = preset.occluders.len();
    for (i, occluder) in preset.occluders.iter_mut().enumerate() {
        ui.push_id(("occluder", i), |ui| {
            ui.horizontal(|ui| {
                let on = ui.checkbox(&mut occluder.enabled, "").on_hover_text("Whether it stands in the scene");
                field::name(&on, &format!("Occluder {} on", i + 1));
                let title = format!("{}. {}", i + 1, summary(&occluder.kind));
                change = titled_buttons(ui, &title, "occluder", i, count).or(change);
            });
            one(ui, i, occluder, preset.size, asks);
        });
    }
    if let Some((i, change)) = change {
        change.apply(&mut preset.occluders, i);
    }
    ui.horizontal_wrapped(|ui| {
        let (middle, last) = (preset.size / 2, preset.size - 1);
        let block = OccluderKind::Box { from: [middle, 0, 0], to: [middle, middle, last] };
        let plane = OccluderKind::Plane { axis: Axis::X, at: middle };
        for (name, kind) in [("Add box", block), ("Add plane", plane)] {
            if ui.button(name).clicked() {
                preset.occluders.push(opaque(kind));
            }
        }
        let hint = "A CSV file of occupied cells, beside the preset";
        if ui.button("Add file…").on_hover_text(hint).accessible_name("Add occluder file…").clicked() {
            asks.ask(Ask::Choose(Purpose::Occluder(preset.occluders.len())));
        }
    });
    if !preset.occluders.is_empty() {
        acting(ui, &mut preset.occlusion);
    }
}

fn summary(kind: &OccluderKind) -> String {
    match kind {
        OccluderKind::Box { from: [a, b, c], to: [d, e, f] } => format!("Box ({a}, {b}, {c}) to ({d}, {e}, {f})"),
        OccluderKind::Plane { axis, at } => format!("Plane {} = {at}", axis_name(*axis)),
        OccluderKind::File { path } => format!("File {}", path.file_name().unwrap_or_default().to_string_lossy()),
    }
}

fn axis_name(axis: Axis) -> &'static str {
    match axis {
        Axis::X => "x",
        Axis::Y => "y",
        Axis::Z => "z",
    }
}

fn one(ui: &mut Ui, i: usize, occluder: &mut Occluder, size: usize, asks: &mut Asks) {
    let full = |part: &str| format!("Occluder {} {part}", i + 1);
    CollapsingHeader::new("Settings").id_salt("settings").default_open(false).show(ui, |ui| {
        match &mut occluder.kind {
            OccluderKind::Box { from, to } => {
                field::cell(ui, "From", &full("from"), from, size);
                field::cell(ui, "To", &full("to"), to, size);
            }
            OccluderKind::Plane { axis, at } => {
                let all = [Axis::X, Axis::Y, Axis::Z];
                let hint = "The axis that it stands across";
                named_choice(ui, "Axis", &full("axis"), hint, axis, &all, |axis| axis_name(*axis).to_owned());
                named_row(ui, "At", &full("at"), |ui| {
                    field::add(ui, DragValue::new(at).range(0..=size.saturating_sub(1)).speed(0.1))
                });
            }
            OccluderKind::File { path } => {
                named_row(ui, "File", &full("file"), |ui| ui.label(path.display().to_string()));
                if small_button(ui, "Choose…", &full("choose file")).clicked() {
                    asks.ask(Ask::Choose(Purpose::Occluder(i)));
                }
            }
        }
        named_row(ui, "Normal", &full("normal by hand"), |ui| {
            let mut chosen = occluder.normal.is_some();
            let hint = "Off, each cell's normal comes from the occupied cells around it";
            let response = ui.checkbox(&mut chosen, "by hand").on_hover_text(hint);
            if response.changed() {
                occluder.normal = chosen.then_some([-1.0, 0.0, 0.0]);
            }
            response
        });
        if let Some(normal) = &mut occluder.normal {
            ui.horizontal(|ui| field::vector(ui, &full("normal"), normal));
        }
        named_row(ui, "Opacity", &full("opacity"), |ui| {
            field::add(ui, DragValue::new(&mut occluder.opacity).range(0.0..=1.0).speed(0.01).max_decimals(4))
        });
        named_row(ui, "Albedo", &full("albedo"), |ui| {
            let mut rgb = occluder.albedo.map(|c| c as f32);
            let response = ui.color_edit_button_rgb(&mut rgb).on_hover_text("The share of light that is sent back");
            if response.changed() {
                occluder.albedo = rgb.map(|c| f64::from(c.clamp(0.0, 1.0)));
            }
            response
        });
    });
}

fn acting(ui: &mut Ui, occlusion: &mut Occlusion) {
    let text = |mode: &OcclusionMode| match mode {
        OcclusionMode::Off => "Off".to_owned(),
        OcclusionMode::Fuzzy => "Fuzzy".to_owned(),
        OcclusionMode::Hard => "Hard".to_owned(),
    };
    let all = [OcclusionMode::Off, OcclusionMode::Fuzzy, OcclusionMode::Hard];
    let hint = "Fuzzy: a geometry volume half a cell off the light; hard: an occupied cell passes nothing";
    choice(ui, "Occlusion", hint, &mut occlusion.mode, &all, text);
    match occlusion.mode {
        OcclusionMode::Off => return,
        OcclusionMode::Fuzzy => fuzzy(ui, occlusion),
        OcclusionMode::Hard => (),
    }
    let field = DragValue::new(&mut occlusion.bounce).range(0.0..=100.0).speed(0.01);
    number(ui, "Bounce", "What reflected light is multiplied by; the reflective scheme mirrors by albedo alone", field);
    let text = |accumulate: &Accumulate| match accumulate {
        Accumulate::Everywhere => "Everywhere".to_owned(),
        Accumulate::Occupied => "Occupied cells".to_owned(),
    };
    let all = [Accumulate::Everywhere, Accumulate::Occupied];
    choice(ui, "Accumulate", "Which cells sum up the light that they receive", &mut occlusion.accumulate, &all, text);
}

fn fuzzy(ui: &mut Ui, occlusion: &mut Occlusion) {
    let field = DragValue::new(&mut occlusion.amplifier).range(0.0..=100.0).speed(0.01);
    number(ui, "Amplifier", "What fuzzy blocking is multiplied by", field);
    let text = |sign: &BlockingSign| match sign {
        BlockingSign::AgainstTravel => "Fronts block".to_owned(),
        BlockingSign::AlongTravel => "Backs block".to_owned(),
    };
    let all = [BlockingSign::AgainstTravel, BlockingSign::AlongTravel];
    choice(ui, "Sign", "Which side of a surface blocks light", &mut occlusion.sign, &all, text);
    let field = DragValue::new(&mut occlusion.from_iteration).range(0..=1000).speed(0.05);
    number(ui, "From iteration", "The first iteration that it acts in", field);
}
