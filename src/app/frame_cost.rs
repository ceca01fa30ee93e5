//! What a frame costs to build, without a display: the benchmark's view of the window.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use egui::{Context, RawInput, Rect, Vec2};

use crate::app::lab::Lab;
use crate::app::session::command::Command;
use crate::app::session::settings::Settings;
use crate::app::session::view::Scaling;
use crate::report::slice::SliceCell;
use crate::scene::Preset;
use crate::scene::injector::{Injector, InjectorKind, Side};

/// Frames that are measured; the median counts.
const FRAMES: usize = 31;
/// How long the worker may take to show the light that is drawn.
const PATIENCE: Duration = Duration::from_secs(60);

/// The work of building one frame with three views, triangles included, the graphics driver not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameCost {
    /// Seconds where every glyph had to be drawn anew.
    pub changed: f64,
    /// Seconds where nothing had changed.
    pub unchanged: f64,
    /// Glyphs in a frame.
    pub glyphs: usize,
}

/// Measures a 1920×1080 window with three views of `side`² glyphs; `None` if their light cannot be computed.
pub fn measure(side: usize) -> Option<FrameCost> {
    let ctx = Context::default();
    let walls = [Side::NegX, Side::PosX].map(|side| Injector::new(InjectorKind::Wall { side }));
    let preset = Preset { size: side, coarsest: side, injectors: walls.to_vec(), ..Preset::default() };
    let mut settings = Settings::default();
    // However faint a glyph's light, it is drawn, and as large as its cell.
    settings.view.scaling = Scaling::PerGlyph;
    let mut lab = Lab::new(&ctx, preset, None::<PathBuf>, settings).ok()?;
    for _ in 0..side / 2 {
        lab.perform(Command::Propagate, &ctx);
    }
    let started = Instant::now();
    while !lab.is_idle() || lab.iteration() < side / 2 {
        frame(&ctx, &mut lab);
        std::thread::sleep(Duration::from_millis(5));
        if started.elapsed() > PATIENCE {
            return None;
        }
    }
    let mut median = |anew: bool| {
        let mut seconds: Vec<f64> = (0..FRAMES)
            .map(|_| {
                if anew {
                    lab.redraw();
                }
                let started = Instant::now();
                frame(&ctx, &mut lab);
                started.elapsed().as_secs_f64()
            })
            .collect();
        seconds.sort_by(f64::total_cmp);
        seconds[FRAMES / 2]
    };
    let (changed, unchanged) = (median(true), median(false));
    let lit = |cell: &&SliceCell| cell.light.iter().any(|light| !light.is_zero());
    let glyphs = lab.shown().iter().map(|shown| shown.slice.cells.iter().filter(lit).count()).sum();
    Some(FrameCost { changed, unchanged, glyphs })
}

fn frame(ctx: &Context, lab: &mut Lab) {
    let screen = Rect::from_min_size(egui::Pos2::ZERO, Vec2::new(1920.0, 1080.0));
    let input = RawInput { screen_rect: Some(screen), ..RawInput::default() };
    let mut output = ctx.run_ui(input, |ui| {
        lab.logic(&ui.ctx().clone());
        lab.ui(ui);
    });
    // There is no graphics driver to take them.
    output.textures_delta.clear();
    std::hint::black_box(ctx.tessellate(output.shapes, output.pixels_per_point));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_without_a_display_builds_its_frames() {
        let cost = measure(8).unwrap();
        assert!(cost.unchanged > 0.0 && cost.changed > 0.0, "{cost:?}");
        assert_eq!(cost.glyphs, 3 * 8 * 8);
    }
}
