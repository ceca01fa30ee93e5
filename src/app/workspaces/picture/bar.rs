//! The bar over the pictures: which of them, on what display, how well they are made, from where.

use egui::{Button, ComboBox, DragValue, Ui};

use super::camera;
use crate::app::panels::button::button;
use crate::app::panels::field::{self, name};
use crate::app::session::Session;
use crate::app::session::ask::{Ask, Asks};
use crate::app::session::command::Command;
use crate::app::session::picture::{BOUNCES, Glass, PATHS, SIDES, Tile, bounces_name};
use crate::render::cells::Sampling;
use crate::scene::mesh_scene::Camera;

/// How far the pictures are.
#[derive(Clone, Debug, Default)]
pub struct Progress {
    /// How good the truth is so far, in words.
    pub quality: Option<String>,
    /// Whether it is being refined.
    pub refining: bool,
    /// Its paths a pixel so far.
    pub paths: u64,
    /// The share done of pictures that are being made.
    pub making: Option<f64>,
    /// Who looks.
    pub camera: Option<Camera>,
    /// The places of the runs that have pictures.
    pub places: Vec<usize>,
}

/// The bar.
pub fn ui(ui: &mut Ui, session: &Session, progress: Progress, asks: &mut Asks) {
    let mut glass = session.picture;
    ui.horizontal_wrapped(|ui| {
        which(ui, &mut glass, &progress.places, asks);
        ui.separator();
        display(ui, &mut glass, asks);
        ui.separator();
        making(ui, &mut glass);
        if let Some(camera) = progress.camera {
            ui.separator();
            ui.menu_button("Camera", |ui| viewpoint(ui, session, camera, asks));
        }
        button(ui, session, Command::ExportSheet, asks);
        if progress.making.is_some() {
            ui.spinner();
        }
    });
    ui.horizontal_wrapped(|ui| truth(ui, &mut glass, &progress, asks));
    asks.changed(&session.picture, glass, Ask::Picture);
}

/// Which pictures, and how they lie.
fn which(ui: &mut Ui, glass: &mut Glass, places: &[usize], asks: &mut Asks) {
    let split = ui.selectable_label(glass.split.is_some(), "Split bar");
    name(&split.clone().on_hover_text(Command::SplitPicture.tooltip(ui.ctx())), Command::SplitPicture.name());
    if split.clicked() {
        asks.command(Command::SplitPicture);
    }
    match &mut glass.split {
        Some(both) => {
            for (side, tile) in ["Left", "Right"].into_iter().zip(both) {
                let combo = ComboBox::from_id_salt(side).selected_text(tile.name()).width(104.0).show_ui(ui, |ui| {
                    for choice in Tile::all(places, true) {
                        ui.selectable_value(tile, choice, choice.name());
                    }
                });
                name(&combo.response, &format!("{side} of the bar"));
            }
        }
        None => {
            let about = "Where each picture is too bright or too dark, and what an eye sees of that";
            ui.checkbox(&mut glass.against, "Differences").on_hover_text(about);
        }
    }
}

/// What radiance becomes on the display.
fn display(ui: &mut Ui, glass: &mut Glass, asks: &mut Asks) {
    let stops = DragValue::new(&mut glass.stops).range(-10.0..=10.0).speed(0.02).max_decimals(2).suffix(" stops");
    let about = "Exposure: each stop doubles the radiance; 0 brings 98 in 100 pixels of direct light onto the display";
    name(&field::add(ui, stops).on_hover_text(about), "Exposure");
    let tab = ui.selectable_label(glass.false_colour, "False colour");
    name(&tab.clone().on_hover_text(Command::FalseColour.tooltip(ui.ctx())), Command::FalseColour.name());
    if tab.clicked() {
        asks.command(Command::FalseColour);
    }
}

/// How pictures are made.
fn making(ui: &mut Ui, glass: &mut Glass) {
    let combo = ComboBox::from_id_salt("sampling").selected_text(glass.sampling.name()).width(84.0);
    let combo = combo.show_ui(ui, |ui| {
        for sampling in Sampling::ALL {
            ui.selectable_value(&mut glass.sampling, sampling, sampling.name());
        }
    });
    let about = "Where on the way to a surface the light of cells is taken";
    name(&combo.response.on_hover_text(about), "Sampling");
    let combo = ComboBox::from_id_salt("pixels").selected_text(format!("{0} × {0}", glass.side)).width(84.0);
    let combo = combo.show_ui(ui, |ui| {
        for side in SIDES {
            ui.selectable_value(&mut glass.side, side, format!("{side} × {side}"));
        }
    });
    name(&combo.response.on_hover_text("Pixels"), "Pixels of the picture");
}

/// The camera's numbers.
fn viewpoint(ui: &mut Ui, session: &Session, mut camera: Camera, asks: &mut Asks) {
    let before = &session.document.preset;
    let mut preset = before.clone();
    let seen = camera;
    camera::ui(ui, &mut camera);
    let Some(scene) = &mut preset.scene else { return };
    if camera != seen {
        scene.camera = Some(camera);
    }
    if ui.button("Before the mesh").on_hover_text("The camera of a preset that names none").clicked() {
        scene.camera = None;
    }
    asks.changed(before, preset, |preset| Ask::Preset(Box::new(preset)));
}

/// Which truth, how good, and how far it is.
fn truth(ui: &mut Ui, glass: &mut Glass, progress: &Progress, asks: &mut Asks) {
    ui.label("Truth:");
    let combo = ComboBox::from_id_salt("bounces").selected_text(bounces_name(glass.bounces)).width(96.0);
    let combo = combo.show_ui(ui, |ui| {
        for bounces in BOUNCES {
            ui.selectable_value(&mut glass.bounces, bounces, bounces_name(bounces));
        }
    });
    name(&combo.response.on_hover_text("How often its light is reflected on its way"), "Bounces of the truth");
    let combo = ComboBox::from_id_salt("paths").selected_text(format!("up to {} paths", glass.paths)).width(120.0);
    let combo = combo.show_ui(ui, |ui| {
        for paths in PATHS {
            ui.selectable_value(&mut glass.paths, paths, format!("up to {paths} paths"));
        }
    });
    name(&combo.response.on_hover_text("Where it comes to rest"), "Paths of the truth");
    let words = if glass.refine { "⏸ Pause" } else { "▶ Refine" };
    let refine = ui.add_sized([84.0, ui.spacing().interact_size.y], Button::new(words));
    name(&refine.clone().on_hover_text(Command::RefineTruth.tooltip(ui.ctx())), Command::RefineTruth.name());
    if refine.clicked() {
        asks.command(Command::RefineTruth);
    }
    let known = progress.quality.clone().unwrap_or_else(|| "not traced yet".to_owned());
    let state = if progress.refining {
        " · refining"
    } else if progress.paths >= glass.paths {
        " · done"
    } else {
        ""
    };
    ui.label(format!("{known}{state}"));
}
