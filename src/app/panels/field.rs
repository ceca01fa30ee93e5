//! Fields with their names: to the left on screen, and for those who listen.

use std::cell::RefCell;

use egui::{ComboBox, Context, DragValue, Id, Response, Ui, vec2};

/// Where fields begin, in points from the left.
const NAME_WIDTH: f32 = 104.0;

/// Gives a control its name where no label beside it does.
pub fn name(response: &Response, name: &str) {
    response.clone().accessible_name(name);
}

/// A field for a number. A decimal comma is read as a point; what cannot be read is told by [`take_unreadable`] once
/// the field is left, and changes nothing.
pub fn add(ui: &mut Ui, field: DragValue<'_>) -> Response {
    let tried: RefCell<Option<Option<String>>> = RefCell::default();
    let parse = |text: &str| {
        let number = read(text);
        *tried.borrow_mut() = Some(number.is_none().then(|| text.trim().to_owned()));
        number
    };
    let response = ui.add(field.custom_parser(parse));
    let [mistyped, unreadable] = [Id::unique("mistyped").with(response.id), Id::unique("unreadable number")];
    let left = response.lost_focus();
    ui.data_mut(|data| {
        if let Some(outcome) = tried.take() {
            data.insert_temp(mistyped, outcome.unwrap_or_default());
        }
        if left && let Some(text) = data.remove_temp::<String>(mistyped).filter(|text| !text.is_empty()) {
            data.insert_temp(unreadable, text);
        }
    });
    response
}

/// The text of a field that was left and is no number, once.
pub fn take_unreadable(ctx: &Context) -> Option<String> {
    let unreadable = Id::unique("unreadable number");
    ctx.data_mut(|data| data.remove_temp(unreadable))
}

/// A number as people write it: blanks between thousands, a true minus, a point or a comma before decimals.
fn read(text: &str) -> Option<f64> {
    let text: String = text.chars().filter(|c| !c.is_whitespace()).map(|c| if c == '−' { '-' } else { c }).collect();
    let text = if text.matches(',').count() == 1 && !text.contains('.') { text.replace(',', ".") } else { text };
    text.parse().ok().filter(|number: &f64| number.is_finite())
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
    row(ui, label, |ui| add(ui, field).on_hover_text(hint))
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
            name(&add(ui, field).on_hover_text(axis), &format!("{full_name} {axis}"));
        }
    });
}

/// The parts of a vector.
pub fn vector(ui: &mut Ui, full_name: &str, vector: &mut [f64; 3]) {
    for (axis, part) in ["x", "y", "z"].into_iter().zip(vector) {
        let field = DragValue::new(part).speed(0.02).range(-1e6..=1e6).max_decimals(4);
        name(&add(ui, field).on_hover_text(axis), &format!("{full_name} {axis}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_people_write_them() {
        for (text, number) in [("3.5", 3.5), ("3,5", 3.5), ("−2", -2.0), (" 1 000 ", 1000.0), ("1e-3", 1e-3)] {
            assert_eq!(read(text), Some(number), "{text}");
        }
        for text in ["", "abc", "1,000,000", "1,5.2", "nan", "inf", "--1"] {
            assert_eq!(read(text), None, "{text}");
        }
    }
}
