//! Who looks: the document's camera, by numbers and by the hand.

use egui::{DragValue, Ui, Vec2};
use glam::{DQuat, DVec3};

use crate::app::panels::field::{self, name, vector};
use crate::scene::Stage;
use crate::scene::mesh_scene::{Camera, MeshScene};

/// How far the camera turns for a point that it is dragged, in radians.
const TURN: f64 = 0.008;
/// How near to straight up or down it comes, in radians.
const POLE: f64 = 0.02;

/// The camera of a scene: the document's, else one before its mesh.
pub fn of(scene: &MeshScene, stage: &Stage) -> Camera {
    scene.camera.unwrap_or(stage.camera)
}

/// Its numbers.
pub fn ui(ui: &mut Ui, camera: &mut Camera) {
    for (label, value) in [("from", &mut camera.from), ("to", &mut camera.to), ("up", &mut camera.up)] {
        ui.horizontal(|ui| {
            ui.add_sized([36.0, ui.spacing().interact_size.y], egui::Label::new(label));
            vector(ui, &format!("Camera {label}"), value);
        });
    }
    ui.horizontal(|ui| {
        ui.label("field of view");
        let fov = DragValue::new(&mut camera.fov).range(1.0..=170.0).speed(0.2).suffix("°");
        name(&field::add(ui, fov).on_hover_text("Vertical"), "Camera field of view");
    });
}

/// The camera carried around what it looks at by so many points of the hand.
pub fn orbit(camera: &Camera, drag: Vec2) -> Camera {
    let [from, to, up] = [camera.from, camera.to, camera.up].map(DVec3::from_array);
    let (Some(up), Some(right)) = (up.try_normalize(), (to - from).cross(up).try_normalize()) else { return *camera };
    let around = DQuat::from_axis_angle(up, -TURN * f64::from(drag.x));
    let height = (from - to).angle_between(up);
    let raise = (TURN * f64::from(drag.y)).clamp(POLE - (std::f64::consts::PI - height), height - POLE);
    let over = DQuat::from_axis_angle(right, -raise);
    Camera { from: (to + around * (over * (from - to))).to_array(), ..*camera }
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;

    #[test]
    fn an_orbit_keeps_the_distance_and_stays_off_the_poles() {
        let camera = Camera { from: [3.0, 1.0, 0.0], to: [0.0, 1.0, 0.0], up: [0.0, 1.0, 0.0], fov: 40.0 };
        let quarter = (std::f64::consts::FRAC_PI_2 / TURN) as f32;
        let around = DVec3::from_array(orbit(&camera, vec2(quarter, 0.0)).from);
        assert!((around - DVec3::new(0.0, 1.0, 3.0)).length() < 1e-3, "{around}");
        // Dragged down, the scene tips towards the eye: the camera rises.
        let above = DVec3::from_array(orbit(&camera, vec2(0.0, 20.0)).from);
        assert!(above.y > 1.0 && ((above - DVec3::Y).length() - 3.0).abs() < 1e-9);
        for far in [1e4, -1e4] {
            let pole = DVec3::from_array(orbit(&camera, vec2(0.0, far)).from) - DVec3::Y;
            assert!(((pole.y.abs() / 3.0).acos() - POLE).abs() < 1e-6, "{pole}");
        }
        let blind = Camera { to: camera.from, ..camera };
        assert_eq!(orbit(&blind, vec2(5.0, 5.0)), blind);
    }
}
