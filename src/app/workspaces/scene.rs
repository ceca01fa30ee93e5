//! The scene as a mesh in space, with its lights: moved by numbers or by their handles, their shadow maps below.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{
    CentralPanel, Color32, ColorImage, Context, Frame, Image, Panel, Rect, Sense, Stroke, TextureHandle,
    TextureOptions, Ui, vec2,
};
use glam::DVec3;

use super::Panels;
use crate::app::draw::ink::color;
use crate::app::draw::space::{Eye, Projection};
use crate::app::draw::stage::{Shown, picture};
use crate::app::draw::style::theme;
use crate::app::panels::mesh_scene;
use crate::app::session::Session;
use crate::app::session::asides::{Aside, Watch};
use crate::app::session::ask::{Ask, Asks};
use crate::report::shadow_map::{self, Aspect};
use crate::scene::Stage;
use crate::scene::mesh_scene::{LightKind, MeshScene};
use crate::scene::shadow_map::ShadowMap;
use crate::scene::stage::Cache;

/// What a scene is made from.
type Wanted = (MeshScene, usize, PathBuf);

/// The workspace's own state.
pub struct Scene {
    stage: Aside<Wanted, Arc<Stage>>,
    cache: Arc<Cache>,
    /// Why there is no scene.
    fault: Option<String>,
    eye: Eye,
    shown: Shown,
    /// The picture in view with what it shows.
    drawn: Option<(Drawn, TextureHandle)>,
    /// The light whose handle is being dragged.
    held: Option<usize>,
    aspect: Aspect,
    maps: Vec<(Arc<ShadowMap>, Aspect, TextureHandle)>,
}

/// Everything that the picture depends on.
#[derive(Clone)]
struct Drawn {
    stage: Arc<Stage>,
    eye: Eye,
    shown: Shown,
    size: [usize; 2],
    dark: bool,
}

impl PartialEq for Drawn {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.stage, &other.stage)
            && (self.eye, self.shown, self.size, self.dark) == (other.eye, other.shown, other.size, other.dark)
    }
}

impl Default for Scene {
    fn default() -> Self {
        Scene {
            stage: Aside::new("scene"),
            cache: Arc::default(),
            fault: None,
            eye: Eye::default(),
            shown: Shown::default(),
            drawn: None,
            held: None,
            aspect: Aspect::Flux,
            maps: Vec::new(),
        }
    }
}

impl Panels for Scene {
    fn logic(&mut self, ctx: &Context, session: &Session, _asks: &mut Asks) {
        if let Err(line) = self.stage.hear(ctx) {
            self.fault = Some(line);
        }
        let preset = &session.document.preset;
        let Some(scene) = &preset.scene else { return };
        let wanted = (scene.clone(), preset.size, session.document.folder());
        if self.stage.known(&wanted).is_some() {
            self.fault = None;
            return;
        }
        let (key, cache) = (wanted.clone(), Arc::clone(&self.cache));
        let work = |_: Option<(&Wanted, &Arc<Stage>)>| {
            move |watch: &Watch| {
                let (scene, size, folder) = wanted;
                let mut progress = |share: f64| {
                    watch.go_on(share);
                };
                let stage = Stage::new(&scene, size, &folder, &cache, &mut progress);
                stage.map(Arc::new).map_err(|error| error.to_string())
            }
        };
        if let Err(line) = self.stage.want(&key, ctx, work) {
            self.fault = Some(line);
        }
    }

    fn ui(&mut self, ui: &mut Ui, session: &Session, asks: &mut Asks) {
        let has_mesh = session.document.preset.scene.is_some();
        let stage = self.stage.latest().filter(|_| has_mesh).map(|(_, stage)| Arc::clone(stage));
        Panel::right("mesh scene").exact_size(300.0).resizable(false).show(ui, |ui| {
            mesh_scene::ui(ui, session, stage.as_deref(), asks);
        });
        if let Some(stage) = stage.as_ref().filter(|stage| !stage.maps.is_empty()) {
            Panel::bottom("shadow maps").default_size(190.0).size_range(90.0..=500.0).resizable(true).show(ui, |ui| {
                self.maps(ui, stage);
            });
        }
        Panel::top("scene view").show(ui, |ui| self.bar(ui));
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| match &stage {
            Some(stage) => self.space(ui, session, stage, asks),
            None if self.fault.is_none() && has_mesh => {
                ui.centered_and_justified(|ui| ui.label("Reading the mesh…"));
            }
            None => {}
        });
    }
}

impl Scene {
    fn bar(&mut self, ui: &mut Ui) {
        ui.horizontal_wrapped(|ui| {
            let Shown { mesh, backs, emitters, cells } = &mut self.shown;
            ui.checkbox(mesh, "Mesh");
            ui.checkbox(backs, "Backs").on_hover_text("Triangles that face away too: they may hide what is inside");
            ui.checkbox(emitters, "Virtual point lights");
            ui.checkbox(cells, "Occupied cells");
            if let Some(share) = self.stage.share() {
                ui.spinner();
                ui.label(format!("{:.0} %", 100.0 * share));
            }
            if let Some(fault) = &self.fault {
                ui.colored_label(ui.visuals().error_fg_color, fault);
            }
        });
    }

