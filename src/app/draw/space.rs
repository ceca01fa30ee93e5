//! The three-dimensional view: lit cells as shaded cubes or small lobes, seen from any side.

use std::sync::Arc;

use egui::{Color32, Mesh, Pos2, Rect, Sense, Shape, Ui, Vec2, vec2};
use glam::{Mat3, Vec3, vec3};

use crate::app::draw::ink::{Ink, color};
use crate::app::session::view::{Scaling, View};
use crate::app::worker::look::{Cloud, CloudCell, Pin};
use crate::report::colour::{Paint, Rgb, Theme};
use crate::report::glyph::{GlyphScale, Glyphs, Outline, peak};
use crate::report::slice::{Axis, Plane};
use crate::sh::Sh;

/// The eye's distance from the middle of the volume, in sides of the volume.
const DISTANCE: f32 = 3.0;
/// Points in the outline of a lobe.
const LOBE_POINTS: usize = 16;

/// Where the eye is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Turned about the upright axis, in radians.
    pub yaw: f32,
    /// Raised above the horizon, in radians.
    pub pitch: f32,
    /// How much larger than fitting.
    pub zoom: f32,
    /// How far the middle is moved on screen, in shares of the view.
    pub pan: Vec2,
}

impl Default for Eye {
    fn default() -> Self {
        Eye { yaw: -0.55, pitch: 0.45, zoom: 1.0, pan: Vec2::ZERO }
    }
}

impl Eye {
    /// Turns, moves and zooms as the pointer asks over a view in `rect`.
    pub fn steer(&mut self, ui: &Ui, rect: Rect, response: &egui::Response) {
        let eye = self;
        if response.dragged_by(egui::PointerButton::Primary) && !ui.input(|input| input.modifiers.shift) {
            let drag = response.drag_delta() * 0.01;
            eye.yaw += drag.x;
            eye.pitch = (eye.pitch + drag.y).clamp(-1.55, 1.55);
        } else if response.dragged() {
            eye.pan += response.drag_delta() / rect.width().min(rect.height());
        }
        if response.hovered() {
            let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            eye.zoom = (eye.zoom * pinch * (scroll * 0.004).exp()).clamp(0.3, 20.0);
        }
        if response.double_clicked() {
            *eye = Eye::default();
        }
    }

    /// The place of the eye, in sides of the volume from its middle, and the tangent of half the angle of view over
    /// the shorter side of the screen. What is panned aside is left out.
    pub fn place(&self) -> (Vec3, f32) {
        let turn = Mat3::from_rotation_x(self.pitch) * Mat3::from_rotation_y(self.yaw);
        (turn.transpose() * vec3(0.0, 0.0, DISTANCE), 1.0 / (DISTANCE * self.zoom))
    }

    /// A move on screen of a place in the volume, in finest cells: in the plane across the view through that place.
    pub fn drag(&self, projection: &Projection, at: Vec3, moved: Vec2) -> Vec3 {
        let (_, nearness) = projection.screen(projection.seen(at));
        let seen = vec3(moved.x, -moved.y, 0.0) / (projection.scale * nearness);
        projection.turn.transpose() * seen * projection.side
    }
}

/// How places in the volume come on screen.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    pub(super) turn: Mat3,
    centre: Pos2,
    scale: f32,
    side: f32,
}

impl Projection {
    /// Of a volume of so many finest cells along a side, in `rect`.
    pub fn new(eye: &Eye, rect: Rect, side: usize) -> Self {
        // y is up in the volume; the eye looks along −z of its own frame.
        let turn = Mat3::from_rotation_x(eye.pitch) * Mat3::from_rotation_y(eye.yaw);
        let extent = rect.width().min(rect.height());
        Projection { turn, centre: rect.center() + eye.pan * extent, scale: extent * 0.5 * eye.zoom, side: side as f32 }
    }

    /// A place in finest cells, in the eye's frame: the volume's middle at 0, its side 1, z towards the eye.
    pub fn seen(&self, at: Vec3) -> Vec3 {
        self.turn * ((at - Vec3::splat(self.side / 2.0)) / self.side)
    }

    /// A place in the eye's frame, on screen, with how much larger than in the middle things are there.
    pub fn screen(&self, seen: Vec3) -> (Pos2, f32) {
        let nearness = DISTANCE / (DISTANCE - seen.z).max(0.1);
        (self.centre + vec2(seen.x, -seen.y) * self.scale * nearness, nearness)
    }

