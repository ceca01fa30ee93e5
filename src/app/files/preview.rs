//! What a picture will be, before it is saved: the same SVG, smaller.

use egui::{ColorImage, TextStyle, TextureHandle, TextureOptions, Ui, vec2};

use super::export;
use crate::app::session::Session;
use crate::app::session::asides::{Aside, Watch};
use crate::app::session::command::Command;
use crate::app::session::format::Format;
use crate::report::raster;

/// The greatest width and height of a preview, in points.
const LARGEST: [f32; 2] = [420.0, 260.0];

/// What a preview shows.
type Key = (Command, Format, u64);

/// The preview's own state.
pub struct Preview {
    making: Aside<Key, ColorImage>,
    drawn: Option<(Key, TextureHandle)>,
}

impl Default for Preview {
    fn default() -> Self {
        Preview { making: Aside::new("preview"), drawn: None }
    }
}

impl Preview {
    /// Shows what an export command will save. It takes the same room whether it is drawn already or not: the question
    /// around it is centred, and must not move under the pointer.
    pub fn ui(&mut self, ui: &mut Ui, session: &Session, command: Command, format: &Format) {
        let room = vec2(LARGEST[0], LARGEST[1] + ui.text_style_height(&TextStyle::Small) + ui.spacing().item_spacing.y);
        ui.allocate_ui(room, |ui| {
            ui.set_min_size(room);
            self.show(ui, session, command, format);
        });
    }

    fn show(&mut self, ui: &mut Ui, session: &Session, command: Command, format: &Format) {
        let key = (command, *format, session.sight.edition);
        let density = ui.pixels_per_point();
        let begun = match self.making.known(&key).is_some() || self.making.is_underway() {
            true => Ok(()),
            false => self.begin(&key, ui, session, density),
        };
        if let Err(line) = begun.and_then(|()| self.making.hear(ui.ctx())) {
            ui.colored_label(ui.visuals().warn_fg_color, line);
            return;
        }
        let Some(image) = self.making.known(&key) else {
            ui.allocate_ui(vec2(LARGEST[0], 60.0), |ui| ui.spinner());
            return;
        };
        if self.drawn.as_ref().is_none_or(|(of, _)| *of != key) {
            let texture = ui.ctx().load_texture("preview", image.clone(), TextureOptions::LINEAR);
            self.drawn = Some((key, texture));
        }
        let [width, height] = image.size.map(|side| side as f32 / density);
        if let Some((_, texture)) = &self.drawn {
            let fit = (LARGEST[0] / width).min(LARGEST[1] / height).min(1.0);
            let picture = egui::Image::new(texture).fit_to_exact_size(vec2(width, height) * fit);
            let response = ui.add(picture);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Preview of the export"));
        }
        if let Some(millimetres) = format.millimetres() {
            ui.small(format!("{millimetres:.0} × {:.0} mm", millimetres * height / width));
        }
    }

    fn begin(&mut self, key: &Key, ui: &Ui, session: &Session, density: f32) -> Result<(), String> {
        let (command, format, _) = key;
        let svg = export::picture(session, *command, format).map_err(|error| error.to_string())?;
        let width = LARGEST[0] * density / format.width() as f32;
        self.making.want(key, ui.ctx(), |_| move |_: &Watch| image(&svg, width))
    }

    /// Forgets what was shown, once the question is gone.
    pub fn close(&mut self) {
        if self.drawn.take().is_some() {
            self.making.keep_only(|_| false);
        }
    }
}

/// The picture with so many pixels for a unit of its own.
fn image(svg: &str, pixels_each: f32) -> Result<ColorImage, String> {
    let pixels = raster::pixels(svg, pixels_each).map_err(|error| error.to_string())?;
    let size = [pixels.width() as usize, pixels.height() as usize];
    Ok(ColorImage::from_rgba_premultiplied(size, pixels.data()))
}