    /// The mesh in space with the handles of its lights.
    fn space(&mut self, ui: &mut Ui, session: &Session, stage: &Arc<Stage>, asks: &mut Asks) {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "View: the mesh in space"));
        let theme = theme(ui.ctx());
        let projection = Projection::new(&self.eye, rect, stage.placement.size);
        let handled = self.handles(session, stage, &projection, &response, asks);
        if !handled {
            self.eye.steer(ui, rect, &response);
        }
        let size = [rect.width().max(1.0) as usize, rect.height().max(1.0) as usize];
        let drawn = Drawn { stage: Arc::clone(stage), eye: self.eye, shown: self.shown, size, dark: theme.dark };
        if self.drawn.as_ref().is_none_or(|(known, _)| *known != drawn) {
            let image = picture(stage, &self.eye, size, self.shown, &theme);
            let texture = ui.ctx().load_texture("scene", image, TextureOptions::LINEAR);
            self.drawn = Some((drawn, texture));
        }
        let painter = ui.painter_at(rect);
        if let Some((_, texture)) = &self.drawn {
            painter.image(
                texture.id(),
                rect,
                Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0)),
                Color32::WHITE,
            );
        }
        let projection = Projection::new(&self.eye, rect, stage.placement.size);
        volume(&painter, &projection, stage.placement.size as f32, color(theme.muted));
        let scene = session.document.preset.scene.as_ref();
        for (i, light) in scene.iter().flat_map(|scene| scene.lights.iter().enumerate()) {
            let (LightKind::Point { position } | LightKind::Spot { position, .. }) = light.kind else { continue };
            let at = projection.at(stage.placement.in_cells(DVec3::from_array(position)).as_vec3());
            let ink = if light.enabled { Color32::from_rgb(255, 210, 60) } else { Color32::GRAY };
            painter.circle(at, if self.held == Some(i) { 9.0 } else { 7.0 }, ink, Stroke::new(1.5, Color32::BLACK));
        }
    }

    /// Takes a light by its handle and moves it across the view; whether one is held.
    fn handles(
        &mut self,
        session: &Session,
        stage: &Stage,
        projection: &Projection,
        response: &egui::Response,
        asks: &mut Asks,
    ) -> bool {
        let before = &session.document.preset;
        let Some(scene) = &before.scene else { return false };
        let place = |position: [f64; 3]| stage.placement.in_cells(DVec3::from_array(position)).as_vec3();
        if response.drag_started() {
            let Some(pointer) = response.interact_pointer_pos() else { return false };
            let near = |(i, light): (usize, &crate::scene::mesh_scene::Light)| match light.kind {
                LightKind::Point { position } | LightKind::Spot { position, .. } => {
                    let off = projection.at(place(position)).distance(pointer);
                    (off < 14.0).then_some((i, off))
                }
                LightKind::Sun { .. } => None,
            };
            let nearest = scene.lights.iter().enumerate().filter_map(near).min_by(|a, b| a.1.total_cmp(&b.1));
            self.held = nearest.map(|(i, _)| i);
        }
        if response.drag_stopped() {
            self.held = None;
        }
        let Some(held) = self.held.filter(|held| *held < scene.lights.len()) else { return false };
        if response.dragged() {
            let mut preset = before.clone();
            let light = preset.scene.as_mut().map(|scene| &mut scene.lights[held].kind);
            if let Some(LightKind::Point { position } | LightKind::Spot { position, .. }) = light {
                let moved = self.eye.drag(projection, place(*position), response.drag_delta());
                let by = moved.as_dvec3() * stage.placement.cell_side;
                *position = (DVec3::from_array(*position) + by).to_array();
            }
            asks.changed(before, preset, |preset| Ask::Preset(Box::new(preset)));
        }
        true
    }

    /// The shadow map of every light.
    fn maps(&mut self, ui: &mut Ui, stage: &Stage) {
        ui.horizontal(|ui| {
            ui.label("Shadow maps");
            for aspect in Aspect::ALL {
                ui.selectable_value(&mut self.aspect, aspect, aspect.name());
            }
        });
        self.maps.retain(|(map, aspect, _)| *aspect == self.aspect && stage.maps.iter().any(|m| Arc::ptr_eq(m, map)));
        let height = (ui.available_height() - 22.0).max(40.0);
        egui::ScrollArea::horizontal().show(ui, |ui| {
            ui.horizontal(|ui| {
                for (i, map) in stage.maps.iter().enumerate() {
                    let known = self.maps.iter().position(|(known, _, _)| Arc::ptr_eq(known, map));
                    let known = known.unwrap_or_else(|| {
                        let picture = shadow_map::picture(map, self.aspect);
                        let size = [picture.width() as usize, picture.height() as usize];
                        let image = ColorImage::from_rgb(size, picture.as_raw());
                        let texture = ui.ctx().load_texture(format!("map {i}"), image, TextureOptions::NEAREST);
                        self.maps.push((Arc::clone(map), self.aspect, texture));
                        self.maps.len() - 1
                    });
                    let texture = &self.maps[known].2;
                    let size = texture.size_vec2();
                    let size = vec2(height * size.x / size.y.max(1.0), height);
                    let alt = format!("Shadow map of light {}: {}", i + 1, self.aspect.name());
                    ui.add(Image::new((texture.id(), size)).alt_text(&alt)).on_hover_text(alt);
                }
            });
        });
    }
}

/// The edges of the volume.
fn volume(painter: &egui::Painter, projection: &Projection, n: f32, ink: Color32) {
    let corner = |i: usize| glam::vec3((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * n;
    for from in 0..8usize {
        for to in [1, 2, 4].map(|bit| from ^ bit).into_iter().filter(|to| from < *to) {
            let line = [projection.at(corner(from)), projection.at(corner(to))];
            painter.line_segment(line, (1.0, ink.gamma_multiply(0.7)));
        }
    }
}
