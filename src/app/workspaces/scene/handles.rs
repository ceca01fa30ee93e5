//! What is taken by the hand in space: lights and the picture's camera, moved in the plane across the view. Each is a
//! button with a name of its own.

use egui::{Align2, Color32, CursorIcon, FontId, Painter, Pos2, Rect, Sense, Stroke, Ui, Vec2};
use glam::{DVec3, Vec3, vec3};

use crate::app::draw::ink::color;
use crate::app::draw::space::{Eye, Projection};
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::report::colour::Theme;
use crate::scene::Stage;
use crate::scene::mesh_scene::{Camera, LightKind, MeshScene};

/// The side of a handle, in points.
const HANDLE: f32 = 16.0;
/// How long the arrow of a light's direction is, in sides of the volume.
const ARROW: f32 = 0.18;
/// How far from the volume's middle the sun's arrow begins, in sides of the volume.
const SUN: f32 = 0.75;
/// How deep the camera's pyramid is, in sides of the volume.
const PYRAMID: f32 = 0.16;
/// A light that is on.
const ON: Color32 = Color32::from_rgb(255, 210, 60);

/// A place in metres, in finest cells.
fn cells(stage: &Stage, metres: [f64; 3]) -> Vec3 {
    stage.placement.in_cells(DVec3::from_array(metres)).as_vec3()
}

/// Changes the scene in the document.
fn change(session: &Session, asks: &mut Asks, change: impl FnOnce(&mut MeshScene)) {
    let before = &session.document.preset;
    let mut preset = before.clone();
    if let Some(scene) = &mut preset.scene {
        change(scene);
    }
    asks.changed(before, preset, |preset| Ask::Preset(Box::new(preset)));
}

/// The edges of the volume, with the names of its axes.
pub fn frame(painter: &Painter, projection: &Projection, n: f32, theme: &Theme) {
    let ink = color(theme.muted).gamma_multiply(0.7);
    let corner = |i: usize| vec3((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * n;
    for from in 0..8usize {
        for to in [1, 2, 4].map(|bit| from ^ bit).into_iter().filter(|to| from < *to) {
            painter.line_segment([projection.at(corner(from)), projection.at(corner(to))], (1.0, ink));
        }
    }
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let at = projection.at(Vec3::AXES[axis] * n * 1.06);
        painter.text(at, Align2::CENTER_CENTER, name, FontId::proportional(13.0), color(theme.ink));
    }
}

/// Draws handles onto a view of the scene, and asks for what the hand does with them.
pub struct Handles<'a> {
    /// Where the view is.
    pub ui: &'a Ui,
    /// What draws onto it.
    pub painter: &'a Painter,
    /// Whose document is changed.
    pub session: &'a Session,
    /// The scene in its volume.
    pub stage: &'a Stage,
    /// Who looks at it.
    pub eye: &'a Eye,
    /// How places come onto the screen.
    pub projection: &'a Projection,
    /// The window's colours.
    pub theme: &'a Theme,
}