    /// How much a surface at a place, in finest cells, faces the eye: the cosine of the angle to its normal.
    pub fn facing(&self, at: Vec3, normal: Vec3) -> f32 {
        let to_eye = vec3(0.0, 0.0, DISTANCE) - self.seen(at);
        (self.turn * normal).dot(to_eye.normalize_or_zero())
    }

    /// How many points a length of one finest cell takes up on screen at a place.
    pub fn points(&self, at: Vec3) -> f32 {
        self.scale / self.side * self.screen(self.seen(at)).1
    }

    /// A place in finest cells, on screen.
    pub fn at(&self, at: Vec3) -> Pos2 {
        self.screen(self.seen(at)).0
    }
}

/// The view's own state.
#[derive(Default)]
pub struct Space {
    eye: Eye,
    drawn: Option<(Key, Arc<Mesh>)>,
}

/// Everything that the drawn mesh depends on.
#[derive(Clone)]
struct Key {
    cloud: Arc<Cloud>,
    eye: Eye,
    lobes: bool,
    rect: Rect,
    view: View,
    dark: bool,
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.cloud, &other.cloud)
            && self.eye == other.eye
            && self.lobes == other.lobes
            && self.rect == other.rect
            && self.view == other.view
            && self.dark == other.dark
    }
}

impl Space {
    /// Draws the cloud in all the room there is, with `lobes` in place of cubes.
    /// The cell that was clicked, if one was.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        cloud: &Arc<Cloud>,
        lobes: bool,
        view: &View,
        marks: &Marks,
        theme: &Theme,
    ) -> Option<Pin> {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "View: the light in space"));
        self.eye.steer(ui, rect, &response);
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, color(theme.ground));
        let key = Key { cloud: Arc::clone(cloud), eye: self.eye, lobes, rect, view: view.clone(), dark: theme.dark };
        if self.drawn.as_ref().is_none_or(|(drawn, _)| *drawn != key) {
            let mesh = draw(&key, theme);
            self.drawn = Some((key, Arc::new(mesh)));
        }
        let projection = Projection::new(&self.eye, rect, cloud.side.max(1));
        frame(&painter, &projection, view.plane(), theme, false);
        if let Some((_, mesh)) = &self.drawn {
            painter.add(Shape::mesh(Arc::clone(mesh)));
        }
        frame(&painter, &projection, view.plane(), theme, true);
        marks.draw(&painter, &projection, theme);
        let clicked = response.interact_pointer_pos().filter(|_| response.clicked())?;
        picked(cloud, &projection, clicked)
    }
}

/// What is marked in space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Marks {
    /// The cell that is kept in sight.
    pub pin: Option<Pin>,
    /// The ends of the line of cells whose light is plotted, in finest cells.
    pub line: Option<[[f32; 3]; 2]>,
}

impl Marks {
    fn draw(&self, painter: &egui::Painter, projection: &Projection, theme: &Theme) {
        if let Some([from, to]) = self.line {
            let line = [from, to].map(|end| projection.at(Vec3::from(end)));
            painter.line_segment(line, (1.8, color(theme.curve(1))));
        }
        let Some(Pin { level, cell }) = self.pin else { return };
        let span = (1 << level) as f32;
        let low = Vec3::from(cell.map(|c| c as f32)) * span;
        let corner = |i: usize| low + vec3((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32) * span;
        for from in 0..8usize {
            for to in [1, 2, 4].map(|bit| from ^ bit).into_iter().filter(|to| from < *to) {
                let edge = [projection.at(corner(from)), projection.at(corner(to))];
                painter.line_segment(edge, (1.6, color(theme.negative)));
            }
        }
    }
}

/// The nearest cell that is drawn at a place on screen.
fn picked(cloud: &Cloud, projection: &Projection, at: Pos2) -> Option<Pin> {
    let here = cloud.cells.iter().filter_map(|cell| {
        let seen = projection.seen(Vec3::from(cell.centre));
        let (centre, nearness) = projection.screen(seen);
        // A cube seen from a corner is wider than its side.
        let reach = 0.6 * cell.span / projection.side * projection.scale * nearness;
        (centre.distance(at) <= reach.max(3.0)).then_some((seen.z, cell.pin))
    });
    here.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, pin)| pin)
}

