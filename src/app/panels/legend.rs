//! What glyphs and colours mean, with units.

use egui::{Rect, Sense, Ui, Vec2, pos2, vec2};

use crate::app::draw::glyphs::{Scale, Scales, level_tint};
use crate::app::draw::ink::{Ink, color};
use crate::app::session::view::{Heat, View};
use crate::app::worker::look::Shown;
use crate::report::colour::Theme;
use crate::report::glyph::{FULL_RADIUS, GlyphScale};

/// One line under the views.
pub fn ui(ui: &mut Ui, view: &View, scales: &Scales, shown: &[Shown], theme: &Theme) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        if view.glyphs {
            disc(ui, theme);
            match &scales.difference {
                None => drop(ui.small(full(&scales.light))),
                Some(difference) => {
                    ui.small(format!("light {}", full(&scales.light)));
                    ui.add_space(8.0);
                    disc(ui, theme);
                    ui.small(format!("difference {}", full(difference)));
                }
            }
            if view.negative {
                ui.add_space(8.0);
                swatch(ui, color(theme.negative));
                ui.small("negative lobe");
            }
        }
        if view.heat != Heat::None {
            ui.add_space(8.0);
            ramp(ui, theme);
            let unit = if view.heat == Heat::Relative { "" } else { " (SH coefficient)" };
            let of_difference = scales.difference.filter(|scale| scale.heat > 0.0);
            let of_difference = of_difference.map(|scale| format!(", in differences to {}", number(scale.heat)));
            let heat = number(scales.light.heat);
            ui.small(format!("{}{unit}, up to {heat}{}", view.heat.name(), of_difference.unwrap_or_default()));
        }
        if view.levels {
            ui.add_space(8.0);
            ui.small("sampled from level");
            let levels = shown.iter().flat_map(|shown| &shown.index).max().map_or(0, |most| usize::from(*most));
            for level in 0..=levels {
                swatch(ui, level_tint(theme, level));
                ui.small(level.to_string());
            }
        }
        if shown.iter().any(|shown| !shown.slice.borders.is_empty()) {
            ui.add_space(8.0);
            let (rect, _) = ui.allocate_exact_size(vec2(14.0, 12.0), Sense::hover());
            ui.painter().hline(rect.x_range(), rect.center().y, (1.6, color(theme.ink)));
            ui.small("border between levels");
        }
    });
}

/// What a full glyph means.
fn full(scale: &Scale) -> String {
    match scale.glyph {
        GlyphScale::Linear { full } => format!("fills its cell at {} /sr", number(full)),
        GlyphScale::Log { full, decades } => {
            format!("fills its cell at {} /sr, nothing {decades} decades below", number(full))
        }
        GlyphScale::PerGlyph => "fills every cell".to_owned(),
    }
}

/// A number as short as it can be read.
pub fn number(value: f32) -> String {
    // A zero has no sign worth showing.
    let value = value + 0.0;
    if value == 0.0 || (1e-3..1e4).contains(&value.abs()) { format!("{value:.4}") } else { format!("{value:.2e}") }
}

/// A round glyph that fills its cell.
fn disc(ui: &mut Ui, theme: &Theme) {
    let (rect, _) = ui.allocate_exact_size(Vec2::splat(14.0), Sense::hover());
    let painter = ui.painter();
    painter.rect_stroke(rect.shrink(0.5), 0.0, (1.0, color(theme.muted)), egui::StrokeKind::Inside);
    painter.circle_filled(rect.center(), rect.width() * FULL_RADIUS - 0.5, color(theme.glyph));
}

fn swatch(ui: &mut Ui, ink: egui::Color32) {
    let (rect, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
    ui.painter().rect_filled(rect.shrink(1.0), 2.0, ink);
}

fn ramp(ui: &mut Ui, theme: &Theme) {
    let (rect, _) = ui.allocate_exact_size(vec2(60.0, 10.0), Sense::hover());
    let mut ink = Ink::default();
    let steps = 20;
    let at = |i: usize| rect.left() + rect.width() * i as f32 / steps as f32;
    for i in 0..steps {
        let part = Rect::from_min_max(pos2(at(i), rect.top()), pos2(at(i + 1), rect.bottom()));
        ink.rect(part, color(theme.heat(i as f32 / (steps - 1) as f32)));
    }
    ui.painter().add(egui::Shape::mesh(ink.mesh));
}
