//! The list of injectors.

use egui::{CollapsingHeader, Color32, DragValue, Rect, Response, Sense, Ui, Vec2, vec2};

use super::Surroundings;
use crate::app::panels::button::small_button;
use crate::app::panels::field::{self, named_choice, named_row};
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::purpose::Purpose;
use crate::report::slice::Axis;
use crate::scene::Preset;
use crate::scene::injector::{Injector, InjectorKind, Side};

/// The largest multiplier that can be dragged to.
const LARGEST_MULTIPLIER: f64 = 1e6;

/// The list, and a button that makes it longer.
pub fn ui(ui: &mut Ui, preset: &mut Preset, around: Surroundings, asks: &mut Asks) {
    let mut change = None;
    let count = preset.injectors.len();
    for (i, injector) in preset.injectors.iter_mut().enumerate() {
        ui.push_id(("injector", i), |ui| {
            change = head(ui, i, count, injector).or(change);
            one(ui, i, injector, preset.size, around, asks);
        });
    }
    if let Some((i, change)) = change {
        change.apply(&mut preset.injectors, i);
    }
    ui.horizontal_wrapped(|ui| {
        let middle = [preset.size / 2; 3];
        let kinds = [
            ("Add wall", InjectorKind::Wall { side: Side::NegX }),
            ("Add rectangle", rectangle(preset.size)),
            ("Add single cell", InjectorKind::Single { cell: middle }),
        ];
        for (name, kind) in kinds {
            if ui.button(name).clicked() {
                preset.injectors.push(Injector::new(kind));
            }
        }
        if ui.button("Add file…").on_hover_text("A CSV or .npy file of cells, beside the preset").clicked() {
            asks.ask(Ask::Choose(Purpose::Injector(preset.injectors.len())));
        }
    });
}

fn rectangle(size: usize) -> InjectorKind {
    let (low, high) = (size / 4, (3 * size / 4).max(1) - 1);
    InjectorKind::Rectangle { from: [low, low, 0], to: [high.max(low), high.max(low), 0] }
}

/// What can be done with a line of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    Up,
    Down,
    Duplicate,
    Delete,
}

impl Change {
    /// Does it with the `i`-th line.
    pub(super) fn apply<T: Clone>(self, list: &mut Vec<T>, i: usize) {
        match self {
            Change::Up => list.swap(i, i - 1),
            Change::Down => list.swap(i, i + 1),
            Change::Duplicate => list.insert(i + 1, list[i].clone()),
            Change::Delete => drop(list.remove(i)),
        }
    }
}

/// The rest of a list's `i`-th line: its title, cut where it must be, and the buttons to the right.
pub(super) fn titled_buttons(ui: &mut Ui, title: &str, what: &str, i: usize, count: usize) -> Option<(usize, Change)> {
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let change = buttons(ui, what, i, count);
        ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.add(egui::Label::new(title).truncate());
        });
        change
    })
    .inner
}

fn buttons(ui: &mut Ui, what: &str, i: usize, count: usize) -> Option<(usize, Change)> {
    let mut change = None;
    let all = [
        (Change::Delete, "✖", "Delete", true),
        (Change::Duplicate, "🗐", "Duplicate", true),
        (Change::Down, "⏷", "Move down", i + 1 < count),
        (Change::Up, "⏶", "Move up", i > 0),
    ];
    for (one, picture, verb, possible) in all {
        ui.add_enabled_ui(possible, |ui| {
            if small_button(ui, picture, &format!("{verb} {what} {}", i + 1)).clicked() {
                change = Some((i, one));
            }
        });
    }
    change
}

fn head(ui: &mut Ui, i: usize, count: usize, injector: &mut Injector) -> Option<(usize, Change)> {
    ui.horizontal(|ui| {
        let on = ui.checkbox(&mut injector.enabled, "").on_hover_text("Whether it injects");
        field::name(&on, &format!("Injector {} on", i + 1));
        let [r, g, b] = injector.color.map(|c| (c.clamp(0.0, 1.0) * 255.0) as u8);
        let (dot, _) = ui.allocate_exact_size(Vec2::splat(10.0), Sense::hover());
        ui.painter().circle(dot.center(), 4.5, Color32::from_rgb(r, g, b), (1.0, ui.visuals().weak_text_color()));
        titled_buttons(ui, &format!("{}. {}", i + 1, summary(&injector.kind)), "injector", i, count)
    })
    .inner
}

fn summary(kind: &InjectorKind) -> String {
    match kind {
        InjectorKind::Wall { side } => format!("Wall {}", side_name(*side)),
        InjectorKind::Rectangle { .. } => "Rectangle".to_owned(),
        InjectorKind::Single { cell: [x, y, z] } => format!("Cell ({x}, {y}, {z})"),
        InjectorKind::File { path, .. } => {
            format!("File {}", path.file_name().unwrap_or_default().to_string_lossy())
        }
    }
}

fn side_name(side: Side) -> String {
    let axis = Axis::name(side.axis());
    if side.inwards().max_element() > 0.0 { format!("{axis} = 0") } else { format!("{axis} = n − 1") }
}