/// Something that hides what is behind it.
enum Solid<'a> {
    Lit(&'a CloudCell),
    Occupied([f32; 3]),
}

/// The cells, the farthest first.
fn draw(key: &Key, theme: &Theme) -> Mesh {
    let projection = Projection::new(&key.eye, key.rect, key.cloud.side.max(1));
    let depth = |centre: [f32; 3]| projection.seen(Vec3::from(centre)).z;
    let occupied: &[[f32; 3]] = if key.view.occluders { &key.cloud.occupied } else { &[] };
    let lit = key.cloud.cells.iter().map(|cell| (depth(cell.centre), Solid::Lit(cell)));
    let mut cells: Vec<(f32, Solid)> = lit.collect();
    cells.extend(occupied.iter().map(|centre| (depth(*centre), Solid::Occupied(*centre))));
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let dress = Dress::of(&key.cloud, &key.view);
    let mut ink = Ink::default();
    let mut pen = Pen {
        glyphs: dress.glyphs(),
        outline: Outline::default(),
        positive: color(theme.glyph),
        negative: color(theme.negative),
    };
    for (_, solid) in cells {
        let cell = match solid {
            Solid::Lit(cell) => cell,
            Solid::Occupied(centre) => {
                cube(&mut ink, &projection, centre, key.cloud.occupied_span, theme.muted, theme);
                continue;
            }
        };
        let (share, paint) = dress.worn(cell, &key.view, key.lobes, theme);
        if key.lobes {
            pen.positive = color(paint);
            lobe(&mut ink, &projection, cell, key.view.hue.of(cell.light), &mut pen);
        } else {
            cube(&mut ink, &projection, cell.centre, cell.span * (0.35 + 0.6 * share), paint, theme);
        }
    }
    ink.mesh
}

/// How large and in which colour lit cells are drawn.
#[derive(Clone, Copy, Debug)]
pub struct Dress {
    scale: GlyphScale,
    full: f32,
}

impl Dress {
    /// That of a cloud: its strongest cell is the largest.
    pub fn of(cloud: &Cloud, view: &View) -> Self {
        let strongest = cloud.cells.iter().map(|cell| peak(view.hue.of(cell.light), Axis::Z)).fold(0.0, f32::max);
        let full = strongest.max(f32::MIN_POSITIVE);
        let scale = match view.scaling {
            Scaling::Linear => GlyphScale::Linear { full },
            Scaling::Log => GlyphScale::Log { full, decades: view.decades },
            Scaling::PerGlyph => GlyphScale::PerGlyph,
        };
        Dress { scale, full }
    }

    /// A cell's share of the largest size, and its colour.
    pub fn worn(&self, cell: &CloudCell, view: &View, lobes: bool, theme: &Theme) -> (f32, Rgb) {
        let light = view.hue.of(cell.light);
        let share = self.scale.share(peak(light, Axis::Z), self.full).clamp(0.0, 1.0);
        let paint = match view.paint {
            // One colour alone would hide how strong the light is.
            Paint::Single if !lobes => theme.glyph.towards(theme.ground, 0.75 * (1.0 - share)),
            paint => paint.glyph(theme, cell.light, light, view.axis, share),
        };
        (share, paint)
    }

    /// What draws outlines of lobes.
    pub fn glyphs(&self) -> Glyphs {
        Glyphs::new(Axis::Z, self.scale, LOBE_POINTS)
    }
}

/// What lobes are drawn with.
struct Pen {
    glyphs: Glyphs,
    outline: Outline,
    positive: Color32,
    negative: Color32,
}

/// A lobe as the eye sees it: its outline in the plane across the line of sight.
fn lobe(ink: &mut Ink, projection: &Projection, cell: &CloudCell, light: Sh<f32>, pen: &mut Pen) {
    let Sh([c00, x, y, z]) = light;
    let turned = projection.turn * vec3(x, y, z);
    pen.glyphs.outline(Sh([c00, turned.x, turned.y, turned.z]), &mut pen.outline);
    let (centre, nearness) = projection.screen(projection.seen(Vec3::from(cell.centre)));
    let side = cell.span / projection.side * projection.scale * nearness;
    ink.glyph(&pen.outline, centre, side, pen.positive, Some(pen.negative));
}

