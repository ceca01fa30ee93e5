//! The pictures on screen: all under one lens, side by side or two of them under a bar.

use std::sync::Arc;

use egui::{
    Align2, Color32, ColorImage, CursorIcon, FontId, Painter, PointerButton, Pos2, Rect, Sense, Stroke, TextureHandle,
    TextureOptions, Ui, Vec2, pos2, vec2,
};
use glam::DVec3;

use super::lens::{self, Lens};
use super::making::{Apart, Pictures, Traced};
use crate::app::draw::ink::color;
use crate::app::session::picture::Tile;
use crate::field::Cell;
use crate::render::image::Image;
use crate::report::colour::Theme;
use crate::report::radiance;
use crate::scene::placement::Placement;

/// Height of a tile's title, in points.
const TITLE: f32 = 18.0;
/// Room between tiles, in points.
const GAP: f32 = 6.0;
/// Width of the bar to the hand, in points.
const BAR: f32 = 10.0;

/// What there is to show, as far as it is made.
#[derive(Clone, Debug)]
pub struct Made {
    /// The pictures.
    pub pictures: Arc<Pictures>,
    /// Their truth.
    pub truth: Option<Arc<Traced>>,
    /// How far they are from it, as it is now or was a little less refined.
    pub apart: Option<Arc<Vec<Apart>>>,
    /// What radiance is multiplied with.
    pub exposure: f32,
    /// Whether radiance is shown by a scale of colours.
    pub false_colour: bool,
}

impl Made {
    /// A picture's pixels, eight bits a channel, with the side that it has; `None` while it is not made.
    pub fn rgb(&self, tile: Tile) -> Option<(usize, Vec<u8>)> {
        let [side, _] = self.pictures.view.size();
        let radiance = |image: &Image| match self.false_colour {
            true => radiance::false_colour(image, self.exposure),
            false => image.to_srgb(self.exposure),
        };
        let rgb = match tile {
            Tile::Truth => radiance(&self.truth.as_ref()?.light),
            Tile::Picture(place) => radiance(&self.pictures.run(place)?.light),
            Tile::Difference(place) => {
                let run = self.pictures.run(place)?;
                radiance::difference_pixels(&self.truth.as_ref()?.light, &run.light, self.exposure)
            }
            Tile::Flip(place) => {
                radiance::map_pixels(&self.apart.as_ref()?.iter().find(|apart| apart.place == place)?.flip)
            }
        };
        (rgb.len() == 3 * side * side).then_some((side, rgb))
    }

    /// Whether a picture looks the same made from either.
    fn looks_the_same(&self, other: &Made, tile: Tile) -> bool {
        let same = |a: &Option<Arc<Traced>>, b: &Option<Arc<Traced>>| match (a, b) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        let display = (self.exposure, self.false_colour) == (other.exposure, other.false_colour);
        let pictures = Arc::ptr_eq(&self.pictures, &other.pictures);
        match tile {
            Tile::Truth => display && same(&self.truth, &other.truth),
            Tile::Picture(_) => display && pictures,
            Tile::Difference(_) => display && pictures && same(&self.truth, &other.truth),
            Tile::Flip(_) => match (&self.apart, &other.apart) {
                (Some(a), Some(b)) => Arc::ptr_eq(a, b),
                (a, b) => a.is_none() && b.is_none(),
            },
        }
    }
}

/// What the pointer does to the pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pointed {
    /// The pixel under it.
    pub pixel: Option<[usize; 2]>,
    /// Whether that was clicked.
    pub clicked: bool,
    /// How far the camera is dragged, in points.
    pub orbit: Vec2,
}

/// The pictures' own state.
pub struct Tiles {
    lens: Lens,
    /// Where the bar is, 0 at the left.
    bar: f32,
    textures: Vec<(Tile, Made, TextureHandle)>,
    /// The place under the pointer, in shares of the picture.
    at: Option<Pos2>,
}

impl Default for Tiles {
    fn default() -> Self {
        Tiles { lens: Lens::default(), bar: 0.5, textures: Vec::new(), at: None }
    }
}

/// What is drawn over the pictures.
pub struct Marks<'a> {
    /// The pinned cell, in finest cells: its corner and side.
    pub cell: Option<(Cell, usize)>,
    /// Where the cells lie.
    pub placement: &'a Placement,
}

impl Tiles {
    /// Zooms and pans back to the whole picture.
    pub fn whole(&mut self) {
        self.lens = Lens::default();
    }

