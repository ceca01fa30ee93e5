//! What glyphs and colours mean, with units.

use egui::{Rect, Sense, Ui, Vec2, pos2, vec2};

use crate::app::draw::glyphs::level_tint;
use crate::app::draw::ink::{Ink, color};
use crate::app::draw::scales::Scale;
use crate::app::draw::scales::Scales;
use crate::app::session::view::{Fill, Heat, Scaling, View};
use crate::app::worker::look::Shown;
use crate::report::colour::{Paint, Rgb, Theme};
use crate::report::glyph::{FULL_RADIUS, GlyphScale};
use crate::report::slice::Axis;
use crate::sh::Sh;

/// One line under the views.
pub fn ui(ui: &mut Ui, view: &View, scales: &Scales, shown: &[Shown], theme: &Theme) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        if view.glyphs {
            glyphs(ui, view, scales, shown, theme);
        }
        if view.heat != Heat::None {
            heat(ui, view, scales, theme);
        }
        if view.levels {
            ui.small("sampled from level");
            let levels = shown.iter().flat_map(|shown| &shown.index).max().map_or(0, |most| usize::from(*most));
            for level in 0..=levels {
                swatch(ui, level_tint(theme, level));
                ui.small(level.to_string());
            }
            ui.add_space(8.0);
        }
        if shown.iter().any(|shown| !shown.slice.borders.is_empty()) {
            let (rect, _) = ui.allocate_exact_size(vec2(14.0, 12.0), Sense::hover());
            ui.painter().hline(rect.x_range(), rect.center().y, (1.6, color(theme.ink)));
            ui.small("border between levels");
        }
        if !view.linked && shown.len() > 1 {
            ui.small("views zoom and pan apart");
        }
    });
}

/// What the size and the colour of glyphs mean.
fn glyphs(ui: &mut Ui, view: &View, scales: &Scales, shown: &[Shown], theme: &Theme) {
    let light = match (scales.moving.is_some(), scales.accumulated.is_some()) {
        (true, true) => ["S_k", "S_A"],
        _ => ["light", "light"],
    };
    let all = [(light[0], scales.moving), (light[1], scales.accumulated), ("difference", scales.difference)];
    let all: Vec<(&str, Scale)> = all.into_iter().filter_map(|(name, scale)| Some((name, scale?))).collect();
    for (name, scale) in &all {
        disc(ui, theme);
        let name = if all.len() > 1 { format!("{name} ") } else { String::new() };
        ui.small(format!("{name}{}", full(scale)));
        ui.add_space(8.0);
    }
    if view.scaling != Scaling::PerGlyph {
        ui.small(match view.fill {
            Fill::Run if scales.difference.is_some() => "per run, differences per frame",
            Fill::Run => "in the whole run",
            Fill::Frame => "in this frame",
            Fill::Fixed => "as chosen",
        });
        ui.add_space(8.0);
    }
    let axis = shown.first().map_or(view.axis, |shown| shown.slice.plane.axis);
    let paint = scales.paint(view);
    match paint {
        Paint::Single => {}
        Paint::Direction => {
            wheel(ui, axis, theme);
            ui.small("where the light goes; grey: towards or away from the eye");
            ui.add_space(8.0);
        }
        Paint::Light => {
            ui.small("in the colour of the light");
            ui.add_space(8.0);
        }
        Paint::Intensity => {
            strip(ui, |share| Paint::Intensity.glyph(theme, [Sh::ZERO; 3], Sh::ZERO, axis, share));
            ui.small("from nothing to a full glyph");
            ui.add_space(8.0);
        }
    }
    if view.negative {
        swatch(ui, color(paint.negative(theme)));
        ui.small("negative lobe");
        ui.add_space(8.0);
    }
}

fn heat(ui: &mut Ui, view: &View, scales: &Scales, theme: &Theme) {
    strip(ui, |share| theme.heat(share));
    let unit = if view.heat == Heat::Relative { "" } else { " (SH coefficient)" };
    let light = [scales.moving, scales.accumulated];
    let light: Vec<String> = light.into_iter().flatten().map(|scale| number(scale.heat)).collect();
    let of_difference = scales.difference.filter(|scale| scale.heat > 0.0);
    let of_difference = of_difference.map(|scale| format!(", in differences to {}", number(scale.heat)));
    let light = light.join(" and ");
    ui.small(format!("{}{unit}, up to {light}{}", view.heat.name(), of_difference.unwrap_or_default()));
    ui.add_space(8.0);
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

/// The colours of shares from 0 to 1.
fn strip(ui: &mut Ui, of: impl Fn(f32) -> Rgb) {
    let (rect, _) = ui.allocate_exact_size(vec2(60.0, 10.0), Sense::hover());
    let mut ink = Ink::default();
    let steps = 20;
    let at = |i: usize| rect.left() + rect.width() * i as f32 / steps as f32;
    for i in 0..steps {
        let part = Rect::from_min_max(pos2(at(i), rect.top()), pos2(at(i + 1), rect.bottom()));
        ink.rect(part, color(of(i as f32 / (steps - 1) as f32)));
    }
    ui.painter().add(egui::Shape::mesh(ink.mesh));
}

/// The colours of the directions in a cut, each where it points.
fn wheel(ui: &mut Ui, axis: Axis, theme: &Theme) {
    const PARTS: u32 = 36;
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(18.0), Sense::hover());
    response.on_hover_text("The colour of light by where it goes in the cut");
    let mut mesh = egui::Mesh::default();
    mesh.colored_vertex(rect.center(), color(theme.muted));
    for i in 0..PARTS {
        let (up, right) = (std::f32::consts::TAU * i as f32 / PARTS as f32).sin_cos();
        let mut direction = [0.0; 3];
        (direction[axis.columns()], direction[axis.rows()]) = (right, up);
        let light = Sh([1.0, direction[0], direction[1], direction[2]]);
        let ink = Paint::Direction.glyph(theme, [light; 3], light, axis, 1.0);
        mesh.colored_vertex(rect.center() + vec2(right, -up) * rect.width() * 0.5, color(ink));
        mesh.add_triangle(0, 1 + i, 1 + (i + 1) % PARTS);
    }
    ui.painter().add(egui::Shape::mesh(mesh));
}
