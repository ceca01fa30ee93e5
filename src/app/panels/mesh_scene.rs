//! The panel where a scene with a mesh is edited: the mesh, its volume, its lights; and what they come to.

use egui::{DragValue, RichText, ScrollArea, Ui};
use glam::DVec3;

use super::button::{button, small_button};
use super::field::{self, choice, name, row, vector};
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::command::Command;
use crate::app::session::purpose::Purpose;
use crate::scene::Stage;
use crate::scene::mesh_scene::{Injection, LARGEST_MAP, Light, LightKind, MOST_LIGHTS, MeshScene, Volume};

/// The whole panel; `stage` is what the scene has become, as far as that is known.
pub fn ui(ui: &mut Ui, session: &Session, stage: Option<&Stage>, asks: &mut Asks) {
    let before = &session.document.preset;
    let mut preset = before.clone();
    ui.horizontal(|ui| {
        if preset.scene.is_none() {
            ui.label("No mesh");
            return;
        }
        let about = "An .obj, .gltf or .glb beside the preset; or drop one";
        if ui.button("Another mesh…").on_hover_text(about).clicked() {
            asks.ask(Ask::Choose(Purpose::Mesh));
        }
        if ui.button("Take out").on_hover_text("Go on without a mesh").clicked() {
            preset.scene = None;
        }
    });
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        if let Some(scene) = &mut preset.scene {
            ui.label(scene.mesh.display().to_string());
            volume(ui, scene, before.size, stage);
            lights(ui, scene, stage);
            if let Some(stage) = stage {
                account(ui, stage);
            }
        }
    });
    asks.changed(before, preset, |preset| Ask::Preset(Box::new(preset)));
}

/// What is missing where there is no mesh, and how it is added.
pub fn missing(ui: &mut Ui, session: &Session, asks: &mut Asks) {
    ui.add_space(24.0);
    ui.vertical_centered(|ui| {
        ui.label("This preset has no mesh, so there is nothing for a lamp to light or a camera to see.");
        ui.label("Open a mesh, or take a preset that has one: cornell, cube-room, room-with-windows, atrium.");
        ui.add_space(8.0);
        if ui.button("Open a mesh…").on_hover_text("An .obj, .gltf or .glb beside the preset; or drop one").clicked()
        {
            asks.ask(Ask::Choose(Purpose::Mesh));
        }
        button(ui, session, Command::Gallery, asks);
    });
}

/// Where the volume lies, and how lights are sampled.
fn volume(ui: &mut Ui, scene: &mut MeshScene, size: usize, stage: Option<&Stage>) {
    ui.add_space(6.0);
    ui.label(RichText::new("Volume").strong());
    let mut fits = matches!(scene.volume, Volume::Fit { .. });
    let hint = "Around the mesh, or a cube of your own";
    choice(ui, "Place", hint, &mut fits, &[true, false], |fits| {
        if *fits { "Fits the mesh" } else { "Cube" }.to_owned()
    });
    match (&mut scene.volume, fits) {
        (Volume::Fit { margin }, true) => {
            let field = DragValue::new(margin).range(0.0..=(size as f64 / 2.0 - 0.5)).speed(0.05).suffix(" cells");
            field::number(ui, "Margin", "Empty cells on every side", field);
        }
        (Volume::Cube { center, side }, false) => {
            ui.horizontal(|ui| vector(ui, "Centre of the volume", center));
            field::number(ui, "Side", "In metres", DragValue::new(side).range(1e-3..=1e6).speed(0.02).suffix(" m"));
        }
        (other, true) => *other = Volume::default(),
        // A cube begins where the volume was.
        (other, false) => {
            let [low, high] = stage.map_or([DVec3::ZERO, DVec3::ONE], |stage| stage.placement.bounds());
            *other = Volume::Cube { center: ((low + high) / 2.0).to_array(), side: (high - low).x };
        }
    }
    let map = DragValue::new(&mut scene.shadow_map).range(1..=LARGEST_MAP);
    field::number(ui, "Shadow map", "Texels along a side of a face, all of them injected", map);
    let hint = "Into the cell of a virtual point light, or into the eight around it: light that moves moves smoothly";
    let kinds = [Injection::Nearest, Injection::Split];
    choice(ui, "Injected into", hint, &mut scene.injection, &kinds, |kind| match kind {
        Injection::Nearest => "One cell".to_owned(),
        Injection::Split => "Eight cells".to_owned(),
    });
    row(ui, "Lamps of file", |ui| {
        ui.checkbox(&mut scene.lamps_of_file, "").on_hover_text("Whether the lamps of a glTF file shine too")
    });
}

