//! The flat views: slices side by side, zoomed and panned together or apart.

use std::sync::Arc;

use egui::{Align2, Color32, FontId, Mesh, Pos2, Rect, Response, Sense, Shape, TextureHandle, Ui, Vec2, pos2, vec2};

use crate::app::draw::borders;
use crate::app::draw::glyphs::meshes;
use crate::app::draw::ink::color;
use crate::app::draw::mesh_cut::MeshCut;
use crate::app::draw::placing::{Placing, Style};
use crate::app::draw::scales::{Scale, Scales};
use crate::app::draw::sprites;
use crate::app::session::view::View;
use crate::app::worker::look::Shown;
use crate::report::colour::{Paint, Theme};
use crate::report::slice::{Axis, Slice};

/// The farthest zoom, in finest cells that fill a view.
const NEAREST: f32 = 1.5;
/// Room for a view's title, and for the names of its axes.
const TITLE: f32 = 20.0;
const MARGIN: f32 = 16.0;

/// Which part of a slice a view shows.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Camera {
    /// What lies in the middle, in shares of the slice's side.
    centre: Vec2,
    /// 1 shows the whole slice.
    zoom: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Camera { centre: Vec2::splat(0.5), zoom: 1.0 }
    }
}

/// Everything that a drawn slice depends on; while it stays the same the mesh does.
#[derive(Clone)]
struct Key {
    slice: Arc<Slice>,
    view: View,
    scale: Scale,
    paint: Paint,
    placing: Placing,
    dark: bool,
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.slice, &other.slice)
            && self.view == other.view
            && self.scale == other.scale
            && self.paint == other.paint
            && self.placing == other.placing
            && self.dark == other.dark
    }
}

/// How all views are drawn.
#[derive(Clone, Copy)]
pub struct Manner<'a> {
    /// How light is looked at.
    pub view: &'a View,
    /// The colours.
    pub theme: &'a Theme,
    /// Theirs.
    pub scales: &'a Scales,
    /// What glyphs' colours tell.
    pub paint: Paint,
    /// Rectangles to frame.
    pub marks: &'a [Mark],
    /// What stands between neighbouring views in a row, from the left: a sign, and a sentence that says what it means.
    pub between: &'a [(&'a str, &'a str)],
    /// Whether dragging marks cells; else it moves the slice.
    pub marks_cells: bool,
}

/// Cells of a view that the pointer marks by being dragged over them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The view, from the left.
    pub pane: usize,
    /// Where the pointer was pressed, and where it is: finest cells, (column, row).
    pub ends: [[usize; 2]; 2],
    /// Whether it has just been let go.
    pub done: bool,
}

impl Span {
    /// Its lower left and upper right cells.
    pub fn corners(&self) -> [[usize; 2]; 2] {
        let [a, b] = self.ends;
        [[a[0].min(b[0]), a[1].min(b[1])], [a[0].max(b[0]), a[1].max(b[1])]]
    }
}

/// What the pointer does in a view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pointed {
    /// The view, from the left.
    pub pane: usize,
    /// The finest cell under the pointer, (column, row).
    pub at: [usize; 2],
    /// Whether it was clicked.
    pub clicked: bool,
    /// Whether it was clicked twice.
    pub double_clicked: bool,
}

/// The views' own state.
#[derive(Default)]
pub struct Grids {
    cameras: Vec<Camera>,
    drawn: Vec<Option<(Key, [Arc<Mesh>; 2])>>,
    /// Where the views were drawn last.
    placings: Vec<Placing>,
    /// The cells that are being marked.
    span: Option<Span>,
    /// The shapes of small glyphs, once there is something to draw.
    sprites: Option<TextureHandle>,
    /// Where the views' plane cuts the scene's mesh.
    pub mesh: MeshCut,
}

impl Grids {
    /// Shows every slice whole again.
    pub fn whole(&mut self) {
        self.cameras.fill(Camera::default());
    }

    /// Where the views were drawn last, from the left.
    pub fn placings(&self) -> &[Placing] {
        &self.placings
    }

    /// The cells that are being marked, or have just been.
    pub fn span(&self) -> Option<Span> {
        self.span
    }

    /// Forgets what was drawn.
    pub fn redraw(&mut self) {
        self.drawn.clear();
    }

