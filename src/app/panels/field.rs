//! Fields with their names: to the left on screen, and for those who listen.

use egui::{ComboBox, DragValue, Response, Ui, vec2};

/// Where fields begin, in points from the left.
const NAME_WIDTH: f32 = 104.0;

/// Gives a control its name where no label beside it does.
pub fn name(response: &Response, name: &str) {
    response.clone().accessible_name(name);
}

/// A line with a name to the left and what belongs to it.
pub fn row(ui: &mut Ui, label: &str, control: impl FnOnce(&mut Ui) -> Response) -> Response {
    named_row(ui, label, label, control)
}

/// The same, where the name alone would not tell which of several it is.
pub fn named_row(ui: &mut Ui, label: &str, full_name: &str, control: impl FnOnce(&mut Ui) -> Response) -> Response {
    ui.horizontal(|ui| {
        let size = vec2(NAME_WIDTH, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.set_min_width(NAME_WIDTH);
            ui.label(label);
        });
        control(ui).accessible_name(full_name)
    })
    .inner
}

/// A number to type or drag.
pub fn number(ui: &mut Ui, label: &str, hint: &str, field: DragValue<'_>) -> Response {
    row(ui, label, |ui| ui.add(field).on_hover_text(hint))
}

/// One of several values.
pub fn choice<T: PartialEq + Clone>(
    ui: &mut Ui,
    label: &str,
    hint: &str,
    value: &mut T,
    all: &[T],
    text: impl Fn(&T) -> String,
) -> Response {
    named_choice(ui, label, label, hint, value, all, text)
}

/// The same, where the name alone would not tell which of several it is.
pub fn named_choice<T: PartialEq + Clone>(
    ui: &mut Ui,
    label: &str,
    full_name: &str,
    hint: &str,
    value: &mut T,
    all: &[T],
    text: impl Fn(&T) -> String,
) -> Response {
    named_row(ui, label, full_name, |ui| {
        let combo = ComboBox::from_id_salt(full_name).selected_text(text(value)).width(120.0);
        let shown = combo.show_ui(ui, |ui| {
            for one in all {
                ui.selectable_value(value, one.clone(), text(one));
            }
        });
        shown.response.on_hover_text(hint)
    })
}

/// The coordinates of a cell, each from 0 to `size` − 1.
pub fn cell(ui: &mut Ui, label: &str, full_name: &str, cell: &mut [usize; 3], size: usize) {
    ui.horizontal(|ui| {
        let width = vec2(NAME_WIDTH, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(width, egui::Layout::left_to_right(egui::Align::Center), |ui| {
            ui.set_min_width(NAME_WIDTH);
            ui.label(label);
        });
        for (axis, coordinate) in ["x", "y", "z"].into_iter().zip(cell) {
            let field = DragValue::new(coordinate).range(0..=size.saturating_sub(1)).speed(0.1);
            name(&ui.add(field).on_hover_text(axis), &format!("{full_name} {axis}"));
        }
    });
}

/// The parts of a vector.
pub fn vector(ui: &mut Ui, full_name: &str, vector: &mut [f64; 3]) {
    for (axis, part) in ["x", "y", "z"].into_iter().zip(vector) {
        let field = DragValue::new(part).speed(0.02).range(-1e6..=1e6).max_decimals(4);
        name(&ui.add(field).on_hover_text(axis), &format!("{full_name} {axis}"));
    }
}
