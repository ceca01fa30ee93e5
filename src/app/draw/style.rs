//! The window's colours: egui's own themes, with grounds and texts that agree with the plots and pictures.

use egui::{Context, Stroke, TextStyle};

use crate::app::draw::ink::color;
use crate::report::colour::Theme;

/// The size of small text, in points: egui's own is too small to read on a large screen.
const SMALL_TEXT: f32 = 11.0;

/// Sets the colours for light and dark; which of them is used follows the system.
pub fn apply(ctx: &Context) {
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
        });
    }
}

/// The report's colours for the window's theme.
pub fn theme(ctx: &Context) -> Theme {
    if ctx.global_style().visuals.dark_mode { Theme::DARK } else { Theme::LIGHT }
}
