//! The window's colours: egui's own themes, with grounds and texts that agree with the plots and pictures.

use egui::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use egui::{Color32, Context, FontData, FontFamily, Stroke, TextStyle};

use crate::app::draw::ink::color;
use crate::report::colour::Theme;

/// The size of small text, in points: egui's own is too small to read on a large screen.
const SMALL_TEXT: f32 = 11.0;

/// Sets the colours for light and dark; which of them is used follows the system.
pub fn apply(ctx: &Context) {
    let last = InsertFontFamily { family: FontFamily::Proportional, priority: FontPriority::Lowest };
    // It has the raised minus that Ubuntu lacks.
    let hack = FontData::from_static(epaint_default_fonts::HACK_REGULAR);
    ctx.add_font(FontInsert::new("hack for signs", hack, vec![last]));
    for (egui_theme, theme) in [(egui::Theme::Light, Theme::LIGHT), (egui::Theme::Dark, Theme::DARK)] {
        ctx.style_mut_of(egui_theme, |style| {
            if let Some(small) = style.text_styles.get_mut(&TextStyle::Small) {
                small.size = SMALL_TEXT;
            }
            let visuals = &mut style.visuals;
            visuals.extreme_bg_color = color(theme.ground);
            // egui's own grey for labels is hard to read on its panels.
            visuals.widgets.noninteractive.fg_stroke =
                Stroke::new(1.0, color(theme.ink).lerp_to_gamma(color(theme.muted), 0.5));
            visuals.weak_text_color = Some(color(theme.muted));
            if egui_theme == egui::Theme::Light {
                // egui's own orange and red are too faint on its light panels.
                visuals.warn_fg_color = Color32::from_rgb(0x9a, 0x48, 0x00);
                visuals.error_fg_color = Color32::from_rgb(0xb0, 0x00, 0x20);
            } else {
                // Nor is egui's pure red bright enough on its dark ones.
                visuals.error_fg_color = Color32::from_rgb(0xff, 0x7b, 0x72);
            }
        });
    }
}

/// The report's colours for the window's theme.
pub fn theme(ctx: &Context) -> Theme {
    if ctx.global_style().visuals.dark_mode { Theme::DARK } else { Theme::LIGHT }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance, WCAG 2.2.
    fn luminance(color: Color32) -> f64 {
        let linear = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(color.r()) + 0.7152 * linear(color.g()) + 0.0722 * linear(color.b())
    }

    fn contrast(a: Color32, b: Color32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn warnings_and_small_text_can_be_read_in_both_themes() {
        let ctx = Context::default();
        apply(&ctx);
        for theme in [egui::Theme::Light, egui::Theme::Dark] {
            let visuals = &ctx.style_of(theme).visuals;
            let weak = visuals.weak_text_color.unwrap();
            for ink in [visuals.warn_fg_color, visuals.error_fg_color, weak] {
                for ground in [visuals.panel_fill, visuals.window_fill, visuals.extreme_bg_color] {
                    assert!(contrast(ink, ground) >= 4.5, "{theme:?}: {ink:?} on {ground:?}");
                }
            }
        }
    }
}