/// The list of lights.
fn lights(ui: &mut Ui, scene: &mut MeshScene, stage: Option<&Stage>) {
    ui.add_space(6.0);
    ui.label(RichText::new(format!("Lights ({})", scene.lights.len())).strong());
    let mut gone = None;
    for (i, light) in scene.lights.iter_mut().enumerate() {
        ui.push_id(("light", i), |ui| {
            let kind = kind_name(light);
            ui.horizontal(|ui| {
                let box_ = ui.checkbox(&mut light.enabled, kind).on_hover_text("Whether it shines");
                name(&box_, &format!("Light {}", i + 1));
                if small_button(ui, "✖", &format!("Delete light {}", i + 1)).clicked() {
                    gone = Some(i);
                }
            });
            one(ui, i, light);
        });
    }
    if let Some(i) = gone {
        scene.lights.remove(i);
    }
    let middle = stage.map_or([0.0; 3], |stage| {
        let [low, high] = stage.model.mesh.bounds();
        ((low + high) / 2.0).to_array()
    });
    // As bright as to light a room of this size.
    let size = stage.map_or(1.0, |stage| stage.placement.cell_side * stage.placement.size as f64);
    let power = [size * size; 3];
    ui.add_enabled_ui(scene.lights.len() < MOST_LIGHTS, |ui| {
        ui.horizontal_wrapped(|ui| {
            if ui.button("Add point").clicked() {
                scene.lights.push(Light::point(middle, power));
            }
            if ui.button("Add spot").clicked() {
                let kind = LightKind::Spot { position: middle, direction: [0.0, -1.0, 0.0], angle: 40.0, blend: 0.2 };
                scene.lights.push(Light { kind, ..Light::point(middle, power) });
            }
            if ui.button("Add sun").clicked() {
                scene.lights.push(Light::sun([0.3, -1.0, 0.2], [10.0; 3]));
            }
        });
    });
}

fn kind_name(light: &Light) -> &'static str {
    match light.kind {
        LightKind::Point { .. } => "Point",
        LightKind::Spot { .. } => "Spot",
        LightKind::Sun { .. } => "Sun",
    }
}

fn one(ui: &mut Ui, i: usize, light: &mut Light) {
    let called = |what: &str| format!("Light {} {what}", i + 1);
    let place = |ui: &mut Ui, label: &str, value: &mut [f64; 3]| {
        ui.horizontal(|ui| {
            ui.label(label);
            vector(ui, &called(label), value);
        });
    };
    let (power, unit) = match &mut light.kind {
        LightKind::Point { position } => {
            place(ui, "at", position);
            (light.intensity.get_or_insert([1.0; 3]), "W/sr")
        }
        LightKind::Spot { position, direction, angle, blend } => {
            place(ui, "at", position);
            place(ui, "towards", direction);
            ui.horizontal(|ui| {
                let angle = ui.add(DragValue::new(angle).range(1.0..=80.0).speed(0.2).suffix("°"));
                name(&angle.on_hover_text("Half angle"), &called("half angle"));
                let blend = ui.add(DragValue::new(blend).range(0.0..=1.0).speed(0.01));
                name(&blend.on_hover_text("Share of the angle over which it fades"), &called("blend"));
            });
            (light.intensity.get_or_insert([1.0; 3]), "W/sr")
        }
        LightKind::Sun { direction } => {
            place(ui, "towards", direction);
            (light.irradiance.get_or_insert([1.0; 3]), "W/m²")
        }
    };
    ui.horizontal(|ui| {
        for (colour, part) in ["red", "green", "blue"].into_iter().zip(power) {
            let field = ui.add(DragValue::new(part).range(0.0..=1e6).speed(0.02).max_decimals(4));
            name(&field.on_hover_text(colour), &called(colour));
        }
        ui.label(unit);
    });
}

/// What the mesh and its lights come to.
fn account(ui: &mut Ui, stage: &Stage) {
    ui.add_space(6.0);
    ui.label(RichText::new("What it comes to").strong());
    let sum = |flux: [f64; 3]| flux.iter().sum::<f64>();
    let given: f64 = stage.maps.iter().map(|map| sum(map.given)).sum();
    let met: f64 = stage.maps.iter().map(|map| sum(map.met)).sum();
    let lines = [
        ("triangles", stage.model.mesh.len().to_string()),
        ("area", format!("{:.3} m²", stage.model.mesh.total_area())),
        ("a cell", format!("{:.4} m", stage.placement.cell_side)),
        ("occupied cells", stage.voxels.solids.len().to_string()),
        ("virtual point lights", format!("{} in the volume", stage.injected.inside)),
        ("lights give", format!("{given:.4} W")),
        ("of it meets surfaces", format!("{met:.4} W")),
        ("injected", format!("{:.4} W", sum(stage.injected.flux))),
    ];
    egui::Grid::new("account").num_columns(2).show(ui, |ui| {
        for (what, number) in lines {
            ui.label(what);
            ui.label(number);
            ui.end_row();
        }
    });
    for note in &stage.model.notes {
        ui.colored_label(ui.visuals().warn_fg_color, note);
    }
}