    /// Shows the tiles in all the room there is; `split` puts the two that there are under a bar.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        made: &Made,
        tiles: &[Tile],
        split: bool,
        marks: &Marks,
        theme: &Theme,
    ) -> Pointed {
        self.textures.retain(|(tile, of, _)| tiles.contains(tile) && made.looks_the_same(of, *tile));
        let room = ui.available_rect_before_wrap();
        ui.allocate_rect(room, Sense::hover());
        let count = if split { 1 } else { tiles.len() };
        let mut pointed = Pointed::default();
        let before = self.at.take();
        for (i, rect) in lens::tiles(room, count, TITLE, GAP).into_iter().enumerate() {
            let titled: &[Tile] = if split { tiles } else { &tiles[i..=i] };
            self.one(ui, rect, made, titled, marks, theme, before, &mut pointed);
        }
        pointed
    }

    #[expect(clippy::too_many_arguments, reason = "a tile shares what is shown and marked with all others")]
    fn one(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        made: &Made,
        tiles: &[Tile],
        marks: &Marks,
        theme: &Theme,
        pointer: Option<Pos2>,
        pointed: &mut Pointed,
    ) {
        let names: Vec<String> = tiles.iter().map(|tile| tile.name()).collect();
        let name = names.join(" | ");
        let response = ui.interact(rect, ui.scope_id().with(&name), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, format!("View: {name}")));
        let bar = (tiles.len() == 2).then(|| self.bar(ui, rect));
        self.steer(ui, rect, &response, made, pointed);

        let painter = ui.painter_at(rect.expand2(vec2(0.0, TITLE)));
        let title = |at: Pos2, align: Align2, text: &str| {
            painter.text(at, align, text, FontId::proportional(13.0), color(theme.ink));
        };
        title(rect.left_top() - vec2(0.0, 2.0), Align2::LEFT_BOTTOM, &names[0]);
        if let [_, right] = names.as_slice() {
            title(rect.right_top() - vec2(0.0, 2.0), Align2::RIGHT_BOTTOM, right);
        }
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, color(theme.grid));
        for (i, tile) in tiles.iter().enumerate() {
            let mut clip = rect;
            if let Some(bar) = bar {
                if i == 0 { clip.max.x = bar } else { clip.min.x = bar }
            }
            let within = painter.with_clip_rect(clip);
            match self.texture(ui, *tile, made) {
                Some(texture) => {
                    within.image(texture.id(), rect, self.lens.part(), Color32::WHITE);
                }
                None => {
                    within.text(
                        clip.center(),
                        Align2::CENTER_CENTER,
                        "not made yet",
                        FontId::proportional(12.0),
                        color(theme.muted),
                    );
                }
            }
        }
        if let Some(bar) = bar {
            let stroke = Stroke::new(2.0, color(theme.ink));
            painter.line_segment([pos2(bar, rect.top()), pos2(bar, rect.bottom())], stroke);
        }
        self.mark(&painter, rect, made, marks, theme);
        if let Some(at) = pointer.filter(|_| !response.hovered()) {
            let at = self.lens.screen(rect, at);
            let stroke = Stroke::new(1.0, color(theme.negative));
            painter.line_segment([at - vec2(6.0, 0.0), at + vec2(6.0, 0.0)], stroke);
            painter.line_segment([at - vec2(0.0, 6.0), at + vec2(0.0, 6.0)], stroke);
        }
    }

    /// Zooms, pans and points.
    fn steer(&mut self, ui: &Ui, rect: Rect, response: &egui::Response, made: &Made, pointed: &mut Pointed) {
        if response.dragged_by(PointerButton::Primary) || response.dragged_by(PointerButton::Middle) {
            self.lens.pan(rect, response.drag_delta());
        }
        if response.dragged_by(PointerButton::Secondary) {
            pointed.orbit = response.drag_delta();
        }
        if response.double_clicked() {
            self.whole();
        }
        let Some(at) = response.hover_pos() else { return };
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        if scroll != 0.0 || pinch != 1.0 {
            self.lens.zoom(rect, at, pinch * (scroll * 0.004).exp());
        }
        let place = self.lens.place(rect, at);
        let [side, _] = made.pictures.view.size();
        self.at = Some(place);
        pointed.pixel = lens::pixel(place, side);
        pointed.clicked = response.clicked();
    }

    /// The bar between two pictures, dragged by the hand; where it is on screen.
    fn bar(&mut self, ui: &Ui, rect: Rect) -> f32 {
        let x = rect.left() + self.bar * rect.width();
        let hand = Rect::from_center_size(pos2(x, rect.center().y), vec2(BAR, rect.height()));
        let response = ui.interact(hand, ui.scope_id().with("split bar"), Sense::drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Split bar"));
        let response = response.on_hover_cursor(CursorIcon::ResizeHorizontal);
        if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            self.bar = ((pointer.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        }
        rect.left() + self.bar * rect.width()
    }

    fn texture(&mut self, ui: &Ui, tile: Tile, made: &Made) -> Option<&TextureHandle> {
        if !self.textures.iter().any(|(known, ..)| *known == tile) {
            let (side, rgb) = made.rgb(tile)?;
            let image = ColorImage::from_rgb([side, side], &rgb);
            let options = TextureOptions { magnification: egui::TextureFilter::Nearest, ..TextureOptions::LINEAR };
            let texture = ui.ctx().load_texture(tile.name(), image, options);
            self.textures.push((tile, made.clone(), texture));
        }
        self.textures.iter().find(|(known, ..)| *known == tile).map(|(_, _, texture)| texture)
    }

    /// The edges of the pinned cell, as the camera sees them.
    fn mark(&self, painter: &Painter, rect: Rect, made: &Made, marks: &Marks, theme: &Theme) {
        let Some((low, span)) = marks.cell else { return };
        let [side, _] = made.pictures.view.size();
        let corner = |i: usize| {
            let cell: [usize; 3] = std::array::from_fn(|axis| low[axis] + if i >> axis & 1 == 1 { span } else { 0 });
            let place =
                made.pictures.view.place(marks.placement.in_metres(DVec3::from_array(cell.map(|c| c as f64))))?;
            let [x, y] = place.map(|pixels| (pixels / side as f64) as f32);
            Some(self.lens.screen(rect, pos2(x, y)))
        };
        for from in 0..8usize {
            for to in [1, 2, 4].map(|bit| from ^ bit).into_iter().filter(|to| from < *to) {
                if let (Some(a), Some(b)) = (corner(from), corner(to)) {
                    painter.line_segment([a, b], (1.4, color(theme.negative)));
                }
            }
        }
    }
}