    /// Draws the views side by side in all the room there is; `titles` stand over them.
    pub fn ui(&mut self, ui: &mut Ui, shown: &[Shown], titles: &[String], manner: &Manner) -> Option<Pointed> {
        let room = ui.available_rect_before_wrap();
        ui.allocate_rect(room, Sense::hover());
        self.cameras.resize(shown.len(), Camera::default());
        self.drawn.resize(shown.len(), None);
        self.placings.clear();
        self.span.take_if(|span| span.done || !manner.marks_cells);
        let gap = 10.0;
        let (columns, side) = arrange(room.size(), shown.len(), gap);
        let rows = shown.len().div_ceil(columns.max(1));
        let block = vec2(side + MARGIN, side + TITLE + MARGIN);
        let used = vec2(
            block.x * columns as f32 + gap * columns.saturating_sub(1) as f32,
            block.y * rows as f32 + gap * rows.saturating_sub(1) as f32,
        );
        let corner = room.min + ((room.size() - used) / 2.0).max(Vec2::ZERO);
        let mut pointed = None;
        for (i, shown) in shown.iter().enumerate() {
            let at = corner + vec2((i % columns) as f32, (i / columns) as f32) * (block + Vec2::splat(gap));
            let rect = Rect::from_min_size((at + vec2(MARGIN, TITLE)).round(), Vec2::splat(side.floor()));
            pointed = self.pane(ui, i, rect, shown, &titles[i], manner).or(pointed);
            if let (Some((sign, about)), false) = (manner.between.get(i), (i + 1) % columns == 0) {
                let at = rect.right_center() + vec2((gap + MARGIN) / 2.0, -12.0);
                let font = FontId::proportional(15.0);
                let rect = ui.painter().text(at, Align2::CENTER_CENTER, *sign, font, color(manner.theme.muted));
                let response = ui.interact(rect.expand(4.0), ui.scope_id().with(("between", i)), Sense::hover());
                response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, *about));
                response.on_hover_text(*about);
            }
        }
        pointed
    }

    fn pane(
        &mut self,
        ui: &mut Ui,
        i: usize,
        rect: Rect,
        shown: &Shown,
        title: &str,
        manner: &Manner,
    ) -> Option<Pointed> {
        let Manner { view, theme, scales, paint, marks, .. } = *manner;
        let scale = scales.scale(shown);
        let response = ui.interact(rect, ui.scope_id().with(("view", i)), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, format!("View: {title}")));
        self.steer(ui, i, rect, &response, shown.slice.side, manner);
        let camera = self.cameras[i];
        let cell = rect.width() * camera.zoom / shown.slice.side.max(1) as f32;
        let whole = cell * shown.slice.side as f32;
        let origin = rect.center() + vec2(-camera.centre.x, camera.centre.y) * whole;
        let placing = Placing { clip: rect, origin, cell, density: ui.pixels_per_point() };
        let key = Key { slice: Arc::clone(&shown.slice), view: view.clone(), scale, paint, placing, dark: theme.dark };
        let sprites = self.sprites.get_or_insert_with(|| sprites::texture(ui.ctx())).id();
        let meshes = match &self.drawn[i] {
            Some((known, meshes)) if *known == key => meshes.clone(),
            _ => {
                let meshes = meshes(shown, &Style { view, paint, scale, theme, sprites }, &placing);
                self.drawn[i] = Some((key, meshes.clone()));
                meshes
            }
        };
        self.placings.push(placing);
        if manner.marks_cells {
            self.mark(ui, i, &response, &placing, shown.slice.side);
        }
        let painter = ui.painter_at(rect.expand(1.0));
        painter.rect_filled(rect, 0.0, color(theme.ground));
        painter.extend(meshes.map(Shape::mesh));
        borders::number(&painter, shown, &placing, theme);
        for mark in marks.iter().filter(|mark| mark.pane.is_none_or(|pane| pane == i)) {
            let low = placing.at(mark.column as f32, mark.row as f32);
            let high = placing.at((mark.column + mark.size[0]) as f32, (mark.row + mark.size[1]) as f32);
            painter.rect_stroke(Rect::from_two_pos(low, high), 0.0, (1.5, mark.color), egui::StrokeKind::Middle);
        }
        frame_text(ui, rect, shown, title, theme, &placing);
        let at = placing.cell_at(response.hover_pos()?, shown.slice.side)?;
        Some(Pointed { pane: i, at, clicked: response.clicked(), double_clicked: response.double_clicked() })
    }

    /// Marks the cells that the pointer is dragged over.
    fn mark(&mut self, ui: &Ui, pane: usize, response: &Response, placing: &Placing, side: usize) {
        let Some(at) = response.interact_pointer_pos() else { return };
        let here = placing.nearest(at, side);
        if response.drag_started() {
            let from = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
            self.span = Some(Span { pane, ends: [placing.nearest(from, side), here], done: false });
        }
        if let Some(span) = self.span.as_mut().filter(|span| span.pane == pane) {
            span.ends[1] = here;
            span.done = response.drag_stopped();
        }
    }

    /// Zooms about the pointer and pans with it.
    fn steer(&mut self, ui: &Ui, i: usize, rect: Rect, response: &Response, side: usize, manner: &Manner) {
        let before = self.cameras[i];
        let mut camera = before;
        if response.dragged() && !manner.marks_cells {
            let moved = response.drag_delta() / (rect.width() * camera.zoom);
            camera.centre += vec2(-moved.x, moved.y);
        }
        if let Some(pos) = response.hover_pos() {
            let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            let factor = pinch * (scroll * 0.004).exp();
            let zoom = (camera.zoom * factor).clamp(1.0, (side as f32 / NEAREST).max(1.0));
            // What lies under the pointer stays there.
            let offset = (pos - rect.center()) / rect.width();
            let offset = vec2(offset.x, -offset.y);
            camera.centre += offset / camera.zoom - offset / zoom;
            camera.zoom = zoom;
        }
        let reach = 0.5 / camera.zoom;
        camera.centre = camera.centre.clamp(Vec2::splat(reach), Vec2::splat(1.0 - reach));
        if camera != before {
            if manner.view.linked { self.cameras.fill(camera) } else { self.cameras[i] = camera }
        }
    }
}