/// The three faces of a cube, its middle and side in finest cells, that face the eye, shaded by how much they do.
fn cube(ink: &mut Ink, projection: &Projection, centre: [f32; 3], side: f32, paint: Rgb, theme: &Theme) {
    let (centre, half) = (Vec3::from(centre), side * 0.5);
    let eye = projection.turn.transpose() * vec3(0.0, 0.0, DISTANCE);
    let to_eye = eye * projection.side - (centre - Vec3::splat(projection.side / 2.0));
    for axis in 0..3 {
        let sign = if to_eye[axis] > 0.0 { 1.0 } else { -1.0 };
        let normal = Vec3::AXES[axis] * sign;
        let (u, v) = (Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]);
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let corners = corners.map(|(a, b)| projection.at(centre + (normal + u * a + v * b) * half));
        let facing = (projection.turn * normal).z.max(0.0);
        let lit = paint.towards(theme.ground, 0.55 * (1.0 - facing));
        ink.quad(corners, color(lit));
    }
}

/// The edges of the volume, those behind the light or those before it, with its axes and the cut.
fn frame(painter: &egui::Painter, projection: &Projection, plane: Plane, theme: &Theme, front: bool) {
    let n = projection.side;
    let corner = |i: usize| vec3((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32) * n;
    let depth = |i: usize| projection.seen(corner(i)).z;
    let nearest = (0..8).max_by(|a, b| depth(*a).total_cmp(&depth(*b))).unwrap_or(0);
    for from in 0..8usize {
        for bit in [1, 2, 4] {
            let to = from ^ bit;
            if from < to && (from == nearest || to == nearest) == front {
                let line = [projection.at(corner(from)), projection.at(corner(to))];
                painter.line_segment(line, (1.0, color(theme.muted).gamma_multiply(if front { 0.35 } else { 0.8 })));
            }
        }
    }
    if !front {
        return;
    }
    for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
        let at = projection.at(Vec3::AXES[i] * n * 1.06);
        painter.text(at, egui::Align2::CENTER_CENTER, name, egui::FontId::proportional(13.0), color(theme.ink));
    }
    painter.text(
        projection.at(Vec3::splat(-0.04 * n)),
        egui::Align2::CENTER_CENTER,
        "0",
        egui::FontId::proportional(11.0),
        color(theme.muted),
    );
    let across = plane.axis.across();
    let at = Vec3::AXES[across] * (plane.index as f32 + 0.5);
    let (u, v) = (Vec3::AXES[(across + 1) % 3] * n, Vec3::AXES[(across + 2) % 3] * n);
    let corners = [at, at + u, at + u + v, at + v].map(|corner| projection.at(corner));
    painter.add(Shape::closed_line(corners.to_vec(), (1.0, color(theme.negative).gamma_multiply(0.8))));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eye_sees_what_is_nearer_larger_and_up_as_up() {
        let rect = Rect::from_min_size(Pos2::ZERO, Vec2::splat(400.0));
        let eye = Eye { yaw: 0.0, pitch: 0.0, ..Eye::default() };
        let projection = Projection::new(&eye, rect, 8);
        assert!((projection.at(Vec3::splat(4.0)) - rect.center()).length() < 1e-3);
        assert!(projection.at(vec3(4.0, 8.0, 4.0)).y < rect.center().y);
        assert!(projection.at(vec3(8.0, 4.0, 4.0)).x > rect.center().x);
        let (_, near) = projection.screen(projection.seen(vec3(4.0, 4.0, 8.0)));
        let (_, far) = projection.screen(projection.seen(vec3(4.0, 4.0, 0.0)));
        assert!(near > 1.0 && far < 1.0);
    }

    #[test]
    fn the_nearest_cell_under_the_pointer_is_picked() {
        let cell = |z: f32, x: usize| CloudCell {
            centre: [4.0, 4.0, z],
            span: 1.0,
            light: [Sh::ZERO; 3],
            pin: Pin { level: 0, cell: [x, 4, 4] },
        };
        let cloud = Cloud { side: 8, cells: vec![cell(1.5, 1), cell(6.5, 6)], ..Cloud::default() };
        let rect = Rect::from_min_size(Pos2::ZERO, Vec2::splat(400.0));
        let projection = Projection::new(&Eye { yaw: 0.0, pitch: 0.0, ..Eye::default() }, rect, 8);
        assert_eq!(picked(&cloud, &projection, rect.center()), Some(Pin { level: 0, cell: [6, 4, 4] }));
        assert_eq!(picked(&cloud, &projection, rect.left_top()), None);
    }
}