impl Handles<'_> {
    /// Every light with its handle; those that have a direction with an arrow.
    pub fn lights(&self, asks: &mut Asks) {
        let Some(scene) = &self.session.document.preset.scene else { return };
        let n = self.stage.placement.size as f32;
        for (i, light) in scene.lights.iter().enumerate() {
            let ink = if light.enabled { ON } else { color(self.theme.muted) };
            let arrow = |from: Vec3| {
                let Some(way) = light.direction() else { return };
                let from_to = [from, from + way.as_vec3() * ARROW * n].map(|place| self.projection.at(place));
                self.painter.arrow(from_to[0], from_to[1] - from_to[0], Stroke::new(2.0, ink));
            };
            match light.kind {
                LightKind::Point { position } | LightKind::Spot { position, .. } => {
                    arrow(cells(self.stage, position));
                    let (at, held, by) = self.dragged(&format!("Position of light {}", i + 1), position);
                    self.painter.circle(at, if held { 9.0 } else { 7.0 }, ink, Stroke::new(1.5, Color32::BLACK));
                    let Some(by) = by else { continue };
                    change(self.session, asks, |scene| {
                        if let LightKind::Point { position } | LightKind::Spot { position, .. } =
                            &mut scene.lights[i].kind
                        {
                            *position = (DVec3::from_array(*position) + by).to_array();
                        }
                    });
                }
                LightKind::Sun { .. } => {
                    let way = light.direction().unwrap_or(DVec3::NEG_Y).as_vec3();
                    arrow(Vec3::splat(n / 2.0) - way * (SUN + ARROW) * n);
                }
            }
        }
    }

    /// The picture's camera as a pyramid before its eye, which is dragged.
    pub fn camera(&self, asks: &mut Asks) {
        let (stage, projection) = (self.stage, self.projection);
        let Some(scene) = &self.session.document.preset.scene else { return };
        let camera = scene.camera.unwrap_or(stage.camera);
        let ink = color(self.theme.curve(0));
        let far = corners(&camera, f64::from(PYRAMID) * stage.placement.size as f64 * stage.placement.cell_side);
        for (i, corner) in far.iter().flatten().enumerate() {
            let next = far.as_ref().map_or(*corner, |far| far[(i + 1) % 4]);
            let [from, corner, next] = [camera.from, *corner, next].map(|place| projection.at(cells(stage, place)));
            self.painter.line_segment([from, corner], (1.0, ink));
            self.painter.line_segment([corner, next], (1.0, ink));
        }
        let (at, held, by) = self.dragged("Position of the camera", camera.from);
        let half = if held { 6.0 } else { 4.5 };
        self.painter.rect_filled(Rect::from_center_size(at, Vec2::splat(2.0 * half)), 2.0, ink);
        if let Some(by) = by {
            let from = (DVec3::from_array(camera.from) + by).to_array();
            change(self.session, asks, |scene| scene.camera = Some(Camera { from, ..camera }));
        }
    }

    /// A handle at a place in metres: where it is on the screen, whether the hand is on it, and by how much it is dragged
    /// in the plane across the view, in metres.
    fn dragged(&self, name: &str, at: [f64; 3]) -> (Pos2, bool, Option<DVec3>) {
        let place = cells(self.stage, at);
        let on_screen = self.projection.at(place);
        let rect = Rect::from_center_size(on_screen, Vec2::splat(HANDLE));
        let response = self.ui.interact(rect, self.ui.scope_id().with(("handle", name)), Sense::drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
        let response = response.on_hover_cursor(CursorIcon::Grab).on_hover_text(name);
        let by = response.dragged().then(|| {
            let by = self.eye.drag(self.projection, place, response.drag_delta());
            by.as_dvec3() * self.stage.placement.cell_side
        });
        (on_screen, response.hovered() || response.dragged(), by)
    }
}

/// The corners of what a square picture shows at a distance, around it.
fn corners(camera: &Camera, distance: f64) -> Option<[[f64; 3]; 4]> {
    let [from, to, up] = [camera.from, camera.to, camera.up].map(DVec3::from_array);
    let ahead = (to - from).try_normalize()?;
    let right = ahead.cross(up).try_normalize()?;
    let half = (0.5 * camera.fov).to_radians().tan();
    let corner = |x: f64, y: f64| from + distance * (ahead + half * (x * right + y * right.cross(ahead)));
    Some([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| corner(x, y).to_array()))
}

/// Puts the picture's camera where the view is seen from; what is in its middle stays there.
pub fn camera_here(session: &Session, stage: &Stage, eye: &Eye, asks: &mut Asks) {
    let (place, half) = eye.place();
    let n = stage.placement.size as f64;
    let middle = DVec3::splat(n / 2.0);
    let from = stage.placement.in_metres(middle + place.as_dvec3() * n).to_array();
    let to = stage.placement.in_metres(middle).to_array();
    let fov = 2.0 * f64::from(half).atan().to_degrees();
    change(session, asks, |scene| scene.camera = Some(Camera { from, to, up: [0.0, 1.0, 0.0], fov }));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pyramid_is_as_wide_as_the_field_of_view() {
        let camera = Camera { from: [0.0; 3], to: [0.0, 0.0, 5.0], up: [0.0, 1.0, 0.0], fov: 90.0 };
        let found = corners(&camera, 2.0).unwrap();
        assert!(
            found.iter().all(|[x, y, z]| (x.abs() - 2.0).abs() < 1e-12 && (y.abs() - 2.0).abs() < 1e-12 && *z == 2.0)
        );
        assert_eq!(corners(&Camera { up: [0.0, 0.0, 1.0], ..camera }, 2.0), None);
    }

    #[test]
    fn the_camera_put_here_sees_as_much_as_the_view() {
        // In a view 3 sides away the middle of the volume is seen one side high, twice as large at zoom 2.
        let (place, half) = Eye { yaw: 0.0, pitch: 0.0, ..Eye::default() }.place();
        assert!((place - vec3(0.0, 0.0, 3.0)).length() < 1e-6);
        assert!((half * 3.0 - 1.0).abs() < 1e-6);
    }
}