/// A rectangle to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// The view, or all of them.
    pub pane: Option<usize>,
    /// Its left side, in finest cells.
    pub column: usize,
    /// Its lower side, in finest cells.
    pub row: usize,
    /// Its width and height, in finest cells.
    pub size: [usize; 2],
    /// Its colour.
    pub color: Color32,
}

/// How many views go side by side so that they are as large as can be, and how large that is.
fn arrange(room: Vec2, count: usize, gap: f32) -> (usize, f32) {
    let side = |columns: usize| {
        let rows = count.max(1).div_ceil(columns);
        let wide = (room.x - gap * (columns - 1) as f32) / columns as f32 - MARGIN;
        let high = (room.y - gap * (rows - 1) as f32) / rows as f32 - TITLE - MARGIN;
        wide.min(high).max(1.0)
    };
    let best = (1..=count.max(1)).max_by(|a, b| side(*a).total_cmp(&side(*b))).unwrap_or(1);
    (best, side(best))
}

/// A view's title, and the names and numbers of its axes.
fn frame_text(ui: &Ui, rect: Rect, shown: &Shown, title: &str, theme: &Theme, placing: &Placing) {
    let painter = ui.painter();
    let font = FontId::proportional(13.0);
    // What explains the title goes first where there is no room for both.
    let width = |text: &str| painter.layout_no_wrap(text.to_owned(), font.clone(), color(theme.ink)).size().x;
    let short = title.split("  ·  ").next().unwrap_or(title);
    let title = if width(title) <= rect.width() { title } else { short };
    let mut title_job = egui::text::LayoutJob::simple_singleline(title.to_owned(), font.clone(), color(theme.ink));
    title_job.wrap = egui::text::TextWrapping::truncate_at_width(rect.width());
    let galley = painter.layout_job(title_job);
    painter.galley(pos2(rect.left(), rect.top() - TITLE + 2.0), galley, color(theme.ink));
    let small = FontId::proportional(11.5);
    let muted = color(theme.muted);
    let axis = shown.slice.plane.axis;
    let numbers = |low: f32| low.max(0.0) as usize;
    let (left, right) =
        ((rect.left() - placing.origin.x) / placing.cell, (rect.right() - placing.origin.x) / placing.cell);
    let (low, high) =
        ((placing.origin.y - rect.bottom()) / placing.cell, (placing.origin.y - rect.top()) / placing.cell);
    let last = |edge: f32| (edge.ceil() as usize).clamp(1, shown.slice.side) - 1;
    let below = rect.bottom() + 3.0;
    let text = |pos: Pos2, align: Align2, what: String| painter.text(pos, align, what, small.clone(), muted);
    text(pos2(rect.left(), below), Align2::LEFT_TOP, numbers(left.floor()).to_string());
    text(pos2(rect.right(), below), Align2::RIGHT_TOP, last(right).to_string());
    text(pos2(rect.center().x, below), Align2::CENTER_TOP, Axis::name(axis.columns()).to_owned());
    let beside = rect.left() - 4.0;
    text(pos2(beside, rect.bottom()), Align2::RIGHT_BOTTOM, numbers(low.floor()).to_string());
    text(pos2(beside, rect.top()), Align2::RIGHT_TOP, last(high).to_string());
    text(pos2(beside, rect.center().y), Align2::RIGHT_CENTER, Axis::name(axis.rows()).to_owned());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_are_arranged_to_be_as_large_as_can_be() {
        assert_eq!(arrange(vec2(1000.0, 300.0), 3, 10.0).0, 3);
        assert_eq!(arrange(vec2(300.0, 1000.0), 3, 10.0).0, 1);
        assert_eq!(arrange(vec2(700.0, 700.0), 4, 10.0).0, 2);
    }
}