fn one(ui: &mut Ui, i: usize, injector: &mut Injector, size: usize, around: Surroundings, asks: &mut Asks) {
    let full = |part: &str| format!("Injector {} {part}", i + 1);
    CollapsingHeader::new("Settings").id_salt("settings").default_open(false).show(ui, |ui| {
        kind(ui, i, injector, size, around, asks);
        if !matches!(injector.kind, InjectorKind::File { .. }) {
            direction(ui, &full("direction"), injector, around.axis);
        }
        named_row(ui, "Multiplier", &full("multiplier"), |ui| {
            let range = 0.0..=LARGEST_MULTIPLIER;
            field::add(ui, DragValue::new(&mut injector.multiplier).range(range).speed(0.02).max_decimals(6))
        });
        named_row(ui, "Colour", &full("colour"), |ui| {
            let mut rgb = injector.color.map(|c| c as f32);
            let response = ui.color_edit_button_rgb(&mut rgb);
            if response.changed() {
                injector.color = rgb.map(f64::from);
            }
            response
        });
    });
}

fn kind(ui: &mut Ui, i: usize, injector: &mut Injector, size: usize, around: Surroundings, asks: &mut Asks) {
    let full = |part: &str| format!("Injector {} {part}", i + 1);
    match &mut injector.kind {
        InjectorKind::Wall { side } => {
            named_choice(ui, "Side", &full("side"), "The side of the volume", side, &Side::ALL, |s| side_name(*s));
        }
        InjectorKind::Rectangle { from, to } => {
            field::cell(ui, "From", &full("from"), from, size);
            field::cell(ui, "To", &full("to"), to, size);
        }
        InjectorKind::Single { cell } => {
            field::cell(ui, "Cell", &full("cell"), cell, size);
            let mut waiting = around.placing == Some(i);
            let label = if waiting { "Click a cell in a view…" } else { "Place in a view" };
            if ui.toggle_value(&mut waiting, label).clicked() {
                asks.ask(Ask::Place(waiting.then_some(i)));
            }
        }
        InjectorKind::File { path, .. } => {
            named_row(ui, "File", &full("file"), |ui| ui.label(path.display().to_string()));
            if ui.button("Choose…").clicked() {
                asks.ask(Ask::Choose(Purpose::Injector(i)));
            }
        }
    }
}

/// The direction, by numbers and by an arrow in the plane of the views; or the kind's own.
fn direction(ui: &mut Ui, full_name: &str, injector: &mut Injector, axis: Axis) {
    let own = match injector.kind {
        InjectorKind::Wall { side } => side.inwards().to_array(),
        _ => [1.0, 0.0, 0.0],
    };
    named_row(ui, "Direction", full_name, |ui| {
        let mut chosen = injector.direction.is_some();
        let hint = "Off, a wall sends inwards and others towards +x";
        let response = ui.checkbox(&mut chosen, "by hand").on_hover_text(hint);
        if response.changed() {
            injector.direction = chosen.then_some(own);
        }
        response
    });
    let Some(direction) = &mut injector.direction else { return };
    ui.horizontal(|ui| {
        ui.add_space(8.0);
        arrow(ui, full_name, direction, axis);
        ui.vertical(|ui| {
            ui.horizontal(|ui| field::vector(ui, full_name, direction));
            ui.small(format!("arrow: {} right, {} up", Axis::name(axis.columns()), Axis::name(axis.rows())));
        });
    });
    if *direction == [0.0; 3] {
        ui.colored_label(ui.visuals().error_fg_color, "A direction needs a length; set one part");
    }
}

/// An arrow to drag: its two parts in the plane of the views; the third stays.
fn arrow(ui: &mut Ui, full_name: &str, direction: &mut [f64; 3], axis: Axis) -> Response {
    let (rect, mut response) = ui.allocate_exact_size(Vec2::splat(56.0), Sense::click_and_drag());
    let radius = rect.width() / 2.0 - 4.0;
    if let Some(pos) = response.interact_pointer_pos() {
        let to = (pos - rect.center()) / radius;
        let tenth = |part: f32| (f64::from(part.clamp(-1.0, 1.0)) * 20.0).round() / 20.0;
        let (right, up) = (tenth(to.x), tenth(-to.y));
        if (right, up) != (0.0, 0.0) {
            direction[axis.columns()] = right;
            direction[axis.rows()] = up;
            response.mark_changed();
        }
    }
    let [x, y, z] = *direction;
    let length = (x * x + y * y + z * z).sqrt().max(f64::MIN_POSITIVE);
    let part = |i: usize| (direction[i] / length) as f32;
    let visuals = ui.visuals();
    let painter = ui.painter_at(Rect::from_center_size(rect.center(), rect.size()));
    painter.circle(rect.center(), radius, visuals.extreme_bg_color, visuals.widgets.inactive.bg_stroke);
    painter.arrow(
        rect.center(),
        vec2(part(axis.columns()), -part(axis.rows())) * radius,
        egui::Stroke::new(2.0, visuals.strong_text_color()),
    );
    response.on_hover_text("Drag to turn").accessible_name(format!("{full_name} arrow"))
}
